import { drawnUnit, hatch, label, onResize, path, set, svg } from "./svg";

/** What the transversal section shows. */
export interface TransversalScene {
  /** Closed curves y, z, y, z, ...: none where the plane misses the capsule, two where it cuts the rear cavity. */
  readonly curves: readonly Float32Array[];
  /** Which longitudinal planes are shown beside, to be marked. */
  readonly midplane: boolean;
  readonly diagonal: boolean;
}

const HALF_EXTENT = 1.16;
const AXIS = 26;

/** The section across the square channel, looking along the flow. */
export class Transversal {
  readonly #svg: SVGSVGElement;
  readonly #frame: SVGGElement;
  readonly #planes: SVGGElement;
  readonly #membrane: SVGPathElement;
  readonly #miss: SVGTextElement;
  readonly #fill: string;
  #size = 0;
  #unit = "";
  #scene: TransversalScene | undefined;

  constructor(stage: HTMLElement) {
    this.#svg = svg("svg", { role: "img", "aria-label": "Section of the capsule across the channel" }, stage);
    this.#fill = hatch(this.#svg, "hatch-transversal");
    this.#frame = svg("g", { class: "axis" }, this.#svg);
    this.#planes = svg("g", { class: "planes" }, this.#svg);
    this.#membrane = svg("path", { class: "membrane", "fill-rule": "evenodd" }, this.#svg);
    this.#miss = svg("text", { class: "axis-name", "text-anchor": "middle" }, this.#svg);
    onResize(stage, (width, height) => {
      this.#size = Math.min(width, height);
      this.#layOut();
      this.#redraw();
    });
  }

  /** Shows a section, or the empty channel. */
  draw(scene: TransversalScene | undefined): void {
    this.#scene = scene;
    this.#redraw();
  }

  readonly #toX = (y: number) => AXIS + ((y + HALF_EXTENT) * (this.#size - AXIS)) / (2 * HALF_EXTENT);
  readonly #toY = (z: number) => ((HALF_EXTENT - z) * (this.#size - AXIS)) / (2 * HALF_EXTENT);

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
      below.textContent = label(at);
      beside.textContent = label(at);
      parts.push(below, beside);
    }
    const y = svg("text", { x: toX(0.5), y: floor + 14, class: "axis-name", "text-anchor": "middle" });
    this.#unit = drawnUnit();
    y.innerHTML = `<tspan class="symbol">y</tspan> [${this.#unit}]`;
    const z = svg("text", { x: AXIS - 6, y: toY(0.5) + 4, class: "axis-name", "text-anchor": "end" });
    z.innerHTML = '<tspan class="symbol">z</tspan>';
    this.#frame.replaceChildren(...parts, y, z);
    set(this.#miss, { x: toX(0), y: toY(0.06) });
  }

  #redraw(): void {
    const scene = this.#scene;
    if (scene === undefined) {
      set(this.#membrane, { d: "" });
      this.#miss.textContent = "";
      return;
    }
    if (this.#size === 0) return;
    if (this.#unit !== drawnUnit()) this.#layOut();
    const [toX, toY] = [this.#toX, this.#toY];
    const loop = (curve: Float32Array) =>
      `${path(
        curve,
        (y) => toX(y),
        (_, z) => toY(z),
      )}Z`;
    set(this.#membrane, { d: scene.curves.map(loop).join("") });
    this.#miss.textContent = scene.curves.length === 0 ? "The plane misses the capsule." : "";
    const planes: Element[] = [];
    if (scene.midplane) {
      planes.push(svg("line", { x1: toX(-1), x2: toX(1), y1: toY(0), y2: toY(0), class: "trace-midplane" }));
    }
    if (scene.diagonal) {
      planes.push(svg("line", { x1: toX(-1), x2: toX(1), y1: toY(-1), y2: toY(1), class: "trace-diagonal" }));
    }
    this.#planes.replaceChildren(...planes);
  }
}
