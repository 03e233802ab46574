/**
 * The state of an explorer, a field once: its default, its text in a link, and its check. The link, the steps of the
 * browser's history and the saved session follow from this table.
 */

import { QUANTITIES } from "./quantities";

export const METHODS = ["direct", "paper"] as const;
export type Method = (typeof METHODS)[number];

export const FRAMES = ["laboratory", "centroid"] as const;
export type Frame = (typeof FRAMES)[number];

export const VIEWS = ["solid", "midplane", "diagonal", "transversal", "plots", "measured"] as const;
export type View = (typeof VIEWS)[number];

export { QUANTITIES };
export type Quantity = (typeof QUANTITIES)[number];

/** Quantities that the map shows as contours. */
export const LAYERS = ["none", ...QUANTITIES, "misfit"] as const;
export type Layer = (typeof LAYERS)[number];

/** Kinds of a measured outline. */
export const OBSERVABLES = ["midplane", "silhouette"] as const;

/** Units of a measured outline's numbers; "named": as its headings say. */
export const OUTLINE_UNITS = ["named", "um", "px"] as const;

/** Directions of the flow in a measured outline; "found": the one that fits best. */
export const FLOWS = ["found", "right", "left", "up", "down"] as const;

/** The whole of a model plays in this many seconds at speed 1, as the channel's 20 l/V do. */
export const PLAY_SECONDS = 20;
export const SPEEDS = [0.25, 0.5, 1, 2, 5] as const;

/** Scales of the axis of Ca on the map. */
export const SCALES = ["linear", "root", "log"] as const;
export type Scale = (typeof SCALES)[number];

/** What the small plots run along: time, or a parameter in the steady state. */
export const ALONG = ["time", "ca", "confinement"] as const;
export type Along = (typeof ALONG)[number];

/** Fields that colour the membrane in space, by their names in the core. */
export const COLOURS = [
  "none",
  "displacement",
  "velocity",
  "stretch_1",
  "stretch_2",
  "tension_1",
  "tension_2",
  "energy_density",
  "load",
] as const;
export type Colour = (typeof COLOURS)[number];

/** The plane that the capsule in space is cut open by: y = 0, z = 0. */
export const CLIPS = ["none", "y", "z"] as const;
export type Clip = (typeof CLIPS)[number];

/** Where the space view is seen from. */
export const CAMERAS = ["oblique", "side", "front"] as const;
export type Camera = (typeof CAMERAS)[number];

/** What determines a motion: the model's parameters in their order, the method, and whether it may be extrapolated. */
export interface Query {
  readonly parameters: readonly number[];
  readonly method: Method;
  readonly extrapolate: boolean;
}

/** The queries that can be pinned at once, by name. */
export const PIN_NAMES = ["A", "B", "C", "D"] as const;
export type PinName = (typeof PIN_NAMES)[number];

/** A query that is kept for comparison. */
export interface Pin extends Query {
  readonly name: PinName;
}

/** What the page knows of a field of the state. */
export interface Field<T> {
  /** Its name in a link and in a saved session; undefined where it is in neither. */
  readonly key: string | undefined;
  readonly standard: T;
  /** Undefined where the text makes no sense. */
  readonly parse: (text: string) => T | undefined;
  readonly format: (value: T) => string;
  readonly check: (value: T) => boolean;
  /** Whether a change of it is a step that the browser's back button undoes. */
  readonly undo: boolean;
  /** The kind of model that it belongs to; undefined: all. */
  readonly model: "channel" | "other" | undefined;
}

type Options = Partial<Pick<Field<never>, "undo" | "model">>;

const COMMON = { undo: true, model: undefined } as const;

function number(key: string, standard: number, check: (value: number) => boolean, options: Options = {}) {
  const field: Field<number> = {
    ...COMMON,
    key,
    standard,
    parse: (text) => (text.trim() === "" ? undefined : Number(text)),
    format: short,
    check: (value) => Number.isFinite(value) && check(value),
    ...options,
  };
  return field;
}

function oneOf<T extends string>(key: string, among: readonly T[], standard: T, options: Options = {}) {
  const field: Field<T> = {
    ...COMMON,
    key,
    standard,
    parse: (text) => among.find((item) => item === text),
    format: (value) => value,
    check: (value) => among.includes(value),
    ...options,
  };
  return field;
}

function flag(key: string | undefined, standard: boolean, options: Options = {}) {
  const field: Field<boolean> = {
    ...COMMON,
    key,
    standard,
    parse: (text) => (text === "1" ? true : text === "0" ? false : undefined),
    format: (value) => (value ? "1" : "0"),
    check: (value) => typeof value === "boolean",
    ...options,
  };
  return field;
}

const any = () => true;

/** Capillary number Ca = mu V / G_s, and confinement a/l. The core says which values it answers. */
const ca = number("ca", 0.1, any, { model: "channel" });
const confinement = number("al", 0.9, any, { model: "channel" });

/** The parameters of a model that is not one of a capsule in the channel; empty for one that is. */
const parameters: Field<readonly number[]> = {
  ...COMMON,
  key: "p",
  standard: [],
  parse: numbers,
  format: (values) => values.map(short).join(","),
  check: (values) => Array.isArray(values) && values.every(Number.isFinite),
  model: "other",
};

const speed: Field<number> = {
  ...number("speed", 1, (value) => SPEEDS.some((item) => item === value)),
  undo: false,
};

/** The views that are open. */
const views: Field<ReadonlySet<View>> = {
  ...COMMON,
  key: "views",
  standard: new Set<View>(["solid", "midplane", "diagonal", "transversal"]),
  parse: (text) => new Set(VIEWS.filter((view) => text.split(".").includes(view))),
  format: (value) => [...value].join("."),
  check: (value) => value instanceof Set && [...value].every((view) => VIEWS.includes(view)),
};

/** Channel's side in um, viscosity in mPa s, surface shear modulus in mN/m; empty: numbers without dimension. */
const dimensions: Field<readonly number[]> = {
  ...parameters,
  key: "dims",
  check: (values) => (values.length === 0 || values.length === 3) && values.every((v) => Number.isFinite(v) && v > 0),
  model: "channel",
};

/** The least and the greatest value of the colours, in the model's unit; empty: those of the field on screen. */
const range: Field<readonly number[]> = {
  ...parameters,
  key: "range",
  check: (values) =>
    Array.isArray(values) &&
    values.every(Number.isFinite) &&
    (values.length === 0 || (values.length === 2 && Number(values[0]) < Number(values[1]))),
  model: undefined,
};

/** `A:direct:0.1,0.9;B:paper!:0.2,0.9`: the exclamation mark allows extrapolation. */
const pins: Field<readonly Pin[]> = {
  ...COMMON,
  key: "pins",
  standard: [],
  parse: (text) => {
    const found = text.split(";").map(pin);
    return found.every((item) => item !== undefined) ? found : undefined;
  },
  format: (value) =>
    value
      .map(({ name, method, extrapolate, parameters: values }) =>
        [name, extrapolate ? `${method}!` : method, values.map(short).join(",")].join(":"),
      )
      .join(";"),
  check: (value) =>
    Array.isArray(value) &&
    value.length <= PIN_NAMES.length &&
    new Set(value.map(({ name }) => name)).size === value.length &&
    value.every(({ parameters: values }) => values.length > 0 && values.every(Number.isFinite)),
};

/** Inputs of a measurement: a change of them is no step of the browser's history. */
const MEASURED = { undo: false, model: "channel" } as const;
const measured = (key: string) => number(key, 0, (value) => value >= 0, MEASURED);

export const FIELDS = {
  ca,
  confinement,
  parameters,
  /** Time in l/V. */
  t: number("t", 2, any, { undo: false }),
  /** The last instant that the open model answers for. */
  end: { ...number("", 20, (value) => value > 0), key: undefined },
  method: oneOf("method", METHODS, "direct"),
  frame: oneOf("frame", FRAMES, "laboratory"),
  /** Whether a query beyond the steady region is evaluated all the same. */
  extrapolate: flag("extrapolate", false),
  playing: flag(undefined, false),
  /** Time units (l/V) per second of the wall clock. */
  speed,
  /** Axial position of the transversal section relative to the centroid, in l. */
  section: number("section", 0, (value) => Math.abs(value) <= 10),
  /** Whether the shape at t = 0 is drawn too. */
  initial: flag("initial", true),
  /** Whether the profile of the undisturbed flow is drawn too. */
  profile: flag("profile", false, { model: "channel" }),
  /** The read-out drawn along the time axis. */
  trace: oneOf("trace", QUANTITIES, "axial_length"),
  views,
  pins,
  /** The quantity that the map shows as contours. */
  layer: oneOf("layer", LAYERS, "none", { model: "channel" }),
  scale: oneOf("scale", SCALES, "linear", { model: "channel" }),
  samples: flag("samples", true, { model: "channel" }),
  along: oneOf("along", ALONG, "time"),
  colour: oneOf("colour", COLOURS, "none"),
  range,
  clip: oneOf("clip", CLIPS, "none"),
  camera: oneOf("camera", CAMERAS, "oblique", { undo: false }),
  dimensions,
  /** Of the measured outline: half the channel's side in um, mean velocity in mm/s, viscosity in Pa s; 0: not known. */
  halfWidth: measured("half"),
  meanVelocity: measured("vel"),
  viscosity: measured("visc"),
  /** Size of a pixel in um; 0: not known. */
  pixel: measured("pixel"),
  observable: oneOf("seen", OBSERVABLES, "midplane", MEASURED),
  outlineUnit: oneOf("unit", OUTLINE_UNITS, "named", MEASURED),
  flow: oneOf("flow", FLOWS, "found", MEASURED),
  /** Which of several capsules in a picture, from 1; 0: there is one. */
  nth: { ...measured("nth"), check: (value: number) => Number.isInteger(value) && value >= 0 },
} as const;

type Value<F> = F extends Field<infer T> ? T : never;

/** What an explorer shows. Everything on screen is a function of it and of the open model. */
export type State = { readonly [K in keyof typeof FIELDS]: Value<(typeof FIELDS)[K]> };

export type Key = keyof State;

/** The fields one by one, where their types do not matter. */
export const ENTRIES = Object.entries(FIELDS) as unknown as readonly (readonly [Key, Field<unknown>])[];

/** The paper's configuration of Figs. 10 to 12, at an instant at which it still deforms. */
export const DEFAULT_STATE = Object.fromEntries(ENTRIES.map(([key, { standard }]) => [key, standard])) as State;

/** The query of a state: of a capsule in the channel, or of a model with other parameters. */
export function queryOf({ ca, confinement, parameters, method, extrapolate }: State): Query {
  return { parameters: parameters.length > 0 ? parameters : [ca, confinement], method, extrapolate };
}

/** A change of the state that makes these parameters the query's. */
export function moveTo(state: State, values: readonly number[]): Partial<State> {
  const [first = state.ca, second = state.confinement] = values;
  const place = state.parameters.length > 0 ? { parameters: values } : { ca: first, confinement: second };
  return { ...place, extrapolate: false };
}

/** A number as a person would type it: 2.3, not 2.3000000000000003, which adding up time steps makes. */
export function short(value: number): string {
  return String(Number(value.toPrecision(12)));
}

function numbers(text: string): readonly number[] | undefined {
  const values = text.split(",").map((item) => (item.trim() === "" ? Number.NaN : Number(item)));
  return values.every(Number.isFinite) ? values : undefined;
}

function pin(text: string): Pin | undefined {
  const [name, kind = "", list = ""] = text.split(":");
  const known = PIN_NAMES.find((item) => item === name);
  const method = METHODS.find((item) => item === kind.replace("!", ""));
  const values = numbers(list);
  if (known === undefined || method === undefined || values === undefined) return undefined;
  return { name: known, method, extrapolate: kind.endsWith("!"), parameters: values };
}
