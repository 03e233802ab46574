import { html, type Root } from "../app/dom";
import { QUANTITIES, type Quantity } from "../app/schema";
import type { Messages } from "../messages/en";
import type { Answer } from "../model/answer";
import { ERRORS, measure, nameOf, PRESENTATION, unitOf, written } from "../model/quantities";
import type { Units } from "../model/units";
import type { Context, Trace, ViewPart } from "../views/view";
import { shownTime } from "./time-axis";

/** How long things must be at rest before the figures are spoken. */
const REST_MS = 700;

interface Row {
  readonly row: HTMLButtonElement;
  readonly name: HTMLElement;
  readonly output: HTMLOutputElement;
  readonly unit: HTMLElement;
}

/** The figures of the instant on screen. Each output carries its number in full in `data-value`. */
export class Readouts implements ViewPart {
  readonly needs = [];
  readonly #rows = new Map<Quantity, Row>();
  readonly #panel: HTMLElement;
  readonly #announcement: HTMLElement;
  readonly #mark: HTMLElement;
  readonly #uncertain: HTMLElement;
  readonly #errors: HTMLElement;
  #announcing = 0;

  constructor(root: Root, onTrace: (quantity: Quantity) => void) {
    this.#panel = root.part("readouts", HTMLElement);
    this.#announcement = root.part("announcement", HTMLElement);
    this.#mark = root.part("extrapolated", HTMLElement);
    this.#uncertain = root.part("uncertain", HTMLElement);
    this.#errors = root.part("errors", HTMLElement);
    this.#panel.role = "radiogroup";
    for (const quantity of QUANTITIES) {
      const { plane } = PRESENTATION[quantity];
      const output = html("output", { id: root.id(quantity) });
      // They change sixty times a second; the announcement is spoken instead.
      output.ariaLive = "off";
      output.dataset.quantity = quantity;
      const name = html("span");
      const unit = html("span", { className: "unit" });
      const row = html("button", { type: "button", className: "readout" }, name, output, unit);
      row.role = "radio";
      if (plane !== undefined) row.dataset.plane = plane;
      if (ERRORS.has(quantity)) row.setAttribute("aria-describedby", this.#errors.id);
      row.addEventListener("click", () => onTrace(quantity));
      row.addEventListener("keydown", (event) => this.#rove(event, quantity, onTrace));
      this.#rows.set(quantity, { row, name, output, unit });
      this.#panel.append(row);
    }
  }

  draw([live]: readonly Trace[], { state, units, capsule, errors, words }: Context): void {
    if (this.#errors.textContent !== errors.sentence) this.#errors.textContent = errors.sentence;
    for (const [quantity, { row, unit }] of this.#rows) {
      row.ariaChecked = String(quantity === state.trace);
      row.tabIndex = quantity === state.trace ? 0 : -1;
      unit.textContent = unitOf(quantity, units).name;
    }
    window.clearTimeout(this.#announcing);
    if (live?.answer === undefined) {
      this.#clear(words);
      return;
    }
    this.#show(live.answer, live.radius, units, words);
    // The names of the rows hold their values; while time runs they would be rewritten in every frame.
    if (state.playing) return;
    const extrapolated = live.answer.validity.kind === "extrapolated";
    const figures = [...this.#rows].map(([quantity, { row }]) => {
      const value = measure(words, quantity, live.answer?.read(quantity), units);
      row.ariaLabel = `${nameOf(words, quantity, extrapolated)} ${value}`;
      return row.ariaLabel;
    });
    const query = live.query.parameters.map((value, i) => `${capsule.names()[i]} ${value}`).join(", ");
    const t = `${shownTime(state.t, state.end, units)} ${units.time.plain}`;
    const { announced, announcedExtrapolated } = words.readouts;
    const spoken = announced(query, t, figures.join(", "), errors.against);
    this.#announce(extrapolated ? announcedExtrapolated(spoken) : spoken);
  }

  #show(answer: Answer, radius: number, units: Units, words: Messages): void {
    const extrapolated = answer.validity.kind === "extrapolated";
    this.#markExtrapolated(extrapolated, words);
    this.#uncertain.hidden = extrapolated || !answer.isUncertain;
    for (const [quantity, { output, unit }] of this.#rows) {
      const value = answer.read(quantity);
      unit.toggleAttribute("hidden", value === undefined);
      if (value === undefined) {
        output.textContent = words.readouts.none;
        delete output.dataset.value;
        continue;
      }
      const isRough = answer.isUncertain && !ERRORS.has(quantity);
      output.textContent = isRough
        ? `≈ ${rough(value, answer.band * radius, quantity, units)}`
        : written(quantity, value, units);
      output.dataset.value = String(value);
    }
  }

  /** Shows that there is no answer, and has none spoken. */
  #clear(words: Messages): void {
    this.#markExtrapolated(false, words);
    this.#uncertain.hidden = true;
    for (const [quantity, { row, output, unit }] of this.#rows) {
      unit.toggleAttribute("hidden", false);
      output.textContent = "–";
      row.ariaLabel = words.readouts.noAnswer(nameOf(words, quantity, false));
      delete output.dataset.value;
    }
    this.#announcement.textContent = "";
  }

  #markExtrapolated(extrapolated: boolean, words: Messages): void {
    this.#mark.hidden = !extrapolated;
    this.#panel.ariaLabel = extrapolated ? words.readouts.groupExtrapolated : words.readouts.group;
    for (const [quantity, { name }] of this.#rows) name.textContent = nameOf(words, quantity, extrapolated);
  }

  /** Has the figures spoken once things have come to rest. */
  #announce(words: string): void {
    this.#announcing = window.setTimeout(() => {
      this.#announcement.textContent = words;
    }, REST_MS);
  }

  /** Arrow keys move the choice, as in any group of radio buttons. */
  #rove(event: KeyboardEvent, quantity: Quantity, onTrace: (quantity: Quantity) => void): void {
    const step = { ArrowDown: 1, ArrowRight: 1, ArrowUp: -1, ArrowLeft: -1 }[event.key];
    if (step === undefined) return;
    const next = QUANTITIES[(QUANTITIES.indexOf(quantity) + step + QUANTITIES.length) % QUANTITIES.length];
    if (next !== undefined) {
      onTrace(next);
      this.#rows.get(next)?.row.focus();
    }
    event.preventDefault();
    event.stopPropagation();
  }
}

/** A number with the digits that an error of `band` leaves. */
function rough(value: number, band: number, quantity: Quantity, units: Units): string {
  const { factor } = unitOf(quantity, units);
  const digits = Math.min(4, Math.max(0, -Math.floor(Math.log10(Math.max(band * factor, 1e-4)))));
  return (value * factor).toFixed(digits).replace("-", "−");
}
