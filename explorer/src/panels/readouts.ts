import { html } from "../app/page";
import { QUANTITIES, type Quantity } from "../app/state";
import { PRESENTATION, STANDARD_UNITS, written } from "./quantities";

/** The figures of the instant on screen. Each output carries its number in full in `data-value`. */
export class Readouts {
  readonly #outputs = new Map<Quantity, HTMLOutputElement>();
  readonly #rows = new Map<Quantity, HTMLButtonElement>();
  readonly #units = new Map<Quantity, HTMLElement>();
  readonly #announcement: HTMLElement;
  #announcing = 0;

  constructor(panel: HTMLElement, announcement: HTMLElement, onTrace: (quantity: Quantity) => void) {
    this.#announcement = announcement;
    panel.role = "radiogroup";
    panel.ariaLabel = "Read-outs; the chosen one is plotted along time";
    for (const quantity of QUANTITIES) {
      const { name, unit, plane } = PRESENTATION[quantity];
      const output = html("output", { id: quantity });
      // They change sixty times a second; what is spoken is said in the announcement instead.
      output.ariaLive = "off";
      output.dataset.quantity = quantity;
      const row = html("button", { type: "button", className: "readout" }, html("span", {}, name), output);
      const mark = html("span", { className: "unit", textContent: unit });
      this.#units.set(quantity, mark);
      row.append(mark);
      row.role = "radio";
      if (plane !== undefined) row.dataset.plane = plane;
      row.addEventListener("click", () => onTrace(quantity));
      row.addEventListener("keydown", (event) => this.#rove(event, quantity, onTrace));
      this.#outputs.set(quantity, output);
      this.#rows.set(quantity, row);
      panel.append(row);
    }
  }

  /** Sets the units that the open model's numbers have. */
  setUnits({ length, velocity }: { readonly length: string; readonly velocity: string }): void {
    for (const [quantity, mark] of this.#units) {
      const presentation = PRESENTATION[quantity];
      presentation.unit = STANDARD_UNITS[quantity].replace("ℓ", length).replace("V", velocity);
      mark.textContent = presentation.unit;
    }
  }

  /** Shows the numbers that `read` gives, or none when there is no answer. */
  show(read: ((quantity: Quantity) => number) | undefined): void {
    for (const [quantity, output] of this.#outputs) {
      if (read === undefined) {
        output.textContent = "–";
        delete output.dataset.value;
      } else {
        const value = read(quantity);
        output.textContent = written(quantity, value);
        output.dataset.value = String(value);
      }
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
      const figures = [...this.#outputs].map(
        ([quantity, output]) => `${PRESENTATION[quantity].name} ${output.textContent} ${PRESENTATION[quantity].unit}`,
      );
      this.#announcement.textContent = `${situation}: ${figures.join(", ")}`;
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
