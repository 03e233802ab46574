import type { Quantity, Query, State } from "../app/schema";
import { type Evaluation, Model } from "../wasm/capsule_wasm";
import { Answer } from "./answer";
import { prepare } from "./prepare";
import { type Units, unitsOf } from "./units";

/** What a view or a colour may need of a model. */
export type Need = "outlines" | "channel" | "mechanics";

/** A file that was opened, and the answers that the core gives with it, each computed when it is asked for. */
export class Capsule {
  readonly model: Model;
  readonly bytes: number;
  /** The file's name, where it is not the one beside the page. */
  readonly file: string | undefined;
  readonly units: Units;
  /**
   * Each with a workspace of its own, so that what one computes does not displace what another holds. There are as many
   * as names, and they last: a view out of sight may still hold the answer of a query that is pinned no longer.
   */
  readonly #lanes = new Map<string, { evaluation: Evaluation; query: string; answer: Answer | undefined }>();

  constructor(bytes: Uint8Array, file: string | undefined) {
    this.model = Model.open(bytes);
    this.bytes = bytes.length;
    this.file = file;
    this.units = unitsOf(this.model);
  }

  has(need: Need): boolean {
    const { hasOutlines, isChannel, hasMechanics } = this.model;
    return { outlines: hasOutlines, channel: isChannel, mechanics: hasMechanics }[need];
  }

  /** The names of the parameters, for people. */
  names(): readonly string[] {
    return this.model.isChannel ? ["Ca", "a/l"] : this.model.parameterNames();
  }

  /** The state that this model begins with, where it differs from the default. */
  defaults(): Partial<State> {
    const { model } = this;
    const ranges = model.ranges();
    const middle = model.parameterNames().map((_, i) => 0.5 * ((ranges[2 * i] ?? 0) + (ranges[2 * i + 1] ?? 1)));
    return {
      method: model.defaultMethod === "paper" ? "paper" : "direct",
      parameters: model.isChannel ? [] : middle,
      end: model.endTime,
    };
  }

  /**
   * The answer to a query at an instant. A lane holds the last one asked of it: the same question again is not computed
   * again.
   */
  answer(lane: string, query: Query, t: number): Answer {
    const place = this.#lane(lane);
    const key = JSON.stringify(query);
    if (place.answer === undefined || place.query !== key || place.answer.t !== t) {
      place.query = key;
      place.answer = new Answer(this.model, place.evaluation, query, t);
    }
    return place.answer;
  }

  /** The course of a read-out at instants; not a number where there is no answer. Throws where the query is refused. */
  course(lane: string, query: Query, quantity: Quantity, times: Float32Array): Float32Array {
    const place = this.#lane(lane);
    place.answer = undefined;
    prepare(place.evaluation, query);
    return place.evaluation.course(quantity, times);
  }

  /** A read-out at one instant for many sets of parameters, one set after another; not a number where there is none. */
  grid(lane: string, quantity: Quantity, parameters: Float64Array, t: number, method: string): Float32Array {
    const place = this.#lane(lane);
    place.answer = undefined;
    return place.evaluation.grid(quantity, parameters, this.names().length, t, method);
  }

  /** No answer may be asked after it. */
  free(): void {
    for (const { evaluation } of this.#lanes.values()) evaluation.free();
    this.#lanes.clear();
    this.model.free();
  }

  #lane(name: string) {
    let lane = this.#lanes.get(name);
    if (lane === undefined) {
      lane = { evaluation: this.model.evaluation(), query: "", answer: undefined };
      this.#lanes.set(name, lane);
    }
    return lane;
  }
}
