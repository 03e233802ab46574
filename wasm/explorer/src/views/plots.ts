import { html, type Root } from "../app/dom";
import { ALONG, type Along, QUANTITIES, type Quantity, type State } from "../app/schema";
import type { Store } from "../app/store";
import type { Need } from "../model/capsule";
import { nameOf, PRESENTATION, resolution, unitOf } from "../model/quantities";
import { type Course, type Courses, extremes, pieces } from "./courses";
import { label, onResize, path, set, svg, ticks, tidy } from "./svg";
import { type Context, type Trace, traceClass, type ViewPart } from "./view";

const INSET = { left: 46, right: 8, top: 20, bottom: 20 };

/** All read-outs as small plots, one beside the other: along time, stretched at the start, or along a parameter. */
export class Plots implements ViewPart {
  readonly needs: readonly Need[] = [];
  readonly #courses: Courses;
  readonly #choice: HTMLSelectElement;
  readonly #plots: Plot[];
  #drawn: readonly [readonly Trace[], Context] | undefined;

  constructor(root: Root, store: Store, courses: Courses) {
    this.#courses = courses;
    this.#choice = root.part("along", HTMLSelectElement);
    const options = ALONG.map((value) => html("option", { value }));
    root.speak(({ views }) => {
      for (const [i, value] of ALONG.entries()) options[i]?.replaceChildren(views.along[value]);
    });
    this.#choice.append(...options);
    this.#choice.addEventListener("change", () => {
      const along = ALONG.find((value) => value === this.#choice.value);
      if (along !== undefined) store.set({ along });
    });
    const stage = root.part("plots", HTMLElement);
    const redraw = () => {
      if (this.#drawn !== undefined) this.draw(...this.#drawn);
    };
    this.#plots = QUANTITIES.map((quantity) => new Plot(root, stage, quantity, redraw));
  }

  draw(traces: readonly Trace[], context: Context): void {
    this.#drawn = [traces, context];
    const { state, capsule } = context;
    this.#choice.value = state.along;
    // The parameters of a model that is not one of a capsule in the channel have other names and another number.
    this.#choice.hidden = !capsule.has("channel");
    const along = capsule.has("channel") ? state.along : "time";
    for (const plot of this.#plots) {
      const courses = traces.map(({ name, query }) =>
        along === "time"
          ? this.#courses.alongTime(name, query, plot.quantity, 2)
          : this.#courses.alongParameter(name, query, plot.quantity, along),
      );
      plot.draw(courses, traces, along, context);
    }
  }
}

/** One read-out. */
class Plot {
  readonly quantity: Quantity;
  readonly #svg: SVGSVGElement;
  readonly #axis: SVGGElement;
  readonly #curves: SVGGElement;
  readonly #cursor: SVGLineElement;
  #width = 0;
  #height = 0;
  #key = "";

  constructor(root: Root, stage: HTMLElement, quantity: Quantity, onSize: () => void) {
    this.quantity = quantity;
    this.#svg = svg("svg", { role: "img", class: "plot" }, stage);
    // Until it is drawn, with values.
    root.speak((words) => set(this.#svg, { "aria-label": nameOf(words, quantity, false) }));
    const { plane } = PRESENTATION[quantity];
    if (plane !== undefined) this.#svg.dataset.plane = plane;
    this.#axis = svg("g", { class: "axis" }, this.#svg);
    this.#curves = svg("g", {}, this.#svg);
    this.#cursor = svg("line", { class: "cursor" }, this.#svg);
    // Asked for in a frame, the size would have the browser lay out the page anew.
    onResize(this.#svg, (width, height) => {
      this.#width = width;
      this.#height = height;
      onSize();
    });
  }

  draw(courses: readonly Course[], traces: readonly Trace[], along: Along, context: Context): void {
    const [width, height, first] = [this.#width, this.#height, courses[0]];
    if (width === 0 || first === undefined) return;
    const [from, to] = [first.places[0] ?? 0, first.places.at(-1) ?? 1];
    const place = (at: number) => {
      const share = (at - from) / (to - from);
      return along === "time" ? Math.sqrt(Math.max(share, 0)) : share;
    };
    const toX = (at: number) => INSET.left + place(at) * (width - INSET.left - INSET.right);
    const key = [along, width, height, JSON.stringify(context.units), ...courses.map(({ done }) => done)].join();
    const rest = JSON.stringify([nameOf(context.words, this.quantity, false), traces.map(({ query }) => query)]);
    if (key + rest !== this.#key) {
      this.#key = key + rest;
      const range = this.#range(courses, context);
      const bottom = height - INSET.bottom;
      const toY = (value: number) => bottom - ((value - range[0]) / (range[1] - range[0])) * (bottom - INSET.top);
      set(this.#svg, { viewBox: `0 0 ${width} ${height}`, "aria-label": this.#words(first, along, context) });
      this.#drawAxes(width, height, [from, to], range, toX, toY, along, context);
      const lines = courses.map((course, i) =>
        svg("path", {
          class: `curve ${traceClass(traces[i]?.name ?? "live")}`,
          d: pieces(course)
            .map((points) => path(points, toX, (_, value) => toY(value)))
            .join(""),
        }),
      );
      // The live curve lies over the pinned ones.
      this.#curves.replaceChildren(...lines.reverse());
    }
    const x = toX(placeOf(context.state, along));
    set(this.#cursor, { x1: x, x2: x, y1: INSET.top, y2: height - INSET.bottom });
  }

  #range(courses: readonly Course[], { units }: Context): readonly [number, number] {
    const [low, high] = extremes(courses) ?? [0, 1];
    const least = 20 * resolution(this.quantity, Math.max(Math.abs(low), Math.abs(high)), units);
    const spare = Math.max(0.04 * (high - low), (least - (high - low)) / 2);
    return [low - spare, high + spare];
  }

  #drawAxes(
    width: number,
    height: number,
    [from, to]: readonly [number, number],
    [low, high]: readonly [number, number],
    toX: (at: number) => number,
    toY: (value: number) => number,
    along: Along,
    { units, words }: Context,
  ): void {
    const scale = along === "time" ? units.time.factor : 1;
    const bottom = height - INSET.bottom;
    const { name, factor } = unitOf(this.quantity, units);
    const title = svg("text", { class: "axis-name", x: INSET.left, y: 12 });
    title.textContent = `${nameOf(words, this.quantity, false)} [${name}]`;
    const parts: Element[] = [
      title,
      svg("path", { d: `M${INSET.left} ${INSET.top}V${bottom}H${width - INSET.right}`, fill: "none" }),
    ];
    const text = (content: string, attributes: Record<string, string | number>) => {
      const made = svg("text", attributes);
      made.textContent = content;
      parts.push(made);
    };
    for (const value of ticks(low * factor, high * factor, niceStep((high - low) * factor, 3))) {
      const y = toY(value / factor);
      parts.push(svg("line", { x1: INSET.left - 4, x2: INSET.left, y1: y, y2: y }));
      text(label(value), { x: INSET.left - 6, y: y + 4, "text-anchor": "end" });
    }
    // Along time the end has more room than the start: a hundredth, a twentieth, a quarter, the whole.
    const marks =
      along === "time" ? [0, 0.05, 0.25, 1].map((share) => share * to) : ticks(from, to, niceStep(to - from, 3));
    for (const at of marks) {
      parts.push(svg("line", { x1: toX(at), x2: toX(at), y1: bottom, y2: bottom + 4 }));
      text(label(tidy(at * scale)), {
        x: toX(at),
        y: bottom + 16,
        "text-anchor": at === to ? "end" : "middle",
      });
    }
    this.#axis.replaceChildren(...parts);
  }

  #words(course: Course, along: Along, { units, words }: Context): string {
    const { name, plain, factor } = unitOf(this.quantity, units);
    const found = extremes([course]);
    const digits = (value: number) => String(Number((value * factor).toPrecision(4)));
    const { curve, along: alongs, noValues, span } = words.views;
    const values = found === undefined ? noValues : span(digits(found[0]), digits(found[1]), plain || name);
    return curve(nameOf(words, this.quantity, false), alongs[along], values);
  }
}

const placeOf = ({ t, ca, confinement }: State, along: Along) => ({ time: t, ca, confinement })[along];

/** A round step that divides a span into about `count` pieces. */
function niceStep(span: number, count: number): number {
  const raw = Math.max(span, 1e-12) / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  return power * ([1, 2, 5, 10].find((factor) => factor * power >= raw) ?? 10);
}
