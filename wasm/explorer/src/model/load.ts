import { en, type Messages } from "../messages/en";
import initialise from "../wasm/capsule_wasm";
import wasmAddress from "../wasm/capsule_wasm_bg.wasm?url";
import { Capsule } from "./capsule";
import { reason, refusalOf, text } from "./refusal";

/** Why there is no model to show, and what would help: in the language in which it is asked for. */
export class ModelError extends Error {
  readonly say: (words: Refusals) => readonly [message: string, remedy: string];

  constructor(say: (words: Refusals) => readonly [message: string, remedy: string]) {
    super(say(en.refusals)[0]);
    this.say = say;
  }
}

type Refusals = Messages["refusals"];

/** Bytes of the header: magic, version, payload length, CRC-32. */
const HEADER = 16;
const MAGIC = [..."CROM"].map((letter) => letter.charCodeAt(0));

/** Starts to load the WebAssembly module; it is loaded once, whoever asks. */
export function loadModule(): Promise<unknown> {
  module ??= initialise({ module_or_path: wasmAddress }).catch((error) => {
    module = undefined;
    throw new ModelError((words) => [words.noProgram(text(error)), words.loadAgain]);
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
    throw new ModelError((words) => [words.unread(name, text(error)), words.openReadable]);
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
    throw new ModelError((words) => [words.elsewhere(address.href), words.putBeside]);
  }
  let response: Response;
  try {
    response = await fetch(address);
    if (response.ok) return new Uint8Array(await response.arrayBuffer());
  } catch (error) {
    throw new ModelError((words) => [words.unfetched(name, text(error)), words.loadAgain]);
  }
  const { status } = response;
  throw new ModelError((words) => [words.missing(name, status, address.pathname), words.buildPage]);
}

/** Refuses what cannot be a model before it takes room in the module's memory. */
function check(header: Uint8Array, size: number, name: string): void {
  if (!MAGIC.every((byte, i) => header[i] === byte)) throw noModel(name, (words) => words.noMagic);
  if (header.length < HEADER) throw noModel(name, (words) => words.truncated);
  const stated = HEADER + new DataView(header.buffer, header.byteOffset).getUint32(8, true);
  if (size < stated) throw noModel(name, (words) => words.tooShort(size, stated));
  if (size > stated) throw noModel(name, (words) => words.tooLong(size, stated));
}

function open(bytes: Uint8Array, name: string, file: string | undefined): Capsule {
  try {
    return new Capsule(bytes, file);
  } catch (error) {
    const refusal = refusalOf(error);
    throw noModel(name, (words) => reason(words, refusal).words);
  }
}

const noModel = (name: string, cause: (words: Refusals) => string) =>
  new ModelError((words) => [words.noModel(name, cause(words)), words.openModel]);

const nameOf = (address: URL) => address.pathname.split("/").at(-1) ?? address.pathname;
