import { en, type Messages } from "../messages/en";
import type { Language } from "../messages/languages";

/** An element of the document that holds one explorer. Its parts are looked up inside it and nowhere else. */
export class Root {
  readonly element: HTMLElement;
  /** Stands before each id, so that the ids of two explorers on one page differ. */
  readonly prefix: string;
  #words: Messages = en;
  #language: Language = "en";
  readonly #speakers: ((words: Messages) => void)[] = [];

  /** Puts the markup into the element, which then speaks English. */
  constructor(element: HTMLElement, prefix: string, markup: string) {
    this.element = element;
    this.prefix = prefix;
    element.classList.add("explorer");
    element.insertAdjacentHTML("beforeend", prefix === "" ? markup : prefixed(markup, prefix));
    // At once: explorers that come into this one have words of their own.
    const parts = this.all("[data-say]").map(askedBy);
    this.speak(({ page }) => {
      for (const say of parts) say(page);
    });
  }

  get language(): Language {
    return this.#language;
  }

  /** The messages of the present language. */
  get words(): Messages {
    return this.#words;
  }

  /** Has something said in the language of the element: now, and again whenever the language changes. */
  speak(say: (words: Messages) => void): void {
    this.#speakers.push(say);
    say(this.#words);
  }

  translate(language: Language, words: Messages): void {
    this.#words = words;
    this.#language = language;
    this.element.lang = language;
    for (const say of this.#speakers) say(words);
  }

  /** The id that a part has in the document. */
  id(name: string): string {
    return `${this.prefix}${name}`;
  }

  /** Finds a part that the markup promises. */
  part<T extends Element>(name: string, type: new (...args: never[]) => T): T {
    const found = this.element.querySelector(`[id="${this.id(name)}"]`);
    if (!(found instanceof type)) throw new Error(`the markup has no ${type.name} with id "${name}"`);
    return found;
  }

  all<T extends Element = HTMLElement>(selector: string): T[] {
    return [...this.element.querySelectorAll<T>(selector)];
  }
}

/** Fills in a part of the markup: where `data-say` lists "text" or attributes, these hold the names of messages. */
function askedBy(part: HTMLElement): (page: Messages["page"]) => void {
  const places = (part.dataset.say ?? "").split(" ").map((place) => {
    const key = place === "text" ? part.textContent : part.getAttribute(place);
    if (key === null || !(key in en.page)) throw new Error(`the markup asks for a message "${key}" that there is not`);
    return [place, key as keyof Messages["page"]] as const;
  });
  return (page) => {
    for (const [place, key] of places) {
      if (place === "text") part.innerHTML = page[key];
      else part.setAttribute(place, page[key]);
    }
  };
}

/** The markup with the prefix before each id and before each reference to one. */
function prefixed(markup: string, prefix: string): string {
  return markup.replace(
    /\b(id|for|name|aria-labelledby|aria-describedby|aria-controls)="([^"]+)"/g,
    (_, attribute: string, ids: string) =>
      `${attribute}="${ids
        .split(" ")
        .map((id) => prefix + id)
        .join(" ")}"`,
  );
}

/** Makes an HTML element with properties and children. */
export function html<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  properties: Partial<HTMLElementTagNameMap[K]> = {},
  ...children: (Node | string)[]
): HTMLElementTagNameMap[K] {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

/** Words of the core, which speaks English whatever the page does. */
export function inEnglish(words: string): HTMLSpanElement {
  return html("span", { lang: "en", textContent: words });
}

/** Makes a button that runs something. */
export function button(label: string, run: () => void): HTMLButtonElement {
  const made = html("button", { type: "button", textContent: label });
  made.addEventListener("click", run);
  return made;
}
