/** A surface with its unit normals as a Wavefront OBJ file. Each line of words becomes a comment. */
export function toObj(
  positions: Float32Array,
  normals: Float32Array,
  triangles: Uint32Array,
  words: readonly string[],
): string {
  const lines = words.map((line) => `# ${line}`);
  for (const [name, numbers] of [
    ["v", positions],
    ["vn", normals],
  ] as const) {
    for (let i = 0; i < numbers.length; i += 3) lines.push([name, ...numbers.subarray(i, i + 3)].join(" "));
  }
  for (let i = 0; i < triangles.length; i += 3) {
    // The format counts from 1; a corner is its vertex and its normal.
    const corners = [...triangles.subarray(i, i + 3)].map((vertex) => `${vertex + 1}//${vertex + 1}`);
    lines.push(`f ${corners.join(" ")}`);
  }
  return `${lines.join("\n")}\n`;
}
