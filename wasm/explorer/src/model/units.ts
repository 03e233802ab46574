import type { Model } from "../wasm/capsule_wasm";

/** A unit in which the page shows the model's numbers. */
export interface Unit {
  readonly name: string;
  /** As it is written where a screen reader or a file meets it. */
  readonly plain: string;
  /** What one of the model's units is in this one. */
  readonly factor: number;
}

/** The units that numbers and axes are shown in. */
export interface Units {
  readonly length: Unit;
  readonly velocity: Unit;
  readonly time: Unit;
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
      drawn: unit("ℓ", "l"),
      fixedDigits: true,
    };
  }
  const [length = "", velocity = "", time = ""] = model.units();
  return {
    length: unit(length),
    velocity: unit(velocity),
    time: unit(time),
    drawn: unit("a"),
    fixedDigits: false,
  };
}
