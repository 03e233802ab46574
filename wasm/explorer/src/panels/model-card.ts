import { html } from "../app/dom";
import type { Capsule } from "../model/capsule";

/** The model that is computed with: every figure on the page belongs to the one with this digest. */
export function describe(list: HTMLElement, { model, bytes }: Capsule): void {
  const created = new Date(model.createdUnixS * 1000).toISOString().slice(0, 10);
  const entries: [name: string, value: string, hint: string][] = [
    ["Model", model.digest, `${model.title}. Database ${model.databaseDigest}, made on ${created}`],
    [
      "Samples",
      String(model.samples().length / model.parameterNames().length),
      "Full-order simulations that the model was made from",
    ],
    ["Membrane", model.membraneLaw, "Constitutive law of the membrane"],
    ["Size", `${(bytes / 1e6).toFixed(2)} MB`, `${model.nodeCount} nodes on the membrane`],
  ];
  const licences = html("a", { href: "./THIRD-PARTY.txt", textContent: "third-party" });
  list.replaceChildren(
    ...entries.map(([name, value, hint]) =>
      html("div", { title: hint }, html("dt", { textContent: name }), html("dd", { textContent: value })),
    ),
    html("div", {}, html("dt", { textContent: "Licences" }), html("dd", {}, licences)),
  );
  list.dataset.digest = model.digest;
}
