import type { Scale } from "../app/schema";

/** Places and numbers of the map. */

export type Span = readonly [number, number];

export interface Point {
  readonly ca: number;
  readonly confinement: number;
}

/** Places on an axis for a value, 0 at the first and 1 at the last of its span, and back. */
export const AXES: Record<Scale, readonly [to: (value: number) => number, from: (place: number) => number]> = {
  linear: [(value) => value, (place) => place],
  root: [(value) => Math.sqrt(Math.max(value, 0)), (place) => place ** 2],
  log: [(value) => Math.log(Math.max(value, 1e-9)), Math.exp],
};

export function clamp(value: number, low: number, high: number): number {
  return Math.min(high, Math.max(low, value));
}

export function rounded(value: number, step: number): number {
  return Number((Math.round(value / step) * step).toPrecision(10));
}

export function short(value: number): string {
  return String(Number(value.toPrecision(4)));
}

export const holds = ([low, high]: Span, value: number) => low <= value && value <= high;

/** The part of a curve of rising confinement that lies between two confinements; beyond its ends it is constant. */
export function between(curve: readonly Point[], [low, high]: readonly [number, number]): Point[] {
  const at = (confinement: number): Point => {
    const after = curve.findIndex((point) => point.confinement >= confinement);
    const [from, to] = [curve[after - 1], curve[after]];
    if (!from || !to) return { confinement, ca: (to ?? curve[curve.length - 1])?.ca ?? 0 };
    const share = (confinement - from.confinement) / (to.confinement - from.confinement);
    return { confinement, ca: from.ca + share * (to.ca - from.ca) };
  };
  const inner = curve.filter(({ confinement }) => low < confinement && confinement < high);
  return [at(low), ...inner, at(high)];
}
