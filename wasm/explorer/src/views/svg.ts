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

/** Sets attributes; numbers are written to a hundredth of a pixel. */
export function set(element: Element, attributes: Attributes): void {
  for (const [name, value] of Object.entries(attributes)) {
    element.setAttribute(name, typeof value === "number" ? fixed(value) : value);
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
  const pixels = points.map(([x, y]) => [toX(x), toY(y)] as const);
  const at = (i: number) => pixels[(i + pixels.length) % pixels.length] ?? [0, 0];
  let text = `M${fixed(at(0)[0])} ${fixed(at(0)[1])}`;
  for (let i = 0; i < pixels.length; i++) {
    const [before, from, to, after] = [at(i - 1), at(i), at(i + 1), at(i + 2)];
    const leave = [from[0] + (to[0] - before[0]) / 6, from[1] + (to[1] - before[1]) / 6] as const;
    const reach = [to[0] - (after[0] - from[0]) / 6, to[1] - (after[1] - from[1]) / 6] as const;
    text += `C${[...leave, ...reach, ...to].map(fixed).join(" ")}`;
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
