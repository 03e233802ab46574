import { html, type Root } from "../app/dom";
import { keepLanguage, LANGUAGES, type Language } from "../messages/languages";
import { isControl } from "./transport";

const THEMES = ["auto", "light", "dark"] as const;
const STORED = "capsule-explorer-theme";

/** The sheet of keys and help, which `?` opens, and the choices of theme and language, which the browser keeps. */
export function tieHelp(root: Root, onTheme: () => void, onLanguage: (language: Language) => void): void {
  tieLanguage(root, onLanguage);
  const sheet = root.part("help", HTMLDialogElement);
  root.part("open-help", HTMLButtonElement).addEventListener("click", () => sheet.showModal());
  root.part("close-help", HTMLButtonElement).addEventListener("click", () => sheet.close());
  root.element.addEventListener("keydown", (event) => {
    if (event.key === "?" && !event.ctrlKey && !event.metaKey && !isControl(event.target)) sheet.showModal();
  });
  const choice = root.part("theme", HTMLSelectElement);
  const dark = window.matchMedia("(prefers-color-scheme: dark)");
  const apply = (theme: string) => {
    choice.value = theme;
    root.element.dataset.theme = theme === "auto" ? (dark.matches ? "dark" : "light") : theme;
    onTheme();
  };
  dark.addEventListener("change", () => apply(choice.value));
  choice.addEventListener("change", () => {
    apply(choice.value);
    try {
      window.localStorage.setItem(STORED, choice.value);
    } catch {
      // A browser that keeps nothing still shows the theme until the page is left.
    }
  });
  apply(THEMES.find((theme) => theme === stored()) ?? "auto");
}

function stored(): string | null {
  try {
    return window.localStorage.getItem(STORED);
  } catch {
    return null;
  }
}

/** The choice of the language; each calls itself by its own name. */
function tieLanguage(root: Root, onLanguage: (language: Language) => void): void {
  const choice = root.part("language", HTMLSelectElement);
  const options = Object.entries(LANGUAGES).map(([value, name]) => {
    return html("option", { value, lang: value, textContent: name });
  });
  choice.append(...options);
  root.speak(() => {
    choice.value = root.language;
  });
  choice.addEventListener("change", () => {
    const language = choice.value as Language;
    keepLanguage(language);
    onLanguage(language);
  });
}
