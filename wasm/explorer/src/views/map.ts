import type { Root } from "../app/dom";
import type { Scale } from "../app/schema";
import type { Measured } from "../identify/measured";
import { writtenMisfit } from "../identify/misfit-grid";
import type { Messages } from "../messages/en";
import type { Capsule, Need } from "../model/capsule";
import { measure } from "../model/quantities";
import type { Unit } from "../model/units";
import { drawBest, drawRegion } from "./fit-drawing";
import { AXES, between, clamp, holds, type Point, rounded, type Span, short } from "./map-geometry";
import type { Contour } from "./map-layer";
import { hatch, label, onResize, set, svg, ticks, tidy } from "./svg";
import { type Context, type Trace, traceClass, type ViewPart } from "./view";

/** The domain of a model. */
interface Domain {
  readonly caRange: Span;
  readonly confinementRange: Span;
  /** Ca, a/l, Ca, a/l, ... */
  readonly samples: Float64Array;
  /** a/l, largest steady Ca, a/l, ... by rising a/l. */
  readonly steadyLimit: Float64Array;
  /** a/l, Ca, a/l, ... where the solution jumps; empty where it does not. */
  readonly jumpBorder: Float64Array;
  /** Time by which a steady state must be reached. */
  readonly end: number;
  readonly time: Unit;
}

const NONE = new Float64Array();
const NO_UNIT: Unit = { name: "", plain: "", factor: 1 };
const INSET = { left: 44, right: 10, top: 8, bottom: 40 };
/** Steps of the keys and of the mouse; with Shift, a fifth of them. */
const STEP: Point = { ca: 0.005, confinement: 0.01 };

/** The plane of the parameters: sampled points, the region with a steady state, and the current choice to drag. */
export class ParameterMap implements ViewPart {
  readonly needs: readonly Need[] = ["channel"];
  #domain: Domain = {
    caRange: [0, 1],
    confinementRange: [0, 1],
    samples: NONE,
    steadyLimit: NONE,
    jumpBorder: NONE,
    end: 0,
    time: NO_UNIT,
  };
  readonly #onChoice: (point: Point) => void;
  readonly #svg: SVGSVGElement;
  readonly #ground: SVGGElement;
  readonly #layer: SVGGElement;
  readonly #pins: SVGGElement;
  readonly #answer: SVGGElement;
  readonly #measured: Measured;
  readonly #hint: SVGTextElement;
  readonly #guides: SVGPathElement;
  readonly #handle: SVGCircleElement;
  readonly #ring: SVGCircleElement;
  readonly #grip: SVGCircleElement;
  readonly #fill: string;
  readonly #limitId: string;
  readonly #jumpId: string;
  #caSpan: Span = [0, 1];
  #confinementSpan: Span = [0, 1];
  #width = 0;
  #height = 0;
  #tell: ((point: Point) => string) | undefined;
  /** Where the mouse is. */
  #hovered: Point | undefined;
  #traces: readonly Trace[] = [];
  #contoured: readonly Contour[] | undefined;
  #point: Point = { ca: 0, confinement: 0 };
  #capsule: Capsule | undefined;
  #words: Messages;
  #scale: Scale = "linear";
  #hasSamples = true;
  /** Contours of the layer, which another part computes. */
  contours: readonly Contour[] = [];

  constructor(root: Root, measured: Measured, onChoice: (point: Point) => void) {
    this.#measured = measured;
    const stage = root.part("map", HTMLElement);
    this.#onChoice = onChoice;
    this.#svg = svg("svg");
    this.#svg.setAttribute("role", "group");
    this.#fill = hatch(this.#svg, root.id("hatch-map"));
    this.#limitId = root.id("steady-limit");
    this.#jumpId = root.id("jump-border");
    this.#ground = svg("g", { class: "axis" }, this.#svg);
    this.#layer = svg("g", { class: "layer" }, this.#svg);
    this.#answer = svg("g", { class: "answer" }, this.#svg);
    this.#guides = svg("path", { class: "guide", fill: "none" }, this.#svg);
    this.#hint = svg("text", { class: "region hint" }, this.#svg);
    const surface = svg(
      "rect",
      { class: "surface", width: "100%", height: "100%", id: root.id("map-surface") },
      this.#svg,
    );
    this.#pins = svg("g", {}, this.#svg);
    this.#handle = svg("circle", { class: "point", r: 8, tabindex: 0, role: "slider" }, this.#svg);
    this.#ring = svg("circle", { class: "focus-ring", r: 12 }, this.#svg);
    // A finger takes hold of more than is seen.
    this.#grip = svg("circle", { class: "grip", r: 22 }, this.#svg);
    set(this.#handle, {
      id: root.id("map-point"),
      "aria-orientation": "horizontal",
    });
    stage.replaceChildren(this.#svg);
    this.#words = root.words;
    root.speak((words) => {
      this.#words = words;
      set(this.#svg, { "aria-label": words.map.name });
      set(this.#handle, { "aria-label": words.map.point });
      if (this.#width > 0) this.#layOut();
    });
    onResize(stage, (width, height) => {
      this.#width = width;
      this.#height = height;
      this.#layOut();
      this.#show();
    });
    for (const target of [surface, this.#grip] as SVGGraphicsElement[]) {
      target.addEventListener("pointerdown", (event) => this.#grasp(event, target));
      target.addEventListener("pointermove", (event) => {
        if (target.hasPointerCapture(event.pointerId)) this.#choose(event);
      });
    }
    surface.addEventListener("pointermove", (event) => this.#preview(event));
    surface.addEventListener("pointerleave", () => {
      this.#hovered = undefined;
      this.#hint.textContent = "";
    });
    surface.addEventListener("click", (event) => this.#choose(event));
    this.#handle.addEventListener("keydown", (event) => this.#step(event));
  }

  draw(traces: readonly Trace[], { state, capsule, units }: Context): void {
    const isOther = units.time.factor !== this.#domain.time.factor;
    if (isOther || capsule !== this.#capsule || state.scale !== this.#scale || state.samples !== this.#hasSamples) {
      this.#capsule = capsule;
      this.#scale = state.scale;
      this.#hasSamples = state.samples;
      this.#setDomain(capsule, units.time);
    }
    this.#point = state;
    this.#traces = traces;
    this.#tell = ({ ca, confinement }) => {
      if (state.layer === "misfit" && this.#measured.found !== undefined) {
        return writtenMisfit(this.#words, this.#measured.misfit({ ca, confinement }));
      }
      const [value = Number.NaN] = capsule.grid(
        "hover",
        state.trace,
        Float64Array.of(ca, confinement),
        state.t,
        state.method,
      );
      return Number.isNaN(value) ? this.#words.map.noAnswer : measure(this.#words, state.trace, value, units);
    };
    this.#show();
  }

  #setDomain({ model }: Capsule, time: Unit): void {
    const [caLeast = 0, caMost = 1, least = 0, most = 1] = model.ranges();
    const margin = 0.07 * (most - least);
    this.#domain = {
      caRange: [caLeast, caMost],
      confinementRange: [least, most],
      samples: model.samples(),
      steadyLimit: model.steadyLimit(),
      jumpBorder: model.jumpBorder(),
      end: model.endTime,
      time,
    };
    const beyond = caMost + 0.06 * (caMost - caLeast);
    this.#caSpan = [this.#scale === "log" ? caLeast / 1.3 : 0, beyond];
    this.#confinementSpan = [least - margin, most + margin];
    set(this.#handle, { "aria-valuemin": String(this.#caSpan[0]), "aria-valuemax": String(this.#caSpan[1]) });
    if (this.#width > 0) this.#layOut();
  }

  /** Places the current point, the pinned ones and the contours. */
  #show(): void {
    if (this.#width === 0) return;
    const place = ({ ca, confinement }: Point) =>
      [
        clamp(this.#toX(ca), INSET.left, this.#width - INSET.right),
        clamp(this.#toY(confinement), INSET.top, this.#height - INSET.bottom),
      ] as const;
    const [x, y] = place(this.#point);
    for (const circle of [this.#handle, this.#ring, this.#grip]) set(circle, { cx: x, cy: y });
    set(this.#guides, { d: `M${INSET.left} ${y}H${x}V${this.#height - INSET.bottom}` });
    set(this.#handle, {
      "aria-valuenow": String(clamp(this.#point.ca, ...this.#caSpan)),
      "aria-valuetext": `Ca ${short(this.#point.ca)}, a/l ${short(this.#point.confinement)}${this.#misfit()}`,
    });
    this.#drawAnswer();
    this.#writeHint();
    const pins = this.#traces.flatMap(({ name, query }): Element[] => {
      if (name === "live") return [];
      const [ca = 0, confinement = 0] = query.parameters;
      const [px, py] = place({ ca, confinement });
      const mark = svg("circle", { class: traceClass(name), cx: px, cy: py, r: 5 });
      return [mark, written(svg("text", { class: "pin-name", x: px + 8, y: py - 6 }), name)];
    });
    this.#pins.replaceChildren(...pins);
    this.#drawLayer();
  }

  /** The misfit of the chosen point, for its name. */
  #misfit(): string {
    return this.#measured.found === undefined
      ? ""
      : `, ${writtenMisfit(this.#words, this.#measured.misfit(this.#point))}`;
  }

  /** The capsule that fits the measured outline best, with its regions and its verdict. */
  #drawAnswer(): void {
    const { found, regions } = this.#measured;
    this.#answer.replaceChildren();
    if (found === undefined) return;
    const { ca, confinement, alternative } = found.answer;
    const words = this.#words.outline;
    for (const region of regions) drawRegion(this.#answer, region, this.#toX, this.#toY, words);
    if (alternative !== undefined) drawBest(this.#answer, alternative, this.#toX, this.#toY);
    drawBest(this.#answer, { ca, confinement }, this.#toX, this.#toY);
    const [x, y] = [this.#toX(ca), this.#toY(confinement)];
    const isRight = x > this.#width / 2;
    const text = svg(
      "text",
      { class: "region", x: x + (isRight ? -9 : 9), y: y - 9, "text-anchor": isRight ? "end" : "start" },
      this.#answer,
    );
    const [verdict] = words.verdicts[found.answer.verdict] ?? [found.answer.verdict];
    written(text, this.#words.map.bestFit(verdict));
  }

  /** The regions above the levels of the layer, laid over one another, each with its level on its longest ring. */
  #drawLayer(): void {
    if (this.contours === this.#contoured) return;
    this.#contoured = this.contours;
    const { caRange, confinementRange } = this.#domain;
    const at = ([ca, confinement]: readonly [number, number]) =>
      [this.#toX(clamp(ca, ...caRange)), this.#toY(clamp(confinement, ...confinementRange))] as const;
    const off = ([x, y]: readonly [number, number]) => Math.hypot(x - this.#width / 2, y - this.#height / 2);
    const labels: Element[] = [];
    const regions = this.contours.map(({ label: name, rings }) => {
      const drawn = rings.map((ring) => ring.map(at));
      const longest = drawn.reduce((a, b) => (b.length > a.length ? b : a), drawn[0] ?? []);
      // Where the ring comes nearest to the middle there is room for words.
      const [x, y] = longest.reduce((a, b) => (off(b) < off(a) ? b : a), longest[0] ?? [0, 0]);
      if (longest.length > 8)
        labels.push(written(svg("text", { class: "level", x, y: y + 4, "text-anchor": "middle" }), name));
      const d = drawn
        .map((ring) => `M${ring.map(([px, py]) => `${px.toFixed(1)} ${py.toFixed(1)}`).join("L")}Z`)
        .join("");
      return svg("path", { class: "contour", d, "fill-rule": "evenodd" });
    });
    this.#layer.replaceChildren(...regions, ...labels);
  }

  readonly #toX = (ca: number) => {
    const [from, to] = this.#caSpan;
    const [place] = AXES[this.#scale];
    const share = (place(ca) - place(from)) / (place(to) - place(from));
    return INSET.left + share * (this.#width - INSET.left - INSET.right);
  };

  readonly #toY = (confinement: number) => {
    const [from, to] = this.#confinementSpan;
    const bottom = this.#height - INSET.bottom;
    return bottom - ((confinement - from) / (to - from)) * (bottom - INSET.top);
  };

  #layOut(): void {
    const { caRange, confinementRange, samples, steadyLimit } = this.#domain;
    if (steadyLimit.length === 0) return;
    const [toX, toY] = [this.#toX, this.#toY];
    const [left, right, top] = [INSET.left, this.#width - INSET.right, INSET.top];
    const bottom = this.#height - INSET.bottom;
    set(this.#svg, { viewBox: `0 0 ${this.#width} ${this.#height}` });

    const curve: Point[] = [];
    for (let i = 0; i + 1 < steadyLimit.length; i += 2) {
      curve.push({ confinement: steadyLimit[i] ?? 0, ca: steadyLimit[i + 1] ?? 0 });
    }
    this.#contoured = undefined;
    const border = between(curve, confinementRange).map(
      ({ ca, confinement }) => `${toX(Math.min(ca, this.#caSpan[1])).toFixed(2)} ${toY(confinement).toFixed(2)}`,
    );
    const [least, most] = caRange.map(toX) as unknown as Span;
    const [low, high] = confinementRange.map(toY) as unknown as Span;
    const parts: Element[] = [
      svg("rect", { class: "beyond", x: left, y: top, width: right - left, height: bottom - top }),
      svg("rect", { class: "sampled", x: least, y: high, width: most - least, height: low - high }),
      svg("rect", { class: "unsteady", x: least, y: high, width: most - least, height: low - high, fill: this.#fill }),
      svg("path", { class: "steady", d: `M${least} ${low}L${border.join("L")}L${least} ${high}Z` }),
      svg("rect", { class: "border", x: least, y: high, width: most - least, height: low - high }),
      // From left to right, so that the name along it stands upright.
      svg("path", { class: "limit", d: `M${border.toReversed().join("L")}`, id: this.#limitId }),
      this.#nameAlong(this.#limitId, this.#words.map.steadyLimit, "30%"),
      ...this.#jump(),
    ];
    for (let i = 0; this.#hasSamples && i + 1 < samples.length; i += 2) {
      const [ca, confinement] = [samples[i] ?? 0, samples[i + 1] ?? 0];
      const shown = holds(this.#caSpan, ca) && holds(this.#confinementSpan, confinement);
      if (shown) parts.push(svg("circle", { class: "sample", cx: toX(ca), cy: toY(confinement), r: 1.4 }));
    }
    parts.push(svg("path", { d: `M${left} ${top}V${bottom}H${right}`, fill: "none" }));
    const steps = { ca: (this.#caSpan[1] > 0.3 ? 2 : 1) * 0.05, confinement: 0.1 };
    const regular = ticks(...this.#caSpan, steps.ca);
    const marks = { linear: regular, root: [0, 0.01, 0.05, ...regular], log: [0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5] };
    for (const ca of new Set(marks[this.#scale].filter((value) => holds(this.#caSpan, value)))) {
      parts.push(svg("line", { x1: toX(ca), x2: toX(ca), y1: bottom, y2: bottom + 4 }));
      parts.push(written(svg("text", { x: toX(ca), y: bottom + 17, "text-anchor": "middle" }), label(ca)));
    }
    for (const confinement of ticks(...this.#confinementSpan, steps.confinement)) {
      const y = toY(confinement);
      parts.push(svg("line", { x1: left - 4, x2: left, y1: y, y2: y }));
      parts.push(written(svg("text", { x: left - 8, y: y + 4, "text-anchor": "end" }), confinement.toFixed(1)));
    }
    const middle = (left + right) / 2;
    const ca = svg("text", { class: "axis-name symbol", x: middle, y: this.#height - 4, "text-anchor": "middle" });
    const confinement = svg("text", { class: "axis-name symbol", "text-anchor": "middle" });
    confinement.setAttribute("transform", `translate(12 ${(top + bottom) / 2}) rotate(-90)`);
    parts.push(written(ca, "Ca"), written(confinement, "a/ℓ"), ...this.#regionNames());
    this.#ground.replaceChildren(...parts);
  }

  /** A name along a path. */
  #nameAlong(id: string, name: string, startOffset: string): Element {
    const text = svg("text", { class: "region", dy: -5 });
    const along = svg("textPath", { href: `#${id}`, startOffset }, text);
    written(along, name);
    return text;
  }

  /** The border that interpolation does not cross, with its name. */
  #jump(): Element[] {
    const points: string[] = [];
    const { jumpBorder, caRange, confinementRange } = this.#domain;
    for (let i = 0; i + 1 < jumpBorder.length; i += 2) {
      const [confinement, ca] = [jumpBorder[i] ?? 0, jumpBorder[i + 1] ?? 0];
      if (!holds(caRange, ca) || !holds(confinementRange, confinement)) continue;
      points.push(`${this.#toX(ca).toFixed(2)} ${this.#toY(confinement).toFixed(2)}`);
    }
    if (points.length < 2) return [];
    return [
      svg("path", { class: "jump", d: `M${points.toReversed().join("L")}`, id: this.#jumpId }),
      this.#nameAlong(this.#jumpId, this.#words.map.jump, "20%"),
    ];
  }

  /** The name of the region beyond the limit, in its far corner, where it has most room. */
  #regionNames(): Element[] {
    // On the other scales of Ca it is too narrow for words.
    if (this.#scale !== "linear") return [];
    const x = this.#toX(this.#domain.caRange[1]) - 10;
    const y = this.#toY(this.#domain.confinementRange[1]) + 22;
    const line = (text: string, dy: number) =>
      written(svg("text", { class: "region", x, y: y + dy, "text-anchor": "end" }), text);
    const { end, time } = this.#domain;
    const before = time.factor === 1 ? `${end}` : `${tidy(end * time.factor)} ${time.name}`;
    const { unsteady, before: by } = this.#words.map;
    return [line(unsteady, 0), line(by(before), 16)];
  }

  /** Begins to drag. A finger on the bare map may want to scroll the page: there it chooses by a tap. */
  #grasp(event: PointerEvent, target: Element): void {
    if (event.button !== 0 || (event.pointerType === "touch" && target !== this.#grip)) return;
    target.setPointerCapture(event.pointerId);
    event.preventDefault();
    this.#handle.focus();
    if (target !== this.#grip) this.#choose(event);
  }

  #choose(event: MouseEvent): void {
    this.#onChoice(this.#at(event));
  }

  /** The parameters below the mouse, and the chosen read-out there: what a click would give. */
  #preview(event: PointerEvent): void {
    if (event.pointerType !== "mouse" || event.buttons !== 0 || this.#tell === undefined) return;
    this.#hovered = this.#at(event);
    set(this.#hint, { x: INSET.left + 6, y: this.#height - INSET.bottom - 6 });
    this.#writeHint();
  }

  #writeHint(): void {
    const point = this.#hovered;
    if (point === undefined || this.#tell === undefined) return;
    this.#hint.textContent = `Ca ${short(point.ca)}, a/ℓ ${short(point.confinement)}: ${this.#tell(point)}`;
  }

  #at(event: MouseEvent): Point {
    const box = this.#svg.getBoundingClientRect();
    const fine = event.shiftKey ? 5 : 1;
    const place = (pixels: number, size: number, [from, to]: Span) => from + clamp(pixels / size, 0, 1) * (to - from);
    const [toPlace, toCa] = AXES[this.#scale];
    const [from, to] = this.#caSpan;
    const [x, y] = [event.clientX - box.left - INSET.left, box.bottom - event.clientY - INSET.bottom];
    const ca = toCa(place(x, this.#width - INSET.left - INSET.right, [toPlace(from), toPlace(to)]));
    const confinement = place(y, this.#height - INSET.top - INSET.bottom, this.#confinementSpan);
    return { ca: Math.max(rounded(ca, 0.001 / fine), 0.001), confinement: rounded(confinement, 0.005 / fine) };
  }

  #step(event: KeyboardEvent): void {
    const directions: Record<string, [number, number]> = {
      ArrowLeft: [-1, 0],
      ArrowRight: [1, 0],
      ArrowDown: [0, -1],
      ArrowUp: [0, 1],
    };
    const direction = directions[event.key];
    if (direction === undefined) return;
    const share = event.shiftKey ? 0.2 : 1;
    const { ca, confinement } = this.#point;
    // Kept at once: the next key may come before the next frame.
    this.#point = {
      ca: clamp(rounded(ca + direction[0] * STEP.ca * share, 0.001), 0.001, this.#caSpan[1]),
      confinement: clamp(
        rounded(confinement + direction[1] * STEP.confinement * share, 0.002),
        ...this.#confinementSpan,
      ),
    };
    this.#onChoice(this.#point);
    event.preventDefault();
    event.stopPropagation();
  }
}

function written<E extends Element>(element: E, text: string): E {
  element.textContent = text;
  return element;
}
