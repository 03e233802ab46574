import { DEFAULT_STATE, ENTRIES, type Key, type State } from "./schema";

/** The version of the links that this page writes. */
const VERSION = 1;

/** What a link says. */
export interface Link {
  /** Every field of the state that a link can hold; what it leaves out means the default. */
  readonly state: Partial<State>;
  /** Digest of the model that it was made with; undefined where it does not say. */
  readonly digest: string | undefined;
  /** The file that the model came from, where it is not the one beside the page. */
  readonly file: string | undefined;
}

/** The model that a link is about. */
export interface LinkedModel {
  readonly isChannel: boolean;
  readonly digest: string;
  readonly file: string | undefined;
}

/** Fields that a link names even where they have their default: the query and the instant. */
const ALWAYS: ReadonlySet<Key> = new Set(["ca", "confinement", "parameters", "t", "method"]);

/** Writes the state as the fragment of a URL: the query, the instant, and what differs from its default. */
export function toFragment(state: State, { isChannel, digest, file }: LinkedModel): string {
  const words = new URLSearchParams({ v: String(VERSION), m: digest });
  if (file !== undefined) words.set("file", file);
  for (const [key, { key: name, model, format, standard }] of ENTRIES) {
    if (name === undefined || (model !== undefined && model !== (isChannel ? "channel" : "other"))) continue;
    const text = format(state[key]);
    if (ALWAYS.has(key) || text !== format(standard)) words.set(name, text);
  }
  return `#${words}`;
}

/** Reads a fragment. `defaults` are the open model's; a field that is missing or makes no sense has its default. */
export function fromFragment(fragment: string, defaults: Partial<State> = {}): Link {
  const words = new URLSearchParams(fragment.replace(/^#/, ""));
  const state = Object.fromEntries(
    ENTRIES.filter(([, { key }]) => key !== undefined).map(([key, { key: name, parse, check }]) => {
      const text = words.get(name ?? "");
      const value = text === null ? undefined : parse(text);
      const isGood = value !== undefined && check(value);
      return [key, isGood ? value : (defaults[key] ?? DEFAULT_STATE[key])];
    }),
  );
  return { state, digest: words.get("m") ?? undefined, file: words.get("file") ?? undefined };
}

/** Whether the change from one state to another is a step that the browser's back button undoes. */
export function isStep(state: State, previous: State): boolean {
  return ENTRIES.some(([key, { undo, key: name, format }]) => {
    return undo && name !== undefined && format(state[key]) !== format(previous[key]);
  });
}
