import type { Colour, Frame } from "../app/schema";
import type { Unit, Units } from "./units";

/** A scalar on the membrane, by its name in the core. */
export type FieldName = Exclude<Colour, "none">;

/** How a field is named and coloured. */
interface Presentation {
  readonly name: string;
  readonly unit: (units: Units) => Unit;
  /** The value on whose two sides the colours differ; undefined for a magnitude. */
  readonly centre?: number;
  /** Whether it is one of the frame that things are seen in. */
  readonly hasFrame?: true;
}

const ratio = (): Unit => ({ name: "", plain: "", factor: 1 });
const tension = ({ tension }: Units) => tension;

export const FIELD_PRESENTATION: Record<FieldName, Presentation> = {
  displacement: { name: "Displacement", unit: ({ length }) => length, hasFrame: true },
  velocity: { name: "Velocity", unit: ({ velocity }) => velocity, hasFrame: true },
  stretch_1: { name: "Stretch λ₁", unit: ratio, centre: 1 },
  stretch_2: { name: "Stretch λ₂", unit: ratio, centre: 1 },
  tension_1: { name: "Tension T₁", unit: tension, centre: 0 },
  tension_2: { name: "Tension T₂", unit: tension, centre: 0 },
  energy_density: { name: "Energy density", unit: tension },
  load: { name: "Load", unit: ({ load }) => load },
};

/** The name of a field, with the frame that a motion is seen in. */
export function fieldName(field: FieldName, frame: Frame): string {
  const { name, hasFrame } = FIELD_PRESENTATION[field];
  const seen = frame === "laboratory" ? "in the laboratory frame" : "relative to the centroid";
  return hasFrame ? `${name} ${seen}` : name;
}

/** Whether a field needs the stress-free state, which is known of a capsule in the channel alone. */
export function isMechanics(field: FieldName): boolean {
  return FIELD_PRESENTATION[field].hasFrame === undefined;
}

/** A span narrower than this is no difference that a field of order one has. */
const LEAST_SPAN = 1e-4;

/** The least and the greatest of all values. */
export function extremesOf(parts: readonly Float32Array[]): readonly [number, number] {
  let [least, most] = [Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY];
  for (const values of parts) {
    for (const value of values) {
      if (value < least) least = value;
      if (value > most) most = value;
    }
  }
  return [least, most];
}

/** The span of the colours for values between two extremes: these, or as far to both sides of the centre. */
export function colourSpan(field: FieldName, [least, most]: readonly [number, number]): readonly [number, number] {
  const { centre } = FIELD_PRESENTATION[field];
  if (centre === undefined) return [least, Math.max(most, least + LEAST_SPAN)];
  const reach = Math.max(most - centre, centre - least, LEAST_SPAN / 2);
  return [centre - reach, centre + reach];
}
