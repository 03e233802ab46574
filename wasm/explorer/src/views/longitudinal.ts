import type { Root } from "../app/dom";
import type { Measured } from "../identify/measured";
import type { Found } from "../identify/protocol";
import type { Outline } from "../model/answer";
import type { Need } from "../model/capsule";
import { flowProfile, REACH_OF_V } from "./flow";
import { hatch, label, onResize, path, set, smoothLoop, svg, tidy } from "./svg";
import { type Context, type Trace, traceClass, type ViewPart } from "./view";

/** Half of what is seen across the channel: the same in both sections, so that they are drawn to one scale. */
const HALF_HEIGHT = 1.62;
const AXIS_HEIGHT = 34;
const AXIS_WIDTH = 30;
/** Where the window begins, so that nothing is drawn. */
const AWAY = -10;
/** Where the profile of the flow begins: from the edge of the window, in l. */
const FLOW_INSET = 0.3;
/** Size of an arrow's head in pixels. */
const HEAD = 5;

/** A section along the channel, cut by its walls at r = +-wall. The window follows the capsule. */
export class Longitudinal implements ViewPart {
  readonly needs: readonly Need[] = ["outlines"];
  readonly #outline: Outline;
  readonly #svg: SVGSVGElement;
  readonly #pattern: Element | null;
  readonly #shapes: SVGGElement;
  readonly #initial: SVGPathElement;
  readonly #band: SVGPathElement;
  readonly #membrane: SVGPathElement;
  readonly #points: SVGPathElement;
  readonly #picture: SVGGElement;
  readonly #plane: SVGLineElement;
  readonly #flow: SVGPathElement;
  readonly #flowValue: SVGTextElement;
  readonly #ticks: SVGGElement;
  readonly #axis: SVGGElement;
  readonly #wall: number;
  readonly #walls: SVGElement[] = [];
  readonly #caption: SVGTextElement;
  #width = 0;
  #height = 0;
  #left = 0;
  #factor = 1;
  /** The whole x that the ticks begin at, and all else that they depend on. */
  #ticked = "";
  #drawn: readonly [readonly Trace[], Context] | undefined;
  readonly #measured: Measured | undefined;
  readonly #key: HTMLElement;
  /** The measured outline that is drawn, and the scale that it is drawn in. */
  #traced: readonly [Found | undefined, number] = [undefined, 0];

  /** `measured` is drawn over the section. */
  constructor(root: Root, outline: Outline, onSection: (offset: number) => void, measured?: Measured) {
    this.#measured = measured;
    this.#key = root.part("measured-key", HTMLElement);
    const stage = root.part(outline, HTMLElement);
    this.#outline = outline;
    this.#wall = outline === "midplane" ? 1 : Math.SQRT2;
    this.#svg = svg("svg", { role: "img" }, stage);
    root.speak(({ views }) => {
      set(this.#svg, { "aria-label": outline === "midplane" ? views.sectionZ : views.sectionYZ });
    });
    const fill = hatch(this.#svg, root.id(`hatch-${outline}`));
    this.#pattern = this.#svg.querySelector("pattern");
    const clipId = root.id(`clip-${outline}`);
    const clip = svg("clipPath", { id: clipId }, this.#svg);
    const plot = svg("g", { "clip-path": `url(#${clipId})` }, this.#svg);
    this.#walls.push(svg("rect", {}, clip));
    for (let i = 0; i < 2; i++) {
      this.#walls.push(svg("rect", { fill, class: "outside" }, plot), svg("line", { class: "wall" }, plot));
    }
    this.#picture = svg("g", {}, plot);
    this.#flow = svg("path", { class: "flow" }, plot);
    this.#flowValue = svg("text", { class: "flow-value" }, plot);
    this.#shapes = svg("g", {}, plot);
    this.#initial = svg("path", { class: "initial" }, plot);
    this.#band = svg("path", { class: "band" }, plot);
    this.#membrane = svg("path", { class: "membrane" }, plot);
    this.#points = svg("path", { class: "measured-outline" }, plot);
    this.#plane = svg("line", { class: "cut" }, plot);
    this.#axis = svg("g", { class: "axis" }, this.#svg);
    this.#ticks = svg("g", { class: "axis" }, this.#svg);
    this.#caption = svg("text", { class: "axis-name" }, this.#svg);
    onResize(stage, (width, height) => {
      this.#width = width;
      this.#height = height;
      this.#layOut();
      this.#redraw();
    });
    this.#takePlane(onSection);
  }

  draw(traces: readonly Trace[], context: Context): void {
    this.#drawn = [traces, context];
    if (context.units.drawn.factor !== this.#factor) {
      this.#factor = context.units.drawn.factor;
      if (this.#width > 0) this.#layOut();
    }
    this.#redraw();
  }

  /** The plane of the transversal section follows the mouse or a pen; a finger that may scroll moves it by a tap. */
  #takePlane(onSection: (offset: number) => void): void {
    const choose = (event: MouseEvent) => {
      const [traces, context] = this.#drawn ?? [];
      const answer = traces?.[0]?.answer;
      if (answer === undefined || context === undefined || !context.shows("transversal")) return;
      const x = (event.clientX - this.#svg.getBoundingClientRect().left - AXIS_WIDTH) / this.#scale + this.#left;
      onSection(context.state.frame === "laboratory" ? x - answer.centroid : x);
    };
    const drag = (event: PointerEvent) => {
      if (event.pointerType !== "touch" && event.buttons === 1) choose(event);
    };
    this.#svg.addEventListener("pointerdown", drag);
    this.#svg.addEventListener("pointermove", drag);
    this.#svg.addEventListener("click", choose);
  }

  get #scale(): number {
    return (this.#height - AXIS_HEIGHT) / (2 * HALF_HEIGHT);
  }

  readonly #toY = (r: number) => (HALF_HEIGHT - r) * this.#scale;

  /** All that depends on the size alone. */
  #layOut(): void {
    const [width, bottom] = [this.#width, this.#height - AXIS_HEIGHT];
    this.#ticked = "";
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
    const parts: Element[] = [svg("path", { d: `M${AXIS_WIDTH} 0V${bottom}H${width}`, fill: "none" })];
    for (const r of [-1, 0, 1]) {
      const y = this.#toY(r);
      parts.push(svg("line", { x1: AXIS_WIDTH - 4, x2: AXIS_WIDTH, y1: y, y2: y }));
      const text = svg("text", { x: AXIS_WIDTH - 7, y: y + 4, "text-anchor": "end" });
      text.textContent = label(tidy(r * this.#factor));
      parts.push(text);
    }
    this.#axis.replaceChildren(...parts);
  }

  #redraw(): void {
    if (this.#drawn === undefined || this.#width === 0) return;
    const [traces, context] = this.#drawn;
    const [live, ...pinned] = traces;
    const { state } = context;
    const answer = live?.answer;
    const laboratory = state.frame === "laboratory";
    const visible = (this.#width - AXIS_WIDTH) / this.#scale;
    const centre = answer?.centroid ?? pinned.find((pin) => pin.answer !== undefined)?.answer?.centroid ?? 0;
    this.#left = (laboratory ? centre : 0) - visible / 2;
    const toX = (x: number) => AXIS_WIDTH + (x - this.#left) * this.#scale;
    const closed = (outline: Float32Array, centroid: number) =>
      smoothLoop(loop(outline), (x) => toX(laboratory ? x : x - centroid), this.#toY);

    if (answer === undefined) {
      for (const shape of [this.#membrane, this.#initial, this.#band]) set(shape, { d: "" });
      set(this.#plane, { x1: AWAY, x2: AWAY });
    } else {
      const d = closed(answer.outline(this.#outline), answer.centroid);
      set(this.#membrane, { d, class: `membrane${answer.isUncertain ? " uncertain" : ""}` });
      set(this.#band, { d, "stroke-width": 2 * answer.band * (live?.radius ?? 1) * this.#scale });
      const start = state.initial ? live?.start() : undefined;
      set(this.#initial, { d: start === undefined ? "" : closed(start.outline(this.#outline), start.centroid) });
      const cut = context.shows("transversal") ? toX((laboratory ? answer.centroid : 0) + state.section) : AWAY;
      set(this.#plane, { x1: cut, x2: cut, y1: this.#toY(this.#wall), y2: this.#toY(-this.#wall) });
    }
    this.#drawFlow(answer?.read("velocity"), context);
    this.#drawMeasured(answer === undefined ? AWAY : toX(laboratory ? answer.centroid : 0));
    this.#shapes.replaceChildren(
      ...pinned.flatMap(({ name, answer: pin }) =>
        pin === undefined
          ? []
          : [svg("path", { class: traceClass(name), d: closed(pin.outline(this.#outline), pin.centroid) })],
      ),
    );
    this.#drawTicks(visible, context, laboratory);
  }

  /** The undisturbed flow's profile at the left edge, in the frame of the section, with its largest value. */
  #drawFlow(capsule: number | undefined, { state, units }: Context): void {
    const isLaboratory = state.frame === "laboratory";
    const isShown = this.#outline === "midplane" && state.profile && (isLaboratory || capsule !== undefined);
    if (!isShown) {
      set(this.#flow, { d: "" });
      this.#flowValue.textContent = "";
      return;
    }
    const frame = isLaboratory ? 0 : (capsule ?? 0);
    const { curve, arrows } = flowProfile(frame);
    const start = AXIS_WIDTH + (FLOW_INSET + REACH_OF_V * frame) * this.#scale;
    const to = ([reach, y]: readonly [number, number]) => [start + reach * this.#scale, this.#toY(y)] as const;
    const profile = curve.map((place) =>
      to(place)
        .map((at) => at.toFixed(2))
        .join(" "),
    );
    const heads = arrows.map((place) => {
      const [x, y] = to(place);
      const back = Math.sign(x - start) * HEAD;
      const head = Math.abs(x - start) < HEAD ? "" : `m${-back} ${-HEAD / 2}l${back} ${HEAD / 2}l${-back} ${HEAD / 2}`;
      return `M${start} ${y}H${x}${head}`;
    });
    set(this.#flow, { d: `M${start} ${this.#toY(-1)}V${this.#toY(1)}M${profile.join("L")}${heads.join("")}` });
    const most = Math.max(...curve.map(([reach]) => reach)) / REACH_OF_V;
    const { name, factor } = units.velocity;
    set(this.#flowValue, { x: start + most * REACH_OF_V * this.#scale + 4, y: this.#toY(0) - 5 });
    this.#flowValue.textContent = `${label(Number((most * factor).toPrecision(3)))} ${name}`;
  }

  /** The measured outline and its picture, with the centroid that it was fitted to at a place of the drawing. */
  #drawMeasured(x: number): void {
    if (this.#measured === undefined) return;
    const { found, address } = this.#measured;
    this.#key.hidden = found === undefined;
    if (found !== this.#traced[0] || this.#scale !== this.#traced[1]) {
      this.#traced = [found, this.#scale];
      const points = found?.contour.flat() ?? [];
      set(this.#points, {
        d: path(
          points,
          (along) => along * this.#scale,
          (_, r) => -r * this.#scale,
        ),
      });
      this.#picture.replaceChildren();
      if (found?.picture !== undefined && address !== undefined) this.#place(found.picture, address);
    }
    const away = x === AWAY ? -1e4 : x;
    for (const part of [this.#points, this.#picture]) {
      part.setAttribute("transform", `translate(${away.toFixed(2)} ${this.#toY(0).toFixed(2)})`);
    }
  }

  /** Lays a picture over the section: its pixels where the fit has them. */
  #place({ size: [width, height], corner, ways }: NonNullable<Found["picture"]>, href: string): void {
    const pixels = [...ways, corner].flatMap(([x, r]) => [x * this.#scale, -r * this.#scale]);
    const image = svg("image", { href, class: "measured-picture" }, this.#picture);
    set(image, { width, height, preserveAspectRatio: "none", transform: `matrix(${pixels.join(" ")})` });
  }

  /** Ticks at whole x. They move with the window, and are made anew when a whole x enters or leaves. */
  #drawTicks(visible: number, { units }: Context, laboratory: boolean): void {
    const first = Math.ceil(this.#left);
    const shift = (first - this.#left) * this.#scale;
    this.#ticks.setAttribute("transform", `translate(${shift.toFixed(2)} 0)`);
    this.#pattern?.setAttribute(
      "patternTransform",
      `translate(${(-this.#left * this.#scale).toFixed(2)} 0) rotate(45)`,
    );
    const key = [first, laboratory, units.drawn.name, units.drawn.factor].join(" ");
    if (key === this.#ticked) return;
    this.#ticked = key;
    const bottom = this.#height - AXIS_HEIGHT;
    const parts: Element[] = [];
    for (let i = 0; i < visible - 0.2; i++) {
      const x = AXIS_WIDTH + i * this.#scale;
      parts.push(svg("line", { x1: x, x2: x, y1: bottom, y2: bottom + 4 }));
      const text = svg("text", { x, y: bottom + 16, "text-anchor": "middle" });
      text.textContent = label(tidy((first + i) * units.drawn.factor));
      parts.push(text);
    }
    this.#ticks.replaceChildren(...parts);
    const unit = `[${units.drawn.name}]`;
    const x = '<tspan class="symbol">x</tspan>';
    const centroid = '<tspan class="symbol">X</tspan><tspan class="sub" dy="3">c</tspan>';
    this.#caption.innerHTML = laboratory ? `${x} ${unit}` : `${x} − ${centroid}<tspan dy="-3"> ${unit}</tspan>`;
  }
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
