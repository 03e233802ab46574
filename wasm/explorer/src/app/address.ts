import { isStep } from "./link";
import type { State } from "./schema";
import type { Store } from "./store";

/** How long the state must be at rest before the address follows it. */
const REST_MS = 200;

/** The document's address: it always restores what is seen, and the browser's back button undoes a change. */
export class Address {
  readonly #store: Store;
  readonly #fragment: () => string;
  /** The state of the entry of the history that one is at; undefined until a model is open. */
  #entered: State | undefined;
  #pending = 0;

  /** `follow` takes a fragment that the address got from elsewhere. */
  constructor(store: Store, fragment: () => string, follow: (fragment: string) => void) {
    this.#store = store;
    this.#fragment = fragment;
    store.subscribe((state) => {
      if (this.#entered === undefined || state.playing) return;
      window.clearTimeout(this.#pending);
      this.#pending = window.setTimeout(() => this.#write(), REST_MS);
    });
    window.addEventListener("popstate", () => {
      window.clearTimeout(this.#pending);
      follow(this.wanted);
      this.#entered = store.state;
    });
  }

  /** The fragment that the address has. */
  get wanted(): string {
    return window.location.hash;
  }

  /** Writes the state over the entry of the history that one is at. */
  enter(): void {
    window.clearTimeout(this.#pending);
    this.#entered = this.#store.state;
    window.history.replaceState(null, "", this.#fragment());
  }

  #write(): void {
    const { state } = this.#store;
    const step = this.#entered !== undefined && isStep(state, this.#entered);
    this.#entered = state;
    const fragment = this.#fragment();
    if (fragment === window.location.hash) return;
    if (step) window.history.pushState(null, "", fragment);
    else window.history.replaceState(null, "", fragment);
  }
}
