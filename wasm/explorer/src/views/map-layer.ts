import { contours } from "d3-contour";
import type { Jobs } from "../app/jobs";
import type { Method, Quantity } from "../app/schema";
import type { Capsule } from "../model/capsule";
import { ERRORS, unitOf } from "../model/quantities";
import type { Units } from "../model/units";
import { label, tidy } from "./svg";

/** Points of the grid along the root of Ca, where the motion changes evenly, and along a/l. */
const COLUMNS = 56;
const ROWS = 36;
const LEVELS = 6;

/** What a layer of the map shows. */
export interface LayerQuestion {
  readonly quantity: Quantity;
  readonly method: Method;
  readonly t: number;
}

/** The region above a level: rings of (Ca, a/l). */
export interface Contour {
  readonly label: string;
  readonly rings: readonly (readonly (readonly [number, number])[])[];
}

/** Contours of a read-out over the sampled domain, computed in the gaps between frames. */
export class MapLayer {
  readonly #jobs: Jobs;
  readonly #name: string;
  readonly #onDone: () => void;
  #key = "";
  #contours: readonly Contour[] = [];

  constructor(jobs: Jobs, name: string, onDone: () => void) {
    this.#jobs = jobs;
    this.#name = name;
    this.#onDone = onDone;
  }

  /** The contours as far as they are known: none until the whole grid is. */
  get contours(): readonly Contour[] {
    return this.#contours;
  }

  ask(capsule: Capsule, question: LayerQuestion | undefined, units: Units): void {
    const key = JSON.stringify([capsule.model.digest, question, units]);
    if (key === this.#key) return;
    this.#key = key;
    this.#contours = [];
    if (question === undefined) this.#jobs.stop(this.#name);
    else this.#jobs.start(this.#name, this.#compute(capsule, question, units));
  }

  *#compute(capsule: Capsule, { quantity, method, t }: LayerQuestion, units: Units): Generator<void> {
    const [caLeast = 0, caMost = 1, least = 0, most = 1] = capsule.model.ranges();
    const [from, to] = [Math.sqrt(caLeast), Math.sqrt(caMost)];
    const caAt = (column: number) => (from + ((to - from) * column) / (COLUMNS - 1)) ** 2;
    const confinementAt = (row: number) => least + ((most - least) * row) / (ROWS - 1);
    const values: number[] = [];
    for (let row = 0; row < ROWS; row++) {
      const sets = Float64Array.from({ length: 2 * COLUMNS }, (_, i) =>
        i % 2 === 0 ? caAt(i / 2) : confinementAt(row),
      );
      values.push(...capsule.grid("layer", quantity, sets, t, method));
      yield;
    }
    const known = values.filter((value) => !Number.isNaN(value)).sort((a, b) => a - b);
    const at = (share: number) => known[Math.round(share * (known.length - 1))] ?? 0;
    const { factor } = unitOf(quantity, units);
    const [low, high] = [at(0.02) * factor, at(0.98) * factor];
    const levels = ERRORS.has(quantity) ? series(low, high) : niceLevels(low, high);
    const trace = contours().size([COLUMNS, ROWS]);
    const outside = values.map((value) => (Number.isNaN(value) ? Number.NEGATIVE_INFINITY : value));
    this.#contours = levels.map((level) => ({
      label: label(tidy(level)),
      rings: trace
        .contour(outside, level / factor)
        .coordinates.flat()
        .map((ring) => ring.map(([x = 0, y = 0]) => [caAt(x - 0.5), confinementAt(y - 0.5)] as const)),
    }));
    this.#onDone();
  }
}

/** 1, 2, 5, 10, ... between two positive values: errors differ by orders of magnitude. */
function series(least: number, most: number): number[] {
  const levels: number[] = [];
  for (let power = Math.floor(Math.log10(least)); power <= Math.log10(most); power++) {
    levels.push(...[1, 2, 5].map((factor) => Number((factor * 10 ** power).toPrecision(1))));
  }
  return levels.filter((level) => least <= level && level <= most);
}

/** Round levels between two values. */
function niceLevels(least: number, most: number): number[] {
  const raw = (most - least) / LEVELS;
  if (!(raw > 0)) return [];
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = power * ([1, 2, 5, 10].find((factor) => factor * power >= raw) ?? 10);
  const levels: number[] = [];
  for (let i = Math.ceil(least / step); i * step <= most; i++) levels.push(Number((i * step).toPrecision(10)));
  return levels;
}
