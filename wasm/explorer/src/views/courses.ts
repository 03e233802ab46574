import type { Jobs } from "../app/jobs";
import type { Along, Quantity, Query } from "../app/schema";
import type { Capsule } from "../model/capsule";

/** Points of a curve, and of one piece of the work for it. */
export const POINTS = 101;
const PIECE = 4;

/** How a curve runs: along time, or along a parameter at the last instant. */
export interface Course {
  readonly quantity: Quantity;
  /** Where the values belong: instants, or values of the parameter. */
  readonly places: Float64Array;
  /** Not a number where there is no answer or no bound. Filled from the front; `done` says how far. */
  readonly values: Float64Array;
  done: number;
}

/** Computes curves of read-outs in the gaps between frames and keeps them until the queries change. */
export class Courses {
  readonly #jobs: Jobs;
  readonly #onProgress: () => void;
  #capsule: Capsule | undefined;
  #courses = new Map<string, Course>();
  #wanted = new Set<string>();

  constructor(jobs: Jobs, onProgress: () => void) {
    this.#jobs = jobs;
    this.#onProgress = onProgress;
  }

  /** Begins a frame: curves that nobody asks for until `settle` are dropped. */
  begin(capsule: Capsule): void {
    this.#wanted.clear();
    if (capsule !== this.#capsule) this.settle();
    this.#capsule = capsule;
  }

  settle(): void {
    for (const key of this.#courses.keys()) {
      if (this.#wanted.has(key)) continue;
      this.#courses.delete(key);
      this.#jobs.stop(key);
    }
  }

  /** A read-out along time, at instants evenly apart (`power` 1), or closer together at the start (2). */
  alongTime(lane: string, query: Query, quantity: Quantity, power: 1 | 2): Course {
    const end = this.#capsule?.model.endTime ?? 1;
    const placeAt = (share: number) => end * share ** power;
    return this.#course(`${lane} time ${power}`, query, quantity, placeAt, (capsule, places) =>
      capsule.course(`${lane} course`, query, quantity, Float32Array.from(places)),
    );
  }

  /** A read-out at the last instant along parameter 0 or 1 over its sampled range, the other one as in the query. */
  alongParameter(lane: string, query: Query, quantity: Quantity, along: Exclude<Along, "time">): Course {
    const index = along === "ca" ? 0 : 1;
    const ranges = this.#capsule?.model.ranges() ?? new Float64Array();
    const [least, most] = [ranges[2 * index] ?? 0, ranges[2 * index + 1] ?? 1];
    const placeAt = (share: number) => least + (most - least) * share;
    return this.#course(`${lane} ${along}`, query, quantity, placeAt, (capsule, places) => {
      const sets = [...places].flatMap((value) => query.parameters.with(index, value));
      const end = capsule.model.endTime;
      return capsule.grid(`${lane} course`, quantity, Float64Array.from(sets), end, query.method);
    });
  }

  #course(
    kind: string,
    query: Query,
    quantity: Quantity,
    placeAt: (share: number) => number,
    compute: (capsule: Capsule, places: Float64Array) => Float32Array,
  ): Course {
    const key = `course ${kind} ${quantity} ${JSON.stringify(query)}`;
    this.#wanted.add(key);
    let course = this.#courses.get(key);
    if (course === undefined) {
      const places = Float64Array.from({ length: POINTS }, (_, i) => placeAt(i / (POINTS - 1)));
      course = { quantity, places, values: new Float64Array(POINTS).fill(Number.NaN), done: 0 };
      this.#courses.set(key, course);
      this.#jobs.start(key, this.#fill(course, compute));
    }
    return course;
  }

  *#fill(course: Course, compute: (capsule: Capsule, places: Float64Array) => Float32Array): Generator<void> {
    while (course.done < POINTS && this.#capsule !== undefined) {
      const to = Math.min(course.done + PIECE, POINTS);
      try {
        course.values.set(compute(this.#capsule, course.places.subarray(course.done, to)), course.done);
      } catch {
        // The query is refused: the curve is empty, and the notice says why.
        course.done = POINTS;
        break;
      }
      course.done = to;
      yield;
    }
    this.#onProgress();
  }
}

/** The least and the greatest value, if there is any. */
export function extremes(courses: readonly Course[]): readonly [number, number] | undefined {
  let [least, most] = [Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY];
  for (const { values } of courses) {
    for (const value of values) {
      if (Number.isNaN(value)) continue;
      least = Math.min(least, value);
      most = Math.max(most, value);
    }
  }
  return least > most ? undefined : [least, most];
}

/** The curve between its gaps: place, value, place, value, ... */
export function pieces({ places, values, done }: Course): number[][] {
  const found: number[][] = [[]];
  for (let i = 0; i < done; i++) {
    const value = values[i] ?? Number.NaN;
    if (Number.isNaN(value)) found.push([]);
    else found.at(-1)?.push(places[i] ?? 0, value);
  }
  return found.filter((points) => points.length > 2);
}
