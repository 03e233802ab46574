/** How much of the page is around the figures: all of it, the time bar alone, or nothing. */
export type Controls = "full" | "time" | "none";

export type Method = "direct" | "paper";
export type Frame = "laboratory" | "centroid";
export type View = "solid" | "midplane" | "diagonal" | "transversal" | "plots" | "measured";
export type Quantity =
  | "axial_length"
  | "half_width"
  | "half_diagonal"
  | "rear_depth"
  | "velocity"
  | "volume"
  | "expected_error"
  | "error_bound";

/** A query that is kept for comparison. */
export interface Pin {
  readonly name: "A" | "B" | "C" | "D";
  readonly parameters: readonly number[];
  readonly method: Method;
  readonly extrapolate: boolean;
}

/** The state of an explorer. */
export interface State {
  /** Capillary number Ca. */
  readonly ca: number;
  /** a/l. */
  readonly confinement: number;
  /** Parameters of a model of other data; empty for capsules in the channel. */
  readonly parameters: readonly number[];
  /** Time, in l/V. */
  readonly t: number;
  /** The last instant of the model. */
  readonly end: number;
  readonly method: Method;
  readonly frame: Frame;
  /** Whether a query outside the sampled domain is answered all the same. */
  readonly extrapolate: boolean;
  readonly playing: boolean;
  /** l/V a second. */
  readonly speed: number;
  /** Place of the transversal section, from the centroid, in l. */
  readonly section: number;
  /** Whether the shape at t = 0 is drawn too. */
  readonly initial: boolean;
  /** Whether the profile of the undisturbed flow is drawn too. */
  readonly profile: boolean;
  /** The read-out along the time axis. */
  readonly trace: Quantity;
  readonly views: ReadonlySet<View>;
  readonly pins: readonly Pin[];
  /** Contours of the map. */
  readonly layer: "none" | Quantity | "misfit";
  /** Scale of the map's axis of Ca. */
  readonly scale: "linear" | "root" | "log";
  /** Whether the map shows the samples. */
  readonly samples: boolean;
  /** What the plots run along. */
  readonly along: "time" | "ca" | "confinement";
  /** Field that colours the membrane in space. */
  readonly colour:
    | "none"
    | "displacement"
    | "velocity"
    | "stretch_1"
    | "stretch_2"
    | "tension_1"
    | "tension_2"
    | "energy_density"
    | "load";
  /** Ends of the scale of colours; empty: those of the field. */
  readonly range: readonly number[];
  /** The plane that the membrane in space is cut by: y = 0 or z = 0. */
  readonly clip: "none" | "y" | "z";
  readonly camera: "oblique" | "side" | "front";
  /** Channel's side in um, viscosity in mPa s, shear modulus in mN/m; empty: numbers without dimension. */
  readonly dimensions: readonly number[];
  /** Of a measured outline: half the channel's side in um; 0: not known. */
  readonly halfWidth: number;
  /** Mean velocity in mm/s. */
  readonly meanVelocity: number;
  /** Viscosity in Pa s. */
  readonly viscosity: number;
  /** Size of a pixel in um. */
  readonly pixel: number;
  readonly observable: "midplane" | "silhouette";
  readonly outlineUnit: "named" | "um" | "px";
  readonly flow: "found" | "right" | "left" | "up" | "down";
  /** Which of several capsules in a picture, from 1; 0: there is one. */
  readonly nth: number;
}

/** Events of the element, beside those of all elements. */
export interface CapsuleExplorerEventMap extends HTMLElementEventMap {
  /** Follows each change of the state, by an attribute, a script or a person; it bubbles. */
  statechange: Event;
}

/** `<capsule-explorer>`. */
export interface CapsuleExplorerElement extends HTMLElement {
  readonly state: State;
  /** Changes fields of the state; throws a `TypeError` for a value that cannot be one. */
  set(patch: Partial<State>): void;
  /** The query and the figures on screen. */
  read(): Record<string, number | string | boolean>;
  addEventListener<K extends keyof CapsuleExplorerEventMap>(
    type: K,
    listener: (this: CapsuleExplorerElement, event: CapsuleExplorerEventMap[K]) => unknown,
    options?: boolean | AddEventListenerOptions,
  ): void;
  addEventListener(
    type: string,
    listener: EventListenerOrEventListenerObject,
    options?: boolean | AddEventListenerOptions,
  ): void;
}

/** Attributes of the element, as texts or as numbers, for templates that check them. */
export interface CapsuleExplorerAttributes {
  /** Address of a model file; it counts when the element is inserted. By default the model of the package. */
  readonly model?: string;
  readonly controls?: Controls;
  readonly lang?: "en" | "fr";
  readonly ca?: number | string;
  readonly al?: number | string;
  /** Parameters of a model of other data, with commas. */
  readonly p?: string;
  readonly t?: number | string;
  readonly method?: Method;
  readonly frame?: Frame;
  readonly extrapolate?: "0" | "1";
  readonly speed?: number | string;
  readonly section?: number | string;
  readonly initial?: "0" | "1";
  readonly profile?: "0" | "1";
  readonly trace?: Quantity;
  /** Views, with points between them. */
  readonly views?: string;
  readonly pins?: string;
  readonly layer?: State["layer"];
  readonly scale?: State["scale"];
  readonly samples?: "0" | "1";
  readonly along?: State["along"];
  readonly colour?: State["colour"];
  readonly range?: string;
  readonly clip?: State["clip"];
  readonly camera?: State["camera"];
  /** Channel's side in um, viscosity in mPa s, shear modulus in mN/m, with commas. */
  readonly dims?: string;
  readonly half?: number | string;
  readonly vel?: number | string;
  readonly visc?: number | string;
  readonly pixel?: number | string;
  readonly seen?: State["observable"];
  readonly unit?: State["outlineUnit"];
  readonly flow?: State["flow"];
  readonly nth?: number | string;
}

declare global {
  interface HTMLElementTagNameMap {
    "capsule-explorer": CapsuleExplorerElement;
  }
}
