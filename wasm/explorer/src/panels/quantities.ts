import type { Quantity } from "../app/state";

/** How a read-out is named and written. */
export interface Presentation {
  readonly name: string;
  /** In the units of the open model. */
  unit: string;
  /** The section plane that it is measured in. */
  readonly plane?: "midplane" | "diagonal";
  /** From the core's number to the one that is shown. */
  readonly scale: number;
  readonly digits: number;
}

export const PRESENTATION: Record<Quantity, Presentation> = {
  axial_length: { name: "Axial length", unit: "ℓ", scale: 1, digits: 4 },
  half_width: { name: "Half width", unit: "ℓ", plane: "midplane", scale: 1, digits: 4 },
  half_diagonal: { name: "Half diagonal", unit: "ℓ", plane: "diagonal", scale: 1, digits: 4 },
  rear_depth: { name: "Rear depth", unit: "ℓ", scale: 1, digits: 4 },
  velocity: { name: "Velocity", unit: "V", scale: 1, digits: 4 },
  volume: { name: "Volume", unit: "ℓ³", scale: 1, digits: 4 },
  expected_error: { name: "Expected error", unit: "% a", scale: 100, digits: 3 },
  error_bound: { name: "95 % error bound", unit: "% a", scale: 100, digits: 3 },
};

/** The read-outs that are errors: what they are taken against is said wherever they are shown. */
export const ERRORS: ReadonlySet<Quantity> = new Set(["expected_error", "error_bound"]);

/** The name of a read-out. Outside the sampled domain the expected error is a guess. */
export function nameOf(quantity: Quantity, extrapolated: boolean): string {
  const { name } = PRESENTATION[quantity];
  return extrapolated && quantity === "expected_error" ? `${name}, a guess` : name;
}

/** The units of a capsule in the channel. */
export const STANDARD_UNITS = Object.fromEntries(
  Object.entries(PRESENTATION).map(([quantity, { unit }]) => [quantity, unit]),
) as Record<Quantity, string>;

/** A number with its unit; undefined is an error bound that does not exist. */
export function measure(quantity: Quantity, value: number | undefined): string {
  return value === undefined ? "none" : `${written(quantity, value)} ${PRESENTATION[quantity].unit}`;
}

/** A number as its read-out shows it. */
export function written(quantity: Quantity, value: number): string {
  const { scale, digits } = PRESENTATION[quantity];
  // Lengths in other units than the channel's may have any size.
  const isChannel = document.body.dataset.model !== "other";
  const text = isChannel ? (value * scale).toFixed(digits) : String(Number((value * scale).toPrecision(5)));
  return text.replace("-", "−");
}
