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
import type { Messages } from "../messages/en";
import type { Answer } from "../model/answer";
import { text } from "../model/refusal";
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
const DRAWINGS: readonly (readonly [id: string, view: View | undefined, name: (words: Messages) => string])[] = [
  ["map", undefined, (words) => words.export.map],
  ["midplane", "midplane", (words) => words.page.midplane],
  ["diagonal", "diagonal", (words) => words.page.diagonal],
  ["transversal", "transversal", (words) => words.page.transversal],
  ["plots", "plots", (words) => words.page.plots],
  ["track", undefined, (words) => words.export.track],
];

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
    root.part("close-take-away", HTMLButtonElement).addEventListener("click", () => this.#dialog.close());
  }

  open(): void {
    const shown = this.#source.shown();
    if (shown === undefined) return;
    const [traces, context] = shown;
    const { page, export: words } = context.words;
    const drawings = DRAWINGS.filter(([id, view]) => {
      const isMap = id !== "map" || context.capsule.has("channel");
      return isMap && (view === undefined || context.shows(view));
    });
    const named = drawings.map(([id, , name]) => [id, name(context.words)] as const);
    const rows = named.map(([id, name]) => this.#row(name, this.#figureButtons(id, name, traces, context)));
    const picture = context.shows("solid") ? this.#source.picture() : undefined;
    if (picture !== undefined) {
      const save = async () => {
        const shot = this.#picture(traces, context);
        if (shot !== undefined) this.#save("capsule", "png", await picturePng(shot));
      };
      rows.push(this.#row(page.solid, [button("PNG", save)]), this.#filmRow(context.state));
    }
    const link = this.#source.link();
    const report = async () => {
      const figures: ReportFigure[] = named.map(([id, name]) => {
        return { name, drawing: this.#figure(id, name, traces, context) };
      });
      const shot = picture === undefined ? undefined : this.#picture(traces, context);
      if (shot !== undefined) {
        const src = await dataAddress(await picturePng(shot));
        figures.unshift({ name: page.solid, drawing: html("img", { src, alt: page.solid }) });
      }
      return toReport(traces, context, figures, provenance(traces, context, link), this.#root.language);
    };
    rows.unshift(this.#row(words.whole, [button("HTML", async () => this.#save("report", "html", await report()))]));
    rows.push(
      this.#row(words.numbers, [
        button("CSV", () => this.#save("readouts", "csv", toCsv(traces, context, provenance(traces, context, link)))),
        button("JSON", () => this.#save("readouts", "json", toJson(traces, context, link))),
      ]),
    );
    const [live] = traces;
    if (live?.answer !== undefined) {
      const buttons = this.#surfaceButtons(live, live.answer, context, provenance(traces, context, link));
      rows.push(this.#row(words.surface(context.units.drawn.plain), buttons));
    }
    rows.push(
      this.#row(words.session, [button(words.save, () => this.#save("session", "json", this.#source.session()))]),
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
    return (
      canvas && { canvas, legend: this.#legend(context.words.page.solid, traces, context), scale: this.#source.scale() }
    );
  }

  /** The space view as a film of the whole time; closing the dialog ends it. */
  #filmRow(state: State): HTMLElement {
    const { page, export: words } = this.#root.words;
    const note = html("small", { role: "status" });
    const picture = () => {
      const [traces, context] = this.#source.shown() ?? [];
      return traces?.[0]?.answer && context && this.#picture(traces, context);
    };
    const make = button("MP4", async () => {
      make.disabled = true;
      const onShare = (share: number) => {
        if (!this.#dialog.open) throw new Error(words.closed);
        note.textContent = `${Math.round(100 * share)} %`;
      };
      try {
        this.#save("motion", "mp4", await film(state, this.#source.seek, picture, onShare));
        note.textContent = "";
      } catch (error) {
        note.textContent = words.noFilm(text(error));
      }
      this.#source.seek(state.t);
      make.disabled = false;
    });
    if (!canFilm()) {
      make.disabled = true;
      note.textContent = words.noCodecs;
    }
    const row = this.#row(words.moving(page.solid), [make]);
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
      button(context.words.export.movingGlb, glb),
    ];
  }

  #legend(title: string, traces: readonly Trace[], context: Context): Legend {
    const description = provenance(traces, context, this.#source.link()).join("\n");
    return { title, foot: footer(traces, context), description };
  }

  #row(name: string, buttons: readonly HTMLButtonElement[]): HTMLElement {
    for (const one of buttons) one.ariaLabel = this.#root.words.export.asFormat(name, one.textContent);
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
