import type { Evaluation } from "./capsule_wasm.js";

/** Direct evaluation at the instant, or the paper's method. */
export type Method = "direct" | "paper";

/** Where the parameters of a query lie: inside the sampled domain, or how they are outside. */
export type Domain = "inside" | "beyond-steady-limit" | "far-from-samples" | "outside";

/** The planes z = 0 and y = z. */
export type Plane = "midplane" | "diagonal";

/** Lengths in l, velocity in V. */
export interface Observables {
  /** Extent along the channel. */
  readonly axial_length: number;
  /** Greatest |y| in the plane z = 0. */
  readonly half_width: number;
  /** Greatest distance from the axis in the plane y = z. */
  readonly half_diagonal: number;
  /** Depth of the rear cavity. */
  readonly rear_depth: number;
  /** Velocity of the volume centroid. */
  readonly velocity: number;
  /** Position of the volume centroid along the channel. */
  readonly centroid: number;
}

/** Mechanics of the membrane at the nodes. Vectors are x, y, z of one node after another. */
export interface Fields {
  /** Greater principal extension ratio. */
  readonly stretch_1: Float32Array;
  /** Lesser principal extension ratio. */
  readonly stretch_2: Float32Array;
  /** Area over that at rest. */
  readonly area_dilation: Float32Array;
  /** Greater principal tension, in G_s; negative where the membrane is compressed. */
  readonly tension_1: Float32Array;
  /** Lesser principal tension, in G_s. */
  readonly tension_2: Float32Array;
  /** Elastic energy per area at rest, in G_s. */
  readonly energy_density: Float32Array;
  /** Unit vectors of stretch_1 and tension_1. */
  readonly direction_1: Float32Array;
  /** Unit vectors of stretch_2 and tension_2. */
  readonly direction_2: Float32Array;
  /** Load of the fluid on the membrane, in mu V / l. */
  readonly load: Float32Array;
}

const SCALARS = ["stretch_1", "stretch_2", "area_dilation", "tension_1", "tension_2", "energy_density"] as const;
const VECTORS = ["direction_1", "direction_2", "load"] as const;

/**
 * The motion of a capsule. Each method computes only its own result, at an instant `t` in l/V, in the laboratory frame:
 * the capsule starts at x = 0 and moves along x. All numbers are single precision. A model of other data has its own
 * units instead of l, V and l/V. A method throws a `CapsuleError` where `t` lies outside the model's times, or where no
 * capsule has the extrapolated shape.
 */
export class Prediction {
  readonly domain: Domain;
  readonly #ask: <A>(question: (evaluation: Evaluation) => A) => A;

  /** @internal */
  constructor(domain: Domain, ask: <A>(question: (evaluation: Evaluation) => A) => A) {
    this.domain = domain;
    this.#ask = ask;
  }

  /** Lengths, velocity and place; computes the two outlines only. */
  observables(t: number): Observables {
    return this.#at(t, (evaluation) => {
      const readings = evaluation.readings();
      const { axial_length, half_width, half_diagonal, rear_depth, velocity } = readings;
      readings.free();
      return { axial_length, half_width, half_diagonal, rear_depth, velocity, centroid: evaluation.centroid() };
    });
  }

  /** Enclosed volume, in l^3. */
  volume(t: number): number {
    return this.#at(t, (evaluation) => evaluation.volume());
  }

  /** Positions of the nodes, in l: x, y, z of one node after another. `Model.triangles` joins them. */
  positions(t: number): Float32Array {
    return this.#at(t, (evaluation) => evaluation.positions());
  }

  /** Velocities of the nodes, in V: x, y, z of one node after another. */
  velocities(t: number): Float32Array {
    return this.#at(t, (evaluation) => evaluation.velocities());
  }

  /** Half the section by a plane, from the front to the rear, in l: x, r of one point after another. */
  outline(plane: Plane, t: number): Float32Array {
    return this.#at(t, (evaluation) => evaluation.outline(plane));
  }

  /**
   * Half the silhouette across the direction cos(angle) y + sin(angle) z, from the front to the rear, in l: x, w of one
   * point after another.
   */
  silhouette(t: number, angle = 0, points = 257): Float32Array {
    return this.#at(t, (evaluation) => evaluation.silhouette(angle, points));
  }

  /** Mechanics of the membrane at the nodes; of a capsule in the channel alone. */
  fields(t: number): Fields {
    const numbers = this.#at(t, (evaluation) => evaluation.membrane());
    const nodes = numbers.length / (SCALARS.length + 3 * VECTORS.length);
    const scalar = (index: number) => numbers.subarray(index * nodes, (index + 1) * nodes);
    const vectors = numbers.subarray(SCALARS.length * nodes);
    const vector = (index: number) => vectors.subarray(3 * index * nodes, 3 * (index + 1) * nodes);
    return Object.fromEntries([
      ...SCALARS.map((name, index) => [name, scalar(index)]),
      ...VECTORS.map((name, index) => [name, vector(index)]),
    ]);
  }

  /**
   * Expected distance to the full-order model as a fraction of a: modified Hausdorff distance for a capsule in the
   * channel, else mean distance of the nodes to the data. Outside the sampled domain it is a guess.
   */
  expectedError(t: number): number {
    return this.#at(t, (evaluation) => evaluation.expectedError());
  }

  /** 95 of 100 errors are below, as a fraction of a; undefined outside the sampled domain, where no bound is known. */
  bound(t: number): number | undefined {
    return this.#at(t, (evaluation) => evaluation.errorBound());
  }

  #at<A>(t: number, question: (evaluation: Evaluation) => A): A {
    return this.#ask((evaluation) => {
      evaluation.goTo(t);
      return question(evaluation);
    });
  }
}
