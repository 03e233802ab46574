import { contours } from "d3-contour";
import type { Messages } from "../messages/en";
import { AXES, type Span } from "../views/map-geometry";
import type { Contour } from "../views/map-layer";
import { label } from "../views/svg";

/** Rises of the sum of squares over a part of the plane of Ca and a/l, row by row as they come. */
export class MisfitGrid {
  readonly columns: number;
  readonly rows: number;
  readonly #axis: readonly [(value: number) => number, (place: number) => number];
  readonly #ca: Span;
  readonly #confinement: Span;
  readonly #rises: Float64Array;

  /** Columns at equal distances on a scale of Ca. */
  constructor(scale: keyof typeof AXES, ca: Span, confinement: Span, [columns, rows]: readonly [number, number]) {
    this.#axis = AXES[scale];
    this.#ca = ca;
    this.#confinement = confinement;
    this.columns = columns;
    this.rows = rows;
    this.#rises = new Float64Array(columns * rows).fill(Number.NaN);
  }

  /** Ca, a/l, Ca, a/l, ... of a row. */
  places(row: number): Float64Array {
    return Float64Array.from({ length: 2 * this.columns }, (_, i) =>
      i % 2 === 0 ? this.#caAt(i / 2) : this.#confinementAt(row),
    );
  }

  set(row: number, rises: Float64Array): void {
    this.#rises.set(rises, row * this.columns);
  }

  /** The regions where the rise is below a level, each with its name. */
  below(levels: readonly (readonly [name: string, level: number])[]): Contour[] {
    // Outside the domain, and where nothing is known yet, no rise is small enough.
    const height = Array.from(this.#rises, (rise) => (Number.isNaN(rise) ? Number.NEGATIVE_INFINITY : -rise));
    return levels.map(([name, level]) => this.#contour(name, height, -level));
  }

  /** The regions where the misfit is above 10, 30, 100, ... as far as there are such. */
  above(): Contour[] {
    const misfit = Array.from(this.#rises, (rise) => (Number.isNaN(rise) ? Number.NEGATIVE_INFINITY : root(rise)));
    const most = misfit.reduce((a, b) => Math.max(a, b), 0);
    const levels = [10, 30, 100, 300, 1000, 3000].filter((level) => level < most);
    return levels.map((level) => this.#contour(label(level), misfit, level));
  }

  #contour(name: string, values: number[], level: number): Contour {
    const rings = contours().size([this.columns, this.rows]).contour(values, level).coordinates.flat();
    return {
      label: name,
      rings: rings.map((ring) =>
        ring.map(([x = 0, y = 0]) => [this.#caAt(x - 0.5), this.#confinementAt(y - 0.5)] as const),
      ),
    };
  }

  readonly #caAt = (column: number) => {
    const [to, from] = this.#axis;
    const [least, most] = this.#ca;
    return from(to(least) + ((to(most) - to(least)) * column) / (this.columns - 1));
  };

  readonly #confinementAt = (row: number) => {
    const [least, most] = this.#confinement;
    return least + ((most - least) * row) / (this.rows - 1);
  };
}

/** The misfit of a rise. */
export function root(rise: number): number {
  return Math.sqrt(Math.max(rise, 0));
}

/** A misfit in words, in standard deviations: the root of the rise of the sum of squares. */
export function writtenMisfit({ outline }: Messages, misfit: number | undefined): string {
  if (misfit === undefined) return outline.misfitPending;
  if (Number.isNaN(misfit)) return outline.misfitOutside;
  return outline.misfit(misfit < 100 ? misfit.toFixed(1) : String(Math.round(misfit)));
}
