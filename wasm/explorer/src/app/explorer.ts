import { type Language, wordsOf } from "../messages/languages";
import type { Capsule } from "../model/capsule";
import { fetchModel, loadModule, ModelError, openFile, read } from "../model/load";
import { text } from "../model/refusal";
import { tieHelp } from "../panels/keys";
import { describe } from "../panels/model-card";
import { tieParameters } from "../panels/parameters";
import type { Source, TakeAway } from "../panels/take-away";
import { Tour } from "../panels/tour";
import { isControl } from "../panels/transport";
import { Address } from "./address";
import { button, html, Root } from "./dom";
import { fromFragment, type Link, toFragment } from "./link";
import markup from "./markup.html?raw";
import { DEFAULT_STATE, type State, VIEWS } from "./schema";
import { fromSession, toSession } from "./session";
import { Store } from "./store";
import { Workbench } from "./workbench";

/** The shipped model's file. */
const SHIPPED = "./capsule.crom";

/** Names of files with a measured outline. */
const OUTLINE = /\.(csv|txt|tsv|dat|png|jpe?g|tiff?)$/i;

/** How an explorer is set up. */
export interface Options {
  /** Stands before each id; needed where one document has several explorers. */
  readonly prefix?: string;
  /** Address of the model to open first, on this server; by default the shipped one. */
  readonly model?: string;
  /** The address beside which the shipped model and the notices lie; by default that of the page. */
  readonly home?: URL;
  /** Whether the document's address follows this explorer and the explorer follows it. */
  readonly ownsAddress?: boolean;
  /** By default English. */
  readonly language?: Language;
  /** The state to begin with, where it differs from the default. */
  readonly state?: Partial<State>;
}

/** One explorer in one element: opens models, and ties the state to the address. */
export class Explorer {
  readonly root: Root;
  readonly store: Store;
  readonly workbench: Workbench;
  readonly #home: URL;
  readonly #failure: HTMLElement;
  readonly #banner: HTMLElement;
  readonly #address: Address | undefined;
  /** The language on its way: nothing is shown before it is there. */
  #speaking: Promise<void>;
  #wanted: Language | undefined;
  #failed: unknown;
  /** The state and the model that the link asks for, until that model is open. */
  #link: Link;
  /** Counts what was asked to be opened: what comes late does not replace what was asked for later. */
  #asked = 0;

  constructor(element: HTMLElement, options: Options = {}) {
    const { href } = window.location;
    const { prefix = "", model, home = new URL(href), ownsAddress = false, language = "en", state = {} } = options;
    this.#home = home;
    this.root = new Root(element, prefix, markup);
    this.#link = ownsAddress ? fromFragment(window.location.hash) : { state, digest: undefined, file: undefined };
    this.store = new Store({ ...DEFAULT_STATE, ...this.#link.state });
    this.#failure = this.root.part("failure", HTMLElement);
    this.#banner = this.root.part("banner", HTMLElement);
    this.root.element.dataset.status = "loading";
    this.root.element.dataset.silent = "";
    tieParameters(this.root, this.store);
    this.workbench = new Workbench(this.root, this.store, (file) => this.open(file));
    if (ownsAddress) {
      this.#address = new Address(
        this.store,
        () => this.fragment(),
        (fragment) => this.#follow(fragment),
      );
    }
    tieHelp(
      this.root,
      () => this.workbench.recolour(),
      (chosen) => this.speak(chosen),
    );
    new Tour(this.root);
    this.#tieExport();
    this.#takeFiles();
    this.#takePaste();
    this.#tieCopy();
    this.root.speak(() => this.#say());
    this.#speaking = this.speak(language);
    const [address, base] = model === undefined ? [SHIPPED, home] : [model, href];
    this.#show(fetchModel(new URL(address, base), model === undefined));
    loadModule();
  }

  /** Goes over to a language, as soon as its words are loaded; where they cannot be, it stays with the one it has. */
  speak(language: Language): Promise<void> {
    this.#wanted = language;
    this.#speaking = this.#translate(language);
    return this.#speaking;
  }

  async #translate(language: Language): Promise<void> {
    const spoken = { language: this.root.language, words: this.root.words };
    const found = await wordsOf(language).then(
      (words) => ({ language, words }),
      () => spoken,
    );
    if (language !== this.#wanted) return;
    this.root.translate(found.language, found.words);
    this.root.element.removeAttribute("data-silent");
  }

  /** Says anew what was said of the open model and of the link. */
  #say(): void {
    const { capsule } = this.workbench;
    if (capsule !== undefined) {
      describe(this.root.part("model", HTMLElement), capsule, this.#home, this.root.words);
      this.#warn(capsule);
    }
    if (this.root.element.dataset.status === "failed") this.#fail(this.#failed);
  }

  /** The link's fragment for what is on screen. */
  fragment(): string {
    const { capsule } = this.workbench;
    if (capsule === undefined) return window.location.hash;
    const { digest } = capsule.model;
    return toFragment(this.store.state, { isChannel: capsule.has("channel"), digest, file: capsule.file });
  }

  /** Opens a file of the user's: a model, a measured outline, or a saved session. */
  async open(file: File): Promise<void> {
    if (OUTLINE.test(file.name)) await this.#try(() => this.#measure(file));
    else if (file.name.endsWith(".json")) await this.#try(() => this.#restore(file));
    else await this.#show(openFile(file));
  }

  async #try(task: () => Promise<void>): Promise<void> {
    try {
      await task();
      if (this.workbench.capsule !== undefined) this.#resume();
    } catch (error) {
      this.#fail(error);
    }
  }

  async #restore(file: File): Promise<void> {
    const { link, outline } = await fromSession(file);
    this.#follow(link);
    this.workbench.measured.take(outline);
  }

  /** Takes the outline of a measured capsule. */
  async #measure(file: File): Promise<void> {
    if (this.workbench.capsule?.has("channel") === false) {
      throw new ModelError((words) => [words.isOutline(file.name), words.openChannel]);
    }
    const bytes = await read(file, file.name);
    this.workbench.measured.take({ name: file.name, bytes });
    const { views } = this.store.state;
    this.store.set({ views: new Set(VIEWS.filter((view) => view === "measured" || views.has(view))) });
    const figure = this.root.all<HTMLElement>('figure[data-view="measured"]')[0];
    // Once it is shown.
    requestAnimationFrame(() => requestAnimationFrame(() => figure?.scrollIntoView({ block: "nearest" })));
  }

  /** Shows a model, or why there is none, unless something else was asked for in the meantime. */
  async #show(opening: Promise<Capsule>): Promise<void> {
    const asked = ++this.#asked;
    try {
      const [capsule] = await Promise.all([opening, this.#speaking]);
      if (asked !== this.#asked) {
        capsule.free();
        return;
      }
      this.#enter(capsule);
    } catch (error) {
      if (asked === this.#asked) this.#fail(error);
    }
  }

  /** Puts a model on screen, with the state of the link where it is the link's model. */
  #enter(capsule: Capsule): void {
    const isFirst = this.workbench.capsule === undefined;
    const isLinked = this.#link.digest === capsule.model.digest;
    // A link gives way once another model was opened by hand, unless it waits for that one.
    const fragment = this.#address?.wanted;
    const defaults = capsule.defaults();
    const wanted =
      fragment !== undefined && (isFirst || isLinked)
        ? fromFragment(fragment, defaults).state
        : { ...defaults, ...(isFirst ? this.#link.state : this.#kept()) };
    this.store.set(fitting({ ...this.store.state, ...wanted }, capsule));
    this.workbench.open(capsule);
    this.#say();
    this.#resume();
    this.#address?.enter();
  }

  /** Opening a model by hand keeps the instant and the views. */
  #kept(): Partial<State> {
    const { t, frame, speed, section, initial, profile, trace, views, ca, confinement, parameters } = this.store.state;
    return { t, frame, speed, section, initial, profile, trace, views, ca, confinement, parameters };
  }

  /** Takes another fragment: a step back or forward, or a link that was pasted into the address. */
  #follow(fragment: string): void {
    const { capsule } = this.workbench;
    this.#link = fromFragment(fragment, capsule?.defaults() ?? {});
    if (capsule === undefined) return;
    this.store.set({ ...fitting({ ...this.store.state, ...this.#link.state }, capsule), playing: false });
    this.#warn(capsule);
  }

  /** Says that a link belongs to another model, and to which. */
  #warn({ model }: Capsule): void {
    const { digest, file } = this.#link;
    const isOther = digest !== undefined && digest !== model.digest;
    this.#banner.hidden = !isOther;
    if (!isOther) return;
    const { link } = this.root.words;
    const name = file === undefined ? link.ofModel(digest) : link.ofFile(file, digest);
    const open = button(link.openFile, () => this.root.part("model-file", HTMLInputElement).click());
    const dismiss = button(link.goOn, () => {
      this.#link = { ...this.#link, digest: undefined };
      this.#banner.hidden = true;
      this.#address?.enter();
    });
    this.#banner.replaceChildren(html("p", { textContent: link.isOther(name, model.digest) }), open, dismiss);
  }

  #resume(): void {
    this.#failure.hidden = true;
    this.root.element.dataset.status = "ready";
  }

  #fail(error: unknown): void {
    this.#failed = error;
    const { refusals } = this.root.words;
    const [title, remedy] =
      error instanceof ModelError ? error.say(refusals) : [refusals.noStart(text(error)), refusals.startAgain];
    this.#failure.replaceChildren(html("h2", { textContent: title }), html("p", {}, ...withCode(remedy)));
    if (this.workbench.capsule !== undefined) {
      this.#failure.append(button(refusals.goBack, () => this.#resume()));
    }
    this.#failure.hidden = false;
    this.root.element.dataset.status = "failed";
  }

  /** A file is chosen, or dropped anywhere on the explorer; without this a browser would leave the page for it. */
  #takeFiles(): void {
    const { element } = this.root;
    const picker = this.root.part("model-file", HTMLInputElement);
    const openFirst = async (files: FileList | null | undefined) => {
      const [file] = files ?? [];
      if (file !== undefined) await this.open(file);
    };
    this.root.part("open-model", HTMLButtonElement).addEventListener("click", () => picker.click());
    picker.addEventListener("change", async () => {
      await openFirst(picker.files);
      picker.value = "";
    });
    const over = (isOver: boolean) => element.toggleAttribute("data-dropping", isOver);
    element.addEventListener("dragover", (event) => {
      if (event.dataTransfer?.types.includes("Files")) {
        event.preventDefault();
        over(true);
      }
    });
    element.addEventListener("dragleave", (event) => {
      if (event.relatedTarget === null) over(false);
    });
    element.addEventListener("drop", async (event) => {
      if (event.dataTransfer?.types.includes("Files")) {
        event.preventDefault();
        over(false);
        await openFirst(event.dataTransfer.files);
      }
    });
  }

  /** An outline is pasted: a picture, or the text of its points. */
  #takePaste(): void {
    this.root.element.addEventListener("paste", async ({ target, clipboardData }) => {
      if (clipboardData === null || isControl(target)) return;
      const [file] = clipboardData.files;
      const text = clipboardData.getData("text/plain");
      if (file !== undefined) await this.open(file);
      else if (text !== "") await this.open(new File([text], "pasted.txt"));
    });
  }

  /** The dialog of the exports, and all that writes files, is loaded when it is first asked for. */
  #tieExport(): void {
    const source: Source = {
      shown: () => this.workbench.shown,
      link: () => new URL(this.fragment(), window.location.href).href,
      session: () => toSession(this.fragment(), this.workbench.measured.file),
      picture: () => this.workbench.picture(),
      scale: () => this.workbench.scale(),
      seek: (t) => this.workbench.seek(t),
    };
    let dialog: TakeAway | undefined;
    this.root.part("open-take-away", HTMLButtonElement).addEventListener("click", async () => {
      try {
        const { TakeAway } = await import("../panels/take-away");
        dialog ??= new TakeAway(this.root, source);
        dialog.open();
      } catch (error) {
        this.#fail(new ModelError((words) => [words.noProgram(text(error)), words.loadAgain]));
      }
    });
  }

  #tieCopy(): void {
    const copy = this.root.part("copy-link", HTMLButtonElement);
    copy.addEventListener("click", async () => {
      const link = new URL(this.fragment(), window.location.href);
      this.#address?.enter();
      try {
        await navigator.clipboard.writeText(link.href);
        copy.textContent = this.root.words.link.copied;
      } catch {
        copy.textContent = this.root.words.link.byHand;
      }
      window.setTimeout(() => {
        copy.textContent = this.root.words.page.copyLink;
      }, 2000);
    });
  }
}

/** The state as a model can show it: an instant within its time, as many parameters as it has. */
function fitting(state: State, capsule: Capsule): State {
  const defaults = capsule.defaults();
  const end = defaults.end ?? state.end;
  const standard = defaults.parameters ?? [];
  return {
    ...state,
    end,
    t: Math.min(Math.max(state.t, 0), end),
    parameters: state.parameters.length === standard.length ? state.parameters : standard,
    pins: state.pins.filter(({ parameters }) => parameters.length === capsule.names().length),
    playing: false,
  };
}

/** Sets the words between backquotes as code. */
function withCode(words: string): (Node | string)[] {
  return words.split("`").map((part, i) => (i % 2 === 1 ? html("code", { textContent: part }) : part));
}
