import { button, html, type Root } from "../app/dom";
import type { Camera } from "../app/schema";
import type { Store } from "../app/store";
import type { Messages } from "../messages/en";
import type { Answer } from "../model/answer";
import type { Need } from "../model/capsule";
import { colourSpan, extremesOf, FIELD_PRESENTATION, isMechanics } from "../model/fields";
import { cutPoints, loopPoints } from "./cuts";
import { FieldLegend, type FieldShown } from "./field-legend";
import { type FlowProfile, flowLines, flowProfile, REACH_OF_V } from "./flow";
import type { Cut, Solid, SolidBody, SolidScene } from "./solid";
import { SolidControls } from "./solid-controls";
import type { Context, Trace, ViewPart } from "./view";

/** Where the arrows of the flow begin in the laboratory frame, from the centroid, in l. */
const FLOW_AT = -3.2;
const OUTLINES = ["midplane", "diagonal"] as const;

/** The space view: it loads `three` when it is first drawn, and says what to do where there is no WebGL. */
export class SolidView implements ViewPart {
  readonly needs: readonly Need[] = [];
  readonly #root: Root;
  readonly #store: Store;
  readonly #stage: HTMLElement;
  readonly #controls: SolidControls;
  #legend: FieldLegend | undefined;
  #camera: Camera = "oblique";
  /** Undefined until it is first drawn, null where it cannot be made. */
  #solid: Promise<Solid | null> | undefined;
  #made: Solid | null | undefined;
  #triangles: unknown;
  /** Says what stands in place of the picture. */
  #tell: ((words: Messages["space"]) => void) | undefined;
  #drawn: readonly [readonly Trace[], Context] | undefined;

  constructor(root: Root, store: Store) {
    this.#root = root;
    this.#store = store;
    this.#stage = root.part("solid", HTMLElement);
    root.speak(({ page, space }) => {
      this.#stage.dataset.none = page.noShape;
      this.#made?.speak(space);
      this.#tell?.(space);
    });
    this.#controls = new SolidControls(root, store, (from) => this.#look(from));
  }

  draw(traces: readonly Trace[], context: Context): void {
    this.#drawn = [traces, context];
    this.#controls.draw(context.state, context.capsule);
    if (this.#solid === undefined && traces.length > 0) {
      this.#stage.dataset.loading = "";
      this.#solid = this.#make();
      this.#solid.then(() => {
        delete this.#stage.dataset.loading;
        this.#redraw();
      });
    }
    this.#redraw();
  }

  /** Takes the theme's colours anew. */
  recolour(): void {
    this.#made?.recolour();
  }

  /** The picture as it is on screen; undefined where there is none. */
  picture(): HTMLCanvasElement | undefined {
    return this.#made?.picture();
  }

  /** The scale of its colours; undefined where there are none. */
  get scale(): SVGSVGElement | undefined {
    return this.#legend?.drawing;
  }

  #look(from: Camera): void {
    this.#camera = from;
    this.#made?.look(from);
  }

  async #make(): Promise<Solid | null> {
    try {
      const [{ Solid }, { colours }] = await Promise.all([import("./solid"), import("./colours")]);
      const solid = new Solid(this.#stage, {
        lost: () => this.#say(({ lost }) => lost, true),
        restored: () => this.#clear(),
      });
      solid.speak(this.#root.words.space);
      solid.look(this.#camera);
      this.#legend ??= new FieldLegend(this.#root, this.#store, colours);
      this.#made = solid;
    } catch {
      this.#stage.replaceChildren();
      this.#say(({ noWebGl }) => noWebGl, false);
      this.#made = null;
    }
    return this.#made;
  }

  #say(say: (words: Messages["space"]) => string, isAgain: boolean): void {
    this.#clear();
    // Nothing is drawn until the view renders again.
    delete this.#stage.dataset.rendered;
    const words = html("p");
    const restart = button("", () => this.#restart());
    this.#stage.append(html("div", { className: "missing" }, words, ...(isAgain ? [restart] : [])));
    this.#tell = (space) => {
      words.textContent = say(space);
      restart.textContent = space.startAgain;
    };
    this.#tell(this.#root.words.space);
  }

  #clear(): void {
    this.#stage.querySelector(".missing")?.remove();
    this.#tell = undefined;
  }

  /** Makes the view anew, with a new context. */
  #restart(): void {
    this.#made?.dispose();
    this.#made = undefined;
    this.#solid = undefined;
    this.#triangles = undefined;
    this.#stage.replaceChildren();
    if (this.#drawn !== undefined) this.draw(...this.#drawn);
  }

  #redraw(): void {
    if (!this.#made || this.#drawn === undefined) return;
    const [traces, context] = this.#drawn;
    if (this.#triangles !== context.capsule) {
      this.#triangles = context.capsule;
      this.#made.setTriangles(context.capsule.model.triangles());
      this.#made.setChannel(context.capsule.has("channel"));
    }
    if (context.state.camera !== this.#camera) this.#look(context.state.camera);
    const field = fieldOf(traces, context);
    this.#legend?.draw(field, context.units, context.state.range.length > 0, context.words);
    this.#made.draw(sceneOf(traces, context, field));
  }
}

/** The field that the membranes are coloured by; undefined where there is none, or where it is not finite. */
function fieldOf(traces: readonly Trace[], { state, capsule }: Context): FieldShown | undefined {
  const { colour: field, frame, range } = state;
  const answers = traces.flatMap(({ answer }) => answer ?? []);
  if (field === "none" || answers.length === 0 || (isMechanics(field) && !capsule.has("mechanics"))) return undefined;
  try {
    const extremes = extremesOf(answers.map((answer) => answer.field(field, frame)));
    const [from, to] = range;
    const span = from === undefined || to === undefined ? colourSpan(field, extremes) : ([from, to] as const);
    const map = FIELD_PRESENTATION[field].centre === undefined ? "sequential" : "diverging";
    return { field, frame, map, extremes, span };
  } catch {
    return undefined;
  }
}

/** Coordinates in the colour map's texture for a field at the vertices. */
function coordinates(values: Float32Array, [from, to]: readonly [number, number]): Float32Array {
  const found = new Float32Array(2 * values.length);
  const scale = 1 / (to - from);
  for (let i = 0; i < values.length; i++) found[2 * i] = ((values[i] ?? from) - from) * scale;
  return found;
}

function sceneOf(traces: readonly Trace[], context: Context, field: FieldShown | undefined): SolidScene | undefined {
  const { state } = context;
  const live = traces[0]?.answer;
  if (live === undefined) return undefined;
  const cuts: { plane: Cut; points: Float32Array }[] = [];
  for (const name of OUTLINES) {
    if (context.shows(name)) cuts.push({ plane: name, points: cutPoints(live.outline(name), live.centroid, name) });
  }
  const [section] = context.shows("transversal") ? live.transversal(state.section) : [];
  if (section !== undefined) cuts.push({ plane: "transversal", points: loopPoints(section, state.section) });
  const laboratory = state.frame === "laboratory";
  const body = (name: Trace["name"], answer: Answer): SolidBody => {
    const shift = laboratory ? answer.centroid - live.centroid : 0;
    return { name, positions: answer.surface(), normals: answer.normals(), shift, colours: undefined };
  };
  const painted = (answer: Answer) =>
    field === undefined ? undefined : coordinates(answer.fieldDrawn(field.field, field.frame), field.span);
  const bodies = traces.flatMap(({ name, answer }) =>
    answer === undefined ? [] : [{ ...body(name, answer), colours: painted(answer) }],
  );
  // In the centroid's frame the two surfaces would lie in one another; there the sections compare them.
  const start = state.initial && laboratory ? traces[0]?.start() : undefined;
  return {
    bodies,
    initial: start === undefined ? undefined : body("live", start),
    origin: laboratory ? live.centroid : 0,
    factor: context.units.drawn.factor,
    cuts,
    map: field?.map ?? "sequential",
    clip: state.clip,
    flow: state.profile && context.capsule.has("channel") ? flowLines(...flowOf(live, laboratory)) : undefined,
  };
}

/** The undisturbed flow in the frame, and where its arrows begin: with the capsule they point both ways. */
function flowOf(live: Answer, isLaboratory: boolean): [FlowProfile, number] {
  const frame = isLaboratory ? 0 : (live.read("velocity") ?? 0);
  return [flowProfile(frame), FLOW_AT + REACH_OF_V * frame];
}
