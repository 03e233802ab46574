const HEADER = 80;
const FACET = 50;

/** A surface as a binary STL file: vertices x, y, z, ..., three indices a triangle, and a title in its header. */
export function toStl(positions: Float32Array, triangles: Uint32Array, words: string): ArrayBuffer {
  const count = triangles.length / 3;
  const file = new ArrayBuffer(HEADER + 4 + FACET * count);
  const view = new DataView(file);
  // A file that begins with "solid" would be taken for text.
  new Uint8Array(file).set(new TextEncoder().encode(`CapsuleExplorer ${words}`).subarray(0, HEADER));
  view.setUint32(HEADER, count, true);
  const vertex = (corner: number) => {
    const at = 3 * (triangles[corner] ?? 0);
    return [positions[at] ?? 0, positions[at + 1] ?? 0, positions[at + 2] ?? 0] as const;
  };
  for (let i = 0; i < count; i++) {
    const corners = [vertex(3 * i), vertex(3 * i + 1), vertex(3 * i + 2)] as const;
    const numbers = [...normal(...corners), ...corners.flat()];
    for (const [k, value] of numbers.entries()) view.setFloat32(HEADER + 4 + FACET * i + 4 * k, value, true);
  }
  return file;
}

type Point = readonly [number, number, number];

function normal(a: Point, b: Point, c: Point): Point {
  const [ux, uy, uz] = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
  const [vx, vy, vz] = [c[0] - a[0], c[1] - a[1], c[2] - a[2]];
  const [x, y, z] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
  const length = Math.hypot(x, y, z) || 1;
  return [x / length, y / length, z / length];
}
