import type { Quantity } from "../app/state";
import { label, onResize, path, set, svg, ticks } from "../views/svg";
import { PRESENTATION, written } from "./quantities";

/** Instants that the curve is drawn through, and how long one frame may spend on computing them. */
const INSTANTS = 101;
const BUDGET_MS = 5;
/** Half the thumb: the range input's ends lie this far inside its box. */
const INSET = 7;
const AXIS = 20;
/** Room above the curve for its name. */
const TOP = 22;

/** The time slider, with the course of one read-out behind it. The curve is computed in the gaps between frames. */
export class TimeAxis {
  readonly #input: HTMLInputElement;
  readonly #track: HTMLElement;
  readonly #svg: SVGSVGElement;
  readonly #axis: SVGGElement;
  readonly #curve: SVGPathElement;
  readonly #cursor: SVGLineElement;
  readonly #dot: SVGCircleElement;
  readonly #span: SVGTextElement;
  #end = 1;
  #unit = "l/V";
  #width = 0;
  #height = 0;
  #t = 0;
  #value: number | undefined;
  #values: number[] = [];
  #quantity: Quantity = "axial_length";
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
    this.#span = svg("text", { class: "span", "text-anchor": "end" }, this.#svg);
    track.prepend(this.#svg);
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
    if (this.#width === 0) return;
    const x = this.#toX(t);
    set(this.#cursor, { x1: x, x2: x, y1: TOP - 4, y2: this.#height - AXIS });
    this.#placeDot();
  }

  /** Plots another course: `read` gives the value at an instant. A course that was under way is dropped. */
  plot(quantity: Quantity, read: ((t: number) => number) | undefined): void {
    cancelAnimationFrame(this.#job);
    this.#quantity = quantity;
    this.#track.dataset.plane = PRESENTATION[quantity].plane ?? "";
    this.#values = [];
    if (read === undefined) {
      this.#drawCurve();
      return;
    }
    const work = () => {
      const start = performance.now();
      while (this.#values.length < INSTANTS && performance.now() - start < BUDGET_MS) {
        try {
          this.#values.push(read((this.#end * this.#values.length) / (INSTANTS - 1)));
        } catch {
          // The core refuses an instant: the curve ends before it. The reason is shown when one goes there.
          this.#drawCurve();
          return;
        }
      }
      this.#drawCurve();
      if (this.#values.length < INSTANTS) this.#job = requestAnimationFrame(work);
    };
    this.#job = requestAnimationFrame(work);
  }

  readonly #toX = (t: number) => INSET + (t / this.#end) * (this.#width - 2 * INSET);

  readonly #toY = (value: number) => {
    const [low, high] = this.#range();
    const [top, bottom] = [TOP, this.#height - AXIS - 5];
    return bottom - ((value - low) / (high - low)) * (bottom - top);
  };

  /** The values' range, never narrower than what the read-out's digits can tell apart. */
  #range(): [number, number] {
    const [low, high] = [Math.min(...this.#values), Math.max(...this.#values)];
    const { scale, digits } = PRESENTATION[this.#quantity];
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
    set(this.#span, { x: this.#width - INSET, y: 12 });
  }

  /** Marks the value now, on the curve. */
  #placeDot(): void {
    const hasDot = this.#value !== undefined && this.#values.length === INSTANTS;
    set(this.#dot, { cx: this.#toX(this.#t), cy: hasDot ? this.#toY(this.#value ?? 0) : 0, r: hasDot ? 4 : 0 });
  }

  #drawCurve(): void {
    if (this.#width === 0) return;
    const values = this.#values;
    const points = values.flatMap((value, i) => [(this.#end * i) / (INSTANTS - 1), value]);
    set(this.#curve, { d: values.length > 1 ? path(points, this.#toX, (_, value) => this.#toY(value)) : "" });
    const { name, unit } = PRESENTATION[this.#quantity];
    const [least, most] = [Math.min(...values), Math.max(...values)].map((value) => written(this.#quantity, value));
    this.#placeDot();
    this.#span.textContent = values.length === INSTANTS ? `${name}, ${least} to ${most} ${unit}` : name;
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
