import { html } from "../app/page";
import type { State } from "../app/state";

/** Steps of a slider over its range. */
const STEPS = 200;

/** A slider and a number for each parameter of a model that is not one of a capsule in the channel. */
export class ParameterSliders {
  readonly #panel: HTMLElement;
  readonly #onChange: (parameters: readonly number[]) => void;
  #inputs: (readonly HTMLInputElement[])[] = [];
  #values: readonly number[] = [];

  constructor(panel: HTMLElement, onChange: (parameters: readonly number[]) => void) {
    this.#panel = panel;
    this.#onChange = onChange;
  }

  /** Makes the sliders of a model. Returns the parameters to begin with: the state's if it has as many, else the middle. */
  offer(names: readonly string[], ranges: Float64Array, { parameters }: State): readonly number[] {
    this.#inputs = names.map((name, i) => {
      const [min, max] = [ranges[2 * i] ?? 0, ranges[2 * i + 1] ?? 1];
      const slider = html("input", { type: "range", min: String(min), max: String(max), ariaLabel: name });
      slider.step = String((max - min) / STEPS || 1);
      const number = html("input", { type: "number", id: `parameter-${i}`, step: "any", ariaLabel: `${name}, value` });
      for (const input of [slider, number]) {
        input.addEventListener("input", () => {
          if (!Number.isFinite(input.valueAsNumber)) return;
          this.#onChange(this.#values.map((value, j) => (j === i ? input.valueAsNumber : value)));
        });
      }
      return [slider, number];
    });
    const rows = names.map((name, i) =>
      html("div", { className: "parameter" }, html("span", { className: "name" }, name), ...(this.#inputs[i] ?? [])),
    );
    this.#panel.replaceChildren(...rows);
    const middle = names.map((_, i) => 0.5 * ((ranges[2 * i] ?? 0) + (ranges[2 * i + 1] ?? 1)));
    return parameters.length === names.length ? parameters : middle;
  }

  show(values: readonly number[]): void {
    this.#values = values;
    this.#inputs.forEach((inputs, i) => {
      for (const input of inputs) {
        const value = values[i] ?? 0;
        if (document.activeElement !== input || input.valueAsNumber !== value) {
          input.value = String(Number(value.toPrecision(6)));
        }
      }
    });
  }
}
