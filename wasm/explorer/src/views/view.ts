import type { PinName, Query, State, View } from "../app/schema";
import type { Messages } from "../messages/en";
import type { Answer } from "../model/answer";
import type { Capsule, Need } from "../model/capsule";
import type { ErrorMeaning } from "../model/errors";
import type { Units } from "../model/units";

/** One motion on screen: the live one, or one that is pinned. */
export interface Trace {
  readonly name: "live" | PinName;
  readonly query: Query;
  /** At the instant on screen; undefined where the core refuses it. */
  readonly answer: Answer | undefined;
  /** At t = 0; undefined where the core refuses it. */
  readonly start: () => Answer | undefined;
  /** Radius of the capsule in the drawn length. */
  readonly radius: number;
}

/** What a view is drawn with besides the answers. */
export interface Context {
  readonly state: State;
  readonly capsule: Capsule;
  readonly units: Units;
  readonly errors: ErrorMeaning;
  /** Messages in the language of the page. */
  readonly words: Messages;
  /** Whether a view is open and the model offers it. */
  readonly shows: (view: View) => boolean;
}

/** A part of the page that shows answers. It computes what it needs from them, when it is drawn. */
export interface ViewPart {
  /** What a model must have for this view to be offered. */
  readonly needs: readonly Need[];
  /** The first trace is the live one; without any, nothing is shown and no answer is held. */
  draw(traces: readonly Trace[], context: Context): void;
}

/** The class that gives a trace its colour. */
export const traceClass = (name: Trace["name"]) => (name === "live" ? "live" : `pin pin-${name}`);
