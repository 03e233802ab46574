import type { Root } from "../app/dom";
import { type Frame, type Method, type State, short } from "../app/schema";
import type { Store } from "../app/store";

/** Number inputs and choices, tied to the state both ways. */
export function tieParameters(root: Root, store: Store): void {
  const fields = [
    ["ca", root.part("ca", HTMLInputElement)],
    ["confinement", root.part("confinement", HTMLInputElement)],
  ] as const;
  const radios = root.all<HTMLInputElement>(".choices input");
  const nameOf = (input: HTMLInputElement) => input.name.slice(root.prefix.length);
  for (const [name, input] of fields) {
    input.addEventListener("input", () => {
      // While a number is being typed the last good one stays.
      if (Number.isFinite(input.valueAsNumber)) store.set({ [name]: input.valueAsNumber, extrapolate: false });
    });
    input.addEventListener("blur", () => {
      input.value = short(store.state[name]);
    });
  }
  root.part("inputs", HTMLFormElement).addEventListener("submit", (event) => event.preventDefault());
  for (const input of radios) {
    input.addEventListener("change", () => {
      store.set(nameOf(input) === "method" ? { method: input.value as Method } : { frame: input.value as Frame });
    });
  }
  const show = (state: State) => {
    for (const [name, input] of fields) {
      if (document.activeElement !== input || input.valueAsNumber !== state[name]) input.value = short(state[name]);
    }
    for (const input of radios) {
      input.checked = input.value === (nameOf(input) === "method" ? state.method : state.frame);
    }
  };
  store.subscribe(show);
  show(store.state);
}
