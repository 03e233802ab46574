import { once, read, type Source } from "./bytes.js";
import initialise from "./capsule_wasm.js";
import { Model } from "./model.js";

const loadModule = once(async () => {
  await initialise({ module_or_path: await read(new URL("./capsule_wasm_bg.wasm", import.meta.url)) });
});

/**
 * Opens a model file (.crom): the shipped one, or another one by its bytes, its address or, in Node, its path. Throws a
 * `CapsuleError` for a file that cannot be read or is no model.
 */
export async function load(source: Source = new URL("./capsule.crom", import.meta.url)): Promise<Model> {
  const [bytes] = await Promise.all([read(source), loadModule()]);
  return new Model(bytes);
}
