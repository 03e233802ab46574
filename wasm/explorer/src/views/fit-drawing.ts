import type { Root } from "../app/dom";
import type { Found } from "../identify/protocol";
import type { Messages } from "../messages/en";
import { AXES, type Point, type Span } from "./map-geometry";
import type { Contour } from "./map-layer";
import { label, onResize, path, set, svg, ticks, tidy } from "./svg";

const INSET = { left: 44, right: 8, top: 16, bottom: 34 };
/** Half of what is seen across the channel, and what is left free along it, in l. */
const HALF_HEIGHT = 1.15;
const FREE = 0.15;

/** Two drawings of an answer: the measured points with the fitted outline, and the regions of Ca and a/l. */
export class FitDrawing {
  readonly #fit: SVGSVGElement;
  readonly #regions: SVGSVGElement;
  #words: Messages["outline"];
  #drawn: readonly [Found | undefined, readonly Contour[]] = [undefined, []];

  constructor(root: Root, stage: HTMLElement) {
    this.#words = root.words.outline;
    this.#fit = svg("svg", { role: "img" }, stage);
    this.#regions = svg("svg", { role: "img" }, stage);
    root.speak(({ outline }) => {
      this.#words = outline;
      set(this.#fit, { "aria-label": outline.fit });
      set(this.#regions, { "aria-label": outline.regions });
      this.#draw();
    });
    onResize(stage, () => this.#draw());
  }

  draw(found: Found | undefined, regions: readonly Contour[]): void {
    if (this.#drawn[0] === found && this.#drawn[1] === regions) return;
    this.#drawn = [found, regions];
    this.#draw();
  }

  #draw(): void {
    const [found, regions] = this.#drawn;
    this.#drawFit(found);
    this.#drawRegions(found, regions);
  }

  #drawFit(found: Found | undefined): void {
    const { width, height } = begin(this.#fit);
    if (found === undefined || width === 0) return;
    const along = [...found.contour, ...found.outline].map(([x]) => x);
    const [least, most] = [Math.min(...along) - FREE, Math.max(...along) + FREE];
    const scale = Math.min((height - 2 * INSET.top) / (2 * HALF_HEIGHT), width / (most - least));
    const toX = (x: number) => width / 2 + (x - (least + most) / 2) * scale;
    const toY = (_: number, r: number) => height / 2 - r * scale;
    for (const wall of [-1, 1]) {
      const y = toY(0, wall);
      svg("line", { class: "wall", x1: toX(least), x2: toX(most), y1: y, y2: y }, this.#fit);
    }
    const mirrored = found.outline.map(([x, r]) => [x, -r] as const).reverse();
    const outline = [...found.outline, ...mirrored].flat();
    svg("path", { class: "fitted", d: `${path(outline, toX, toY)}Z` }, this.#fit);
    for (const [x, r] of found.contour) {
      svg("circle", { class: "measured-point", cx: toX(x), cy: toY(x, r), r: 1 }, this.#fit);
    }
    name(this.#fit, 4, 11, this.#words.fitKey);
  }

  #drawRegions(found: Found | undefined, regions: readonly Contour[]): void {
    const { width, height } = begin(this.#regions);
    if (found === undefined || width === 0) return;
    const [ca, confinement] = found.around;
    const [right, bottom] = [width - INSET.right, height - INSET.bottom];
    const [place] = AXES.log;
    const share = (value: number, [low, high]: Span) => (value - low) / (high - low);
    const toX = (value: number) =>
      INSET.left + share(place(value), [place(ca[0]), place(ca[1])]) * (right - INSET.left);
    const toY = (value: number) => bottom - share(value, confinement) * (bottom - INSET.top);
    const axis = svg("g", { class: "axis" }, this.#regions);
    svg("path", { d: `M${INSET.left} ${INSET.top}V${bottom}H${right}`, fill: "none" }, axis);
    for (const value of fewTicks(ca)) {
      const x = toX(value);
      svg("line", { x1: x, x2: x, y1: bottom, y2: bottom + 4 }, axis);
      name(axis, x, bottom + 15, label(tidy(value)), "middle");
    }
    for (const value of fewTicks(confinement)) {
      const y = toY(value);
      svg("line", { x1: INSET.left - 4, x2: INSET.left, y1: y, y2: y }, axis);
      name(axis, INSET.left - 7, y + 4, label(tidy(value)), "end");
    }
    name(axis, (INSET.left + right) / 2, height - 3, "Ca", "middle", "axis-name symbol");
    name(axis, 4, 11, this.#words.regionsKey, "start");
    for (const region of regions) drawRegion(this.#regions, region, toX, toY, this.#words);
    drawBest(this.#regions, { ca: found.answer.ca, confinement: found.answer.confinement }, toX, toY);
  }
}

/** A region of Ca and a/l, as a path. */
export function drawRegion(
  parent: Element,
  { label: text, rings }: Contour,
  toX: (ca: number) => number,
  toY: (confinement: number) => number,
  words: Messages["outline"],
): void {
  const ring = (points: readonly (readonly [number, number])[]) => `${path(points.flat(), toX, (_, y) => toY(y))}Z`;
  const region = svg("path", { class: "region-of", d: rings.map(ring).join(""), "fill-rule": "evenodd" }, parent);
  svg("title", {}, region).textContent = words.region(text);
}

/** The mark of the best fit: a cross. */
export function drawBest(
  parent: Element,
  { ca, confinement }: Point,
  toX: (ca: number) => number,
  toY: (confinement: number) => number,
): SVGPathElement {
  const [x, y] = [toX(ca), toY(confinement)];
  return svg("path", { class: "best-fit", d: `M${x - 6} ${y}H${x + 6}M${x} ${y - 6}V${y + 6}` }, parent);
}

/** Empties a drawing and fits it to its size. */
function begin(drawing: SVGSVGElement): { width: number; height: number } {
  drawing.replaceChildren();
  const { width, height } = drawing.getBoundingClientRect();
  set(drawing, { viewBox: `0 0 ${width} ${height}` });
  return { width, height };
}

function name(parent: Element, x: number, y: number, words: string, anchor = "start", kind = ""): void {
  svg("text", { x, y, "text-anchor": anchor, class: kind }, parent).textContent = words;
}

/** Three to six round values in a span. */
function fewTicks([low, high]: Span): number[] {
  const power = 10 ** Math.floor(Math.log10((high - low) / 3));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((size) => (high - low) / size <= 5) ?? power;
  return ticks(low, high, step);
}
