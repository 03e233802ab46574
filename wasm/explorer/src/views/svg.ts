/** Small helpers for drawing with SVG. */

const NAMESPACE = "http://www.w3.org/2000/svg";

type Attributes = Record<string, string | number>;

/** Makes an element and appends it to `parent` when there is one. */
export function svg<K extends keyof SVGElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  parent?: Element,
): SVGElementTagNameMap[K] {
  const element = document.createElementNS(NAMESPACE, tag);
  set(element, attributes);
  parent?.append(element);
  return element;
}

/** Sets the attributes that differ; numbers are written to a hundredth of a pixel. */
export function set(element: Element, attributes: Attributes): void {
  for (const name in attributes) {
    const value = attributes[name] ?? "";
    const text = typeof value === "number" ? fixed(value) : value;
    // A browser lays out anew also what is set to what it is.
    if (element.getAttribute(name) !== text) element.setAttribute(name, text);
  }
}

/** The path through points given as x, y, x, y, ... after mapping each to pixels. */
export function path(
  points: ArrayLike<number>,
  toX: (x: number, y: number) => number,
  toY: (x: number, y: number) => number,
): string {
  let text = "";
  for (let i = 0; i + 1 < points.length; i += 2) {
    const x = points[i] ?? 0;
    const y = points[i + 1] ?? 0;
    text += `${i === 0 ? "M" : "L"}${fixed(toX(x, y))} ${fixed(toY(x, y))}`;
  }
  return text;
}

/** The closed path through points, smooth between them (Catmull and Rom 1974), after mapping each to pixels. */
export function smoothLoop(
  points: readonly (readonly [number, number])[],
  toX: (x: number) => number,
  toY: (y: number) => number,
): string {
  const count = points.length;
  const [xs, ys] = [new Float64Array(count), new Float64Array(count)];
  for (let i = 0; i < count; i++) {
    const [x, y] = points[i] ?? [0, 0];
    xs[i] = toX(x);
    ys[i] = toY(y);
  }
  const at = (places: Float64Array, i: number) => places[(i + count) % count] ?? 0;
  /** A sixth of the way from the point before to the point after: the curve's direction at the point. */
  const way = (places: Float64Array, i: number) => (at(places, i + 1) - at(places, i - 1)) / 6;
  const [x, y] = [at(xs, 0), at(ys, 0)];
  let text = `M${fixed(x)} ${fixed(y)}C${fixed(x + way(xs, 0))} ${fixed(y + way(ys, 0))} `;
  for (let i = 1; i <= count; i++) {
    const [toward, beside] = [at(xs, i), at(ys, i)];
    const reach = `${fixed(toward - way(xs, i))} ${fixed(beside - way(ys, i))}`;
    // After the first piece each leaves a point as the one before reached it.
    text += `${i === 1 ? "" : "S"}${reach} ${fixed(toward)} ${fixed(beside)}`;
  }
  return `${text}Z`;
}

/** Diagonal hatching for what lies outside, as a fill: `url(#id)`. */
export function hatch(parent: SVGSVGElement, id: string): string {
  const pattern = svg("pattern", { id, width: 6, height: 6, patternUnits: "userSpaceOnUse" }, svg("defs", {}, parent));
  pattern.setAttribute("patternTransform", "rotate(45)");
  svg("line", { x1: 0, y1: 0, x2: 0, y2: 6, class: "hatch" }, pattern);
  return `url(#${id})`;
}

/** Calls `draw` with the size of the element, now and whenever it changes. */
export function onResize(element: Element, draw: (width: number, height: number) => void): void {
  new ResizeObserver(([entry]) => {
    if (entry !== undefined && entry.contentRect.width > 0 && entry.contentRect.height > 0) {
      draw(entry.contentRect.width, entry.contentRect.height);
    }
  }).observe(element);
}

/** Multiples of a step in [from, to], free of accumulated rounding. */
export function ticks(from: number, to: number, step: number): number[] {
  const first = Math.ceil(from / step - 1e-9);
  const last = Math.floor(to / step + 1e-9);
  return Array.from({ length: Math.max(0, last - first + 1) }, (_, i) => Number(((first + i) * step).toPrecision(12)));
}

/** A number to the digits that an axis needs. */
export function tidy(value: number): number {
  return Number(value.toPrecision(4));
}

/** A number with a true minus sign. */
export function label(value: number): string {
  return String(value).replace("-", "−");
}

function fixed(value: number): string {
  return value.toFixed(2);
}
