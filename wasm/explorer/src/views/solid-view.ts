import { button, html, type Root } from "../app/dom";
import type { Answer } from "../model/answer";
import type { Need } from "../model/capsule";
import { cutPoints, loopPoints } from "./cuts";
import type { Cut, Solid, SolidBody, SolidScene } from "./solid";
import type { Context, Trace, ViewPart } from "./view";

const OUTLINES = ["midplane", "diagonal"] as const;

/** The space view: it loads `three` when it is first drawn, and says what to do where there is no WebGL. */
export class SolidView implements ViewPart {
  readonly needs: readonly Need[] = [];
  readonly #stage: HTMLElement;
  /** Undefined until it is first drawn, null where it cannot be made. */
  #solid: Promise<Solid | null> | undefined;
  #made: Solid | null | undefined;
  #triangles: unknown;
  #drawn: readonly [readonly Trace[], Context] | undefined;

  constructor(root: Root) {
    this.#stage = root.part("solid", HTMLElement);
    root.part("reset-camera", HTMLButtonElement).addEventListener("click", () => this.#made?.resetCamera());
  }

  draw(traces: readonly Trace[], context: Context): void {
    this.#drawn = [traces, context];
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

  async #make(): Promise<Solid | null> {
    try {
      const { Solid } = await import("./solid");
      const solid = new Solid(this.#stage, {
        lost: () => this.#say("The browser has taken the graphics card away from this view.", true),
        restored: () => this.#stage.querySelector(".missing")?.remove(),
      });
      this.#made = solid;
    } catch {
      this.#stage.replaceChildren();
      this.#say(
        "This view needs WebGL, which this browser does not offer. The sections and all figures work without it; " +
          "to see the capsule in space, turn on hardware acceleration or use another browser.",
        false,
      );
      this.#made = null;
    }
    return this.#made;
  }

  #say(words: string, isAgain: boolean): void {
    this.#stage.querySelector(".missing")?.remove();
    // Nothing is drawn until the view renders again.
    delete this.#stage.dataset.rendered;
    const message = html("div", { className: "missing" }, html("p", { textContent: words }));
    if (isAgain) message.append(button("Start the 3D view again", () => this.#restart()));
    this.#stage.append(message);
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
    this.#made.draw(sceneOf(traces, context));
  }
}

function sceneOf(traces: readonly Trace[], context: Context): SolidScene | undefined {
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
    return { name, positions: answer.surface(), normals: answer.normals(), shift };
  };
  const bodies = traces.flatMap(({ name, answer }) => (answer === undefined ? [] : [body(name, answer)]));
  // In the centroid's frame the two surfaces would lie in one another; there the sections compare them.
  const start = state.initial && laboratory ? traces[0]?.start() : undefined;
  return {
    bodies,
    initial: start === undefined ? undefined : body("live", start),
    origin: laboratory ? live.centroid : 0,
    factor: context.units.drawn.factor,
    cuts,
  };
}
