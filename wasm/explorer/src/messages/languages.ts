import { en, type Messages } from "./en";

/** The languages of the page, each by its own name. */
export const LANGUAGES = { en: "English", fr: "Français" } as const;
export type Language = keyof typeof LANGUAGES;

const STORED = "capsule-explorer-language";

/** The words of a language. English is there at once, another one is loaded when it is asked for. */
export async function wordsOf(language: Language): Promise<Messages> {
  return language === "en" ? en : (await import("./fr")).fr;
}

/** The first language among those asked for that the page has: "fr-CA" is French. */
export function languageOf(...asked: readonly (string | null | undefined)[]): Language {
  const known = Object.keys(LANGUAGES) as Language[];
  const found = asked.map((tag) => known.find((language) => tag?.toLowerCase().split("-")[0] === language));
  return found.find((language) => language !== undefined) ?? "en";
}

/** The language that was chosen in this browser before. */
export function keptLanguage(): string | null {
  try {
    return window.localStorage.getItem(STORED);
  } catch {
    return null;
  }
}

export function keepLanguage(language: Language): void {
  try {
    window.localStorage.setItem(STORED, language);
  } catch {
    // A browser that keeps nothing still speaks it until the page is left.
  }
}
