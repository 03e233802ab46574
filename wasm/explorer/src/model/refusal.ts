import type { Messages } from "../messages/en";

/** Why there is no answer: the core's name of the reason, what stands in its words, and these words, in English. */
export interface Refusal {
  readonly code: string;
  readonly values: readonly string[];
  readonly words: string;
}

/** The reason of anything thrown: by the core, or by the browser, which has no name for it. */
export function refusalOf(error: unknown): Refusal {
  const { code = "", values = [] } = error instanceof Error ? (error as Partial<Refusal>) : {};
  return { code, values: values.map(rounded), words: text(error) };
}

/** A refusal in words of the page; where they have none for it, in those of the core, which are English. */
export function reason(
  { core }: Messages["refusals"],
  { code, values, words }: Refusal,
): { readonly words: string; readonly isEnglish: boolean } {
  const said = core[code]?.(...values);
  return { words: said ?? words, isEnglish: said === undefined };
}

/** The words of anything thrown, without a closing full stop. */
export function text(error: unknown): string {
  const words = error instanceof Error ? error.message : String(error);
  return rounded(words.replace(/\.$/, ""));
}

/** Numbers to the digits that single precision has. */
const rounded = (words: string) =>
  words.replace(/\d+\.\d{7,}/g, (number) => String(Number(Number(number).toPrecision(6))));
