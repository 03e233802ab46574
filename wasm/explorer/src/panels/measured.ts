import { button, html, type Root } from "../app/dom";
import type { Store } from "../app/store";
import { answerCsv, answerJson } from "../export/answer";
import { figureSvg, svgText } from "../export/figure";
import { save } from "../export/save";
import type { Measured } from "../identify/measured";
import { writtenMisfit } from "../identify/misfit-grid";
import type { Answer, Ends } from "../identify/protocol";
import type { Need } from "../model/capsule";
import { FitDrawing } from "../views/fit-drawing";
import type { Context, Trace, ViewPart } from "../views/view";
import { MeasuredForm } from "./measured-form";

const USE = "Choose a text of points or a picture (PNG, JPEG, TIFF), drop it anywhere on the page, or paste it.";

const SQUARE = "A picture does not tell a square channel from a round tube: in a tube the numbers would be wrong.";

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
  #shown: Answer | undefined;
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
    this.#drawing = new FitDrawing(this.#stage);
  }

  draw(_: readonly Trace[], context: Context): void {
    this.#context = context;
    const { state } = context;
    const { file, found, problem, isBusy, regions } = this.#measured;
    this.#form.draw(state);
    this.#file.textContent = file?.name ?? "";
    const answer = found?.answer;
    const words = answer === undefined ? problem : `${answer.verdict}: ${answer.verdict_text}`;
    this.#say(file === undefined ? USE : isBusy ? "Identifying…" : words);
    this.#verdict.classList.toggle("problem", problem !== "");
    if (answer !== this.#shown) {
      this.#shown = answer;
      this.#answer.replaceChildren(...(answer === undefined ? [] : this.#parts(answer)));
    }
    const misfit = found === undefined ? undefined : this.#measured.misfit(state);
    this.#live.textContent = found === undefined ? "" : `The capsule on screen: ${writtenMisfit(misfit)}`;
    this.#stage.hidden = found === undefined;
    this.#drawing.draw(found, regions);
  }

  /** A live region that is written again is spoken again: leave it alone while it says the same. */
  #say(words: string): void {
    if (this.#said === words) return;
    this.#said = words;
    this.#verdict.textContent = words;
  }

  #parts(answer: Answer): Node[] {
    const parts: Node[] = [table(answer), html("p", { className: "errors", textContent: details(answer) })];
    if (answer.alternative !== undefined) {
      const { ca, confinement, rise_of_chi_squared: rise } = answer.alternative;
      const place = `Ca ${ca.toFixed(5)}, a/ℓ ${confinement.toFixed(4)}`;
      const words = `Another solution: ${place}, χ² greater by ${rise.toFixed(2)}.`;
      parts.push(html("p", { textContent: words }));
    }
    for (const warning of answer.warnings ?? []) {
      parts.push(html("p", { className: "problem", textContent: `Warning: ${warning}.` }));
    }
    if (answer.picture !== undefined) parts.push(html("p", { className: "errors", textContent: SQUARE }));
    const name = (extension: string) => `capsule-identified-${answer.model_digest}.${extension}`;
    parts.push(
      html(
        "div",
        { className: "buttons" },
        button("Show this capsule", () => this.#show(answer)),
        labelled("JSON", () => save(name("json"), answerJson(answer))),
        labelled("CSV", () => save(name("csv"), answerCsv(answer))),
        labelled("SVG", () => save(name("svg"), this.#svg(answer))),
        button("Remove", () => this.#measured.take(undefined)),
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

  #svg(answer: Answer): string {
    const against = this.#context?.errors.sentence.replaceAll("\u00a0", " ") ?? "";
    const line = `Ca = ${answer.ca.toPrecision(5)}, a/l = ${answer.confinement.toPrecision(5)}, ${answer.verdict}`;
    return svgText(
      figureSvg(this.#stage, {
        title: `Measured outline ${this.#measured.file?.name ?? ""}`,
        foot: `Model ${answer.model_digest}; ${line}`,
        description: [line, answer.verdict_text, details(answer), against].join("\n"),
      }),
    );
  }
}

/** Six digits: more than anybody measures. */
const rounded = (value: number) => Number(value.toPrecision(6));

const labelled = (format: string, run: () => void) => {
  const made = button(format, run);
  made.ariaLabel = `Answer, ${format}`;
  return made;
};

function details(answer: Answer): string {
  const signed = (value: number, digits: number) => `${value < 0 ? "−" : "+"}${Math.abs(value).toFixed(digits)}`;
  return [
    `${answer.contour}; flow ${answer.flow}`,
    `residuals ${answer.residual_um.toFixed(3)} µm, edge ${signed(answer.edge_um, 3)} µm`,
    `scale ${signed(100 * answer.scale_error, 2)} %, tilt ${signed(answer.tilt_degrees, 2)}°`,
    `χ² ${answer.chi_squared.toFixed(0)} for ${answer.degrees_of_freedom.toFixed(0)}`,
    `model ${answer.model_digest}`,
  ].join("; ");
}

function table(answer: Answer): HTMLElement {
  const row = (name: string, id: string, value: number, narrow: Ends, wide: Ends, digits: number) => {
    const end = (one: number | null) => (one === null ? "open" : one.toFixed(digits));
    const interval = ([low, high]: Ends) => html("td", { textContent: `${end(low)} to ${end(high)}` });
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
  const heads = ["quantity", "value", "68 %", "95 %"].map((textContent) => html("th", { scope: "col", textContent }));
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
