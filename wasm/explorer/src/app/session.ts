import type { OutlineFile } from "../identify/measured";
import { ModelError } from "../model/load";
import { fromBase64, toBase64 } from "./base64";

const FORMAT = "capsule-explorer-session";

/** Contents of a saved session. */
interface Session {
  readonly format: string;
  readonly version: number;
  readonly link: string;
  /** The measured outline's file, its bytes in base 64. */
  readonly outline?: { readonly name: string; readonly base64: string };
}

/** A saved session: what a link says, and the measured outline, in a file. */
export function toSession(link: string, outline: OutlineFile | undefined): string {
  const session: Session = {
    format: FORMAT,
    version: 1,
    link,
    ...(outline === undefined ? {} : { outline: { name: outline.name, base64: toBase64(outline.bytes) } }),
  };
  return `${JSON.stringify(session, null, 2)}\n`;
}

/** The link and the outline that a saved session holds; throws a `ModelError`. */
export async function fromSession(file: File): Promise<{ link: string; outline: OutlineFile | undefined }> {
  try {
    const content: unknown = JSON.parse(await file.text());
    if (isSession(content)) {
      const { link, outline } = content;
      return { link, outline: outline && { name: outline.name, bytes: fromBase64(outline.base64) } };
    }
  } catch {
    // Said below.
  }
  throw new ModelError((words) => [words.noSession(file.name), words.openSession]);
}

function isSession(value: unknown): value is Session {
  const { format, link, outline } = Object(value);
  const { name, base64 } = outline ?? { name: "", base64: "" };
  const isText = [link, name, base64].every((item) => typeof item === "string");
  return format === FORMAT && isText;
}
