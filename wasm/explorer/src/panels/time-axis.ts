import { html, type Root } from "../app/dom";
import type { Store } from "../app/store";
import { ERRORS, nameOf, PRESENTATION, resolution, unitOf, written } from "../model/quantities";
import type { Units } from "../model/units";
import { type Course, type Courses, extremes, POINTS, pieces } from "../views/courses";
import { label, onResize, path, set, svg, ticks } from "../views/svg";
import { type Context, type Trace, traceClass, type ViewPart } from "../views/view";

/** Half the thumb: the range input's ends lie this far inside its box. */
const INSET = 7;
const AXIS = 20;
/** Room above the curve, below its name. */
const GAP = 6;

/** The time slider, with the course of one read-out behind it. */
export class TimeAxis implements ViewPart {
  readonly needs = [];
  readonly #courses: Courses;
  readonly #input: HTMLInputElement;
  readonly #track: HTMLElement;
  readonly #svg: SVGSVGElement;
  readonly #axis: SVGGElement;
  readonly #pins: SVGGElement;
  readonly #curve: SVGPathElement;
  readonly #cursor: SVGLineElement;
  readonly #dot: SVGCircleElement;
  readonly #caption = html("p", { className: "caption" });
  #width = 0;
  #height = 0;
  #end = 0;
  #factor = 1;
  #top = 22;
  /** The curves on screen, and how far they were computed when they were drawn. */
  #shown: readonly Course[] = [];
  #drawnKey = "";
  #drawn: readonly [readonly Trace[], Context] | undefined;

  constructor(root: Root, store: Store, courses: Courses) {
    this.#courses = courses;
    this.#track = root.part("track", HTMLElement);
    const input = root.part("time", HTMLInputElement);
    this.#input = input;
    input.addEventListener("input", () => store.set({ t: input.valueAsNumber }));
    // An arrow key goes a two-hundredth of the axis instead of the browser's "any".
    input.addEventListener("keydown", (event) => {
      const steps: Record<string, number> = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 };
      const step = steps[event.key];
      if (step === undefined) return;
      const { t, end } = store.state;
      store.set({ t: stepped(t, event.shiftKey ? step * 10 : step, end) });
      event.preventDefault();
      event.stopPropagation();
    });
    this.#svg = svg("svg", { "aria-hidden": "true" });
    this.#axis = svg("g", { class: "axis" }, this.#svg);
    this.#pins = svg("g", {}, this.#svg);
    this.#curve = svg("path", { class: "trace" }, this.#svg);
    this.#cursor = svg("line", { class: "cursor" }, this.#svg);
    this.#dot = svg("circle", { class: "now" }, this.#svg);
    this.#track.prepend(this.#svg, this.#caption);
    onResize(this.#track, (width, height) => {
      this.#width = width;
      this.#height = height;
      this.#end = 0;
      this.#drawnKey = "";
      if (this.#drawn !== undefined) this.draw(...this.#drawn);
    });
  }

  draw(traces: readonly Trace[], context: Context): void {
    this.#drawn = [traces, context];
    const { state, units, words } = context;
    this.#input.ariaLabel = words.time.name(units.time.plain);
    if ((state.end !== this.#end || units.time.factor !== this.#factor) && this.#width > 0) {
      this.#end = state.end;
      this.#factor = units.time.factor;
      this.#input.max = String(state.end);
      this.#layOut();
    }
    this.#shown = traces.map(({ name, query }) => this.#courses.alongTime(name, query, state.trace, 1));
    if (this.#input.valueAsNumber !== state.t) this.#input.valueAsNumber = state.t;
    this.#input.ariaValueText = `${writtenTime(state.t, state.end, units)} ${units.time.plain}`;
    if (this.#width === 0) return;
    const key = [
      state.trace,
      words.quantities[state.trace],
      JSON.stringify(units),
      traces.map(({ query }) => JSON.stringify(query)).join(),
      this.#progress(),
    ].join();
    if (key !== this.#drawnKey) {
      this.#drawnKey = key;
      this.#drawCurves(traces, context);
    }
    this.#placeCursor(traces[0], context);
  }

  #progress(): string {
    return this.#shown.map(({ done }) => done).join();
  }

  readonly #toX = (t: number) => INSET + (t / this.#end) * (this.#width - 2 * INSET);

  readonly #toY = (value: number, [low, high]: readonly [number, number]) => {
    const [top, bottom] = [this.#top, this.#height - AXIS - 5];
    return bottom - ((value - low) / (high - low)) * (bottom - top);
  };

  #layOut(): void {
    const bottom = this.#height - AXIS;
    set(this.#svg, { viewBox: `0 0 ${this.#width} ${this.#height}` });
    // A tick at each whole l/V of 20; in other units, at as round a number.
    const end = this.#end * this.#factor;
    const whole = 10 ** Math.floor(Math.log10(end / 10) + 1e-9);
    const step = this.#width > 480 ? whole : 5 * whole;
    const every = this.#width > 760 ? 2 : 5;
    const parts: Element[] = [svg("path", { d: `M${INSET} ${bottom}H${this.#width - INSET}`, fill: "none" })];
    for (const t of ticks(0, end, step)) {
      const x = this.#toX(t / this.#factor);
      const named = Math.round(t / whole) % every === 0;
      parts.push(svg("line", { x1: x, x2: x, y1: bottom, y2: bottom + (named ? 5 : 3) }));
      if (named) {
        const text = svg("text", { x, y: bottom + 17, "text-anchor": "middle" });
        text.textContent = label(t);
        parts.push(text);
      }
    }
    this.#axis.replaceChildren(...parts);
  }

  #drawCurves(traces: readonly Trace[], context: Context): void {
    const { state, units } = context;
    this.#track.dataset.plane = PRESENTATION[state.trace].plane ?? "";
    const validity = context.capsule.answer("live", traces[0]?.query ?? { ...state, parameters: [] }, state.t).validity;
    const isRefused = validity.kind === "refused" && validity.cause === "query";
    this.#caption.textContent = isRefused ? "" : this.#words(context, validity.kind === "extrapolated");
    this.#top = this.#caption.offsetHeight + GAP;
    const range = this.#range(units);
    const d = (course: Course) =>
      pieces(course)
        .map((points) => path(points, this.#toX, (_, y) => this.#toY(y, range)))
        .join("");
    const [live, ...pinned] = this.#shown;
    set(this.#curve, { d: live === undefined ? "" : d(live) });
    this.#pins.replaceChildren(
      ...pinned.map((course, i) => svg("path", { class: traceClass(traces[i + 1]?.name ?? "A"), d: d(course) })),
    );
  }

  /** The range of the curves' height: never less than what the read-out's digits can tell apart. */
  #range(units: Units): readonly [number, number] {
    const [low, high] = extremes(this.#shown) ?? [0, 1];
    const quantity = this.#shown[0]?.quantity ?? "axial_length";
    const least = 20 * resolution(quantity, Math.max(Math.abs(low), Math.abs(high)), units);
    const spare = Math.max(0, least - (high - low)) / 2;
    return [low - spare, high + spare];
  }

  /** Marks the instant, and on the whole curve its value. */
  #placeCursor(live: Trace | undefined, { state, units }: Context): void {
    const x = this.#toX(state.t);
    set(this.#cursor, { x1: x, x2: x, y1: this.#top - 4, y2: this.#height - AXIS });
    const value = live?.answer?.read(state.trace);
    const hasDot = value !== undefined && this.#shown[0]?.done === POINTS;
    set(this.#dot, { cx: x, cy: hasDot ? this.#toY(value, this.#range(units)) : 0, r: hasDot ? 4 : 0 });
  }

  /** The read-out's name and, once its curve is whole, what it spans. */
  #words({ state, units, errors, words }: Context, extrapolated: boolean): string {
    const [live] = this.#shown;
    const plain = nameOf(words, state.trace, extrapolated);
    const name = extrapolated ? words.time.extrapolated(plain) : plain;
    const title = ERRORS.has(state.trace) ? `${name} ${errors.against}` : name;
    if (live === undefined || live.done < POINTS) return title;
    const found = extremes([live]);
    if (found === undefined) return words.time.none(title);
    const [least, most] = found.map((value) => written(state.trace, value, units));
    return `${title}, ${words.views.span(least ?? "", most ?? "", unitOf(state.trace, units).name)}`;
  }
}

/** An instant in the units shown, to digits that tell instants apart. */
export function writtenTime(t: number, end: number, { time: { factor } }: Units): string {
  return (t * factor).toFixed(timeDigits(end * factor));
}

/** The same in a sentence, without zeros at its end. */
export function shownTime(t: number, end: number, units: Units): string {
  return String(Number(writtenTime(t, end, units)));
}

/** Digits after the point that tell instants apart: hundredths of 20 l/V. */
export function timeDigits(end: number): number {
  return Math.min(12, Math.max(0, 3 - Math.floor(Math.log10(end))));
}

/** Steps of a two-hundredth of the model's span along time, rounded to its digits and within it. */
export function stepped(t: number, steps: number, end: number): number {
  return Math.min(end, Math.max(0, Number((t + (steps * end) / 200).toFixed(timeDigits(end)))));
}
