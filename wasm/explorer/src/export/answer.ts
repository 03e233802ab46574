import type { Answer } from "../identify/protocol";

/** An answer as `capsule-rom identify --json` prints it. */
export function answerJson(answer: Answer): string {
  return `${JSON.stringify(answer, null, 2)}\n`;
}

/** An answer as a table of one row: the ends of intervals are columns of their own, an open one is empty. */
export function answerCsv(answer: Answer): string {
  const cells = Object.entries(answer).flatMap(([key, value]) => columns(key, value));
  const row = (texts: string[]) => texts.map(quoted).join(",");
  return `${row(cells.map(([key]) => key))}\n${row(cells.map(([, text]) => text))}\n`;
}

function columns(key: string, value: unknown): [string, string][] {
  if (Array.isArray(value)) {
    if (key === "warnings") return [[key, value.join("; ")]];
    return ["low", "high"].map((end, i) => [`${key}_${end}`, value[i] === null ? "" : String(value[i])]);
  }
  if (typeof value === "object" && value !== null) {
    return Object.entries(value).flatMap(([inner, one]) => columns(`${key}_${inner}`, one));
  }
  return [[key, value === null ? "" : String(value)]];
}

const quoted = (text: string) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
