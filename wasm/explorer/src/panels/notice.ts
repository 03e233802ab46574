import { button, html, inEnglish, type Root } from "../app/dom";
import { moveTo, type State } from "../app/schema";
import type { Store } from "../app/store";
import type { Messages } from "../messages/en";
import type { Validity } from "../model/answer";
import type { Capsule } from "../model/capsule";
import { reason } from "../model/refusal";
import type { Context, Trace, ViewPart } from "../views/view";
import { shownTime } from "./time-axis";

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

  draw([live]: readonly Trace[], context: Context): void {
    if (live === undefined) return;
    const { state, capsule } = context;
    const words = context.words.notice;
    const { validity } = capsule.answer("live", live.query, state.t);
    this.#markFields(capsule, live.query.parameters, validity);
    if (validity.kind === "given") {
      this.#say("", undefined, []);
    } else if (validity.kind === "extrapolated") {
      const nearest = this.#nearest(capsule, state, live.query.parameters, words);
      this.#say(words.extrapolated(words.where[validity.domain]), undefined, [nearest]);
    } else {
      this.#refuse(validity, live.query.parameters, context);
    }
  }

  #refuse(
    { cause, reason: refusal }: Validity & { kind: "refused" },
    at: readonly number[],
    { state, capsule, units, words: { notice: words, refusals } }: Context,
  ): void {
    const core = reason(refusals, refusal);
    const actions = [this.#nearest(capsule, state, at, words)];
    const mayExtrapolate = !capsule.has("channel") || at.every((value) => value > 0);
    if (mayExtrapolate && !state.extrapolate) {
      actions.push({ label: words.extrapolate, run: () => this.#store.set({ extrapolate: true }) });
    }
    if (cause === "instant") this.#say(words.noAnswerAt(shownTime(state.t, state.end, units)), core, actions);
    else this.#say("", { ...core, words: core.words.charAt(0).toUpperCase() + core.words.slice(1) }, actions);
  }

  #nearest(capsule: Capsule, state: State, at: readonly number[], words: Messages["notice"]): Action {
    const place = [...capsule.model.nearest(Float64Array.from(at))];
    return {
      label: words.nearest(place.join(", ")),
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

  /** Says something, and then why the core refuses. */
  #say(words: string, core: ReturnType<typeof reason> | undefined, actions: readonly Action[]): void {
    // A live region that is written again is spoken again: leave it alone while it says the same.
    const why = core === undefined ? "" : `${core.words}.`;
    const key = [words, why, ...actions.map((action) => action.label)].join("\n");
    if (this.#said === key) return;
    this.#said = key;
    if (key === "\n") {
      this.#element.replaceChildren();
      return;
    }
    const buttons = actions.map(({ label, run }) => button(label, run));
    const said = html("p", {}, words, core?.isEnglish ? inEnglish(why) : why);
    this.#element.replaceChildren(said, html("div", {}, ...buttons));
  }
}
