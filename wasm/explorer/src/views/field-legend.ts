import type { Root } from "../app/dom";
import type { Frame } from "../app/schema";
import type { Store } from "../app/store";
import type { Messages } from "../messages/en";
import { FIELD_PRESENTATION, type FieldName, fieldName } from "../model/fields";
import type { Units } from "../model/units";
import type { ColourMap, colours } from "./colours";
import { label, set, svg } from "./svg";

const WIDTH = 236;
const HEIGHT = 46;
const BAR = { x: 14, y: 18, width: WIDTH - 28, height: 10 };
const STOPS = 17;

/** A field on screen. */
export interface FieldShown {
  readonly field: FieldName;
  readonly frame: Frame;
  readonly map: ColourMap;
  /** The least and the greatest value at the nodes, in the model's unit. */
  readonly extremes: readonly [number, number];
  /** The values at the ends of the colours. */
  readonly span: readonly [number, number];
}

/** What the colours in space mean: the field, its unit and values. */
export class FieldLegend {
  readonly #figure: HTMLElement;
  readonly #hold: HTMLInputElement;
  readonly #title: SVGTextElement;
  readonly #svg: SVGSVGElement;
  readonly #stops: SVGStopElement[];
  readonly #ends: SVGTextElement[];
  readonly #colours: typeof colours;
  #map: ColourMap | undefined;
  #shown: FieldShown | undefined;

  constructor(root: Root, store: Store, colourMap: typeof colours) {
    this.#colours = colourMap;
    this.#figure = root.part("field", HTMLElement);
    this.#hold = root.part("hold-range", HTMLInputElement);
    this.#hold.addEventListener("change", () => {
      store.set({ range: this.#hold.checked && this.#shown !== undefined ? this.#shown.span : [] });
    });
    this.#svg = svg("svg", { role: "img", viewBox: `0 0 ${WIDTH} ${HEIGHT}`, width: WIDTH, height: HEIGHT });
    const id = root.id("field-colours");
    const gradient = svg("linearGradient", { id }, svg("defs", {}, this.#svg));
    this.#stops = Array.from({ length: STOPS }, (_, i) => svg("stop", { offset: i / (STOPS - 1) }, gradient));
    svg("rect", { ...BAR, fill: `url(#${id})` }, this.#svg);
    this.#title = svg("text", { x: WIDTH / 2, y: 12, class: "axis-name", "text-anchor": "middle" }, this.#svg);
    this.#ends = [0, 0.5, 1].map((share) =>
      svg("text", { x: BAR.x + share * BAR.width, y: HEIGHT - 4, "text-anchor": "middle" }, this.#svg),
    );
    root.part("field-scale", HTMLElement).replaceChildren(this.#svg);
  }

  /** The scale as it is drawn; undefined where there are no colours. */
  get drawing(): SVGSVGElement | undefined {
    return this.#shown === undefined ? undefined : this.#svg;
  }

  draw(shown: FieldShown | undefined, units: Units, isHeld: boolean, words: Messages): void {
    this.#shown = shown;
    this.#figure.hidden = shown === undefined;
    if (shown === undefined) return;
    this.#hold.checked = isHeld;
    if (shown.map !== this.#map) {
      this.#map = shown.map;
      this.#colours(shown.map, STOPS).forEach((colour, i) => {
        this.#stops[i]?.setAttribute("stop-color", colour);
      });
    }
    const unit = FIELD_PRESENTATION[shown.field].unit(units);
    const [from, to] = shown.span;
    // Hundredths of the span, and no zeros at the end.
    const digits = Math.min(12, Math.max(0, 2 - Math.floor(Math.log10((to - from) * unit.factor))));
    const written = (value: number) => label(Number((value * unit.factor).toFixed(digits)) + 0);
    const name = fieldName(words, shown.field, shown.frame);
    this.#title.textContent = unit.name === "" ? name : `${name} [${unit.name}]`;
    this.#ends.forEach((end, i) => {
      end.textContent = written(from + (i / 2) * (to - from));
    });
    const [least, most] = shown.extremes;
    const range = `${written(most)} ${unit.plain}`.trim();
    set(this.#svg, { "aria-label": words.fields.colours(name, written(least), range) });
    Object.assign(this.#figure.dataset, { least: String(least), most: String(most) });
  }
}
