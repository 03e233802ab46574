import { once, read } from "./bytes.js";
import initialise, { Identifier } from "./capsule_identify_wasm.js";
import { asked } from "./errors.js";
import type { Model } from "./model.js";

export { CapsuleError } from "./errors.js";

/** A point [x, y]. */
export type Point = readonly [number, number];

/**
 * The outline of a capsule: points in order around it; the text of such points, one a line, with headings that tell the
 * unit; or the bytes of a picture (PNG, JPEG, TIFF) or of such a text.
 */
export type Outline = readonly Point[] | string | ArrayBuffer | ArrayBufferView;

/** The options of `capsule-rom identify`, by their names. One of the three velocities is needed. */
export interface Setup {
  /** Half the side of the square channel. */
  readonly half_width_um: number;
  /** Mean velocity of the liquid. */
  readonly velocity_mm_s?: number;
  readonly flow_rate_ul_min?: number;
  readonly capsule_velocity_mm_s?: number;
  /** Viscosity of the liquid. */
  readonly viscosity_pa_s: number;
  /** The section through the axis, parallel to two walls; or the outline of the projection, as in bright field. */
  readonly observable: "midplane" | "silhouette";
  /** Unit of the outline's numbers: as the headings of a text say; of points um, or px where `pixel_um` is given. */
  readonly unit?: "um" | "px";
  /** Size of a pixel; in a picture the walls tell it, if it is not given. */
  readonly pixel_um?: number;
  /** Direction of the flow, by default the one that fits best. */
  readonly flow?: "right" | "left" | "up" | "down" | "found";
  /** Which of several capsules in a picture, from 1. */
  readonly capsule?: number;
  /** Criterion for the edge in a picture. */
  readonly edge?: "gradient" | "half-level";
  /** Standard deviation of a point, by default from the residuals. */
  readonly noise_um?: number;
  /** Standard deviation of the edge, in pixels, by default 0.25. */
  readonly edge_px?: number;
  /** Relative standard deviation of the scale, by default 0.005. */
  readonly scale_error?: number;
  /** Exposure of the picture, to be told how far the capsule moves in it. */
  readonly exposure_ms?: number;
}

/** Ends of an interval; null is an end at the edge of the sampled domain: nothing is known beyond. */
export type Interval = readonly [number | null, number | null];

/** The answer, with the keys of `capsule-rom identify --json`. */
export interface Answer {
  /**
   * "identified", "bounded-on-one-side", "several-solutions", "outside-domain", "undetermined", "not-such-a-capsule" or
   * "scale-or-channel-inconsistent".
   */
  readonly verdict: string;
  /** The same in a sentence. */
  readonly verdict_text: string;
  /** Capillary number mu V / G_s. */
  readonly ca: number;
  readonly ca_68: Interval;
  readonly ca_95: Interval;
  /** a/l. */
  readonly confinement: number;
  readonly confinement_68: Interval;
  readonly confinement_95: Interval;
  /** Radius a at rest. */
  readonly radius_um: number;
  readonly radius_um_68: Interval;
  readonly radius_um_95: Interval;
  /** Surface shear modulus G_s. */
  readonly gs_n_per_m: number;
  readonly gs_n_per_m_68: Interval;
  readonly gs_n_per_m_95: Interval;
  /** Mean velocity of the liquid. */
  readonly mean_velocity_mm_s: number;
  /** Correlation of the errors of ln Ca and a/l. */
  readonly correlation: number;
  /** Sum of the squares of the residuals over their noise. */
  readonly chi_squared: number;
  readonly degrees_of_freedom: number;
  /** Root mean square of the residuals. */
  readonly residual_um: number;
  /** Noise of a point. */
  readonly noise_um: number;
  /** How many neighbouring residuals count as one. */
  readonly correlated_points: number;
  /** How much of the model's error the outline asks for. */
  readonly structure: number;
  /** How far the edge seems to be drawn too far out. */
  readonly edge_um: number;
  /** Relative error of the scale. */
  readonly scale_error: number;
  /** Angle of the channel's axis. */
  readonly tilt_degrees: number;
  /** Direction of the flow. */
  readonly flow: string;
  /** Way of the capsule in the exposure. */
  readonly blur_um?: number;
  /** A second solution that fits as well. */
  readonly alternative?: { readonly ca: number; readonly confinement: number; readonly rise_of_chi_squared: number };
  /** Origin of the outline, in words. */
  readonly contour: string;
  /** Findings in a picture. */
  readonly picture?: object;
  readonly warnings?: readonly string[];
  readonly model_digest: string;
  /** The solution that the model's errors are taken against. */
  readonly errors_against: string;
}

/** An answer and what is drawn of it, in the frame of the capsule's centroid, in l. */
export interface Identification {
  readonly answer: Answer;
  /** The measured points, at most 1000 of them. */
  readonly contour: readonly Point[];
  /** Half the fitted outline, from the front to the rear. */
  readonly outline: readonly Point[];
}

const loadModule = once(async () => {
  await initialise({ module_or_path: await read(new URL("./capsule_identify_wasm_bg.wasm", import.meta.url)) });
});

/** Makes the starts of all identifications with a model. */
const open = (file: Uint8Array) => Identifier.open(file);

/**
 * Radius, Ca and surface shear modulus of a steady capsule in the channel, with intervals, from its outline. Throws a
 * `CapsuleError` for an outline that holds no capsule, and for a setup that cannot be.
 */
export async function identify(model: Model, outline: Outline, setup: Setup): Promise<Identification> {
  const [bytes, unit] = written(outline, setup);
  await loadModule();
  const said = JSON.stringify({ ...setup, unit });
  const { answer, contour, outline: fitted } = asked(() => JSON.parse(model.part(open).identify("", bytes, said)));
  return { answer, contour, outline: fitted };
}

/** An outline as the bytes of a file, and the unit of its numbers. */
function written(outline: Outline, { unit, pixel_um }: Setup): [bytes: Uint8Array, unit: Setup["unit"]] {
  if (outline instanceof ArrayBuffer) return [new Uint8Array(outline), unit];
  if (ArrayBuffer.isView(outline))
    return [new Uint8Array(outline.buffer, outline.byteOffset, outline.byteLength), unit];
  if (typeof outline === "string") return [new TextEncoder().encode(outline), unit];
  const lines = outline.map(([x, y]) => `${x},${y}\n`).join("");
  return [new TextEncoder().encode(lines), unit ?? (pixel_um === undefined ? "um" : "px")];
}
