import { html, type Root } from "../app/dom";
import type { State } from "../app/schema";
import type { Store } from "../app/store";
import type { Messages } from "../messages/en";
import type { Need } from "../model/capsule";
import { lengthScale, velocityScale } from "../model/units";
import type { Context, Trace, ViewPart } from "../views/view";

/** The sizes of an experiment: each in its unit, as the state gives it, and the change of state that sets it. */
interface Size {
  readonly id: string;
  readonly name: keyof Messages["units"];
  readonly unit: string;
  readonly read: (state: State) => number;
  readonly write: (value: number, state: State) => Partial<State>;
}

/** Channel of 100 um, water, a soft membrane. */
const USUAL = [100, 1, 10] as const;

/** A change of the channel, the viscosity or the membrane leaves the radius and the velocity as they are. */
function rescale(state: State, index: number, value: number): Partial<State> {
  const dimensions = sizesOf(state).with(index, value);
  const radius = state.confinement * lengthScale(sizesOf(state));
  const velocity = velocityScale(sizesOf(state), state.ca);
  return {
    dimensions,
    confinement: rounded(radius / lengthScale(dimensions)),
    ca: rounded(velocity / velocityScale(dimensions, 1)),
    extrapolate: false,
  };
}

const atVelocity = (velocity: number, state: State): Partial<State> => ({
  dimensions: sizesOf(state),
  ca: rounded(velocity / velocityScale(sizesOf(state), 1)),
  extrapolate: false,
});

/** The channel's cross-section so that a mean velocity in mm/s times it is a flow rate in ul/s: in mm^2. */
const flowArea = (state: State) => 1e-6 * (sizesOf(state)[0] ?? 1) ** 2;

const SIZES: readonly Size[] = [
  {
    id: "side",
    name: "side",
    unit: "µm",
    read: (state) => sizesOf(state)[0] ?? 0,
    write: (value, state) => rescale(state, 0, value),
  },
  {
    id: "viscosity",
    name: "viscosity",
    unit: "mPa s",
    read: (state) => sizesOf(state)[1] ?? 0,
    write: (value, state) => rescale(state, 1, value),
  },
  {
    id: "modulus",
    name: "modulus",
    unit: "mN/m",
    read: (state) => sizesOf(state)[2] ?? 0,
    write: (value, state) => rescale(state, 2, value),
  },
  {
    id: "radius",
    name: "radius",
    unit: "µm",
    read: (state) => state.confinement * lengthScale(sizesOf(state)),
    write: (value, state) => ({
      dimensions: sizesOf(state),
      confinement: rounded(value / lengthScale(sizesOf(state))),
      extrapolate: false,
    }),
  },
  {
    id: "mean-velocity",
    name: "velocity",
    unit: "mm/s",
    read: (state) => velocityScale(sizesOf(state), state.ca),
    write: atVelocity,
  },
  {
    id: "flow-rate",
    name: "rate",
    unit: "µl/s",
    read: (state) => velocityScale(sizesOf(state), state.ca) * flowArea(state),
    write: (value, state) => atVelocity(value / flowArea(state), state),
  },
];

/** The dialog that turns the sizes of an experiment into Ca and a/l and back, and shows physical units. */
export class Calculator implements ViewPart {
  readonly needs: readonly Need[] = [];
  readonly #open: HTMLButtonElement;
  readonly #dimensionless: HTMLButtonElement;
  readonly #result: HTMLElement;
  readonly #inputs = new Map<Size, HTMLInputElement>();

  constructor(root: Root, store: Store) {
    const dialog = root.part("units", HTMLDialogElement);
    this.#open = root.part("open-units", HTMLButtonElement);
    this.#dimensionless = root.part("dimensionless", HTMLButtonElement);
    this.#result = root.part("calculator-result", HTMLElement);
    const form = root.part("calculator", HTMLFormElement);
    form.addEventListener("submit", (event) => event.preventDefault());
    for (const size of SIZES) {
      const input = html("input", { type: "number", id: root.id(size.id), step: "any", min: "0" });
      input.addEventListener("input", () => {
        const value = input.valueAsNumber;
        const isGood = Number.isFinite(value) && value > 0;
        input.ariaInvalid = String(!isGood);
        if (isGood) store.set(size.write(value, store.state));
      });
      input.addEventListener("blur", () => this.#show(store.state));
      this.#inputs.set(size, input);
      const name = html("span");
      root.speak(({ units }) => {
        name.textContent = `${units[size.name]}, ${size.unit}`;
      });
      form.append(html("label", {}, name, input));
    }
    this.#open.addEventListener("click", () => {
      store.set({ dimensions: sizesOf(store.state) });
      dialog.showModal();
    });
    this.#dimensionless.addEventListener("click", () => {
      store.set({ dimensions: [] });
      dialog.close();
    });
    root.part("close-units", HTMLButtonElement).addEventListener("click", () => dialog.close());
  }

  draw(_: readonly Trace[], { state, capsule }: Context): void {
    this.#open.hidden = !capsule.has("channel");
    this.#show(state);
  }

  #show(state: State): void {
    for (const [size, input] of this.#inputs) {
      if (document.activeElement === input) continue;
      input.value = String(Number(size.read(state).toPrecision(6)));
      input.ariaInvalid = "false";
    }
    this.#result.textContent = `Ca = ${state.ca}, a/ℓ = ${state.confinement}`;
  }
}

/** The channel's side in um, the viscosity in mPa s, the surface shear modulus in mN/m. */
function sizesOf({ dimensions }: State): readonly number[] {
  return dimensions.length > 0 ? dimensions : USUAL;
}

/** Six digits: more than anybody measures, and a number that a person can read. */
function rounded(value: number): number {
  return Number(value.toPrecision(6));
}
