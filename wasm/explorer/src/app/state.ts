import type { QUANTITIES } from "./quantities";

/** What the page shows, in one immutable value. Everything on screen is a function of it and of the open model. */
export interface State {
  /** Capillary number Ca = mu V / G_s. */
  readonly ca: number;
  /** Confinement a/l. */
  readonly confinement: number;
  /** The parameters of a model that is not one of a capsule in the channel. */
  readonly parameters: readonly number[];
  /** Time in l/V. */
  readonly t: number;
  /** The last instant that the open model answers for. */
  readonly end: number;
  readonly method: Method;
  readonly frame: Frame;
  /** Whether a query beyond the steady region is evaluated all the same. */
  readonly extrapolate: boolean;
  readonly playing: boolean;
  /** Time units (l/V) per second of the wall clock. */
  readonly speed: number;
  /** Axial position of the transversal section relative to the centroid, in l. */
  readonly section: number;
  /** Whether the shape at t = 0 is drawn too. */
  readonly initial: boolean;
  /** The read-out drawn along the time axis. */
  readonly trace: Quantity;
  readonly views: ReadonlySet<View>;
}

export const METHODS = ["direct", "paper"] as const;
export type Method = (typeof METHODS)[number];

export const FRAMES = ["laboratory", "centroid"] as const;
export type Frame = (typeof FRAMES)[number];

export const VIEWS = ["solid", "midplane", "diagonal", "transversal"] as const;
export type View = (typeof VIEWS)[number];

export type Quantity = (typeof QUANTITIES)[number];

export const SPEEDS = [0.25, 0.5, 1, 2, 5] as const;

/** The paper's configuration of Figs. 10 to 12, at an instant at which it still deforms. */
export const DEFAULT_STATE: State = {
  ca: 0.1,
  confinement: 0.9,
  parameters: [],
  t: 2,
  end: 20,
  method: "direct",
  frame: "laboratory",
  extrapolate: false,
  playing: false,
  speed: 1,
  section: 0,
  initial: true,
  trace: "axial_length",
  views: new Set(VIEWS),
};

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

  /** Replaces the given fields; a patch that changes nothing tells nobody. */
  set(patch: Partial<State>): void {
    const previous = this.#state;
    const next = { ...previous, ...patch };
    const keys = Object.keys(patch) as (keyof State)[];
    if (keys.every((key) => Object.is(next[key], previous[key]))) {
      return;
    }
    this.#state = next;
    for (const listener of this.#listeners) {
      listener(next, previous);
    }
  }

  subscribe(listener: Listener): void {
    this.#listeners.add(listener);
  }
}
