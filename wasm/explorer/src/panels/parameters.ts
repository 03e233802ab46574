import { element, html } from "../app/page";
import type { Frame, Method, State, Store } from "../app/state";

/** Number inputs and choices, tied to the state both ways. */
export function tieParameters(store: Store): void {
  const fields = [
    ["ca", element("ca", HTMLInputElement)],
    ["confinement", element("confinement", HTMLInputElement)],
  ] as const;
  for (const [name, input] of fields) {
    input.addEventListener("input", () => {
      // While a number is being typed the last good one stays.
      if (Number.isFinite(input.valueAsNumber)) store.set({ [name]: input.valueAsNumber, extrapolate: false });
    });
    input.addEventListener("blur", () => write(input, store.state[name]));
  }
  element("inputs", HTMLFormElement).addEventListener("submit", (event) => event.preventDefault());
  for (const input of radios()) {
    input.addEventListener("change", () => {
      store.set(input.name === "method" ? { method: input.value as Method } : { frame: input.value as Frame });
    });
  }
  const show = (state: State) => {
    for (const [name, input] of fields) {
      if (document.activeElement !== input || input.valueAsNumber !== state[name]) write(input, state[name]);
    }
    for (const input of radios()) {
      input.checked = input.value === (input.name === "method" ? state.method : state.frame);
    }
  };
  store.subscribe(show);
  show(store.state);
}

/** A way out that a notice offers. */
export interface Action {
  readonly label: string;
  readonly run: () => void;
}

/** Says under the map why there is no answer, or with what caution one is given, and offers what can be done. */
export function notify(words: string | undefined, actions: readonly Action[] = []): void {
  const notice = element("notice", HTMLElement);
  for (const id of ["ca", "confinement"]) {
    element(id, HTMLInputElement).ariaInvalid = String(words !== undefined);
  }
  // A live region that is written again is spoken again: leave it alone while it says the same.
  const key = words === undefined ? "" : [words, ...actions.map((action) => action.label)].join("\n");
  if (notice.dataset.words === key) return;
  notice.dataset.words = key;
  if (words === undefined) {
    notice.replaceChildren();
    return;
  }
  const buttons = actions.map(({ label, run }) => {
    const button = html("button", { type: "button", textContent: label });
    button.addEventListener("click", run);
    return button;
  });
  notice.replaceChildren(html("p", { textContent: words }), html("div", {}, ...buttons));
}

function radios(): HTMLInputElement[] {
  return [...document.querySelectorAll<HTMLInputElement>(".choices input")];
}

function write(input: HTMLInputElement, value: number): void {
  input.value = String(Number(value.toPrecision(12)));
}
