import type { Messages } from "../messages/en";
import type { Model } from "../wasm/capsule_wasm";

/** The kind of error that a model states. */
export interface ErrorMeaning {
  /** The solution that they are taken against: goes with each error. */
  readonly against: string;
  /** The distance that they measure, in a sentence. */
  readonly sentence: string;
}

/** Says it of a model: of a capsule in the channel, or of other people's data. */
export function errorMeaning(
  { errors, laws }: Messages,
  { isChannel, membraneLaw, bendingStiffness }: Pick<Model, "isChannel" | "membraneLaw" | "bendingStiffness">,
): ErrorMeaning {
  // With spaces that no line breaks at.
  const bending = bendingStiffness === undefined ? "" : `, B\u00a0=\u00a0${short(bendingStiffness)}`;
  const law = laws[membraneLaw] ?? membraneLaw;
  const against = isChannel ? errors.againstModel(law, bending) : errors.againstData;
  return { against, sentence: errors.sentence(against, isChannel ? errors.ofCapsule : errors.ofNodes) };
}

function short(stiffness: number): string {
  return stiffness === 0 ? "0" : stiffness.toExponential();
}
