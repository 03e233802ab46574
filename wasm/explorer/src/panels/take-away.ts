import { button, html, type Root } from "../app/dom";
import type { State, View } from "../app/schema";
import { figurePng, figureSvg, type Legend, type Picture, picturePng, svgText } from "../export/figure";
import { canFilm, film } from "../export/film";
import { toCsv, toJson } from "../export/numbers";
import { toObj } from "../export/obj";
import { footer, provenance } from "../export/provenance";
import { type ReportFigure, toReport } from "../export/report";
import { save } from "../export/save";
import { toStl } from "../export/stl";
import { toVtp } from "../export/vtp";
import { type Answer, text } from "../model/answer";
import type { Context, Trace } from "../views/view";

/** What the dialog takes from the explorer. */
export interface Source {
  readonly shown: () => readonly [readonly Trace[], Context] | undefined;
  /** The link of what is on screen. */
  readonly link: () => string;
  readonly session: () => string;
  /** The picture of the space view; undefined where there is none. */
  readonly picture: () => HTMLCanvasElement | undefined;
  /** The scale of its colours; undefined where it has none. */
  readonly scale: () => SVGSVGElement | undefined;
  /** Goes to an instant and draws the picture there. */
  readonly seek: (t: number) => void;
}

/** The drawings, by the id of their element. */
const DRAWINGS: readonly (readonly [id: string, view: View | undefined, name: string])[] = [
  ["map", undefined, "Map of the parameters"],
  ["midplane", "midplane", "Longitudinal section"],
  ["diagonal", "diagonal", "Diagonal section"],
  ["transversal", "transversal", "Transversal section"],
  ["plots", "plots", "All read-outs"],
  ["track", undefined, "Read-out along time"],
];

const SPACE = "Capsule in the channel";

/** Frames of an animation. */
const FRAMES = 41;

/** The dialog from which figures, numbers, the surface and the session are saved as files. */
export class TakeAway {
  readonly #root: Root;
  readonly #source: Source;
  readonly #dialog: HTMLDialogElement;

  constructor(root: Root, source: Source) {
    this.#root = root;
    this.#source = source;
    this.#dialog = root.part("take-away", HTMLDialogElement);
    root.part("open-take-away", HTMLButtonElement).addEventListener("click", () => this.#open());
    root.part("close-take-away", HTMLButtonElement).addEventListener("click", () => this.#dialog.close());
  }

  #open(): void {
    const shown = this.#source.shown();
    if (shown === undefined) return;
    const [traces, context] = shown;
    const drawings = DRAWINGS.filter(([id, view]) => {
      const isMap = id !== "map" || context.capsule.has("channel");
      return isMap && (view === undefined || context.shows(view));
    });
    const rows = drawings.map(([id, , name]) => this.#row(name, this.#figureButtons(id, name, traces, context)));
    const picture = context.shows("solid") ? this.#source.picture() : undefined;
    if (picture !== undefined) {
      const save = async () => {
        const shot = this.#picture(traces, context);
        if (shot !== undefined) this.#save("capsule", "png", await picturePng(shot));
      };
      rows.push(this.#row(SPACE, [button("PNG", save)]), this.#filmRow(context.state));
    }
    const link = this.#source.link();
    const report = async () => {
      const figures: ReportFigure[] = drawings.map(([id, , name]) => {
        return { name, drawing: this.#figure(id, name, traces, context) };
      });
      const shot = picture === undefined ? undefined : this.#picture(traces, context);
      if (shot !== undefined) {
        const src = await dataAddress(await picturePng(shot));
        figures.unshift({ name: SPACE, drawing: html("img", { src, alt: SPACE }) });
      }
      return toReport(traces, context, figures, provenance(traces, context, link));
    };
    rows.unshift(
      this.#row("All of it in one page", [button("HTML", async () => this.#save("report", "html", await report()))]),
    );
    rows.push(
      this.#row("Read-outs, now and along time", [
        button("CSV", () => this.#save("readouts", "csv", toCsv(traces, context, provenance(traces, context, link)))),
        button("JSON", () => this.#save("readouts", "json", toJson(traces, context, link))),
      ]),
    );
    const [live] = traces;
    if (live?.answer !== undefined) {
      const buttons = this.#surfaceButtons(live, live.answer, context, provenance(traces, context, link));
      rows.push(this.#row(`Surface, lengths in ${context.units.drawn.plain}`, buttons));
    }
    rows.push(
      this.#row("Session, to open again", [
        button("Save", () => this.#save("session", "json", this.#source.session())),
      ]),
    );
    this.#root.part("take-away-list", HTMLElement).replaceChildren(...rows);
    this.#dialog.showModal();
  }

  #figureButtons(id: string, name: string, traces: readonly Trace[], context: Context): HTMLButtonElement[] {
    const figure = () => this.#figure(id, name, traces, context);
    return [
      button("SVG", () => this.#save(id, "svg", svgText(figure()))),
      button("PNG", async () => this.#save(id, "png", await figurePng(figure()))),
    ];
  }

  #figure(id: string, name: string, traces: readonly Trace[], context: Context): SVGSVGElement {
    return figureSvg(this.#root.part(id, HTMLElement), this.#legend(name, traces, context));
  }

  /** The space view with its words; undefined where there is none. */
  #picture(traces: readonly Trace[], context: Context): Picture | undefined {
    const canvas = this.#source.picture();
    return canvas && { canvas, legend: this.#legend(SPACE, traces, context), scale: this.#source.scale() };
  }

  /** The space view as a film of the whole time; closing the dialog ends it. */
  #filmRow(state: State): HTMLElement {
    const note = html("small", { role: "status" });
    const picture = () => {
      const [traces, context] = this.#source.shown() ?? [];
      return traces?.[0]?.answer && context && this.#picture(traces, context);
    };
    const make = button("MP4", async () => {
      make.disabled = true;
      const onShare = (share: number) => {
        if (!this.#dialog.open) throw new Error("the dialog was closed");
        note.textContent = `${Math.round(100 * share)} %`;
      };
      try {
        this.#save("motion", "mp4", await film(state, this.#source.seek, picture, onShare));
        note.textContent = "";
      } catch (error) {
        note.textContent = `There is no film: ${text(error)}.`;
      }
      this.#source.seek(state.t);
      make.disabled = false;
    });
    if (!canFilm()) {
      make.disabled = true;
      note.textContent = "This browser has no WebCodecs to encode video with.";
    }
    const row = this.#row(`${SPACE}, moving`, [make]);
    row.insertBefore(note, make);
    return row;
  }

  /** The live surface relative to its centroid: as it is, and as it moves. */
  #surfaceButtons(live: Trace, answer: Answer, context: Context, words: readonly string[]): HTMLButtonElement[] {
    const { capsule, units } = context;
    const triangles = capsule.model.triangles();
    const scaled = (of: Answer) => of.surface().map((x) => x * units.drawn.factor);
    const stl = () => toStl(scaled(answer), triangles, footer([live], context));
    const obj = () => toObj(scaled(answer), answer.normals(), triangles, words);
    const vtp = () => {
      const positions = scaled(answer);
      const start = live.start();
      const from = start === undefined ? positions : scaled(start);
      const displacement = positions.map((x, i) => x - (from[i] ?? 0));
      const data = [
        { name: "normal", values: answer.normals(), components: 3 },
        { name: "displacement", values: displacement, components: 3 },
      ] as const;
      return toVtp(positions, triangles, data, words);
    };
    const glb = async () => {
      const { toGlb } = await import("../export/glb");
      const instants = Array.from({ length: FRAMES }, (_, i) => (capsule.model.endTime * i) / (FRAMES - 1));
      const frames = instants.flatMap((t) => {
        const at = capsule.answer("export", live.query, t);
        return at.validity.kind === "refused" ? [] : [{ t, positions: scaled(at), normals: at.normals() }];
      });
      this.#save("motion", "glb", await toGlb(frames, triangles, words));
    };
    return [
      button("STL", () => this.#save("surface", "stl", stl())),
      button("OBJ", () => this.#save("surface", "obj", obj())),
      button("VTP", () => this.#save("surface", "vtp", vtp())),
      button("GLB, moving", glb),
    ];
  }

  #legend(title: string, traces: readonly Trace[], context: Context): Legend {
    const description = provenance(traces, context, this.#source.link()).join("\n");
    return { title, foot: footer(traces, context), description };
  }

  #row(name: string, buttons: readonly HTMLButtonElement[]): HTMLElement {
    for (const one of buttons) one.ariaLabel = `${name}, ${one.textContent}`;
    return html("li", {}, html("span", { textContent: name }), ...buttons);
  }

  /** Gives a file to the browser to save. Its name says the model. */
  #save(name: string, extension: string, content: BlobPart): void {
    const digest = this.#source.shown()?.[1].capsule.model.digest ?? "";
    save(`capsule-${name}-${digest}.${extension}`, content);
  }
}

function dataAddress(content: Blob): Promise<string> {
  const reader = new FileReader();
  return new Promise((read, failed) => {
    reader.addEventListener("load", () => read(String(reader.result)));
    reader.addEventListener("error", () => failed(reader.error));
    reader.readAsDataURL(content);
  });
}
