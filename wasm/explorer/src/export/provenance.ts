import { measure } from "../model/quantities";
import type { Context, Trace } from "../views/view";

const CITATION = "Boubehziz et al., Entropy 2021, 23, 1193, doi:10.3390/e23091193";

/** One trace in words: its parameters, the method, and the error that the model states. */
export function describeTrace({ name, query, answer }: Trace, { capsule, units, state }: Context): string {
  const parameters = query.parameters.map((value, i) => `${capsule.names()[i]} = ${value}`).join(", ");
  const t = `t = ${Number((state.t * units.time.factor).toPrecision(6))} ${units.time.plain}`;
  const who = name === "live" ? "" : `${name}: `;
  if (answer === undefined) return `${who}${parameters}, ${query.method}, ${t}: no answer`;
  const extrapolated = answer.validity.kind === "extrapolated" ? "extrapolated, " : "";
  const bound = measure("error_bound", answer.read("error_bound"), units);
  return `${who}${parameters}, ${query.method}, ${t}, ${extrapolated}95 % error bound ${bound}`;
}

/** Where figures come from, a line each: the model, the queries, the errors' meaning, the publication, the link. */
export function provenance(traces: readonly Trace[], context: Context, link: string): string[] {
  const { model } = context.capsule;
  return [
    `CapsuleExplorer, model ${model.digest}: ${model.title}`,
    ...traces.map((trace) => describeTrace(trace, context)),
    context.errors.sentence.replaceAll("\u00a0", " "),
    `Method: ${CITATION}`,
    link,
  ];
}

/** One line that goes below a figure. */
export function footer([live]: readonly Trace[], context: Context): string {
  const { digest } = context.capsule.model;
  const query = live === undefined ? "" : describeTrace(live, context);
  return `Model ${digest}; ${query} ${context.errors.against}`.replaceAll("\u00a0", " ");
}
