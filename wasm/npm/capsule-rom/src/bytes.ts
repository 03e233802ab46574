import { CapsuleError } from "./errors.js";

/** Bytes, or where they lie: an address, or in Node a path. */
export type Source = URL | string | ArrayBuffer | ArrayBufferView;

/** What Node has for files; not imported, so that bundlers for browsers need not know of it. */
interface Files {
  readFile(path: URL | string): Promise<Uint8Array>;
}

const ADDRESS = /^(https?|blob|data|file):/;

/** Reads bytes; throws a `CapsuleError` that names the source. */
export async function read(source: Source): Promise<Uint8Array> {
  if (source instanceof ArrayBuffer) return new Uint8Array(source);
  if (ArrayBuffer.isView(source)) return new Uint8Array(source.buffer, source.byteOffset, source.byteLength);
  const { process } = globalThis as { process?: { getBuiltinModule?(name: string): Files } };
  const files = process?.getBuiltinModule?.("node:fs/promises");
  const text = String(source);
  try {
    if (files !== undefined && text.startsWith("file:")) return await files.readFile(new URL(text));
    if (files !== undefined && !ADDRESS.test(text)) return await files.readFile(text);
    const response = await fetch(source);
    if (response.ok) return new Uint8Array(await response.arrayBuffer());
    throw new Error(`the server answered ${response.status}`);
  } catch (error) {
    const words = error instanceof Error ? error.message : String(error);
    throw new CapsuleError("not-read", `${text} could not be read: ${words}`);
  }
}

/** What is loaded once, when it is first asked for; again after a failure. */
export function once(load: () => Promise<unknown>): () => Promise<unknown> {
  let loaded: Promise<unknown> | undefined;
  return () => {
    loaded ??= load().catch((error) => {
      loaded = undefined;
      throw error;
    });
    return loaded;
  };
}
