import { button, html, inEnglish, type Root } from "../app/dom";
import { FLOWS } from "../app/schema";
import type { Store } from "../app/store";
import { answerCsv, answerJson } from "../export/answer";
import { figureSvg, svgText } from "../export/figure";
import { save } from "../export/save";
import type { Measured } from "../identify/measured";
import { writtenMisfit } from "../identify/misfit-grid";
import type { Answer, Ends } from "../identify/protocol";
import type { Messages } from "../messages/en";
import type { Need } from "../model/capsule";
import { reason } from "../model/refusal";
import { FitDrawing } from "../views/fit-drawing";
import type { Context, Trace, ViewPart } from "../views/view";
import { MeasuredForm } from "./measured-form";

type Words = Messages["outline"];

/** The view of a measured outline: its file and its sizes, the capsule that fits it best, and how sure that is. */
export class MeasuredView implements ViewPart {
  readonly needs: readonly Need[] = ["channel", "outlines"];
  readonly #store: Store;
  readonly #measured: Measured;
  readonly #form: MeasuredForm;
  readonly #file: HTMLElement;
  readonly #verdict: HTMLElement;
  readonly #answer: HTMLElement;
  readonly #live: HTMLElement;
  readonly #stage: HTMLElement;
  readonly #drawing: FitDrawing;
  #said = "";
  #shown: readonly [Answer | undefined, Messages | undefined] = [undefined, undefined];
  #context: Context | undefined;

  constructor(root: Root, store: Store, measured: Measured, onFile: (file: File) => void) {
    this.#store = store;
    this.#measured = measured;
    this.#form = new MeasuredForm(root, store, onFile);
    this.#file = root.part("measured-file", HTMLElement);
    this.#verdict = root.part("measured-verdict", HTMLElement);
    this.#answer = root.part("measured-answer", HTMLElement);
    this.#live = root.part("measured-live", HTMLElement);
    this.#stage = root.part("measured", HTMLElement);
    this.#drawing = new FitDrawing(root, this.#stage);
  }

  draw(_: readonly Trace[], context: Context): void {
    this.#context = context;
    const { state } = context;
    const { file, found, problem, isBusy, regions } = this.#measured;
    this.#form.draw(state);
    this.#file.textContent = file?.name ?? "";
    const answer = found?.answer;
    const words = context.words.outline;
    this.#verdict.classList.toggle("problem", problem !== undefined);
    if (answer !== undefined) {
      const [name, meaning] = verdictOf(answer, words);
      this.#say(words.verdict(name, meaning), meaning === answer.verdict_text);
    } else if (file === undefined) this.#say(words.use);
    else if (isBusy || problem === undefined) this.#say(words.busy);
    else if (typeof problem === "function") this.#say(problem(words));
    else {
      const { words: said, isEnglish } = reason(context.words.refusals, problem);
      this.#say(said, isEnglish);
    }
    if (answer !== this.#shown[0] || context.words !== this.#shown[1]) {
      this.#shown = [answer, context.words];
      this.#answer.replaceChildren(...(answer === undefined ? [] : this.#parts(answer, words)));
    }
    const misfit = found === undefined ? undefined : this.#measured.misfit(state);
    this.#live.textContent = found === undefined ? "" : words.onScreen(writtenMisfit(context.words, misfit));
    this.#stage.hidden = found === undefined;
    this.#drawing.draw(found, regions);
  }

  /** A live region that is written again is spoken again: leave it alone while it says the same. */
  #say(words: string, isCore = false): void {
    if (this.#said === words) return;
    this.#said = words;
    this.#verdict.replaceChildren(isCore ? inEnglish(words) : words);
  }

  #parts(answer: Answer, words: Words): Node[] {
    const note = html("p", { className: "errors" }, inEnglish(answer.contour), `; ${details(answer, words)}`);
    const parts: Node[] = [table(answer, words), note];
    if (answer.alternative !== undefined) {
      const { ca, confinement, rise_of_chi_squared: rise } = answer.alternative;
      const place = `Ca ${ca.toFixed(5)}, a/ℓ ${confinement.toFixed(4)}`;
      parts.push(html("p", { textContent: words.alternative(place, rise.toFixed(2)) }));
    }
    for (const warning of answer.warnings ?? []) {
      parts.push(html("p", { className: "problem" }, words.warning, inEnglish(`${warning}.`)));
    }
    if (answer.picture !== undefined) parts.push(html("p", { className: "errors", textContent: words.square }));
    const name = (extension: string) => `capsule-identified-${answer.model_digest}.${extension}`;
    const labelled = (format: string, run: () => void) => {
      const made = button(format, run);
      made.ariaLabel = words.answerAs(format);
      return made;
    };
    parts.push(
      html(
        "div",
        { className: "buttons" },
        button(words.show, () => this.#show(answer)),
        labelled("JSON", () => save(name("json"), answerJson(answer))),
        labelled("CSV", () => save(name("csv"), answerCsv(answer))),
        labelled("SVG", () => save(name("svg"), this.#svg(answer, words))),
        button(words.remove, () => this.#measured.take(undefined)),
      ),
    );
    return parts;
  }

  /** Makes the capsule that fits best the live one, in its steady state and in the sizes of the experiment. */
  #show({ ca, confinement, gs_n_per_m: modulus }: Answer): void {
    const { state } = this.#store;
    this.#store.set({
      ca: rounded(ca),
      confinement: rounded(confinement),
      t: state.end,
      method: "direct",
      extrapolate: false,
      playing: false,
      dimensions: [2 * state.halfWidth, 1e3 * state.viscosity, 1e3 * modulus].map(rounded),
    });
  }

  #svg(answer: Answer, words: Words): string {
    const against = this.#context?.errors.sentence.replaceAll("\u00a0", " ") ?? "";
    const [name, meaning] = verdictOf(answer, words);
    const line = `Ca = ${answer.ca.toPrecision(5)}, a/l = ${answer.confinement.toPrecision(5)}, ${name}`;
    return svgText(
      figureSvg(this.#stage, {
        title: words.title(this.#measured.file?.name ?? ""),
        foot: words.foot(answer.model_digest, line),
        description: [line, meaning, `${answer.contour}; ${details(answer, words)}`, against].join("\n"),
      }),
    );
  }
}

/** The verdict's name and meaning; where a language has none, those of the core. */
function verdictOf({ verdict, verdict_text }: Answer, { verdicts }: Words): readonly [string, string] {
  return verdicts[verdict] ?? [verdict, verdict_text];
}

/** Six digits: more than anybody measures. */
const rounded = (value: number) => Number(value.toPrecision(6));

function details(answer: Answer, words: Words): string {
  const signed = (value: number, digits: number) => `${value < 0 ? "−" : "+"}${Math.abs(value).toFixed(digits)}`;
  const found = words.details(
    flowOf(answer, words),
    answer.residual_um.toFixed(3),
    signed(answer.edge_um, 3),
    signed(100 * answer.scale_error, 2),
    signed(answer.tilt_degrees, 2),
    answer.chi_squared.toFixed(0),
    answer.degrees_of_freedom.toFixed(0),
  );
  return `${found}; ${words.ofModel(answer.model_digest)}`;
}

/** The direction of the flow; in a picture it is one that the core found. */
function flowOf({ flow }: Answer, { flows }: Words): string {
  const known = FLOWS.find((name) => name === flow);
  return known === undefined ? flow : flows[known];
}

function table(answer: Answer, words: Words): HTMLElement {
  const row = (name: string, id: string, value: number, narrow: Ends, wide: Ends, digits: number) => {
    const end = (one: number | null) => (one === null ? words.open : one.toFixed(digits));
    const interval = ([low, high]: Ends) => html("td", { textContent: words.interval(end(low), end(high)) });
    const output = html("output", { textContent: value.toFixed(digits) });
    output.dataset.identified = id;
    output.dataset.value = String(value);
    output.ariaLive = "off";
    return html(
      "tr",
      {},
      html("th", { scope: "row", textContent: name }),
      html("td", {}, output),
      interval(narrow),
      interval(wide),
    );
  };
  const milli = ([low, high]: Ends): Ends => [low === null ? null : 1e3 * low, high === null ? null : 1e3 * high];
  const heads = [words.quantity, words.value, "68 %", "95 %"].map((textContent) =>
    html("th", { scope: "col", textContent }),
  );
  return html(
    "table",
    {},
    html("thead", {}, html("tr", {}, ...heads)),
    html(
      "tbody",
      {},
      row("Ca", "ca", answer.ca, answer.ca_68, answer.ca_95, 5),
      row("a/ℓ", "confinement", answer.confinement, answer.confinement_68, answer.confinement_95, 4),
      row("a, µm", "radius_um", answer.radius_um, answer.radius_um_68, answer.radius_um_95, 3),
      row(
        "Gₛ, mN/m",
        "gs_mn_per_m",
        1e3 * answer.gs_n_per_m,
        milli(answer.gs_n_per_m_68),
        milli(answer.gs_n_per_m_95),
        3,
      ),
    ),
  );
}
