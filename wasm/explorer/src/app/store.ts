import { ENTRIES, FIELDS, type Field, type Key, type State } from "./schema";

type Listener = (state: State, previous: State) => void;

/** Holds the state and tells the listeners after each change. */
export class Store {
  #state: State;
  readonly #listeners = new Set<Listener>();

  constructor(initial: State) {
    this.#state = initial;
  }

  get state(): State {
    return this.#state;
  }

  /**
   * Replaces the given fields; a patch that changes nothing tells nobody.
   *
   * Throws a `TypeError` that names the field where a value cannot be one of it; the state then stays as it is.
   */
  set(patch: Partial<State>): void {
    for (const [key, value] of Object.entries(patch)) {
      if (!(key in FIELDS)) throw new TypeError(`the state has no field ${key}: it has ${names()}`);
      const { check } = FIELDS[key as Key] as Field<unknown>;
      if (!check(value)) throw new TypeError(`${String(value)} is no value of ${key}`);
    }
    const previous = this.#state;
    const next = { ...previous, ...patch };
    if ((Object.keys(patch) as Key[]).every((key) => Object.is(next[key], previous[key]))) return;
    this.#state = next;
    for (const listener of this.#listeners) listener(next, previous);
  }

  subscribe(listener: Listener): void {
    this.#listeners.add(listener);
  }
}

const names = () => ENTRIES.map(([key]) => key).join(", ");
