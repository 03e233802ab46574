import type { Model } from "../wasm/capsule_wasm";

/** The kind of error that a model states. */
export interface ErrorMeaning {
  /** The solution that they are taken against: goes with each error. */
  readonly against: string;
  /** The distance that they measure, in a sentence. */
  readonly sentence: string;
}

/** Says it of a model: of a capsule in the channel, or of other people's data. */
export function errorMeaning(model: Pick<Model, "isChannel" | "membraneLaw" | "bendingStiffness">): ErrorMeaning {
  const { isChannel, membraneLaw, bendingStiffness } = model;
  // With spaces that no line breaks at.
  const bending = bendingStiffness === undefined ? "" : `, B\u00a0=\u00a0${short(bendingStiffness)}`;
  const against = isChannel
    ? `against the full-order model (${membraneLaw}${bending})`
    : "against the data that the model was built from";
  const distance = isChannel
    ? "modified Hausdorff distance, drift along the channel included, in per cent of a"
    : "mean distance of the nodes, in per cent of a, the radius of a sphere of the capsule’s volume";
  return { against, sentence: `Errors are taken ${against}: ${distance}.` };
}

function short(stiffness: number): string {
  return stiffness === 0 ? "0" : stiffness.toExponential();
}
