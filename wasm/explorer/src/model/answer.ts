import { type Frame, QUANTITIES, type Quantity, type Query } from "../app/schema";
import type { Evaluation, Model } from "../wasm/capsule_wasm";
import type { FieldName } from "./fields";
import { type Domain, prepare } from "./prepare";
import { type Refusal, refusalOf } from "./refusal";

export type Outline = "midplane" | "diagonal";

/** Whether there is an answer, and what it is worth. */
export type Validity =
  | { readonly kind: "given" }
  | { readonly kind: "extrapolated"; readonly domain: Exclude<Domain, "inside"> }
  /** `cause` says whether the parameters are refused or the shape at this instant. */
  | { readonly kind: "refused"; readonly cause: "query" | "instant"; readonly reason: Refusal };

/** A 95 % bound above this share of the radius makes figures look uncertain. */
export const UNCERTAIN = 0.02;

/** The answer of a model to a query at an instant. Each part is computed when it is first asked for, and kept. */
export class Answer {
  readonly query: Query;
  readonly t: number;
  readonly #evaluation: Evaluation;
  readonly #length: number;
  readonly #model: Model;
  readonly #kept = new Map<string, unknown>();

  constructor(model: Model, evaluation: Evaluation, query: Query, t: number) {
    this.#evaluation = evaluation;
    this.query = query;
    this.t = t;
    this.#length = model.drawnLength;
    this.#model = model;
  }

  /** Everything else throws where this is "refused". */
  get validity(): Validity {
    return this.#once("validity", () => {
      let domain: Domain;
      try {
        domain = prepare(this.#evaluation, this.query);
      } catch (error) {
        return { kind: "refused", cause: "query", reason: refusalOf(error) };
      }
      try {
        this.#numbers();
      } catch (error) {
        return { kind: "refused", cause: "instant", reason: refusalOf(error) };
      }
      return domain === "inside" ? { kind: "given" } : { kind: "extrapolated", domain };
    });
  }

  /** A read-out in the model's units; undefined is a bound that does not exist. */
  read(quantity: Quantity): number | undefined {
    const value = this.#numbers()[QUANTITIES.indexOf(quantity)];
    return value === undefined || Number.isNaN(value) ? undefined : value;
  }

  /** Whether the figures are to look uncertain: the bound is large, or there is none. */
  get isUncertain(): boolean {
    const bound = this.read("error_bound");
    return bound === undefined || bound > UNCERTAIN;
  }

  /** Half the width of the band that the outline lies in, in a: the bound, or the guess where there is none. */
  get band(): number {
    return this.read("error_bound") ?? this.read("expected_error") ?? 0;
  }

  /** Axial position of the centroid, in the drawn length. */
  get centroid(): number {
    return (this.#numbers()[QUANTITIES.length] ?? 0) / this.#length;
  }

  /** An outline, x, r, x, r, ..., laboratory frame, in the drawn length. */
  outline(name: Outline): Float32Array {
    return this.#once(name, () => this.#drawn(this.#go().outline(name)));
  }

  /** Vertices relative to the centroid, in the drawn length. */
  surface(): Float32Array {
    return this.#once("surface", () => this.#drawn(this.#go().surface()));
  }

  /** The section across by the plane at `offset` from the centroid, in the drawn length: closed curves y, z, ... */
  transversal(offset: number): readonly Float32Array[] {
    return this.#once(`transversal ${offset}`, () => {
      const section = this.#go().transversal(offset * this.#length);
      const points = this.#drawn(section.points);
      let start = 0;
      const curves = [...section.lengths].map((length) => {
        const curve = points.subarray(2 * start, 2 * (start + length));
        start += length;
        return curve;
      });
      section.free();
      return curves;
    });
  }

  /** Unit normals of the surface. */
  normals(): Float32Array {
    return this.#once("normals", () => this.#model.normals(this.surface()));
  }

  /** A field at the nodes, in the model's unit. Throws where it is not finite. */
  field(name: FieldName, frame: Frame): Float32Array {
    return this.#once(`${name} ${frame}`, () => this.#go().field(name, frame));
  }

  /** The same at the vertices of the surface. */
  fieldDrawn(name: FieldName, frame: Frame): Float32Array {
    return this.#once(`${name} ${frame} drawn`, () => this.#model.atVertices(this.field(name, frame)));
  }

  /** How far the capsule reaches behind and before its centroid, in the drawn length. */
  get reach(): readonly [number, number] {
    return this.#once("reach", () => {
      let [least, most] = [0, 0];
      const points = this.surface();
      for (let i = 0; i < points.length; i += 3) {
        least = Math.min(least, points[i] ?? 0);
        most = Math.max(most, points[i] ?? 0);
      }
      return [least, most];
    });
  }

  /** Modified Hausdorff distance to another answer, laboratory frame, in the model's length; both lanes must differ. */
  distance(other: Answer): number {
    return this.#once(`distance ${JSON.stringify(other.query)}`, () => this.#go().distance(other.#go()));
  }

  #numbers(): Float32Array {
    return this.#once("numbers", () => this.#go().readouts());
  }

  /** The evaluation, at this query and instant. The core does nothing where it is there already. */
  #go(): Evaluation {
    prepare(this.#evaluation, this.query);
    this.#evaluation.goTo(this.t);
    return this.#evaluation;
  }

  #drawn(points: Float32Array): Float32Array {
    return this.#length === 1 ? points : points.map((x) => x / this.#length);
  }

  #once<T>(key: string, compute: () => T): T {
    if (!this.#kept.has(key)) this.#kept.set(key, compute());
    return this.#kept.get(key) as T;
  }
}
