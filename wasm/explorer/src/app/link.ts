import { QUANTITIES } from "./quantities";
import { DEFAULT_STATE, FRAMES, METHODS, SPEEDS, type State, VIEWS } from "./state";

/** Writes the state as a URL fragment: always the query and the time, the rest where it differs from the default. */
export function toFragment(state: State): string {
  const { ca, confinement, parameters, t, method } = state;
  const own =
    parameters.length > 0 ? { p: parameters.map(short).join(",") } : { ca: short(ca), al: short(confinement) };
  const fields = new URLSearchParams({ ...own, t: short(t), method });
  const put = (name: string, value: string, standard: string) => {
    if (value !== standard) {
      fields.set(name, value);
    }
  };
  put("frame", state.frame, DEFAULT_STATE.frame);
  put("speed", String(state.speed), String(DEFAULT_STATE.speed));
  put("section", short(state.section), short(DEFAULT_STATE.section));
  put("trace", state.trace, DEFAULT_STATE.trace);
  put("initial", state.initial ? "1" : "0", "1");
  put("extrapolate", state.extrapolate ? "1" : "0", "0");
  put("views", [...state.views].join("."), [...DEFAULT_STATE.views].join("."));
  return `#${fields}`;
}

/** Reads a fragment; a field that is missing or makes no sense is left as it is by default. */
export function fromFragment(fragment: string): Partial<State> {
  const fields = new URLSearchParams(fragment.replace(/^#/, ""));
  const patch: { -readonly [key in keyof State]?: State[key] } = {};
  const number = (name: string) => {
    const text = fields.get(name);
    const value = text === null || text.trim() === "" ? Number.NaN : Number(text);
    return Number.isFinite(value) ? value : undefined;
  };
  const one = <T extends string>(name: string, among: readonly T[]) => among.find((item) => item === fields.get(name));

  const parameters = { ca: number("ca"), confinement: number("al"), t: number("t"), section: number("section") };
  for (const key of ["ca", "confinement", "t", "section"] as const) {
    const value = parameters[key];
    if (value !== undefined) {
      patch[key] = value;
    }
  }
  const others = (fields.get("p") ?? "").split(",").map((text) => (text.trim() === "" ? Number.NaN : Number(text)));
  if (others.every(Number.isFinite)) patch.parameters = others;
  const speed = SPEEDS.find((item) => item === number("speed"));
  const method = one("method", METHODS);
  const frame = one("frame", FRAMES);
  const trace = one("trace", QUANTITIES);
  if (speed !== undefined) patch.speed = speed;
  if (method !== undefined) patch.method = method;
  if (frame !== undefined) patch.frame = frame;
  if (trace !== undefined) patch.trace = trace;
  if (fields.has("initial")) patch.initial = fields.get("initial") !== "0";
  if (fields.has("extrapolate")) patch.extrapolate = fields.get("extrapolate") === "1";
  if (fields.has("views")) {
    const names = (fields.get("views") ?? "").split(".");
    patch.views = new Set(VIEWS.filter((view) => names.includes(view)));
  }
  return patch;
}

/** A number as a person would type it: 2.3, not 2.3000000000000003, which adding up time steps makes. */
function short(value: number): string {
  return String(Number(value.toPrecision(12)));
}
