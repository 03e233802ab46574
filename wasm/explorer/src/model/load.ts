import initialise from "../wasm/capsule_wasm";
import wasmAddress from "../wasm/capsule_wasm_bg.wasm?url";
import { text } from "./answer";
import { Capsule } from "./capsule";

/** Why there is no model to show, and what would help. */
export class ModelError extends Error {
  readonly remedy: string;

  constructor(message: string, remedy: string) {
    super(message);
    this.remedy = remedy;
  }
}

/** Bytes of the header: magic, version, payload length, CRC-32. */
const HEADER = 16;
const MAGIC = [..."CROM"].map((letter) => letter.charCodeAt(0));
const WHICH = "Open a .crom file that `capsule-rom offline build` wrote, or copy this one again.";

/** Starts to load the WebAssembly module; it is loaded once, whoever asks. */
export function loadModule(): Promise<unknown> {
  module ??= initialise({ module_or_path: wasmAddress }).catch((error) => {
    module = undefined;
    throw new ModelError(
      `The page's program could not be loaded: ${text(error)}.`,
      "See whether the server still runs, then load the page again.",
    );
  });
  return module;
}

let module: Promise<unknown> | undefined;

/** Opens a file of the user's; throws a `ModelError`. A file that is no model is not read beyond its header. */
export async function openFile(file: File): Promise<Capsule> {
  check(await read(file.slice(0, HEADER), file.name), file.size, file.name);
  const [bytes] = await Promise.all([read(file, file.name), loadModule()]);
  return open(bytes, file.name, file.name);
}

/** The bytes of a file of the user's, or of a part of it; throws a `ModelError`. */
export async function read(part: Blob, name: string): Promise<Uint8Array> {
  try {
    return new Uint8Array(await part.arrayBuffer());
  } catch (error) {
    throw new ModelError(`${name} could not be read: ${text(error)}.`, "Open a file, not a folder, that you may read.");
  }
}

/** Fetches a model while the module loads; throws a `ModelError`. */
export async function fetchModel(address: URL, isShipped: boolean): Promise<Capsule> {
  const [bytes] = await Promise.all([download(address), loadModule()]);
  const name = nameOf(address);
  check(bytes.subarray(0, HEADER), bytes.length, name);
  return open(bytes, name, isShipped ? undefined : name);
}

async function download(address: URL): Promise<Uint8Array> {
  const name = nameOf(address);
  if (address.origin !== window.location.origin) {
    throw new ModelError(
      `The model ${address.href} lies on another server.`,
      "Put it beside this page, or download it and open it from your disk.",
    );
  }
  let response: Response;
  try {
    response = await fetch(address);
    if (response.ok) return new Uint8Array(await response.arrayBuffer());
  } catch (error) {
    throw new ModelError(
      `The model ${name} could not be fetched: ${text(error)}.`,
      "See whether the server still runs, then load the page again.",
    );
  }
  throw new ModelError(
    `The model ${name} is missing: the server answered ${response.status} for ${address.pathname}.`,
    "Build the page with `cargo xtask explore`, which puts the model beside it, or open a .crom file from your disk.",
  );
}

/** Refuses what cannot be a model before it takes room in the module's memory. */
function check(header: Uint8Array, size: number, name: string): void {
  if (!MAGIC.every((byte, i) => header[i] === byte)) {
    throw new ModelError(`${name} is not a model that can be read: it does not begin with CROM.`, WHICH);
  }
  if (header.length < HEADER) throw new ModelError(`${name} is not a model that can be read: it is truncated.`, WHICH);
  const stated = HEADER + new DataView(header.buffer, header.byteOffset).getUint32(8, true);
  if (stated !== size) {
    const what = size < stated ? "truncated" : "too long";
    throw new ModelError(`${name} is not a model that can be read: it is ${what}, ${size} bytes of ${stated}.`, WHICH);
  }
}

function open(bytes: Uint8Array, name: string, file: string | undefined): Capsule {
  try {
    return new Capsule(bytes, file);
  } catch (error) {
    throw new ModelError(`${name} is not a model that can be read: ${text(error)}.`, WHICH);
  }
}

const nameOf = (address: URL) => address.pathname.split("/").at(-1) ?? address.pathname;
