import { button, html, type Root } from "../app/dom";
import { FLOWS, OBSERVABLES, OUTLINE_UNITS, type State } from "../app/schema";
import type { Store } from "../app/store";

/** A number of the form: the state's, in its unit, and the change of state that sets it; 0 is none. */
interface Field {
  readonly id: string;
  readonly name: string;
  readonly empty: string;
  readonly read: (state: State) => number;
  readonly write: (value: number, state: State) => Partial<State>;
}

/** A flow rate in ul/min for a mean velocity in mm/s, from half the channel's side in um. */
const rate = (halfWidth: number, velocity: number) => 60e-6 * (2 * halfWidth) ** 2 * velocity;

const NUMBERS: readonly Field[] = [
  {
    id: "half-width",
    name: "Half channel side ℓ, µm",
    empty: "",
    read: ({ halfWidth }) => halfWidth,
    write: (halfWidth) => ({ halfWidth }),
  },
  {
    id: "liquid-velocity",
    name: "Mean velocity V, mm/s",
    empty: "",
    read: ({ meanVelocity }) => meanVelocity,
    write: (meanVelocity) => ({ meanVelocity }),
  },
  {
    id: "liquid-rate",
    name: "Flow rate 4ℓ²V, µl/min",
    empty: "",
    read: ({ halfWidth, meanVelocity }) => rate(halfWidth, meanVelocity),
    write: (value, { halfWidth }) => ({ meanVelocity: halfWidth === 0 ? 0 : value / rate(halfWidth, 1) }),
  },
  {
    id: "liquid-viscosity",
    name: "Viscosity, Pa s",
    empty: "",
    read: ({ viscosity }) => viscosity,
    write: (viscosity) => ({ viscosity }),
  },
  {
    id: "pixel-size",
    name: "Size of a pixel, µm",
    empty: "by the walls",
    read: ({ pixel }) => pixel,
    write: (pixel) => ({ pixel }),
  },
  {
    id: "nth-capsule",
    name: "Number of the capsule",
    empty: "the only one",
    read: ({ nth }) => nth,
    write: (value) => ({ nth: Math.round(value) }),
  },
];

/** A choice of the form. */
interface Choice<K extends "observable" | "outlineUnit" | "flow"> {
  readonly id: string;
  readonly key: K;
  readonly name: string;
  readonly among: readonly State[K][];
  readonly names: readonly string[];
}

const OBSERVABLE: Choice<"observable"> = {
  id: "observable",
  key: "observable",
  name: "The outline is",
  among: OBSERVABLES,
  names: ["section z = 0", "silhouette"],
};
const UNIT: Choice<"outlineUnit"> = {
  id: "outline-unit",
  key: "outlineUnit",
  name: "Unit of a text",
  among: OUTLINE_UNITS,
  names: ["as it says", "µm", "pixels"],
};
const FLOW: Choice<"flow"> = {
  id: "outline-flow",
  key: "flow",
  name: "Direction of the flow",
  among: FLOWS,
  names: ["found by the fit", "to the right", "to the left", "up", "down"],
};

/** What is said of a measured outline: the file, the channel, the flow, the liquid. */
export class MeasuredForm {
  readonly #numbers = new Map<Field, HTMLInputElement>();
  readonly #choices: ((state: State) => void)[] = [];

  /** `onFile` gets what is chosen. */
  constructor(root: Root, store: Store, onFile: (file: File) => void) {
    const form = root.part("measured-form", HTMLFormElement);
    form.addEventListener("submit", (event) => event.preventDefault());
    const picker = root.part("outline-file", HTMLInputElement);
    picker.addEventListener("change", () => {
      const [file] = picker.files ?? [];
      if (file !== undefined) onFile(file);
      picker.value = "";
    });
    const choose = button("Choose a file…", () => picker.click());
    choose.id = root.id("choose-outline");
    form.append(choose);
    for (const field of NUMBERS) {
      const input = html("input", { type: "number", id: root.id(field.id), step: "any", min: "0" });
      input.placeholder = field.empty;
      input.addEventListener("input", () => {
        const value = input.value === "" ? 0 : input.valueAsNumber;
        const isGood = Number.isFinite(value) && value >= 0 && !input.validity.badInput;
        input.ariaInvalid = String(!isGood);
        if (isGood) store.set(field.write(value, store.state));
      });
      input.addEventListener("blur", () => this.draw(store.state));
      this.#numbers.set(field, input);
      form.append(html("label", {}, html("span", { textContent: field.name }), input));
    }
    for (const choice of [OBSERVABLE, UNIT, FLOW]) form.append(this.#choice(root, store, choice));
  }

  /** Shows the state; a field that is being typed in stays. */
  draw(state: State): void {
    for (const [field, input] of this.#numbers) {
      if (document.activeElement === input) continue;
      const value = field.read(state);
      input.value = value === 0 ? "" : String(Number(value.toPrecision(6)));
      input.ariaInvalid = "false";
    }
    for (const show of this.#choices) show(state);
  }

  #choice<K extends "observable" | "outlineUnit" | "flow">(root: Root, store: Store, choice: Choice<K>): HTMLElement {
    const { id, key, name, among, names } = choice;
    const select = html("select", { id: root.id(id) });
    select.append(...among.map((value, i) => html("option", { value, textContent: names[i] ?? value })));
    select.addEventListener("change", () => {
      const value = among.find((item) => item === select.value);
      if (value !== undefined) store.set({ [key]: value });
    });
    this.#choices.push((state) => {
      select.value = state[key];
    });
    return html("label", {}, html("span", { textContent: name }), select);
  }
}
