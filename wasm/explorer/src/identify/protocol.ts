import type { Refusal } from "../model/refusal";

/** Messages between the page and its worker. */

/** Information on an outline beside its file, as the module takes it. */
export interface Said {
  readonly half_width_um: number;
  readonly velocity_mm_s: number;
  readonly viscosity_pa_s: number;
  readonly observable: string;
  readonly unit: string | null;
  readonly pixel_um: number | null;
  readonly flow: string;
  readonly capsule: number | null;
}

/** Ends of an interval; null is one that is open. */
export type Ends = readonly [number | null, number | null];

/** The answer, with the keys of `capsule-rom identify --json`. */
export interface Answer {
  readonly verdict: string;
  readonly verdict_text: string;
  readonly ca: number;
  readonly ca_68: Ends;
  readonly ca_95: Ends;
  readonly confinement: number;
  readonly confinement_68: Ends;
  readonly confinement_95: Ends;
  readonly radius_um: number;
  readonly radius_um_68: Ends;
  readonly radius_um_95: Ends;
  readonly gs_n_per_m: number;
  readonly gs_n_per_m_68: Ends;
  readonly gs_n_per_m_95: Ends;
  readonly residual_um: number;
  readonly edge_um: number;
  readonly scale_error: number;
  readonly tilt_degrees: number;
  readonly chi_squared: number;
  readonly degrees_of_freedom: number;
  readonly flow: string;
  readonly contour: string;
  /** There where the outline comes from a picture. */
  readonly picture?: object;
  readonly alternative?: { readonly ca: number; readonly confinement: number; readonly rise_of_chi_squared: number };
  readonly warnings?: readonly string[];
  readonly model_digest: string;
  readonly errors_against: string;
}

/** An answer and what is drawn of it. */
export interface Found {
  readonly answer: Answer;
  /** The measured points in the frame of the capsule's centroid, in l. */
  readonly contour: readonly (readonly [number, number])[];
  /** Half the fitted outline, from the front to the rear, in l. */
  readonly outline: readonly (readonly [number, number])[];
  /** Rises of the sum of squares at the borders of the regions of 68 and 95 %. */
  readonly levels: readonly [number, number];
  /** Ranges of Ca and of a/l that hold these regions. */
  readonly around: readonly [readonly [number, number], readonly [number, number]];
  /** Of a picture, in l in the same frame: its upper left corner, and the ways of a pixel along a row and a column. */
  readonly picture?: {
    readonly size: readonly [number, number];
    readonly corner: readonly [number, number];
    readonly ways: readonly [readonly [number, number], readonly [number, number]];
  };
}

/** What the worker is asked for. */
export type Question =
  | { readonly kind: "open"; readonly model: Uint8Array }
  | { readonly kind: "identify"; readonly name: string; readonly file: Uint8Array; readonly said: Said }
  | { readonly kind: "misfit"; readonly places: Float64Array };

export interface Asked {
  readonly id: number;
  readonly question: Question;
}

/** The result of the question of a number, or why there is none: the core's reason, or words of a worker that broke. */
export type Reply =
  | { readonly id: number; readonly result: Found | Float64Array | undefined }
  | { readonly id: number; readonly refusal: Refusal }
  | { readonly id: number; readonly failed: string };
