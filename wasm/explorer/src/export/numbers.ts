import { QUANTITIES, type Query } from "../app/schema";
import { en } from "../messages/en";
import type { Answer } from "../model/answer";
import type { Capsule } from "../model/capsule";
import { errorMeaning } from "../model/errors";
import { ERRORS, unitOf } from "../model/quantities";
import type { Units } from "../model/units";
import type { Context, Trace } from "../views/view";

/** Instants of an exported course. */
const INSTANTS = 101;

type Numbers = Record<string, number | null>;

/** The read-outs of an answer by name, in the units shown, errors in the radius; null: there is no bound. */
function readouts(answer: Answer, units: Units): Numbers {
  return Object.fromEntries(
    QUANTITIES.map((quantity) => {
      const factor = ERRORS.has(quantity) ? 1 : unitOf(quantity, units).factor;
      const value = answer.read(quantity);
      return [quantity, value === undefined ? null : value * factor];
    }),
  );
}

/** The read-outs at instants over the whole time; those that the core refuses are left out. */
function course(capsule: Capsule, query: Query, units: Units): Numbers[] {
  const end = capsule.model.endTime;
  return Array.from({ length: INSTANTS }, (_, i) => (end * i) / (INSTANTS - 1)).flatMap((t) => {
    const answer = capsule.answer("export", query, t);
    return answer.validity.kind === "refused" ? [] : [{ t: t * units.time.factor, ...readouts(answer, units) }];
  });
}

/** Everything that is on screen in numbers, as JSON: the instant, and the course of each trace. */
export function toJson(traces: readonly Trace[], { capsule, units, state }: Context, link: string): string {
  const { model } = capsule;
  const content = {
    model_digest: model.digest,
    model_title: model.title,
    database_digest: model.databaseDigest,
    membrane_law: model.membraneLaw,
    bending_stiffness: model.bendingStiffness ?? null,
    // In English whatever the page speaks, as all of the file.
    errors_against: errorMeaning(en, model).against.replace("against ", "").replaceAll("\u00a0", " "),
    units: { length: units.length.plain, velocity: units.velocity.plain, time: units.time.plain, errors: "a" },
    link,
    traces: traces.map(({ name, query, answer }) => ({
      name,
      parameters: Object.fromEntries(query.parameters.map((value, i) => [capsule.names()[i] ?? "", value])),
      method: query.method,
      validity: answer?.validity.kind ?? "refused",
      instant: answer === undefined ? null : { t: state.t * units.time.factor, ...readouts(answer, units) },
      course: course(capsule, query, units),
    })),
  };
  return `${JSON.stringify(content, null, 2)}\n`;
}

/** The courses of all traces as CSV, a line an instant; the lines before say where they come from. */
export function toCsv(traces: readonly Trace[], { capsule, units }: Context, provenance: readonly string[]): string {
  const unit = { length: units.length.plain, velocity: units.velocity.plain, time: units.time.plain };
  const lines = [
    ...provenance.map((line) => `# ${line}`),
    `# lengths in ${unit.length}, velocity in ${unit.velocity}, time in ${unit.time}, errors in the radius a`,
    ["trace", ...capsule.names(), "method", "t", ...QUANTITIES].join(","),
  ];
  for (const { name, query } of traces) {
    for (const row of course(capsule, query, units)) {
      lines.push(
        [name, ...query.parameters, query.method, row.t, ...QUANTITIES.map((key) => row[key] ?? "")].join(","),
      );
    }
  }
  return `${lines.join("\n")}\n`;
}
