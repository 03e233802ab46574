import { button, html, type Root } from "../app/dom";
import { moveTo, type State } from "../app/schema";
import type { Store } from "../app/store";
import type { Validity } from "../model/answer";
import type { Capsule } from "../model/capsule";
import type { Domain } from "../model/prepare";
import type { Units } from "../model/units";
import type { Context, Trace, ViewPart } from "../views/view";
import { shownTime } from "./time-axis";

/** Where parameters lie that are extrapolated to. */
const WHERE: Record<Exclude<Domain, "inside">, string> = {
  outside: "outside the sampled range",
  "far-from-samples": "far from all samples",
  "beyond-steady-limit": "beyond the largest steady Ca",
};

/** A way out that a notice offers. */
interface Action {
  readonly label: string;
  readonly run: () => void;
}

/** Says why there is no answer, or with what caution one is given, and offers what can be done. */
export class Notice implements ViewPart {
  readonly needs = [];
  readonly #root: Root;
  readonly #store: Store;
  readonly #element: HTMLElement;
  #said = "";

  constructor(root: Root, store: Store) {
    this.#root = root;
    this.#store = store;
    this.#element = root.part("notice", HTMLElement);
  }

  draw([live]: readonly Trace[], { state, capsule, units }: Context): void {
    if (live === undefined) return;
    const { validity } = capsule.answer("live", live.query, state.t);
    this.#markFields(capsule, live.query.parameters, validity);
    if (validity.kind === "given") {
      this.#say("", []);
    } else if (validity.kind === "extrapolated") {
      const where = WHERE[validity.domain];
      const words = `Extrapolated: these parameters lie ${where}. The expected error is a guess, no bound is known.`;
      this.#say(words, [this.#nearest(capsule, state, live.query.parameters)]);
    } else {
      this.#refuse(validity, state, capsule, live.query.parameters, units);
    }
  }

  #refuse(
    { cause, words }: Validity & { kind: "refused" },
    state: State,
    capsule: Capsule,
    at: readonly number[],
    units: Units,
  ): void {
    const actions = [this.#nearest(capsule, state, at)];
    const mayExtrapolate = !capsule.has("channel") || at.every((value) => value > 0);
    if (mayExtrapolate && !state.extrapolate) {
      actions.push({ label: "Extrapolate", run: () => this.#store.set({ extrapolate: true }) });
    }
    const t = shownTime(state.t, state.end, units);
    const whole = cause === "instant" ? `no answer at t = ${t}: ${words}` : words;
    this.#say(`${whole.charAt(0).toUpperCase()}${whole.slice(1)}.`, actions);
  }

  #nearest(capsule: Capsule, state: State, at: readonly number[]): Action {
    const place = [...capsule.model.nearest(Float64Array.from(at))];
    return {
      label: `Go to the nearest point inside, ${place.join(", ")}`,
      run: () => this.#store.set(moveTo(state, place)),
    };
  }

  /** Marks the fields whose numbers would have to change for an answer inside the domain. */
  #markFields(capsule: Capsule, at: readonly number[], validity: Validity): void {
    const isFaulty = validity.kind === "refused" ? validity.cause === "query" : validity.kind === "extrapolated";
    const nearest = isFaulty ? capsule.model.nearest(Float64Array.from(at)) : undefined;
    const moved = at.map((value, i) => nearest !== undefined && nearest[i] !== value);
    // Where no single number is at fault, all are.
    const isAny = moved.some((item) => item);
    const fields = capsule.has("channel") ? ["ca", "confinement"] : at.map((_, i) => `parameter-${i}`);
    fields.forEach((name, i) => {
      const isWrong = isFaulty && (moved[i] === true || !isAny);
      this.#root.part(name, HTMLInputElement).ariaInvalid = String(isWrong);
    });
  }

  #say(words: string, actions: readonly Action[]): void {
    // A live region that is written again is spoken again: leave it alone while it says the same.
    const key = [words, ...actions.map((action) => action.label)].join("\n");
    if (this.#said === key) return;
    this.#said = key;
    if (words === "") {
      this.#element.replaceChildren();
      return;
    }
    const buttons = actions.map(({ label, run }) => button(label, run));
    this.#element.replaceChildren(html("p", { textContent: words }), html("div", {}, ...buttons));
  }
}
