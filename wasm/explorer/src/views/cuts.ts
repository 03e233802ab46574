/** Curves on the membrane in space, relative to the centroid. */

/** Both halves of an outline (x, r, ..., laboratory frame), as the closed curve in its plane. */
export function cutPoints(outline: Float32Array, centroid: number, plane: "midplane" | "diagonal"): Float32Array {
  const count = outline.length / 2;
  const points = new Float32Array(6 * count);
  const [y, z] = plane === "midplane" ? [1, 0] : [Math.SQRT1_2, Math.SQRT1_2];
  for (let i = 0; i < count; i++) {
    const x = (outline[2 * i] ?? 0) - centroid;
    const r = outline[2 * i + 1] ?? 0;
    points.set([x, y * r, z * r], 3 * i);
    points.set([x, -y * r, -z * r], 3 * (2 * count - 1 - i));
  }
  return points;
}

/** A closed curve (y, z, ...) in the plane at x. */
export function loopPoints(curve: Float32Array, x: number): Float32Array {
  const count = curve.length / 2;
  const points = new Float32Array(3 * (count + 1));
  for (let i = 0; i <= count; i++) {
    const j = i % count;
    points.set([x, curve[2 * j] ?? 0, curve[2 * j + 1] ?? 0], 3 * i);
  }
  return points;
}
