import { toBase64 } from "../app/base64";
import type { State } from "../app/schema";
import type { Messages } from "../messages/en";
import type { Capsule } from "../model/capsule";
import { type Refusal, refusalOf } from "../model/refusal";
import type { Point } from "../views/map-geometry";
import type { Contour } from "../views/map-layer";
import type { Context, Trace, ViewPart } from "../views/view";
import { Client, ProgramError } from "./client";
import { MisfitGrid, root } from "./misfit-grid";
import type { Found, Said } from "./protocol";

/** How long what is typed must be at rest before it is worked with. */
const REST_MS = 250;
/** Columns and rows of the misfit beside the best fit, and over the whole domain. */
const NEAR = [41, 41] as const;
const FAR = [56, 36] as const;
/** Rows between two pictures of the misfit over the domain. */
const SHOWN_ROWS = 6;
/** How many misfits of single places are kept. */
const KEPT = 500;

/** Why there is no answer: in the page's words, or the core's reason. */
export type Problem = ((words: Messages["outline"]) => string) | Refusal;

/** A file with an outline: a text or a picture. */
export interface OutlineFile {
  readonly name: string;
  readonly bytes: Uint8Array;
}

/** The measured outline: its file, and what the worker finds in it. Views draw what is known so far. */
export class Measured implements ViewPart {
  readonly needs = [];
  readonly #onChange: () => void;
  readonly #client = new Client();
  #file: OutlineFile | undefined;
  #address: string | undefined;
  #found: Found | undefined;
  #problem: Problem | undefined;
  #regions: readonly Contour[] = [];
  #layer: readonly Contour[] = [];
  #share = 0;
  readonly #misfits = new Map<string, number>();
  readonly #asking = new Set<string>();
  #key = "";
  #resting = 0;
  /** Counts what was asked for: what comes late is dropped. */
  #asked = 0;

  /** `onChange` is called whenever there is more to draw. */
  constructor(onChange: () => void) {
    this.#onChange = onChange;
  }

  /** The file; undefined where there is none. */
  get file(): OutlineFile | undefined {
    return this.#file;
  }

  /** The picture as an address; undefined where the file is a text, or a picture that browsers do not show. */
  get address(): string | undefined {
    return this.#address;
  }

  /** Takes a file in place of the one before; undefined removes it. */
  take(file: OutlineFile | undefined): void {
    this.#file = file;
    this.#address = file && addressOf(file.bytes);
    this.#key = "";
    this.#clear();
    this.#onChange();
  }

  get found(): Found | undefined {
    return this.#found;
  }

  /** Why there is no answer; undefined where there is one, or none is asked for. */
  get problem(): Problem | undefined {
    return this.#problem;
  }

  /** Whether an answer is on its way. */
  get isBusy(): boolean {
    return this.#file !== undefined && this.#found === undefined && this.#problem === undefined;
  }

  /** The regions that hold the true capsule with 68 and 95 %, as far as they are known. */
  get regions(): readonly Contour[] {
    return this.#regions;
  }

  /** How much of the misfit over the domain is known: 1 is all. */
  get share(): number {
    return this.#share;
  }

  /** The misfit over the domain, as far as it is known. */
  get layer(): readonly Contour[] {
    return this.#layer;
  }

  /** The misfit at a place, in standard deviations: undefined until it is known, not a number outside the domain. */
  misfit({ ca, confinement }: Point): number | undefined {
    const key = `${ca} ${confinement}`;
    const known = this.#misfits.get(key);
    if (known !== undefined || this.#found === undefined) return known;
    // One for the capsule on screen, one for the mouse; who asks comes again with the next frame.
    if (this.#asking.size < 2 && !this.#asking.has(key)) this.#ask(key, Float64Array.of(ca, confinement));
    return undefined;
  }

  draw(_: readonly Trace[], { capsule, state }: Context): void {
    const file = capsule.has("channel") ? this.#file : undefined;
    const [missing, said] = [missingIn(state), saidOf(state)];
    const key = file === undefined ? "" : JSON.stringify([capsule.model.digest, missing, said]);
    if (key === this.#key) return;
    this.#key = key;
    this.#clear();
    if (file === undefined) return;
    if (missing.length > 0) this.#problem = (words) => words.needed(missing.map((name) => words[name]).join(", "));
    else this.#resting = window.setTimeout(() => this.#identify(capsule, file, said), REST_MS);
  }

  #clear(): void {
    this.#asked += 1;
    window.clearTimeout(this.#resting);
    this.#found = undefined;
    this.#problem = undefined;
    this.#regions = [];
    this.#layer = [];
    this.#share = 0;
    this.#misfits.clear();
    this.#asking.clear();
  }

  async #identify({ model }: Capsule, file: OutlineFile, said: Said): Promise<void> {
    const asked = this.#asked;
    const [caLeast = 0, caMost = 1, least = 0, most = 1] = model.ranges();
    const isLate = () => asked !== this.#asked;
    try {
      await this.#client.open(model.digest, () => model.file());
      const found = await this.#client.identify(file.name, file.bytes, said);
      if (isLate()) return;
      this.#found = found;
      this.#onChange();
      const [narrow, wide] = found.levels;
      const near = new MisfitGrid("log", ...found.around, NEAR);
      await this.#fill(near, isLate, () => undefined);
      if (isLate()) return;
      this.#regions = near.below([
        ["95 %", wide],
        ["68 %", narrow],
      ]);
      this.#onChange();
      const far = new MisfitGrid("root", [caLeast, caMost], [least, most], FAR);
      await this.#fill(far, isLate, (row) => {
        if (row % SHOWN_ROWS !== 0) return;
        this.#layer = far.above();
        this.#share = row / far.rows;
        this.#onChange();
      });
    } catch (error) {
      if (isLate()) return;
      this.#problem = problemOf(error);
      this.#onChange();
    }
  }

  /** Fills a grid row by row, so that the worker answers other questions in between. */
  async #fill(grid: MisfitGrid, isLate: () => boolean, onRow: (count: number) => void): Promise<void> {
    for (let row = 0; row < grid.rows; row++) {
      const rises = await this.#client.misfit(grid.places(row));
      if (isLate()) return;
      grid.set(row, rises);
      onRow(row + 1);
    }
  }

  async #ask(key: string, place: Float64Array): Promise<void> {
    const asked = this.#asked;
    this.#asking.add(key);
    const [rise = Number.NaN] = await this.#client.misfit(place).catch(() => []);
    if (asked !== this.#asked) return;
    this.#asking.delete(key);
    if (this.#misfits.size > KEPT) this.#misfits.clear();
    this.#misfits.set(key, root(rise));
    this.#onChange();
  }
}

/** A PNG or a JPEG as an address, told by its first byte. */
function addressOf(bytes: Uint8Array): string | undefined {
  const type = { 137: "png", 255: "jpeg" }[bytes[0] ?? 0];
  return type && `data:image/${type};base64,${toBase64(bytes)}`;
}

function problemOf(error: unknown): Problem {
  if (!(error instanceof ProgramError)) return refusalOf(error);
  const { message } = error;
  return (words) => words.programFailed(message === "" ? words.notLoaded : message);
}

const NEEDED = [
  ["neededHalfWidth", "halfWidth"],
  ["neededVelocity", "meanVelocity"],
  ["neededViscosity", "viscosity"],
] as const;

/** Inputs that are missing, by the names of their words. */
function missingIn(state: State) {
  return NEEDED.filter(([, key]) => state[key] === 0).map(([name]) => name);
}

/** Inputs of the outline from the state. */
function saidOf(state: State): Said {
  return {
    half_width_um: state.halfWidth,
    velocity_mm_s: state.meanVelocity,
    viscosity_pa_s: state.viscosity,
    observable: state.observable,
    unit: state.outlineUnit === "named" ? null : state.outlineUnit,
    pixel_um: state.pixel === 0 ? null : state.pixel,
    flow: state.flow,
    capsule: state.nth === 0 ? null : state.nth,
  };
}
