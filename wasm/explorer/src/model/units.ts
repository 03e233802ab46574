import type { Model } from "../wasm/capsule_wasm";

/** A unit in which the page shows the model's numbers. */
export interface Unit {
  readonly name: string;
  /** As it is written where a screen reader or a file meets it. */
  readonly plain: string;
  /** One of the model's units in this one. */
  readonly factor: number;
}

/** The units that numbers and axes are shown in. */
export interface Units {
  readonly length: Unit;
  readonly velocity: Unit;
  readonly time: Unit;
  /** Forces per length in the membrane. */
  readonly tension: Unit;
  /** Forces per area on the membrane. */
  readonly load: Unit;
  /** The length that figures are drawn in: l in the channel, else the capsule's radius. */
  readonly drawn: Unit;
  /** Whether numbers have a size that fixed digits suit, as those of a capsule in the channel do. */
  readonly fixedDigits: boolean;
}

const unit = (name: string, plain = name, factor = 1): Unit => ({ name, plain, factor });

/** The units that a model's numbers have. */
export function unitsOf(model: Pick<Model, "isChannel" | "units">): Units {
  if (model.isChannel) {
    return {
      length: unit("ℓ", "l"),
      velocity: unit("V"),
      time: unit("ℓ/V", "l/V"),
      tension: unit("Gₛ", "G_s"),
      load: unit("μV/ℓ", "mu V/l"),
      drawn: unit("ℓ", "l"),
      fixedDigits: true,
    };
  }
  const [length = "", velocity = "", time = ""] = model.units();
  return {
    length: unit(length),
    velocity: unit(velocity),
    time: unit(time),
    tension: unit(""),
    load: unit(""),
    drawn: unit("a"),
    fixedDigits: false,
  };
}

/** l in um, from the channel's side in um. */
export function lengthScale([side = 1]: readonly number[]): number {
  return side / 2;
}

/** V = Ca G_s / mu in mm/s, from the viscosity in mPa s and the surface shear modulus in mN/m. */
export function velocityScale([, viscosity = 1, modulus = 1]: readonly number[], ca: number): number {
  return (1000 * ca * modulus) / viscosity;
}

/** The units of an experiment with a capsule in the channel: side in um, viscosity in mPa s, modulus in mN/m. */
export function physicalUnits(dimensions: readonly number[], ca: number): Units {
  const [, viscosity = 1, modulus = 1] = dimensions;
  const [length, velocity] = [lengthScale(dimensions), velocityScale(dimensions, ca)];
  return {
    length: unit("µm", "um", length),
    velocity: unit("mm/s", "mm/s", velocity),
    // um / (mm/s) is a millisecond.
    time: unit("ms", "ms", length / velocity),
    tension: unit("mN/m", "mN/m", modulus),
    // mPa s mm/s / um is a pascal.
    load: unit("Pa", "Pa", (viscosity * velocity) / length),
    drawn: unit("µm", "um", length),
    fixedDigits: false,
  };
}
