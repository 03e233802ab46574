import { html, type Root } from "../app/dom";
import type { Jobs } from "../app/jobs";
import { LAYERS, type Layer, SCALES, type Scale } from "../app/schema";
import type { Store } from "../app/store";
import type { Measured } from "../identify/measured";
import type { Messages } from "../messages/en";
import type { Need } from "../model/capsule";
import { ERRORS, nameOf, unitOf } from "../model/quantities";
import type { ParameterMap } from "../views/map";
import { MapLayer } from "../views/map-layer";
import type { Context, Trace, ViewPart } from "../views/view";
import { shownTime } from "./time-axis";

const SCALE_NAMES: Record<Scale, string> = { linear: "Ca", root: "√Ca", log: "log Ca" };
/** How long time must be at rest before the layer of an instant is computed. */
const REST_MS = 150;

/** The choices above the map: a read-out as contours, the scale of Ca, the samples. */
export class MapChoices implements ViewPart {
  readonly needs: readonly Need[] = ["channel"];
  readonly #map: ParameterMap;
  readonly #measured: Measured;
  readonly #layer: MapLayer;
  readonly #quantity: HTMLSelectElement;
  readonly #scale: HTMLSelectElement;
  readonly #samples: HTMLInputElement;
  readonly #legend: HTMLElement;
  #resting = 0;

  constructor(root: Root, store: Store, map: ParameterMap, measured: Measured, jobs: Jobs, redraw: () => void) {
    this.#map = map;
    this.#measured = measured;
    this.#layer = new MapLayer(jobs, "layer", redraw);
    this.#quantity = root.part("layer", HTMLSelectElement);
    this.#scale = root.part("scale", HTMLSelectElement);
    this.#samples = root.part("samples", HTMLInputElement);
    this.#legend = root.part("map-legend", HTMLElement);
    const layers = LAYERS.map((value) => html("option", { value }));
    root.speak((words) => {
      for (const [i, layer] of LAYERS.entries()) layers[i]?.replaceChildren(layerName(words, layer));
    });
    this.#quantity.append(...layers);
    this.#scale.append(...SCALES.map((value) => html("option", { value, textContent: SCALE_NAMES[value] })));
    this.#quantity.addEventListener("change", () => {
      const layer = LAYERS.find((value) => value === this.#quantity.value);
      if (layer !== undefined) store.set({ layer });
    });
    this.#scale.addEventListener("change", () => {
      const scale = SCALES.find((value) => value === this.#scale.value);
      if (scale !== undefined) store.set({ scale });
    });
    this.#samples.addEventListener("change", () => store.set({ samples: this.#samples.checked }));
  }

  draw(_: readonly Trace[], { state, capsule, units, errors, words }: Context): void {
    this.#quantity.value = state.layer;
    this.#scale.value = state.scale;
    this.#samples.checked = state.samples;
    window.clearTimeout(this.#resting);
    const { layer, method, t } = state;
    if (layer === "none" || layer === "misfit" || !capsule.has("channel")) {
      this.#layer.ask(capsule, undefined, units);
      this.#legend.textContent = layer === "misfit" ? this.#ofMisfit(words.map) : "";
    } else if (!state.playing) {
      this.#resting = window.setTimeout(() => this.#layer.ask(capsule, { quantity: layer, method, t }, units), REST_MS);
      const against = ERRORS.has(layer) ? ` ${errors.against}` : "";
      const at = shownTime(t, state.end, units);
      const name = nameOf(words, layer, false);
      this.#legend.textContent = words.map.contours(name, at, unitOf(layer, units).name, against);
    }
    this.#map.contours = layer === "misfit" ? this.#measured.layer : this.#layer.contours;
  }

  #ofMisfit(words: Messages["map"]): string {
    const { found, share } = this.#measured;
    if (found === undefined) return words.noOutline;
    return words.misfitContours(share === 1 ? "" : words.computed(Math.round(100 * share)));
  }
}

function layerName(words: Messages, layer: Layer): string {
  return layer === "none" || layer === "misfit" ? words.map.layers[layer] : words.quantities[layer];
}
