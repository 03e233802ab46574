import type { Frame } from "../app/state";
import { drawnUnit, hatch, label, onResize, set, smoothLoop, svg, ticks } from "./svg";

/** What a longitudinal section shows; axial positions are in the laboratory frame. */
export interface LongitudinalScene {
  /** Outline from the front pole to the rear pole: x, r, x, r, ... */
  readonly outline: Float32Array;
  /** The outline at t = 0, when it is to be shown. */
  readonly initial: Float32Array | undefined;
  /** Axial position of the centroid now. */
  readonly centroid: number;
  readonly frame: Frame;
  /** Position of the transversal plane relative to the centroid, when that view is open. */
  readonly section: number | undefined;
}

/** Half of what is seen across the channel: the same in both sections, so that they are drawn to one scale. */
const HALF_HEIGHT = 1.62;
/** Free length kept on both sides of the centroid when the laboratory window turns its page. */
const MARGIN = 2.3;
const AXIS_HEIGHT = 34;
const AXIS_WIDTH = 30;

/** A section along the channel, cut by its walls at r = +-wall. */
export class Longitudinal {
  readonly #svg: SVGSVGElement;
  readonly #plot: SVGGElement;
  readonly #axis: SVGGElement;
  readonly #initial: SVGPathElement;
  readonly #membrane: SVGPathElement;
  readonly #plane: SVGLineElement;
  readonly #wall: number;
  readonly #walls: SVGElement[] = [];
  readonly #caption: SVGTextElement;
  #width = 0;
  #height = 0;
  #scene: LongitudinalScene | undefined;
  #left = 0;

  constructor(stage: HTMLElement, name: string, wall: number, onSection: (offset: number) => void) {
    this.#wall = wall;
    this.#svg = svg("svg", { role: "img", "aria-label": `Section of the capsule in the ${name}` }, stage);
    const fill = hatch(this.#svg, `hatch-${stage.id}`);
    const clip = svg("clipPath", { id: `clip-${stage.id}` }, this.#svg);
    this.#plot = svg("g", { "clip-path": `url(#clip-${stage.id})` }, this.#svg);
    this.#walls.push(svg("rect", {}, clip));
    for (let i = 0; i < 2; i++) {
      this.#walls.push(svg("rect", { fill, class: "outside" }, this.#plot), svg("line", { class: "wall" }, this.#plot));
    }
    this.#initial = svg("path", { class: "initial" }, this.#plot);
    this.#membrane = svg("path", { class: "membrane" }, this.#plot);
    this.#plane = svg("line", { class: "cut" }, this.#plot);
    this.#axis = svg("g", { class: "axis" }, this.#svg);
    this.#caption = svg("text", { class: "axis-name" }, this.#svg);
    onResize(stage, (width, height) => {
      this.#width = width;
      this.#height = height;
      this.#layOut();
      this.#redraw();
    });
    const drag = (event: PointerEvent) => {
      if (this.#scene !== undefined && this.#scene.section !== undefined && event.buttons === 1) {
        const x = (event.clientX - this.#svg.getBoundingClientRect().left - AXIS_WIDTH) / this.#scale + this.#left;
        onSection(this.#scene.frame === "laboratory" ? x - this.#scene.centroid : x);
      }
    };
    this.#svg.addEventListener("pointerdown", drag);
    this.#svg.addEventListener("pointermove", drag);
  }

  /** Shows a section, or the empty channel. */
  draw(scene: LongitudinalScene | undefined): void {
    this.#scene = scene;
    this.#redraw();
  }

  get #scale(): number {
    return (this.#height - AXIS_HEIGHT) / (2 * HALF_HEIGHT);
  }

  readonly #toY = (r: number) => (HALF_HEIGHT - r) * this.#scale;

  /** What depends on the size alone. */
  #layOut(): void {
    const [width, bottom] = [this.#width, this.#height - AXIS_HEIGHT];
    set(this.#svg, { viewBox: `0 0 ${width} ${this.#height}` });
    const [clip, upper, upperLine, lower, lowerLine] = this.#walls;
    if (!(clip && upper && upperLine && lower && lowerLine)) return;
    const inner = { x: AXIS_WIDTH, width: Math.max(0, width - AXIS_WIDTH) };
    const [top, low] = [this.#toY(this.#wall), this.#toY(-this.#wall)];
    set(clip, { ...inner, y: 0, height: bottom });
    set(upper, { ...inner, y: 0, height: top });
    set(lower, { ...inner, y: low, height: Math.max(0, bottom - low) });
    set(upperLine, { x1: AXIS_WIDTH, x2: width, y1: top, y2: top });
    set(lowerLine, { x1: AXIS_WIDTH, x2: width, y1: low, y2: low });
    set(this.#caption, { x: AXIS_WIDTH + inner.width / 2, y: this.#height - 3, "text-anchor": "middle" });
  }

  #redraw(): void {
    const scene = this.#scene;
    if (scene === undefined) {
      for (const outline of [this.#membrane, this.#initial]) set(outline, { d: "" });
      set(this.#plane, { x1: -10, x2: -10 });
      return;
    }
    if (this.#width === 0) return;
    const laboratory = scene.frame === "laboratory";
    const visible = (this.#width - AXIS_WIDTH) / this.#scale;
    this.#left = laboratory ? page(scene.centroid, visible) : -visible / 2;
    const origin = laboratory ? 0 : scene.centroid;
    const toX = (x: number) => AXIS_WIDTH + (x - origin - this.#left) * this.#scale;
    const closed = (outline: Float32Array, shift: number) =>
      smoothLoop(loop(outline), (x) => toX(x + shift), this.#toY);
    set(this.#membrane, { d: closed(scene.outline, 0) });
    // In the centroid's frame both shapes are laid over one another; the centroid starts at x = 0.
    set(this.#initial, { d: scene.initial ? closed(scene.initial, laboratory ? 0 : scene.centroid) : "" });
    const cut = scene.section === undefined ? -10 : toX(scene.centroid + scene.section);
    set(this.#plane, { x1: cut, x2: cut, y1: this.#toY(this.#wall), y2: this.#toY(-this.#wall) });
    this.#drawAxis((x) => AXIS_WIDTH + (x - this.#left) * this.#scale, visible);
    this.#caption.innerHTML = laboratory
      ? `<tspan class="symbol">x</tspan> [${drawnUnit()}]`
      : `<tspan class="symbol">x</tspan> − <tspan class="symbol">X</tspan><tspan class="sub" dy="3">c</tspan><tspan dy="-3"> [${drawnUnit()}]</tspan>`;
  }

  #drawAxis(toX: (x: number) => number, visible: number): void {
    const bottom = this.#height - AXIS_HEIGHT;
    const parts: Element[] = [];
    for (const x of ticks(this.#left, this.#left + visible, 1)) {
      parts.push(svg("line", { x1: toX(x), x2: toX(x), y1: bottom, y2: bottom + 4 }));
      if (toX(x) > this.#width - 8) continue;
      const text = svg("text", { x: toX(x), y: bottom + 16, "text-anchor": "middle" });
      text.textContent = label(x);
      parts.push(text);
    }
    for (const r of [-1, 0, 1]) {
      parts.push(svg("line", { x1: AXIS_WIDTH - 4, x2: AXIS_WIDTH, y1: this.#toY(r), y2: this.#toY(r) }));
      const text = svg("text", { x: AXIS_WIDTH - 7, y: this.#toY(r) + 4, "text-anchor": "end" });
      text.textContent = label(r);
      parts.push(text);
    }
    parts.push(svg("path", { d: `M${AXIS_WIDTH} 0V${bottom}H${this.#width}`, fill: "none" }));
    this.#axis.replaceChildren(...parts);
  }
}

/**
 * Left end of the laboratory window: it stands still while the capsule crosses it, then turns the page, so that
 * motion is seen against fixed walls. A function of the position alone, hence the same however time was reached.
 */
export function page(centroid: number, visible: number): number {
  const advance = Math.max(visible - 2 * MARGIN, 1);
  return Math.floor(centroid / advance + 1e-9) * advance - (visible - advance) / 2;
}

/** Both halves of an outline that runs from pole to pole; the poles, on the axis, are there once. */
function loop(outline: Float32Array): (readonly [number, number])[] {
  const half = Array.from(
    { length: outline.length / 2 },
    (_, i) => [outline[2 * i] ?? 0, outline[2 * i + 1] ?? 0] as const,
  );
  const mirrored = half.slice(1, -1).map(([x, r]) => [x, -r] as const);
  return [...half, ...mirrored.reverse()];
}
