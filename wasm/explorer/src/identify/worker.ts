import { refusalOf } from "../model/refusal";
import initialise, { Identifier } from "../wasm/capsule_identify_wasm";
import wasmAddress from "../wasm/capsule_identify_wasm_bg.wasm?url";
import type { Asked, Found, Question, Reply } from "./protocol";

/** Identifies beside the page: its own module, loaded when the page first asks. Questions are answered in turn. */

const module = initialise({ module_or_path: wasmAddress });
let identifier: Identifier | undefined;

async function answer(question: Question): Promise<Found | Float64Array | undefined> {
  await module;
  if (question.kind === "open") {
    identifier?.free();
    identifier = undefined;
    identifier = Identifier.open(question.model);
    return undefined;
  }
  if (identifier === undefined) throw new Error("no model is open");
  if (question.kind === "misfit") return identifier.misfit(question.places);
  return JSON.parse(identifier.identify(question.name, question.file, JSON.stringify(question.said)));
}

let turn = Promise.resolve();

self.addEventListener("message", ({ data: { id, question } }: MessageEvent<Asked>) => {
  turn = turn.then(async () => {
    let reply: Reply;
    try {
      reply = { id, result: await answer(question) };
    } catch (error) {
      reply = { id, refusal: refusalOf(error) };
    }
    self.postMessage(reply);
  });
});
