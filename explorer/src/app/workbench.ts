import { type Capsule, type Outline, text } from "../model/capsule";
import { notify, tieParameters } from "../panels/parameters";
import { Readouts } from "../panels/readouts";
import { ParameterSliders } from "../panels/sliders";
import { stepped, TimeAxis, timeDigits } from "../panels/time-axis";
import { tieTransport } from "../panels/transport";
import { cutPoints, loopPoints } from "../views/cuts";
import { Longitudinal } from "../views/longitudinal";
import { ParameterMap } from "../views/map";
import { type Cut, Solid, type SolidScene } from "../views/solid";
import { Transversal } from "../views/transversal";
import { element, html } from "./page";
import type { Quantity, State, Store, View } from "./state";
import { Visibility } from "./visibility";

const OUTLINES: readonly Outline[] = ["midplane", "diagonal"];

/** The open model on screen: after each change one frame, in which every visible part asks the core for what it shows. */
export class Workbench {
  readonly #store: Store;
  readonly #map: ParameterMap;
  readonly #sliders: ParameterSliders;
  readonly #readouts: Readouts;
  readonly #time: TimeAxis;
  /** Made when it is first shown; null where there is no WebGL. */
  #solid: Solid | null | undefined;
  readonly #sections: Record<Outline, Longitudinal>;
  readonly #transversal: Transversal;
  readonly #visible: Visibility;
  #capsule: Capsule | undefined;
  #frame = 0;
  #lastFrame = 0;
  #plotted = "";

  constructor(store: Store) {
    this.#store = store;
    this.#map = new ParameterMap(element("map", HTMLElement), (point) => store.set({ ...point, extrapolate: false }));
    this.#sliders = new ParameterSliders(element("sliders", HTMLElement), (parameters) =>
      store.set({ parameters, extrapolate: false }),
    );
    const announcement = element("announcement", HTMLElement);
    this.#readouts = new Readouts(element("readouts", HTMLElement), announcement, (trace) => store.set({ trace }));
    const slider = element("time", HTMLInputElement);
    this.#time = new TimeAxis(
      element("track", HTMLElement),
      slider,
      (t) => store.set({ t }),
      (step) => {
        const { t, end } = store.state;
        store.set({ t: stepped(t, step, end) });
      },
    );
    const onSection = (section: number) => store.set({ section: Math.min(1.5, Math.max(-1.5, section)) });
    this.#sections = {
      midplane: new Longitudinal(element("midplane", HTMLElement), "plane z = 0", 1, onSection),
      diagonal: new Longitudinal(element("diagonal", HTMLElement), "diagonal plane y = z", Math.SQRT2, onSection),
    };
    this.#transversal = new Transversal(element("transversal", HTMLElement));
    this.#visible = new Visibility(document.querySelectorAll("figure[data-view]"), () => this.#request());

    tieParameters(store);
    tieTransport(store);
    element("reset-camera", HTMLButtonElement).addEventListener("click", () => this.#solid?.resetCamera());
    window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.#solid?.recolour());
    store.subscribe(() => this.#request());
  }

  /** Puts a model on screen, in place of the one before. */
  open(capsule: Capsule): void {
    this.#capsule?.free();
    this.#capsule = capsule;
    this.#plotted = "";
    const { model } = capsule;
    const ranges = model.ranges();
    const end = model.endTime;
    const [length = "", velocity = "", time = ""] = model.units();
    // What belongs to the channel, and the views along planes of symmetry, are shown only where they exist.
    document.body.dataset.model = model.isChannel ? "channel" : "other";
    document.body.dataset.outlines = String(model.hasOutlines);
    if (model.isChannel) {
      const [caLeast = 0, caMost = 1, confinementLeast = 0, confinementMost = 1] = ranges;
      this.#map.setDomain({
        caRange: [caLeast, caMost],
        confinementRange: [confinementLeast, confinementMost],
        samples: model.samples(),
        steadyLimit: model.steadyLimit(),
        end,
      });
    }
    const parameters = model.isChannel ? [] : this.#sliders.offer(model.parameterNames(), ranges, this.#store.state);
    const units = model.isChannel ? { length: "ℓ", velocity: "V" } : { length, velocity };
    this.#readouts.setUnits(units);
    element("time-unit", HTMLElement).textContent = model.isChannel ? "ℓ/V" : time;
    this.#time.setEnd(end, model.isChannel ? "l/V" : time);
    this.#solid?.setTriangles(model.triangles());
    this.#solid?.setChannel(model.isChannel);
    this.#store.set({ parameters, end, t: Math.min(Math.max(this.#store.state.t, 0), end), playing: false });
    this.#request();
  }

  #request(): void {
    if (this.#frame === 0) this.#frame = requestAnimationFrame((time) => this.#onFrame(time));
  }

  #onFrame(time: number): void {
    this.#frame = 0;
    const { state } = this.#store;
    if (state.playing) {
      // A page that was in the background goes on from where it was.
      const elapsed = this.#lastFrame === 0 ? 0 : Math.min(time - this.#lastFrame, 100) / 1000;
      // The whole of a model plays in 20 s at speed 1, as the channel's 20 l/V do.
      const t = Math.min(state.t + (elapsed * state.speed * state.end) / 20, state.end);
      this.#lastFrame = time;
      this.#store.set({ t, playing: t < state.end });
      this.#request();
    } else {
      this.#lastFrame = 0;
    }
    if (this.#capsule !== undefined) this.#draw(this.#capsule, this.#store.state);
  }

  #draw(capsule: Capsule, state: State): void {
    if (capsule.model.isChannel) this.#map.show(state);
    else this.#sliders.show(state.parameters);
    this.#readouts.mark(state.trace);
    const answered = this.#answer(capsule, state);
    document.body.dataset.answer = answered ? "given" : "refused";
    this.#plot(capsule, state, answered);
    if (!answered) {
      this.#readouts.show(undefined);
      this.#time.show(state.t, undefined);
    } else if (!state.playing) {
      const names = capsule.model.isChannel ? ["Ca", "a/l"] : capsule.model.parameterNames();
      const words = capsule.parameters(state).map((value, i) => `${names[i]} ${value}`);
      this.#readouts.announce(`${words.join(", ")}, time ${state.t.toFixed(timeDigits(state.end))}`);
    }
  }

  /** Asks for everything visible and shows it; when the core refuses, its words and a way out are shown. */
  #answer(capsule: Capsule, state: State): boolean {
    const isChannel = capsule.model.isChannel;
    const place = [...capsule.model.nearest(Float64Array.from(capsule.parameters(state)))];
    const [ca = 0, confinement = 0] = place;
    const nearest = {
      label: `Go to the nearest point inside, ${place.join(", ")}`,
      run: () => this.#store.set({ ...(isChannel ? { ca, confinement } : { parameters: place }), extrapolate: false }),
    };
    try {
      const domain = capsule.prepare(state);
      capsule.now.goTo(state.t);
      this.#readouts.show((quantity) => capsule.read(quantity));
      this.#time.show(state.t, capsule.read(state.trace));
      this.#drawFigures(capsule, state);
      if (domain === "inside") {
        notify(undefined);
      } else {
        const where = {
          outside: "outside the sampled range",
          "far-from-samples": "far from all samples",
          "beyond-steady-limit": "beyond the largest steady Ca",
        }[domain];
        notify(`Extrapolated: these parameters lie ${where}, so no figure here is backed by the model.`, [nearest]);
      }
      return true;
    } catch (error) {
      const extrapolate = { label: "Extrapolate", run: () => this.#store.set({ extrapolate: true }) };
      const words = text(error);
      const positive = !isChannel || (state.ca > 0 && state.confinement > 0);
      notify(`${words.charAt(0).toUpperCase()}${words.slice(1)}.`, positive ? [nearest, extrapolate] : [nearest]);
      return false;
    }
  }

  /** Plots the chosen read-out when the query or the choice has changed. */
  #plot(capsule: Capsule, state: State, answered: boolean): void {
    const { method, extrapolate, trace } = state;
    const wanted = JSON.stringify([capsule.parameters(state), method, extrapolate, trace, answered]);
    if (wanted === this.#plotted) return;
    this.#plotted = wanted;
    const read = (t: number) => capsule.readAt(t, trace);
    this.#time.plot(trace, answered ? read : undefined);
  }

  #drawFigures(capsule: Capsule, state: State): void {
    const exists = (view: View) => capsule.model.hasOutlines || (view !== "midplane" && view !== "diagonal");
    const shown = (view: View) => state.views.has(view) && exists(view);
    const seen = (view: View) => shown(view) && this.#visible.has(figure(view));
    const centroid = capsule.centroid();
    const needsSection = seen("transversal") || (seen("solid") && shown("transversal"));
    const curves = needsSection ? capsule.transversal(state.section) : [];

    const outlines = new Map<Outline, Float32Array>();
    for (const name of OUTLINES) {
      if (seen(name) || (seen("solid") && shown(name))) outlines.set(name, capsule.outline(name));
    }
    for (const name of OUTLINES) {
      const outline = outlines.get(name);
      if (outline === undefined || !seen(name)) continue;
      this.#sections[name].draw({
        outline,
        initial: state.initial ? capsule.initialOutline(name) : undefined,
        centroid,
        frame: state.frame,
        section: shown("transversal") ? state.section : undefined,
      });
    }
    if (seen("transversal")) {
      this.#transversal.draw({ curves, midplane: shown("midplane"), diagonal: shown("diagonal") });
    }
    if (seen("solid")) {
      if (this.#solid === undefined) {
        this.#solid = solid(capsule.model.triangles());
        this.#solid?.setChannel(capsule.model.isChannel);
      }
      this.#solid?.draw(solidScene(capsule, state, centroid, outlines, curves[0]));
    }
  }

  /** The numbers on screen, for scripts that drive the page. */
  read(): Record<string, number | string | boolean> {
    const { state } = this.#store;
    const figures = Object.fromEntries(
      [...document.querySelectorAll<HTMLOutputElement>("output[data-value]")].map((output) => [
        output.dataset.quantity as Quantity,
        Number(output.dataset.value),
      ]),
    );
    const { ca, confinement, parameters, t, method } = state;
    const query = parameters.length > 0 ? { parameters: parameters.join(",") } : { ca, confinement };
    return { ...query, t, method, ...figures };
  }
}

function figure(view: View): Element {
  const found = document.querySelector(`figure[data-view="${view}"]`);
  if (found === null) throw new Error(`index.html has no figure for the view ${view}`);
  return found;
}

/** The space view, or a word of explanation in its place: everything else works without WebGL. */
function solid(triangles: Uint32Array): Solid | null {
  const stage = element("solid", HTMLElement);
  try {
    const view = new Solid(stage);
    view.setTriangles(triangles);
    return view;
  } catch {
    stage.replaceChildren(
      html("p", {
        className: "missing",
        textContent:
          "This view needs WebGL, which this browser does not offer. The sections and all figures work without it; " +
          "to see the capsule in space, turn on hardware acceleration or use another browser.",
      }),
    );
    return null;
  }
}

function solidScene(
  capsule: Capsule,
  state: State,
  centroid: number,
  outlines: ReadonlyMap<Outline, Float32Array>,
  section: Float32Array | undefined,
): SolidScene {
  const cuts: { plane: Cut; points: Float32Array }[] = [];
  for (const [plane, outline] of outlines) {
    if (state.views.has(plane)) cuts.push({ plane, points: cutPoints(outline, centroid, plane) });
  }
  if (section !== undefined) cuts.push({ plane: "transversal", points: loopPoints(section, state.section) });
  return {
    positions: capsule.surface(),
    // In the centroid's frame the two surfaces would lie in one another; there the sections compare them.
    initial: state.initial && state.frame === "laboratory" ? capsule.initialSurface() : undefined,
    centroid,
    frame: state.frame,
    cuts,
  };
}
