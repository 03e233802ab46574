import { ModelError } from "../model/load";

const FORMAT = "capsule-explorer-session";

/** A saved session: what a link says, in a file. */
export function toSession(link: string): string {
  return `${JSON.stringify({ format: FORMAT, version: 1, link }, null, 2)}\n`;
}

/** The link that a saved session holds; throws a `ModelError`. */
export async function fromSession(file: File): Promise<string> {
  let content: unknown;
  try {
    content = JSON.parse(await file.text());
  } catch {
    content = undefined;
  }
  const isSession = (value: unknown): value is { format: string; link: string } =>
    typeof value === "object" &&
    value !== null &&
    "format" in value &&
    value.format === FORMAT &&
    "link" in value &&
    typeof value.link === "string";
  if (isSession(content)) return content.link;
  throw new ModelError(
    `${file.name} is not a session that can be read.`,
    "Open a file that Export, Session saved on this page, or a .crom model.",
  );
}
