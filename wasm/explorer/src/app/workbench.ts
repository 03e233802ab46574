import type { Measured } from "../identify/measured";
import type { Capsule } from "../model/capsule";
import { errorMeaning } from "../model/errors";
import { physicalUnits } from "../model/units";
import { makeParts, type Parts } from "../views/registry";
import type { Context, Trace } from "../views/view";
import type { Root } from "./dom";
import { Jobs } from "./jobs";
import { PLAY_SECONDS, QUANTITIES, type Query, queryOf, type State, VIEWS, type View } from "./schema";
import type { Store } from "./store";
import { Visibility } from "./visibility";

/** The open model on screen: after each change one frame, in which every visible part asks the core what it shows. */
export class Workbench {
  readonly #root: Root;
  readonly #store: Store;
  readonly #parts: Parts;
  readonly #figures: ReadonlyMap<View, HTMLElement>;
  readonly #visible: Visibility;
  #capsule: Capsule | undefined;
  #frame = 0;
  #lastFrame = 0;

  /** `open` takes a file of the user's. */
  constructor(root: Root, store: Store, open: (file: File) => void) {
    this.#root = root;
    this.#store = store;
    this.#parts = makeParts(root, store, new Jobs(), () => this.#request(), open);
    const figure = (view: View) => [view, root.all<HTMLElement>(`figure[data-view="${view}"]`)[0]] as const;
    this.#figures = new Map(VIEWS.map(figure).filter((pair): pair is [View, HTMLElement] => pair[1] !== undefined));
    this.#visible = new Visibility(this.#figures.values(), () => this.#request());
    store.subscribe(() => this.#request());
    root.speak(() => this.#request());
  }

  /** Puts a model on screen, in place of the one before. The state must be one of this model. */
  open(capsule: Capsule): void {
    const previous = this.#capsule;
    this.#capsule = capsule;
    // No part may hold an answer of the model that is freed: one that is out of sight would ask it when it is resized.
    const context = this.#context(capsule, this.#store.state);
    this.#parts.courses.begin(capsule);
    for (const part of [...this.#parts.panels, ...Object.values(this.#parts.views)]) part.draw([], context);
    previous?.free();
    const { dataset } = this.#root.element;
    dataset.model = capsule.has("channel") ? "channel" : "other";
    dataset.outlines = String(capsule.has("outlines"));
    this.#request();
  }

  /** Takes the theme's colours anew. */
  recolour(): void {
    this.#parts.solid.recolour();
  }

  /** Goes to an instant and draws the space view there at once, in sight or not. */
  seek(t: number): void {
    this.#store.set({ t, playing: false });
    if (this.shown !== undefined) this.#parts.solid.draw(...this.shown);
  }

  /** The picture of the space view; undefined where there is none. */
  picture(): HTMLCanvasElement | undefined {
    return this.#parts.solid.picture();
  }

  /** The scale of its colours; undefined where it has none. */
  scale(): SVGSVGElement | undefined {
    return this.#parts.solid.scale;
  }

  /** The measured outline. */
  get measured(): Measured {
    return this.#parts.measured;
  }

  get capsule(): Capsule | undefined {
    return this.#capsule;
  }

  /** What is on screen; undefined before a model is. */
  get shown(): readonly [readonly Trace[], Context] | undefined {
    if (this.#capsule === undefined) return undefined;
    const { state } = this.#store;
    return [traces(this.#capsule, state), this.#context(this.#capsule, state)];
  }

  /** The numbers on screen, for scripts: drawn first where the next frame still has to do it. */
  read(): Record<string, number | string | boolean> {
    if (this.#frame !== 0) this.#draw();
    const { state } = this.#store;
    const live = this.shown?.[0][0]?.answer;
    const figures = QUANTITIES.flatMap((quantity) => {
      const value = live?.read(quantity);
      return value === undefined ? [] : [[quantity, value] as const];
    });
    const { ca, confinement, parameters, t, method } = state;
    const query = parameters.length > 0 ? { parameters: parameters.join(",") } : { ca, confinement };
    const answer = this.#root.element.dataset.answer ?? "refused";
    return { ...query, t, method, answer, ...Object.fromEntries(figures) };
  }

  #request(): void {
    if (this.#frame === 0) this.#frame = requestAnimationFrame((time) => this.#onFrame(time));
  }

  #onFrame(time: number): void {
    this.#frame = 0;
    const { state } = this.#store;
    if (state.playing) {
      // A page that was in the background goes on from where it was.
      const elapsed = this.#lastFrame === 0 ? 0 : Math.min(time - this.#lastFrame, 100) / 1000;
      const t = Math.min(state.t + (elapsed * state.speed * state.end) / PLAY_SECONDS, state.end);
      this.#lastFrame = time;
      this.#store.set({ t, playing: t < state.end });
      this.#request();
    } else {
      this.#lastFrame = 0;
    }
    this.#draw();
  }

  #draw(): void {
    const capsule = this.#capsule;
    if (capsule === undefined) return;
    const [live] = traces(capsule, this.#store.state);
    // Time that runs into a shape that is refused stays at the instant that the notice speaks of.
    if (live?.answer === undefined) this.#store.set({ playing: false });
    const { state } = this.#store;
    const all = traces(capsule, state);
    const context = this.#context(capsule, state);
    this.#mark(capsule.answer("live", queryOf(state), state.t).validity.kind);
    this.#parts.courses.begin(capsule);
    for (const panel of this.#parts.panels) {
      if (panel.needs.every((need) => capsule.has(need))) panel.draw(all, context);
    }
    for (const [view, figure] of this.#figures) {
      figure.hidden = !context.shows(view);
      if (context.shows(view) && this.#visible.has(figure)) this.#parts.views[view].draw(all, context);
    }
    this.#parts.courses.settle();
  }

  #context(capsule: Capsule, state: State): Context {
    const shows = (view: View) =>
      state.views.has(view) && this.#parts.views[view].needs.every((need) => capsule.has(need));
    const isPhysical = capsule.has("channel") && state.dimensions.length > 0 && state.ca > 0;
    const units = isPhysical ? physicalUnits(state.dimensions, state.ca) : capsule.units;
    const { words } = this.#root;
    return { state, capsule, units, errors: errorMeaning(words, capsule.model), words, shows };
  }

  #mark(kind: "given" | "extrapolated" | "refused"): void {
    this.#root.element.dataset.answer = kind;
    const { figures, figuresExtrapolated, figuresRefused } = this.#root.words.views;
    const names = { given: figures, extrapolated: figuresExtrapolated, refused: figuresRefused };
    this.#root.part("figures", HTMLElement).ariaLabel = names[kind];
  }
}

/** The live query and the pinned ones, each with its answer at the instant of the state. */
function traces(capsule: Capsule, state: State): Trace[] {
  const trace = (name: Trace["name"], query: Query): Trace => {
    const valid = (lane: string, t: number) => {
      const answer = capsule.answer(lane, query, t);
      return answer.validity.kind === "refused" ? undefined : answer;
    };
    return {
      name,
      query,
      answer: valid(name, state.t),
      start: () => valid(`${name} start`, 0),
      radius: capsule.has("channel") ? (query.parameters[1] ?? 1) : 1,
    };
  };
  const fitting = state.pins.filter(({ parameters }) => parameters.length === capsule.names().length);
  const pins = fitting.map(({ name, parameters, method, extrapolate }) =>
    trace(name, { parameters, method, extrapolate }),
  );
  return [trace("live", queryOf(state)), ...pins];
}
