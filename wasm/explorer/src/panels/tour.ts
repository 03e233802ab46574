import type { Root } from "../app/dom";

const STORED = "capsule-explorer-tour";
/** Pixels between the words and the part that they are about, and to the window's edge. */
const GAP = 12;

/** The parts that the steps are about: selectors within the explorer, of which the first that has room counts. */
const PARTS = [
  ".query",
  ".choices",
  // In one column the views have no box around them: the first one then.
  ".figures, .figures .view",
  ".readouts",
  ".transport",
  ".masthead",
] as const;

/** A tour of the page: a few words beside one part after another. It starts when somebody asks for it. */
export class Tour {
  readonly #root: Root;
  readonly #invitation: HTMLButtonElement;
  readonly #dialog: HTMLDialogElement;
  readonly #title: HTMLElement;
  readonly #words: HTMLElement;
  readonly #count: HTMLElement;
  readonly #back: HTMLButtonElement;
  readonly #next: HTMLButtonElement;
  #step = 0;
  #opener: Element | null = null;

  constructor(root: Root) {
    this.#root = root;
    this.#dialog = root.part("tour", HTMLDialogElement);
    this.#title = root.part("tour-title", HTMLElement);
    this.#words = root.part("tour-words", HTMLElement);
    this.#count = root.part("tour-count", HTMLElement);
    this.#back = root.part("tour-back", HTMLButtonElement);
    this.#next = root.part("tour-next", HTMLButtonElement);
    this.#invitation = root.part("open-tour", HTMLButtonElement);
    this.#invitation.hidden = wasSeen();
    this.#invitation.addEventListener("click", () => this.#open());
    root.part("tour-from-help", HTMLButtonElement).addEventListener("click", () => {
      root.part("help", HTMLDialogElement).close();
      this.#open();
    });
    this.#back.addEventListener("click", () => this.#go(this.#step - 1));
    this.#next.addEventListener("click", () => {
      if (this.#step + 1 < PARTS.length) this.#go(this.#step + 1);
      else this.#dialog.close();
    });
    root.part("close-tour", HTMLButtonElement).addEventListener("click", () => this.#dialog.close());
    this.#dialog.addEventListener("keydown", (event) => {
      if (event.key === "Escape") this.#dialog.close();
    });
    this.#dialog.addEventListener("close", () => this.#leave());
    root.speak(() => this.#say());
    for (const change of ["resize", "scroll"]) {
      window.addEventListener(change, () => this.#place(), { passive: true, capture: true });
    }
  }

  #open(): void {
    this.#opener = document.activeElement;
    // Beside the page, not over it: one can try what the words are about.
    this.#dialog.show();
    this.#go(0);
  }

  #go(step: number): void {
    this.#step = step;
    this.#say();
    this.#back.disabled = step === 0;
    this.#mark();
    this.#part?.scrollIntoView({ block: "nearest" });
    this.#place();
    // A screen reader reads what it names and describes.
    this.#title.focus({ preventScroll: true });
  }

  #say(): void {
    const { page, tour } = this.#root.words;
    const { steps, count, done } = tour;
    const { title, words } = steps[this.#step] ?? { title: "", words: "" };
    this.#title.textContent = title;
    this.#words.innerHTML = words;
    this.#count.textContent = count(this.#step + 1, PARTS.length);
    this.#next.textContent = this.#step + 1 < PARTS.length ? page.next : done;
  }

  #leave(): void {
    this.#mark();
    this.#invitation.hidden = true;
    try {
      window.localStorage.setItem(STORED, "seen");
    } catch {
      // A browser that keeps nothing offers the tour again.
    }
    const back = this.#opener instanceof HTMLElement && this.#opener.checkVisibility() ? this.#opener : undefined;
    (back ?? this.#root.part("open-help", HTMLButtonElement)).focus();
  }

  get #part(): HTMLElement | undefined {
    const found = this.#root.all<HTMLElement>(PARTS[this.#step] ?? "");
    return found.find((part) => part.getBoundingClientRect().width > 0);
  }

  /** Marks the part that the words are about. */
  #mark(): void {
    for (const marked of this.#root.all("[data-toured]")) marked.removeAttribute("data-toured");
    if (this.#dialog.open) this.#part?.setAttribute("data-toured", "");
  }

  /** Puts the words beside the part where there is room, else over its lower end. */
  #place(): void {
    if (!this.#dialog.open || this.#part === undefined) return;
    const part = this.#part.getBoundingClientRect();
    const { offsetWidth: width, offsetHeight: height } = this.#dialog;
    const [most, lowest] = [window.innerWidth - width - GAP, window.innerHeight - height - GAP];
    const within = (value: number, end: number) => Math.max(GAP, Math.min(value, end));
    const beside = within(part.top, lowest);
    const aligned = within(part.left, most);
    const places = [
      [part.right + GAP, beside],
      [part.left - GAP - width, beside],
      [aligned, part.bottom + GAP],
      [aligned, part.top - GAP - height],
    ] as const;
    const fits = places.find(([left, top]) => left >= GAP && left <= most && top >= GAP && top <= lowest);
    const [left, top] = fits ?? [within(part.right - width - GAP, most), within(part.bottom - height - GAP, lowest)];
    Object.assign(this.#dialog.style, { left: `${left}px`, top: `${top}px` });
  }
}

function wasSeen(): boolean {
  try {
    return window.localStorage.getItem(STORED) === "seen";
  } catch {
    return false;
  }
}
