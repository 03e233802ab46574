import { html } from "../app/dom";
import type { Messages } from "../messages/en";
import type { Capsule } from "../model/capsule";

/** The notices of all that is bundled, a file beside the script. */
const NOTICES = "./THIRD-PARTY.txt";

/** The model that is computed with: every figure on the page belongs to the one with this digest. */
export function describe(list: HTMLElement, { model, bytes }: Capsule, home: URL, words: Messages): void {
  const { page, card, laws } = words;
  const created = new Date(model.createdUnixS * 1000).toISOString().slice(0, 10);
  const samples = model.samples().length / model.parameterNames().length;
  const entries: [name: string, value: string, hint: string][] = [
    [page.model, model.digest, card.origin(model.title, model.databaseDigest, created)],
    [card.samples, String(samples), card.samplesHint],
    [card.membrane, laws[model.membraneLaw] ?? model.membraneLaw, card.membraneHint],
    [card.size, card.megabytes((bytes / 1e6).toFixed(2)), card.sizeHint(model.nodeCount)],
  ];
  const licences = html("a", { href: new URL(NOTICES, home).href, textContent: card.thirdParty });
  list.replaceChildren(
    ...entries.map(([name, value, hint]) =>
      html("div", { title: hint }, html("dt", { textContent: name }), html("dd", { textContent: value })),
    ),
    html("div", {}, html("dt", { textContent: card.licences }), html("dd", {}, licences)),
  );
  list.dataset.digest = model.digest;
}
