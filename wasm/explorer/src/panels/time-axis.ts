import { html } from "../app/page";
import type { Quantity } from "../app/state";
import { label, onResize, path, set, svg, ticks } from "../views/svg";
import { PRESENTATION, written } from "./quantities";

/** Instants that the curve is drawn through, and how long one frame may spend on computing them. */
const INSTANTS = 101;
const BUDGET_MS = 5;
/** Half the thumb: the range input's ends lie this far inside its box. */
const INSET = 7;
const AXIS = 20;
/** Room above the curve, below its name. */
const GAP = 6;

/** The course of a read-out along time. */
export interface Course {
  readonly quantity: Quantity;
  readonly title: string;
  /** The value at an instant; throws where the core refuses it. Undefined is an error bound that does not exist. */
  readonly read: (t: number) => number | undefined;
}

/** The time slider, with the course of one read-out behind it. The curve is computed in the gaps between frames. */
export class TimeAxis {
  readonly #input: HTMLInputElement;
  readonly #track: HTMLElement;
  readonly #svg: SVGSVGElement;
  readonly #axis: SVGGElement;
  readonly #curve: SVGPathElement;
  readonly #cursor: SVGLineElement;
  readonly #dot: SVGCircleElement;
  readonly #caption = html("p", { className: "caption" });
  #end = 1;
  #unit = "l/V";
  #width = 0;
  #height = 0;
  #t = 0;
  #value: number | undefined;
  /** Undefined where there is no answer, or no bound. */
  #values: (number | undefined)[] = [];
  #course: Course | undefined;
  #top = 22;
  #job = 0;

  constructor(
    track: HTMLElement,
    input: HTMLInputElement,
    onTime: (t: number) => void,
    onStep: (step: number) => void,
  ) {
    this.#track = track;
    this.#input = input;
    input.addEventListener("input", () => onTime(input.valueAsNumber));
    // An arrow key goes a two-hundredth of the axis instead of the browser's "any".
    input.addEventListener("keydown", (event) => {
      const steps: Record<string, number> = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 };
      const step = steps[event.key];
      if (step === undefined) return;
      onStep(event.shiftKey ? step * 10 : step);
      event.preventDefault();
      event.stopPropagation();
    });
    this.#svg = svg("svg", { "aria-hidden": "true" });
    this.#axis = svg("g", { class: "axis" }, this.#svg);
    this.#curve = svg("path", { class: "trace" }, this.#svg);
    this.#cursor = svg("line", { class: "cursor" }, this.#svg);
    this.#dot = svg("circle", { class: "now" }, this.#svg);
    track.prepend(this.#svg, this.#caption);
    onResize(track, (width, height) => {
      this.#width = width;
      this.#height = height;
      this.#layOut();
      this.#drawCurve();
      this.show(this.#t, this.#value);
    });
  }

  /** Sets the length of the axis and its unit. */
  setEnd(end: number, unit: string): void {
    this.#unit = unit;
    if (end === this.#end) return;
    this.#end = end;
    this.#input.max = String(end);
    if (this.#width > 0) this.#layOut();
  }

  /** Moves the cursor; `value` is the plotted read-out now. */
  show(t: number, value: number | undefined): void {
    this.#t = t;
    this.#value = value;
    if (this.#input.valueAsNumber !== t) this.#input.valueAsNumber = t;
    this.#input.ariaValueText = `${t.toFixed(timeDigits(this.#end))} ${this.#unit}`;
    if (this.#width > 0) this.#placeCursor();
  }

  /** Plots another course, or none. A course that was under way is dropped. */
  plot(course: Course | undefined): void {
    cancelAnimationFrame(this.#job);
    this.#course = course;
    this.#values = [];
    if (course === undefined) {
      this.#drawCurve();
      return;
    }
    this.#track.dataset.plane = PRESENTATION[course.quantity].plane ?? "";
    const work = () => {
      const start = performance.now();
      while (this.#values.length < INSTANTS && performance.now() - start < BUDGET_MS) {
        const t = (this.#end * this.#values.length) / (INSTANTS - 1);
        let value: number | undefined;
        try {
          value = course.read(t);
        } catch {
          // The core refuses the instant: the curve has a gap. The reason is shown when one goes there.
        }
        this.#values.push(value);
      }
      this.#drawCurve();
      if (this.#values.length < INSTANTS) this.#job = requestAnimationFrame(work);
    };
    this.#job = requestAnimationFrame(work);
  }

  readonly #toX = (t: number) => INSET + (t / this.#end) * (this.#width - 2 * INSET);

  readonly #toY = (value: number, [low, high]: readonly [number, number]) => {
    const [top, bottom] = [this.#top, this.#height - AXIS - 5];
    return bottom - ((value - low) / (high - low)) * (bottom - top);
  };

  /** The least and the greatest value, if there is any. */
  #extremes(): readonly [number, number] | undefined {
    const values = this.#values.filter((value) => value !== undefined);
    return values.length === 0 ? undefined : [Math.min(...values), Math.max(...values)];
  }

  /** The range of the curve's height: never less than what the read-out's digits can tell apart. */
  #range(): readonly [number, number] | undefined {
    const extremes = this.#extremes();
    if (this.#course === undefined || extremes === undefined) return undefined;
    const [low, high] = extremes;
    const { scale, digits } = PRESENTATION[this.#course.quantity];
    const isChannel = document.body.dataset.model !== "other";
    const least = isChannel ? 20 / (scale * 10 ** digits) : 1e-3 * Math.max(Math.abs(low), Math.abs(high), 1e-30);
    const spare = Math.max(0, least - (high - low)) / 2;
    return [low - spare, high + spare];
  }

  #layOut(): void {
    const bottom = this.#height - AXIS;
    set(this.#svg, { viewBox: `0 0 ${this.#width} ${this.#height}` });
    // A tick at each whole l/V of 20.
    const whole = 10 ** Math.floor(Math.log10(this.#end / 10));
    const step = this.#width > 480 ? whole : 5 * whole;
    const every = this.#width > 760 ? 2 : 5;
    const parts: Element[] = [svg("path", { d: `M${INSET} ${bottom}H${this.#width - INSET}`, fill: "none" })];
    for (const t of ticks(0, this.#end, step)) {
      const x = this.#toX(t);
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

  /** Marks the instant, and on the whole curve its value. */
  #placeCursor(): void {
    const x = this.#toX(this.#t);
    set(this.#cursor, { x1: x, x2: x, y1: this.#top - 4, y2: this.#height - AXIS });
    const range = this.#values.length === INSTANTS ? this.#range() : undefined;
    const hasDot = this.#value !== undefined && range !== undefined;
    set(this.#dot, { cx: x, cy: hasDot ? this.#toY(this.#value ?? 0, range) : 0, r: hasDot ? 4 : 0 });
  }

  #drawCurve(): void {
    if (this.#width === 0) return;
    this.#caption.textContent = this.#words();
    this.#top = this.#caption.offsetHeight + GAP;
    const range = this.#range();
    const piece = (points: number[]) => path(points, this.#toX, (_, value) => this.#toY(value, range ?? [0, 1]));
    set(this.#curve, { d: this.#pieces().map(piece).join("") });
    this.#placeCursor();
  }

  /** The curve between its gaps: t, value, t, value, ... */
  #pieces(): number[][] {
    const pieces: number[][] = [[]];
    this.#values.forEach((value, i) => {
      if (value === undefined) pieces.push([]);
      else pieces.at(-1)?.push((this.#end * i) / (INSTANTS - 1), value);
    });
    return pieces.filter((points) => points.length > 2);
  }

  /** The course's title and, once it is whole, what it spans. */
  #words(): string {
    if (this.#course === undefined) return "";
    const { quantity, title } = this.#course;
    if (this.#values.length < INSTANTS) return title;
    const extremes = this.#extremes();
    if (extremes === undefined) return `${title}: none`;
    const [least, most] = extremes.map((value) => written(quantity, value));
    return `${title}, ${least} to ${most} ${PRESENTATION[quantity].unit}`;
  }
}

/** Digits after the point that tell instants apart: hundredths of 20 l/V. */
export function timeDigits(end: number): number {
  return Math.min(12, Math.max(0, 3 - Math.floor(Math.log10(end))));
}

/** Steps of a two-hundredth of the model's span along time, rounded to its digits and within it. */
export function stepped(t: number, steps: number, end: number): number {
  return Math.min(end, Math.max(0, Number((t + (steps * end) / 200).toFixed(timeDigits(end)))));
}
