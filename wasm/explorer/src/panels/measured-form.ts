import { button, html, type Root } from "../app/dom";
import { FLOWS, OBSERVABLES, OUTLINE_UNITS, type State } from "../app/schema";
import type { Store } from "../app/store";
import type { Messages } from "../messages/en";

type Words = Messages["outline"];

/** Names of messages that are plain texts. */
type Name = { [K in keyof Words]: Words[K] extends string ? K : never }[keyof Words];

/** A number of the form: the state's, in its unit, and the change of state that sets it; 0 is none. */
interface Field {
  readonly id: string;
  readonly name: Name;
  /** Stands in the field where there is no number. */
  readonly empty?: Name;
  readonly read: (state: State) => number;
  readonly write: (value: number, state: State) => Partial<State>;
}

/** A flow rate in ul/min for a mean velocity in mm/s, from half the channel's side in um. */
const rate = (halfWidth: number, velocity: number) => 60e-6 * (2 * halfWidth) ** 2 * velocity;

const NUMBERS: readonly Field[] = [
  {
    id: "half-width",
    name: "halfWidth",
    read: ({ halfWidth }) => halfWidth,
    write: (halfWidth) => ({ halfWidth }),
  },
  {
    id: "liquid-velocity",
    name: "meanVelocity",
    read: ({ meanVelocity }) => meanVelocity,
    write: (meanVelocity) => ({ meanVelocity }),
  },
  {
    id: "liquid-rate",
    name: "rate",
    read: ({ halfWidth, meanVelocity }) => rate(halfWidth, meanVelocity),
    write: (value, { halfWidth }) => ({ meanVelocity: halfWidth === 0 ? 0 : value / rate(halfWidth, 1) }),
  },
  {
    id: "liquid-viscosity",
    name: "viscosity",
    read: ({ viscosity }) => viscosity,
    write: (viscosity) => ({ viscosity }),
  },
  {
    id: "pixel-size",
    name: "pixel",
    empty: "byWalls",
    read: ({ pixel }) => pixel,
    write: (pixel) => ({ pixel }),
  },
  {
    id: "nth-capsule",
    name: "number",
    empty: "onlyOne",
    read: ({ nth }) => nth,
    write: (value) => ({ nth: Math.round(value) }),
  },
];

/** A choice of the form. */
interface Choice<K extends "observable" | "outlineUnit" | "flow"> {
  readonly id: string;
  readonly key: K;
  readonly name: Name;
  readonly among: readonly State[K][];
  readonly names: (words: Words) => Record<State[K], string>;
}

const OBSERVABLE: Choice<"observable"> = {
  id: "observable",
  key: "observable",
  name: "observable",
  among: OBSERVABLES,
  names: ({ observables }) => observables,
};
const UNIT: Choice<"outlineUnit"> = {
  id: "outline-unit",
  key: "outlineUnit",
  name: "unit",
  among: OUTLINE_UNITS,
  names: ({ outlineUnits }) => outlineUnits,
};
const FLOW: Choice<"flow"> = {
  id: "outline-flow",
  key: "flow",
  name: "flow",
  among: FLOWS,
  names: ({ flows }) => flows,
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
    const choose = button("", () => picker.click());
    choose.id = root.id("choose-outline");
    root.speak(({ outline }) => {
      choose.textContent = outline.choose;
    });
    form.append(choose);
    for (const field of NUMBERS) {
      const input = html("input", { type: "number", id: root.id(field.id), step: "any", min: "0" });
      input.addEventListener("input", () => {
        const value = input.value === "" ? 0 : input.valueAsNumber;
        const isGood = Number.isFinite(value) && value >= 0 && !input.validity.badInput;
        input.ariaInvalid = String(!isGood);
        if (isGood) store.set(field.write(value, store.state));
      });
      input.addEventListener("blur", () => this.draw(store.state));
      this.#numbers.set(field, input);
      const name = html("span");
      root.speak(({ outline }) => {
        name.textContent = outline[field.name];
        input.placeholder = field.empty === undefined ? "" : outline[field.empty];
      });
      form.append(html("label", {}, name, input));
    }
    form.append(
      this.#choice(root, store, OBSERVABLE),
      this.#choice(root, store, UNIT),
      this.#choice(root, store, FLOW),
    );
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
    const options = among.map((value) => html("option", { value }));
    const title = html("span");
    root.speak(({ outline }) => {
      title.textContent = outline[name];
      for (const [i, value] of among.entries()) options[i]?.replaceChildren(names(outline)[value]);
    });
    select.append(...options);
    select.addEventListener("change", () => {
      const value = among.find((item) => item === select.value);
      if (value !== undefined) store.set({ [key]: value });
    });
    this.#choices.push((state) => {
      select.value = state[key];
    });
    return html("label", {}, title, select);
  }
}
