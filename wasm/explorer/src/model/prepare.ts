import type { Query } from "../app/schema";
import type { Evaluation } from "../wasm/capsule_wasm";

export type Domain = "inside" | "beyond-steady-limit" | "far-from-samples" | "outside";

/** Sets a query; throws with the core's words where it is refused. */
export function prepare(evaluation: Evaluation, { parameters, method, extrapolate }: Query): Domain {
  return evaluation.prepare(Float64Array.from(parameters), method, extrapolate) as Domain;
}
