import type { Method, Quantity, State } from "../app/state";
import initialise, { type Evaluation, Model } from "../wasm/capsule_wasm";
import wasmAddress from "../wasm/capsule_wasm_bg.wasm?url";

/** Why there is no model to show, and what would help. */
export class ModelError extends Error {
  readonly remedy: string;

  constructor(message: string, remedy: string) {
    super(message);
    this.remedy = remedy;
  }
}

export type Outline = "midplane" | "diagonal";
export type Domain = "inside" | "beyond-steady-limit" | "far-from-samples" | "outside";

/** The parameters that determine a motion. */
export type Query = Pick<State, "ca" | "confinement" | "parameters" | "method" | "extrapolate">;

/** A model and the answers to the query that is on screen. Everything is computed by the core, when it is asked for. */
export class Capsule {
  readonly model: Model;
  readonly bytes: number;
  /** The instant on screen. */
  readonly now: Evaluation;
  /** Other instants of the same query: the start, and the time axis. */
  readonly #elsewhere: Evaluation;
  readonly #length: number;
  #query: Query | undefined;
  #parameters: readonly number[] = [];
  #domain: Domain = "inside";
  /** Answers about the shape at t = 0, once asked for. */
  readonly #initial = new Map<Outline | "surface", Float32Array | undefined>();

  private constructor(model: Model, bytes: number) {
    this.model = model;
    this.bytes = bytes;
    this.#length = model.drawnLength;
    this.now = model.evaluation();
    this.#elsewhere = model.evaluation();
  }

  /** Opens the bytes of a model file; throws a `ModelError`. */
  static async open(bytes: Uint8Array, name: string): Promise<Capsule> {
    await initialise({ module_or_path: wasmAddress });
    try {
      return new Capsule(Model.open(bytes), bytes.length);
    } catch (error) {
      throw new ModelError(
        `${name} is not a model that can be read: ${text(error)}.`,
        "Open a .crom file that `capsule-rom offline build` wrote, or copy this one again.",
      );
    }
  }

  /** Fetches and opens a model; throws a `ModelError`. */
  static async fetch(address: URL): Promise<Capsule> {
    const name = address.pathname.split("/").at(-1) ?? address.pathname;
    if (address.origin !== window.location.origin) {
      throw new ModelError(
        `The model ${address.href} lies on another server.`,
        "Put it beside this page, or download it and open it from your disk.",
      );
    }
    let response: Response;
    try {
      response = await fetch(address);
    } catch (error) {
      throw new ModelError(
        `The model ${name} could not be fetched: ${text(error)}.`,
        "See whether the server still runs, then load the page again.",
      );
    }
    if (!response.ok) {
      throw new ModelError(
        `The model ${name} is missing: the server answered ${response.status} for ${address.pathname}.`,
        "Build the page with `cargo xtask explore`, which puts the model beside it, or open a .crom file from your disk.",
      );
    }
    return Capsule.open(new Uint8Array(await response.arrayBuffer()), name);
  }

  /** The parameters of a state, as many as the model has. */
  parameters({ ca, confinement, parameters }: Query): readonly number[] {
    return this.model.isChannel ? [ca, confinement] : parameters;
  }

  /** Sets the query; throws with the core's words when it is refused. */
  prepare(query: Query): Domain {
    const parameters = this.parameters(query);
    const same =
      this.#query !== undefined &&
      parameters.every((value, i) => value === this.#parameters[i]) &&
      query.method === this.#query.method &&
      query.extrapolate === this.#query.extrapolate;
    if (!same) {
      this.#query = undefined;
      this.#initial.clear();
      this.#parameters = parameters;
      this.#domain = prepare(this.now, parameters, query);
      this.#query = query;
    }
    return this.#domain;
  }

  /** Vertices now, relative to the centroid, in the drawn length. */
  surface(): Float32Array {
    return this.#drawn(this.now.surface());
  }

  /** An outline now, in the drawn length. */
  outline(name: Outline): Float32Array {
    return this.#drawn(this.now.outline(name));
  }

  /** The section across now, in the drawn length, by the plane at `offset` of these lengths from the centroid. */
  transversal(offset: number): Float32Array[] {
    const section = this.now.transversal(offset * this.#length);
    const points = this.#drawn(section.points);
    let start = 0;
    const curves = [...section.lengths].map((length) => {
      const curve = points.subarray(2 * start, 2 * (start + length));
      start += length;
      return curve;
    });
    section.free();
    return curves;
  }

  /** Axial position of the centroid now, in the drawn length. */
  centroid(): number {
    return this.now.centroid() / this.#length;
  }

  #drawn(points: Float32Array): Float32Array {
    return this.#length === 1 ? points : points.map((x) => x / this.#length);
  }

  /** Vertices at t = 0, relative to the centroid, or an outline; undefined where the core refuses the shape there. */
  initial(what: Outline | "surface"): Float32Array | undefined {
    if (!this.#initial.has(what)) {
      let points: Float32Array | undefined;
      try {
        const start = this.#at(0);
        points = this.#drawn(what === "surface" ? start.surface() : start.outline(what));
      } catch {
        // The instant on screen may have an answer all the same. Why this one has none is said when one goes there.
      }
      this.#initial.set(what, points);
    }
    return this.#initial.get(what);
  }

  /** A read-out at another instant; undefined is a bound that does not exist. */
  readAt(t: number, quantity: Quantity): number | undefined {
    return read(this.#at(t), quantity);
  }

  /** A read-out at the instant on screen; undefined is a bound that does not exist. */
  read(quantity: Quantity): number | undefined {
    return read(this.now, quantity);
  }

  free(): void {
    this.now.free();
    this.#elsewhere.free();
    this.model.free();
  }

  #at(t: number): Evaluation {
    if (this.#query === undefined) throw new Error("an instant was asked for of a query that is refused");
    prepare(this.#elsewhere, this.#parameters, this.#query);
    this.#elsewhere.goTo(t);
    return this.#elsewhere;
  }
}

function prepare(evaluation: Evaluation, parameters: readonly number[], { method, extrapolate }: Query): Domain {
  return evaluation.prepare(Float64Array.from(parameters), method satisfies Method, extrapolate) as Domain;
}

function read(evaluation: Evaluation, quantity: Quantity): number | undefined {
  switch (quantity) {
    case "volume":
      return evaluation.volume();
    case "expected_error":
      return evaluation.expectedError();
    case "error_bound":
      return evaluation.errorBound();
    default: {
      const readings = evaluation.readings();
      const value = readings[quantity];
      readings.free();
      return value;
    }
  }
}

/** The words of anything thrown, without a closing full stop, and numbers to the digits that single precision has. */
export function text(error: unknown): string {
  const words = error instanceof Error ? error.message : String(error);
  return words.replace(/\.$/, "").replace(/\d+\.\d{7,}/g, (number) => String(Number(Number(number).toPrecision(6))));
}
