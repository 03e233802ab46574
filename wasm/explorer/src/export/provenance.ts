import { measure } from "../model/quantities";
import type { Context, Trace } from "../views/view";

const CITATION = "Boubehziz et al., Entropy 2021, 23, 1193, doi:10.3390/e23091193";

/** One trace in words: its parameters, the method, and the error that the model states. */
export function describeTrace({ name, query, answer }: Trace, { capsule, units, state, words }: Context): string {
  const { methods, refused, extrapolated, bound } = words.provenance;
  const parameters = query.parameters.map((value, i) => `${capsule.names()[i]} = ${value}`);
  const t = `t = ${Number((state.t * units.time.factor).toPrecision(6))} ${units.time.plain}`;
  const asked = [...parameters, methods[query.method], t].join(", ");
  const who = name === "live" ? "" : `${name}: `;
  if (answer === undefined) return refused(`${who}${asked}`);
  const caution = answer.validity.kind === "extrapolated" ? [extrapolated] : [];
  const error = bound(measure(words, "error_bound", answer.read("error_bound"), units));
  return `${who}${[asked, ...caution, error].join(", ")}`;
}

/** Where figures come from, a line each: the model, the queries, the errors' meaning, the publication, the link. */
export function provenance(traces: readonly Trace[], context: Context, link: string): string[] {
  const { model } = context.capsule;
  const words = context.words.provenance;
  return [
    words.model(model.digest, model.title),
    ...traces.map((trace) => describeTrace(trace, context)),
    context.errors.sentence.replaceAll("\u00a0", " "),
    words.method(CITATION),
    link,
  ];
}

/** One line that goes below a figure. */
export function footer([live]: readonly Trace[], context: Context): string {
  const { digest } = context.capsule.model;
  const query = live === undefined ? "" : describeTrace(live, context);
  return context.words.provenance.foot(digest, query, context.errors.against).replaceAll("\u00a0", " ");
}
