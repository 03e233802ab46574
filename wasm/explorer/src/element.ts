import { Explorer } from "./app/explorer";
import { ENTRIES, type State } from "./app/schema";
import { keptLanguage, languageOf } from "./messages/languages";

/** How much of the page is around the figures: all of it, the time bar alone, or nothing. */
export const CONTROLS = ["full", "time", "none"] as const;

/** What scripts that drive or embed an explorer can do. */
export interface Api {
  readonly state: State;
  /** Changes fields of the state; throws a `TypeError` for a value that cannot be one. */
  set(patch: Partial<State>): void;
  /** The query and the figures on screen. */
  read(): Record<string, number | string | boolean>;
}

export function api({ store, workbench }: Explorer): Api {
  return {
    get state() {
      return store.state;
    },
    set: (patch) => store.set(patch),
    read: () => workbench.read(),
  };
}

/** Shows an explorer with so much around the figures; an unknown word means all. */
export function setControls(element: HTMLElement, word: string | null): void {
  element.dataset.controls = CONTROLS.find((level) => level === word) ?? "full";
}

/** The fields of a link, each of which is an attribute by the name that it has there. */
const FIELDS = ENTRIES.filter(([, { key }]) => key !== undefined);

/**
 * `<capsule-explorer ca="0.05" al="0.8" t="3" views="midplane.solid" controls="time">`: an explorer as an element.
 *
 * The attributes are the fields of a link, with `controls` ("full", "time", "none"), `lang` ("en", "fr") and `model`,
 * the address of a model file, which counts when the element is inserted. An attribute that is missing or makes no
 * sense means the default. A `statechange` event follows each change of the state, by an attribute, a script or a
 * person.
 */
export class CapsuleExplorer extends HTMLElement implements Api {
  static readonly observedAttributes = [...FIELDS.map(([, { key }]) => key ?? ""), "controls", "lang"];
  /** The address beside which the shipped model and the notices lie; by default that of the page. */
  static home: URL | undefined;
  static #count = 0;
  #explorer: Explorer | undefined;

  connectedCallback(): void {
    if (this.#explorer !== undefined) return;
    setControls(this, this.getAttribute("controls"));
    const state = Object.fromEntries(FIELDS.map(([field, { key, standard }]) => [field, this.#value(key) ?? standard]));
    const model = this.getAttribute("model");
    const prefix = `capsule-${++CapsuleExplorer.#count}-`;
    // Its own language, the one that its reader chose before, that of the page around it, that of the browser.
    const around = this.parentElement?.closest<HTMLElement>("[lang]")?.lang;
    const language = languageOf(this.getAttribute("lang"), keptLanguage(), around, ...navigator.languages);
    const { home } = CapsuleExplorer;
    const files = { ...(model === null ? {} : { model }), ...(home === undefined ? {} : { home }) };
    this.#explorer = new Explorer(this, { prefix, state, language, ...files });
    this.#explorer.store.subscribe(() => this.dispatchEvent(new Event("statechange", { bubbles: true })));
  }

  attributeChangedCallback(name: string): void {
    if (name === "controls") setControls(this, this.getAttribute(name));
    if (name === "lang" && this.lang !== this.#explorer?.root.language) this.#explorer?.speak(languageOf(this.lang));
    const field = FIELDS.find(([, { key }]) => key === name);
    if (field !== undefined) this.#explorer?.store.set({ [field[0]]: this.#value(name) ?? field[1].standard });
  }

  get state(): State {
    return this.#api.state;
  }

  set(patch: Partial<State>): void {
    this.#api.set(patch);
  }

  read(): Record<string, number | string | boolean> {
    return this.#api.read();
  }

  get #api(): Api {
    if (this.#explorer === undefined) throw new Error("the element is not in a document yet");
    return api(this.#explorer);
  }

  /** The value of the field of this name, as its attribute says it. */
  #value(name: string | undefined): unknown {
    const text = this.getAttribute(name ?? "");
    const field = FIELDS.find(([, { key }]) => key === name)?.[1];
    const value = text === null ? undefined : field?.parse(text);
    return value !== undefined && field?.check(value) ? value : undefined;
  }
}

/** Makes the element known to the document; twice does no harm. */
export function defineElement(): void {
  if (customElements.get("capsule-explorer") === undefined) customElements.define("capsule-explorer", CapsuleExplorer);
}
