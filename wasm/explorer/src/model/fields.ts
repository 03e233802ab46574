import type { Colour, Frame } from "../app/schema";
import type { Messages } from "../messages/en";
import type { Unit, Units } from "./units";

/** A scalar on the membrane, by its name in the core. */
export type FieldName = Exclude<Colour, "none">;

/** How a field is measured and coloured. */
interface Presentation {
  readonly unit: (units: Units) => Unit;
  /** The value on whose two sides the colours differ; undefined for a magnitude. */
  readonly centre?: number;
  /** Whether it is one of the frame that things are seen in. */
  readonly hasFrame?: true;
}

const ratio = (): Unit => ({ name: "", plain: "", factor: 1 });
const tension = ({ tension }: Units) => tension;

export const FIELD_PRESENTATION: Record<FieldName, Presentation> = {
  displacement: { unit: ({ length }) => length, hasFrame: true },
  velocity: { unit: ({ velocity }) => velocity, hasFrame: true },
  stretch_1: { unit: ratio, centre: 1 },
  stretch_2: { unit: ratio, centre: 1 },
  tension_1: { unit: tension, centre: 0 },
  tension_2: { unit: tension, centre: 0 },
  energy_density: { unit: tension },
  load: { unit: ({ load }) => load },
};

/** The name of a field, with the frame that a motion is seen in. */
export function fieldName({ fields }: Messages, field: FieldName, frame: Frame): string {
  const name = fields[field];
  if (FIELD_PRESENTATION[field].hasFrame === undefined) return name;
  return frame === "laboratory" ? fields.inLaboratory(name) : fields.toCentroid(name);
}

/** Whether a field is one of the mechanics of the membrane, which some models do not have. */
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
