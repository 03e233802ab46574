import { type Capsule, type Domain, type Outline, text } from "../model/capsule";
import { errorMeaning } from "../model/errors";
import { type Action, notify, tieParameters } from "../panels/parameters";
import { ERRORS, nameOf } from "../panels/quantities";
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

/** Where parameters lie that are extrapolated to. */
const WHERE: Record<Exclude<Domain, "inside">, string> = {
  outside: "outside the sampled range",
  "far-from-samples": "far from all samples",
  "beyond-steady-limit": "beyond the largest steady Ca",
};

/** An answer with a bound, one without, or none. */
type Answer = "given" | "extrapolated" | "refused";

/** The open model on screen: after each change one frame, in which every visible part asks the core what it shows. */
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
  #against = "";

  constructor(store: Store) {
    this.#store = store;
    this.#map = new ParameterMap(element("map", HTMLElement), (point) => store.set({ ...point, extrapolate: false }));
    this.#sliders = new ParameterSliders(element("sliders", HTMLElement), (parameters) =>
      store.set({ parameters, extrapolate: false }),
    );
    this.#readouts = new Readouts((trace) => store.set({ trace }));
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
    const meaning = errorMeaning(model);
    this.#against = meaning.against;
    this.#readouts.setErrors(meaning);
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
    const domain = this.#prepare(capsule, state);
    const answer = domain === undefined ? "refused" : this.#show(capsule, state, domain);
    if (answer === "refused") this.#clear(state);
    this.#mark(answer);
    this.#plot(capsule, state, domain);
    if (answer !== "refused" && !state.playing) {
      const names = capsule.model.isChannel ? ["Ca", "a/l"] : capsule.model.parameterNames();
      const words = capsule.parameters(state).map((value, i) => `${names[i]} ${value}`);
      this.#readouts.announce(`${words.join(", ")}, time ${state.t.toFixed(timeDigits(state.end))}`);
    }
  }

  /** Sets the query; a refusal is shown. */
  #prepare(capsule: Capsule, state: State): Domain | undefined {
    try {
      return capsule.prepare(state);
    } catch (error) {
      this.#refuse(capsule, state, text(error));
      return undefined;
    }
  }

  /** Asks for everything visible at the instant and shows it; a refusal is shown. */
  #show(capsule: Capsule, state: State, domain: Domain): Answer {
    const extrapolated = domain !== "inside";
    try {
      capsule.now.goTo(state.t);
      this.#readouts.show((quantity) => capsule.read(quantity), extrapolated);
      this.#time.show(state.t, capsule.read(state.trace));
      this.#drawFigures(capsule, state);
    } catch (error) {
      const t = Number(state.t.toFixed(timeDigits(state.end)));
      this.#refuse(capsule, state, `no answer at t = ${t}: ${text(error)}`);
      return "refused";
    }
    if (!extrapolated) {
      notify(undefined);
      return "given";
    }
    const words = `these parameters lie ${WHERE[domain]}. The expected error is a guess, no bound is known.`;
    notify(`Extrapolated: ${words}`, [this.#nearest(capsule, state)]);
    return "extrapolated";
  }

  /** Shows the core's words and the ways out. */
  #refuse(capsule: Capsule, state: State, words: string): void {
    const actions = [this.#nearest(capsule, state)];
    const positive = !capsule.model.isChannel || (state.ca > 0 && state.confinement > 0);
    if (positive && !state.extrapolate) {
      actions.push({ label: "Extrapolate", run: () => this.#store.set({ extrapolate: true }) });
    }
    notify(`${words.charAt(0).toUpperCase()}${words.slice(1)}.`, actions);
  }

  #nearest(capsule: Capsule, state: State): Action {
    const place = [...capsule.model.nearest(Float64Array.from(capsule.parameters(state)))];
    const [ca = 0, confinement = 0] = place;
    const parameters = capsule.model.isChannel ? { ca, confinement } : { parameters: place };
    return {
      label: `Go to the nearest point inside, ${place.join(", ")}`,
      run: () => this.#store.set({ ...parameters, extrapolate: false }),
    };
  }

  /** Leaves nothing of the answer before on screen, and stays at the instant that the notice speaks of. */
  #clear(state: State): void {
    this.#store.set({ playing: false });
    this.#readouts.clear();
    this.#time.show(state.t, undefined);
    for (const view of [...Object.values(this.#sections), this.#transversal, this.#solid]) {
      view?.draw(undefined);
    }
  }

  #mark(answer: Answer): void {
    document.body.dataset.answer = answer;
    const suffix = { given: "", extrapolated: ", extrapolated", refused: ": there is no shape to show" }[answer];
    element("figures", HTMLElement).ariaLabel = `Views of the capsule${suffix}`;
  }

  /** Plots the chosen read-out when the query or the choice has changed. */
  #plot(capsule: Capsule, state: State, domain: Domain | undefined): void {
    const { method, extrapolate, trace } = state;
    const wanted = JSON.stringify([capsule.parameters(state), method, extrapolate, trace]);
    if (wanted === this.#plotted) return;
    this.#plotted = wanted;
    if (domain === undefined) {
      this.#time.plot(undefined);
      return;
    }
    const extrapolated = domain !== "inside";
    const name = `${extrapolated ? "Extrapolated: " : ""}${nameOf(trace, extrapolated)}`;
    const title = ERRORS.has(trace) ? `${name} ${this.#against}` : name;
    this.#time.plot({ quantity: trace, title, read: (t) => capsule.readAt(t, trace) });
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
        initial: state.initial ? capsule.initial(name) : undefined,
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

  /** The numbers of the state, for scripts that drive the page: drawn first where the next frame still has to do it. */
  read(): Record<string, number | string | boolean> {
    const { state } = this.#store;
    if (this.#frame !== 0 && this.#capsule !== undefined) this.#draw(this.#capsule, state);
    const figures = Object.fromEntries(
      [...document.querySelectorAll<HTMLOutputElement>("output[data-value]")].map((output) => [
        output.dataset.quantity as Quantity,
        Number(output.dataset.value),
      ]),
    );
    const { ca, confinement, parameters, t, method } = state;
    const query = parameters.length > 0 ? { parameters: parameters.join(",") } : { ca, confinement };
    return { ...query, t, method, answer: document.body.dataset.answer ?? "refused", ...figures };
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
    initial: state.initial && state.frame === "laboratory" ? capsule.initial("surface") : undefined,
    centroid,
    frame: state.frame,
    cuts,
  };
}
