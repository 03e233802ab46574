import type { Root } from "../app/dom";
import type { Need } from "../model/capsule";
import { hatch, label, onResize, path, set, svg, tidy } from "./svg";
import { type Context, type Trace, traceClass, type ViewPart } from "./view";

const HALF_EXTENT = 1.16;
const AXIS = 26;

/** The section across the square channel, seen from the front, against the flow: y to the right, z upwards. */
export class Transversal implements ViewPart {
  readonly needs: readonly Need[] = [];
  readonly #svg: SVGSVGElement;
  readonly #frame: SVGGElement;
  readonly #planes: SVGGElement;
  readonly #pins: SVGGElement;
  readonly #band: SVGPathElement;
  readonly #membrane: SVGPathElement;
  readonly #miss: SVGTextElement;
  readonly #fill: string;
  #size = 0;
  #unit = "";
  #factor = 1;
  #drawn: readonly [readonly Trace[], Context] | undefined;

  constructor(root: Root) {
    const stage = root.part("transversal", HTMLElement);
    this.#svg = svg("svg", { role: "img" }, stage);
    root.speak(({ views }) => set(this.#svg, { "aria-label": views.sectionAcross }));
    this.#fill = hatch(this.#svg, root.id("hatch-transversal"));
    this.#frame = svg("g", { class: "axis" }, this.#svg);
    this.#planes = svg("g", { class: "planes" }, this.#svg);
    this.#pins = svg("g", {}, this.#svg);
    this.#band = svg("path", { class: "band" }, this.#svg);
    this.#membrane = svg("path", { class: "membrane", "fill-rule": "evenodd" }, this.#svg);
    this.#miss = svg("text", { class: "axis-name", "text-anchor": "middle" }, this.#svg);
    onResize(stage, (width, height) => {
      this.#size = Math.min(width, height);
      this.#layOut();
      this.#redraw();
    });
  }

  draw(traces: readonly Trace[], context: Context): void {
    this.#drawn = [traces, context];
    const { name, factor } = context.units.drawn;
    if (name !== this.#unit || factor !== this.#factor) {
      this.#unit = name;
      this.#factor = factor;
      if (this.#size > 0) this.#layOut();
    }
    this.#redraw();
  }

  get #scale(): number {
    return (this.#size - AXIS) / (2 * HALF_EXTENT);
  }

  readonly #toX = (y: number) => AXIS + (y + HALF_EXTENT) * this.#scale;
  readonly #toY = (z: number) => (HALF_EXTENT - z) * this.#scale;

  #layOut(): void {
    const [size, toX, toY] = [this.#size, this.#toX, this.#toY];
    set(this.#svg, { viewBox: `0 0 ${size} ${size}` });
    const [low, high] = [toX(-1), toX(1)];
    const [top, bottom] = [toY(1), toY(-1)];
    const [edge, floor] = [toX(HALF_EXTENT), toY(-HALF_EXTENT)];
    const parts: Element[] = [
      svg("path", {
        d: `M${AXIS} 0H${edge}V${floor}H${AXIS}ZM${low} ${top}V${bottom}H${high}V${top}Z`,
        fill: this.#fill,
        class: "outside",
      }),
      svg("path", { d: `M${low} ${top}V${bottom}H${high}V${top}Z`, class: "wall", fill: "none" }),
    ];
    for (const at of [-1, 0, 1]) {
      const below = svg("text", { x: toX(at), y: floor + 14, "text-anchor": "middle" });
      const beside = svg("text", { x: AXIS - 6, y: toY(at) + 4, "text-anchor": "end" });
      below.textContent = label(tidy(at * this.#factor));
      beside.textContent = label(tidy(at * this.#factor));
      parts.push(below, beside);
    }
    const y = svg("text", { x: toX(0.5), y: floor + 14, class: "axis-name", "text-anchor": "middle" });
    y.innerHTML = '<tspan class="symbol">y</tspan> ';
    y.append(`[${this.#unit}]`);
    const z = svg("text", { x: AXIS - 6, y: toY(0.5) + 4, class: "axis-name", "text-anchor": "end" });
    z.innerHTML = '<tspan class="symbol">z</tspan>';
    this.#frame.replaceChildren(...parts, y, z);
    set(this.#miss, { x: toX(0), y: toY(0.06) });
  }

  #redraw(): void {
    if (this.#drawn === undefined || this.#size === 0) return;
    const [traces, context] = this.#drawn;
    const [live, ...pinned] = traces;
    const { section } = context.state;
    const loops = (curves: readonly Float32Array[]) =>
      curves
        .map(
          (curve) =>
            `${path(
              curve,
              (y) => this.#toX(y),
              (_, z) => this.#toY(z),
            )}Z`,
        )
        .join("");
    const curves = live?.answer?.transversal(section);
    const d = loops(curves ?? []);
    set(this.#membrane, { d, class: `membrane${live?.answer?.isUncertain === true ? " uncertain" : ""}` });
    const band = 2 * (live?.answer?.band ?? 0) * (live?.radius ?? 1) * this.#scale;
    set(this.#band, { d, "stroke-width": band });
    this.#miss.textContent = curves?.length === 0 ? context.words.views.missed : "";
    this.#pins.replaceChildren(
      ...pinned.flatMap(({ name, answer }) =>
        answer === undefined ? [] : [svg("path", { class: traceClass(name), d: loops(answer.transversal(section)) })],
      ),
    );
    const [toX, toY] = [this.#toX, this.#toY];
    const planes: Element[] = [];
    if (live?.answer !== undefined && context.shows("midplane")) {
      planes.push(svg("line", { x1: toX(-1), x2: toX(1), y1: toY(0), y2: toY(0), class: "trace-midplane" }));
    }
    if (live?.answer !== undefined && context.shows("diagonal")) {
      planes.push(svg("line", { x1: toX(-1), x2: toX(1), y1: toY(-1), y2: toY(1), class: "trace-diagonal" }));
    }
    this.#planes.replaceChildren(...planes);
  }
}
