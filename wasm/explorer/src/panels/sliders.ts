import { html, type Root } from "../app/dom";
import { short } from "../app/schema";
import type { Capsule, Need } from "../model/capsule";
import type { Context, Trace, ViewPart } from "../views/view";

/** Steps of a slider over its range. */
const STEPS = 200;

/** A slider and a number for each parameter of a model that is not one of a capsule in the channel. */
export class ParameterSliders implements ViewPart {
  readonly needs: readonly Need[] = [];
  readonly #root: Root;
  readonly #panel: HTMLElement;
  readonly #onChange: (parameters: readonly number[]) => void;
  #capsule: Capsule | undefined;
  #inputs: (readonly HTMLInputElement[])[] = [];
  #values: readonly number[] = [];

  constructor(root: Root, onChange: (parameters: readonly number[]) => void) {
    this.#root = root;
    this.#panel = root.part("sliders", HTMLElement);
    this.#onChange = onChange;
  }

  draw(_: readonly Trace[], { state, capsule }: Context): void {
    if (capsule !== this.#capsule) {
      this.#capsule = capsule;
      this.#make(capsule);
    }
    this.#values = state.parameters;
    this.#inputs.forEach((inputs, i) => {
      for (const input of inputs) {
        const value = state.parameters[i] ?? 0;
        if (document.activeElement !== input || input.valueAsNumber !== value) input.value = short(value);
      }
    });
  }

  #make({ model }: Capsule): void {
    const names = model.isChannel ? [] : model.parameterNames();
    const ranges = model.ranges();
    this.#inputs = names.map((name, i) => {
      const [min, max] = [ranges[2 * i] ?? 0, ranges[2 * i + 1] ?? 1];
      const slider = html("input", { type: "range", min: String(min), max: String(max), ariaLabel: name });
      slider.step = String((max - min) / STEPS || 1);
      const id = this.#root.id(`parameter-${i}`);
      const number = html("input", { type: "number", id, step: "any" });
      this.#root.speak(({ sliders }) => {
        number.ariaLabel = sliders.value(name);
      });
      for (const input of [slider, number]) {
        input.addEventListener("input", () => {
          if (Number.isFinite(input.valueAsNumber)) this.#onChange(this.#values.with(i, input.valueAsNumber));
        });
      }
      return [slider, number];
    });
    const rows = names.map((name, i) =>
      html("div", { className: "parameter" }, html("span", { className: "name" }, name), ...(this.#inputs[i] ?? [])),
    );
    this.#panel.replaceChildren(...rows);
  }
}
