import { element, html } from "../app/page";
import { QUANTITIES } from "../app/quantities";
import type { Quantity } from "../app/state";
import type { ErrorMeaning } from "../model/errors";
import { ERRORS, measure, nameOf, PRESENTATION, STANDARD_UNITS, written } from "./quantities";

const LABEL = "Read-outs; the chosen one is plotted along time";

/** The figures of the instant on screen. Each output carries its number in full in `data-value`. */
export class Readouts {
  readonly #outputs = new Map<Quantity, HTMLOutputElement>();
  readonly #rows = new Map<Quantity, HTMLButtonElement>();
  readonly #names = new Map<Quantity, HTMLElement>();
  readonly #units = new Map<Quantity, HTMLElement>();
  readonly #panel = element("readouts", HTMLElement);
  readonly #announcement = element("announcement", HTMLElement);
  readonly #mark = element("extrapolated", HTMLElement);
  readonly #errors = element("errors", HTMLElement);
  #against = "";
  #announcing = 0;

  constructor(onTrace: (quantity: Quantity) => void) {
    this.#panel.role = "radiogroup";
    this.#panel.ariaLabel = LABEL;
    for (const quantity of QUANTITIES) {
      const { unit, plane } = PRESENTATION[quantity];
      const output = html("output", { id: quantity });
      // They change sixty times a second; what is spoken is said in the announcement instead.
      output.ariaLive = "off";
      output.dataset.quantity = quantity;
      const name = html("span", { textContent: nameOf(quantity, false) });
      const row = html("button", { type: "button", className: "readout" }, name, output);
      const mark = html("span", { className: "unit", textContent: unit });
      this.#names.set(quantity, name);
      this.#units.set(quantity, mark);
      row.append(mark);
      row.role = "radio";
      if (plane !== undefined) row.dataset.plane = plane;
      if (ERRORS.has(quantity)) row.setAttribute("aria-describedby", this.#errors.id);
      row.addEventListener("click", () => onTrace(quantity));
      row.addEventListener("keydown", (event) => this.#rove(event, quantity, onTrace));
      this.#outputs.set(quantity, output);
      this.#rows.set(quantity, row);
      this.#panel.append(row);
    }
  }

  /** Says what the errors of the open model are. */
  setErrors({ against, sentence }: ErrorMeaning): void {
    this.#against = against;
    this.#errors.textContent = sentence;
  }

  /** Sets the units that the open model's numbers have. */
  setUnits({ length, velocity }: { readonly length: string; readonly velocity: string }): void {
    for (const [quantity, mark] of this.#units) {
      const presentation = PRESENTATION[quantity];
      presentation.unit = STANDARD_UNITS[quantity].replace("ℓ", length).replace("V", velocity);
      mark.textContent = presentation.unit;
    }
  }

  /** Shows the numbers that `read` gives; a bound that it does not give is "none". */
  show(read: (quantity: Quantity) => number | undefined, extrapolated: boolean): void {
    this.#markExtrapolated(extrapolated);
    for (const [quantity, output] of this.#outputs) {
      const value = read(quantity);
      this.#units.get(quantity)?.toggleAttribute("hidden", value === undefined);
      if (value === undefined) {
        output.textContent = "none";
        delete output.dataset.value;
      } else {
        output.textContent = written(quantity, value);
        output.dataset.value = String(value);
      }
    }
  }

  /** Shows that there is no answer, and has none spoken. */
  clear(): void {
    this.#markExtrapolated(false);
    for (const [quantity, output] of this.#outputs) {
      this.#units.get(quantity)?.toggleAttribute("hidden", false);
      output.textContent = "–";
      delete output.dataset.value;
    }
    window.clearTimeout(this.#announcing);
    this.#announcement.textContent = "";
  }

  #markExtrapolated(extrapolated: boolean): void {
    this.#mark.hidden = !extrapolated;
    this.#panel.ariaLabel = extrapolated ? `Extrapolated. ${LABEL}` : LABEL;
    for (const [quantity, name] of this.#names) {
      name.textContent = nameOf(quantity, extrapolated);
    }
  }

  /** Marks the read-out that the time axis plots. */
  mark(trace: Quantity): void {
    for (const [quantity, row] of this.#rows) {
      row.ariaChecked = String(quantity === trace);
      row.tabIndex = quantity === trace ? 0 : -1;
    }
  }

  /** Has the figures spoken once things have come to rest. */
  announce(situation: string): void {
    window.clearTimeout(this.#announcing);
    this.#announcing = window.setTimeout(() => {
      const extrapolated = !this.#mark.hidden;
      const figures = [...this.#outputs].map(([quantity, { dataset }]) => {
        const value = dataset.value === undefined ? undefined : Number(dataset.value);
        return `${nameOf(quantity, extrapolated)} ${measure(quantity, value)}`;
      });
      const words = `${situation}: ${figures.join(", ")}; errors ${this.#against}`;
      this.#announcement.textContent = extrapolated ? `Extrapolated. ${words}` : words;
    }, 700);
  }

  /** Arrow keys move the choice, as in any group of radio buttons. */
  #rove(event: KeyboardEvent, quantity: Quantity, onTrace: (quantity: Quantity) => void): void {
    const step = { ArrowDown: 1, ArrowRight: 1, ArrowUp: -1, ArrowLeft: -1 }[event.key];
    if (step === undefined) return;
    const next = QUANTITIES[(QUANTITIES.indexOf(quantity) + step + QUANTITIES.length) % QUANTITIES.length];
    if (next !== undefined) {
      onTrace(next);
      this.#rows.get(next)?.focus();
    }
    event.preventDefault();
    event.stopPropagation();
  }
}
