import { undisturbedVelocity } from "../wasm/capsule_wasm";

/** Length of the arrow of a velocity V, in l. */
export const REACH_OF_V = 0.5;

const ARROWS = [-0.8, -0.6, -0.4, -0.2, 0, 0.2, 0.4, 0.6, 0.8];
const POINTS = 41;
/** Size of an arrow's head in space, in l. */
const HEAD = 0.07;

/** A place across the channel with the flow's velocity there: along the arrow, across; in l. */
type Place = readonly [reach: number, y: number];

/** The undisturbed flow in the plane z = 0, or y = 0, seen from a frame of this velocity: its profile, and arrows. */
export interface FlowProfile {
  readonly curve: readonly Place[];
  readonly arrows: readonly Place[];
}

export function flowProfile(velocity: number): FlowProfile {
  const at = (y: number): Place => [REACH_OF_V * (undisturbedVelocity(y, 0) - velocity), y];
  const across = Array.from({ length: POINTS }, (_, i) => (2 * i) / (POINTS - 1) - 1);
  return { curve: across.map(at), arrows: ARROWS.map(at) };
}

/** The same in space, in both planes: pairs of ends of lines, whose arrows begin at x. */
export function flowLines({ curve, arrows }: FlowProfile, x: number): Float32Array {
  const planar: number[] = [];
  const line = (...[a, b, c, d]: readonly [number, number, number, number]) => planar.push(a, b, c, d);
  line(x, -1, x, 1);
  curve.slice(1).forEach(([reach, y], i) => {
    const [before, from] = curve[i] ?? [0, 0];
    line(x + before, from, x + reach, y);
  });
  for (const [reach, y] of arrows) {
    line(x, y, x + reach, y);
    const back = x + reach - Math.sign(reach) * HEAD;
    if (Math.abs(reach) > HEAD) for (const side of [-0.5, 0.5]) line(back, y + side * HEAD, x + reach, y);
  }
  const both = [...ends(planar, (r) => [r, 0]), ...ends(planar, (r) => [0, r])];
  return Float32Array.from(both);
}

/** Points x, r, x, r, ... as points of a plane in space. */
function ends(planar: readonly number[], place: (r: number) => readonly [number, number]): number[] {
  const points: number[] = [];
  for (let i = 0; i < planar.length; i += 2) points.push(planar[i] ?? 0, ...place(planar[i + 1] ?? 0));
  return points;
}
