import { button, html, type Root } from "../app/dom";
import { SPEEDS, type State, VIEWS, type View } from "../app/schema";
import type { Store } from "../app/store";
import type { Units } from "../model/units";
import type { Context, Trace, ViewPart } from "../views/view";
import { stepped, timeDigits, writtenTime } from "./time-axis";

/** The plane of the transversal section can be moved at least this far from the centroid. */
const LEAST_REACH = 1.5;

/** Play, time, speed, choice of views, and the keys that work from anywhere in the explorer. */
export class Transport implements ViewPart {
  readonly needs = [];
  readonly #root: Root;
  readonly #store: Store;
  readonly #play: HTMLButtonElement;
  readonly #time: HTMLInputElement;
  readonly #speed: HTMLSelectElement;
  readonly #section: HTMLInputElement;
  readonly #initial: HTMLInputElement;
  /** One in the caption of each view that draws it. */
  readonly #profiles: readonly HTMLInputElement[];
  readonly #offset: HTMLElement;
  #units: Units | undefined;
  readonly #views: Map<View, HTMLButtonElement>;

  constructor(root: Root, store: Store) {
    this.#root = root;
    this.#store = store;
    this.#play = root.part("play", HTMLButtonElement);
    this.#time = root.part("time-value", HTMLInputElement);
    this.#speed = root.part("speed", HTMLSelectElement);
    this.#section = root.part("section", HTMLInputElement);
    this.#initial = root.part("initial", HTMLInputElement);
    this.#profiles = ["profile", "profile-midplane"].map((name) => root.part(name, HTMLInputElement));
    this.#offset = root.part("plane-offset", HTMLElement);
    this.#views = this.#viewButtons();
    this.#play.addEventListener("click", () => this.toggle());
    this.#tieTime();
    const options = SPEEDS.map((factor) => html("option", { value: String(factor), textContent: `${factor}×` }));
    this.#speed.append(...options);
    this.#speed.addEventListener("change", () => store.set({ speed: Number(this.#speed.value) }));
    this.#section.addEventListener("input", () => store.set({ section: this.#section.valueAsNumber }));
    this.#initial.addEventListener("change", () => store.set({ initial: this.#initial.checked }));
    for (const input of this.#profiles) {
      input.addEventListener("change", () => store.set({ profile: input.checked }));
    }
    root.element.addEventListener("keydown", (event) => this.#onKey(event));
  }

  draw([live]: readonly Trace[], { state, units, shows, words }: Context): void {
    this.#play.ariaPressed = String(state.playing);
    this.#play.ariaLabel = state.playing ? words.time.pause : words.page.play;
    this.#units = units;
    this.#time.max = String(state.end * units.time.factor);
    this.#time.step = String(10 ** -(timeDigits(state.end * units.time.factor) - 1));
    this.#time.ariaLabel = words.time.name(units.time.plain);
    if (document.activeElement !== this.#time) this.#writeTime(state);
    this.#time.dataset.value = String(state.t);
    this.#root.part("time-unit", HTMLElement).textContent = units.time.name;
    if (!state.playing && shows("transversal")) {
      const [least, most] = live?.answer?.reach ?? [0, 0];
      const outward = (reach: number) =>
        Math.max(LEAST_REACH, Math.ceil(10 * reach + 1e-6) / 10, Math.abs(state.section));
      this.#section.min = String(-outward(-least));
      this.#section.max = String(outward(most));
    }
    this.#section.value = String(state.section);
    this.#initial.checked = state.initial;
    for (const input of this.#profiles) input.checked = state.profile;
    this.#speed.value = String(state.speed);
    this.#offset.textContent = `${signed(state.section * units.drawn.factor)} ${units.drawn.name}`;
    for (const [view, toggle] of this.#views) toggle.ariaPressed = String(state.views.has(view));
  }

  /** Plays on, or from the start where the end is reached; or pauses. */
  toggle(): void {
    const { playing, t, end } = this.#store.state;
    this.#store.set(playing ? { playing: false } : { playing: true, t: t >= end ? 0 : t });
  }

  /** A number beyond the model's time goes to its end, and is marked while it stands in the field. */
  #tieTime(): void {
    this.#time.addEventListener("input", () => {
      const wanted = this.#time.valueAsNumber / (this.#units?.time.factor ?? 1);
      if (!Number.isFinite(wanted)) return;
      const t = Math.min(Math.max(wanted, 0), this.#store.state.end);
      this.#time.ariaInvalid = String(t !== wanted);
      const { end } = this.#store.state;
      const last = this.#units === undefined ? "" : writtenTime(end, end, this.#units);
      this.#time.title = t === wanted ? "" : this.#root.words.time.ends(last);
      this.#store.set({ t, playing: false });
    });
    this.#time.addEventListener("blur", () => this.#writeTime(this.#store.state));
  }

  #writeTime({ t, end }: State): void {
    this.#time.value = this.#units === undefined ? "" : writtenTime(t, end, this.#units);
    this.#time.ariaInvalid = "false";
    this.#time.title = "";
  }

  #onKey(event: KeyboardEvent): void {
    if (event.ctrlKey || event.altKey || event.metaKey || isControl(event.target)) return;
    const { t, end } = this.#store.state;
    const keys: Record<string, () => void> = {
      " ": () => this.toggle(),
      ArrowRight: () => this.#store.set({ t: stepped(t, event.shiftKey ? 10 : 1, end) }),
      ArrowLeft: () => this.#store.set({ t: stepped(t, event.shiftKey ? -10 : -1, end) }),
      Home: () => this.#store.set({ t: 0 }),
      End: () => this.#store.set({ t: end }),
    };
    const action = keys[event.key];
    if (action !== undefined) {
      action();
      event.preventDefault();
    }
  }

  #viewButtons(): Map<View, HTMLButtonElement> {
    const buttons = new Map<View, HTMLButtonElement>();
    for (const view of VIEWS) {
      const toggle = button("", () => {
        const views = new Set(this.#store.state.views);
        if (!views.delete(view)) views.add(view);
        this.#store.set({ views: new Set(VIEWS.filter((name) => views.has(name))) });
      });
      toggle.dataset.toggles = view;
      this.#root.speak(({ views }) => {
        toggle.textContent = views.toggles[view];
      });
      buttons.set(view, toggle);
    }
    this.#root.part("shown", HTMLFieldSetElement).append(...buttons.values());
    return buttons;
  }
}

/** Whether the key belongs to the element that has the focus. */
export function isControl(target: EventTarget | null): boolean {
  const own = "input, select, button, textarea, summary, dialog, [role=slider], [role=radio]";
  return target instanceof Element && target.closest(own) !== null;
}

function signed(value: number): string {
  return `${value < 0 ? "−" : "+"} ${Math.abs(value).toFixed(2)}`;
}
