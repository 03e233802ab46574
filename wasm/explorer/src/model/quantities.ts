import type { Quantity } from "../app/schema";
import type { Messages } from "../messages/en";
import type { Unit, Units } from "./units";

/** How a read-out is written. */
interface Presentation {
  readonly unit: (units: Units) => Unit;
  /** The section plane that it is measured in. */
  readonly plane?: "midplane" | "diagonal";
  readonly digits: number;
}

const length = ({ length }: Units) => length;
const velocity = ({ velocity }: Units) => velocity;
const volume = ({ length: { name, plain, factor } }: Units): Unit => ({
  name: `${name}³`,
  plain: `${plain}^3`,
  factor: factor ** 3,
});
const error = (): Unit => ({ name: "% a", plain: "% a", factor: 100 });

export const PRESENTATION: Record<Quantity, Presentation> = {
  axial_length: { unit: length, digits: 4 },
  half_width: { unit: length, plane: "midplane", digits: 4 },
  half_diagonal: { unit: length, plane: "diagonal", digits: 4 },
  rear_depth: { unit: length, digits: 4 },
  velocity: { unit: velocity, digits: 4 },
  volume: { unit: volume, digits: 4 },
  expected_error: { unit: error, digits: 3 },
  error_bound: { unit: error, digits: 3 },
};

/** The read-outs that are errors: the solution that they are taken against is named wherever they are shown. */
export const ERRORS: ReadonlySet<Quantity> = new Set(["expected_error", "error_bound"]);

/** The name of a read-out. Outside the sampled domain the expected error is a guess. */
export function nameOf({ quantities, readouts }: Messages, quantity: Quantity, extrapolated: boolean): string {
  const name = quantities[quantity];
  return extrapolated && quantity === "expected_error" ? readouts.guess(name) : name;
}

export function unitOf(quantity: Quantity, units: Units): Unit {
  return PRESENTATION[quantity].unit(units);
}

/** A number as its read-out shows it, without its unit. */
export function written(quantity: Quantity, value: number, units: Units): string {
  const shown = value * unitOf(quantity, units).factor;
  const { digits } = PRESENTATION[quantity];
  const fixed = units.fixedDigits || ERRORS.has(quantity);
  return (fixed ? shown.toFixed(digits) : String(Number(shown.toPrecision(5)))).replace("-", "−");
}

/** A number with its unit; undefined is an error bound that does not exist. */
export function measure(words: Messages, quantity: Quantity, value: number | undefined, units: Units): string {
  return value === undefined
    ? words.readouts.none
    : `${written(quantity, value, units)} ${unitOf(quantity, units).name}`;
}

/** The least difference that a read-out's digits tell apart, in the model's unit. */
export function resolution(quantity: Quantity, value: number, units: Units): number {
  const fixed = units.fixedDigits || ERRORS.has(quantity);
  const { factor } = unitOf(quantity, units);
  return fixed ? 10 ** -PRESENTATION[quantity].digits / factor : 1e-5 * Math.max(Math.abs(value), 1e-30);
}
