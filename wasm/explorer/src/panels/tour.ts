import type { Root } from "../app/dom";

const STORED = "capsule-explorer-tour";
/** Pixels between the words and the part that they are about, and to the window's edge. */
const GAP = 12;

interface Step {
  /** The part that it is about: a selector within the explorer, of which the first that has room counts. */
  readonly part: string;
  readonly title: string;
  /** HTML. */
  readonly words: string;
}

const STEPS: readonly Step[] = [
  {
    part: ".query",
    title: "Two numbers choose the motion",
    words: `<p>The capillary number <i class="symbol">Ca</i> = <i class="symbol">μV</i>/<i
      class="symbol">G</i><sub>s</sub> sets viscous against elastic forces: a large one deforms the capsule more. The
      confinement <i class="symbol">a/ℓ</i> is its radius against half the channel’s side.</p>
      <p>Type them, or drag the point on the map. <b>Units…</b> finds them from the sizes of an experiment.</p>`,
  },
  {
    part: ".choices",
    title: "Two methods on the same data",
    words: `<p><b>Direct</b> interpolates the motion itself, at any instant. <b>Paper</b> steps in time as the
      publication does. The stated error says which is closer to the full-order model.</p>
      <p>Shapes are seen from the laboratory, or from the capsule’s centroid.</p>`,
  },
  {
    // In one column the views have no box around them: the first one then.
    part: ".figures, .figures .view",
    title: "One capsule, seen and cut",
    words: `<p>Each plane has one colour, in space and in its section. The membrane can show its tension, stretch,
      energy, load or motion, and is cut open to look inside. A band around an outline is as wide as the error’s
      bound.</p>`,
  },
  {
    part: ".readouts",
    title: "Numbers, and how far to trust them",
    words: `<p>Choose one to plot it along time. 95 % of the errors lie below the bound; “≈” marks numbers whose bound
      is large or unknown. <b>Pin</b> keeps a query, and compares others with it.</p>`,
  },
  {
    part: ".transport",
    title: "Any instant at once",
    words: `<p>Play, drag the marker, or type an instant: each is computed directly, in this page, when it is asked for.
      The buttons beside show and hide the views.</p>`,
  },
  {
    part: ".masthead",
    title: "Where it comes from, and how to cite it",
    words: `<p>The model holds simulations of a full-order model, the dots on the map: boundary integrals for the flow,
      finite elements for the membrane. Its digest names it in every link and file.</p>
      <p>Cite Boubehziz et al., <cite>Entropy</cite> 2021, 23, 1193, and capsule-rom with the digest; every exported
      file has both.</p>`,
  },
];

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
      if (this.#step + 1 < STEPS.length) this.#go(this.#step + 1);
      else this.#dialog.close();
    });
    root.part("close-tour", HTMLButtonElement).addEventListener("click", () => this.#dialog.close());
    this.#dialog.addEventListener("keydown", (event) => {
      if (event.key === "Escape") this.#dialog.close();
    });
    this.#dialog.addEventListener("close", () => this.#leave());
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
    const { title, words } = STEPS[step] ?? { title: "", words: "" };
    this.#title.textContent = title;
    this.#words.innerHTML = words;
    this.#count.textContent = `${step + 1} of ${STEPS.length}`;
    this.#back.disabled = step === 0;
    this.#next.textContent = step + 1 < STEPS.length ? "Next" : "Done";
    this.#mark();
    this.#part?.scrollIntoView({ block: "nearest" });
    this.#place();
    // A screen reader reads what it names and describes.
    this.#title.focus({ preventScroll: true });
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
    const found = this.#root.all<HTMLElement>(STEPS[this.#step]?.part ?? "");
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
