/** A vector or a number at each vertex of a surface. */
export interface PointData {
  readonly name: string;
  readonly values: Float32Array;
  readonly components: 1 | 3;
}

/** A surface with data at its vertices as a VTK file of polygons, for ParaView. The words become a comment. */
export function toVtp(
  positions: Float32Array,
  triangles: Uint32Array,
  data: readonly PointData[],
  words: readonly string[],
): string {
  const count = triangles.length / 3;
  const ends = Array.from({ length: count }, (_, i) => 3 * (i + 1));
  // Two hyphens would end the comment.
  const comment = words.join("\n").replaceAll("--", "- -");
  return `<?xml version="1.0"?>
<!--
${comment}
-->
<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian">
<PolyData>
<Piece NumberOfPoints="${positions.length / 3}" NumberOfPolys="${count}">
<PointData>
${data.map(({ name, values, components }) => array("Float32", name, values, components)).join("\n")}
</PointData>
<Points>
${array("Float32", "Points", positions, 3)}
</Points>
<Polys>
${array("Int32", "connectivity", triangles)}
${array("Int32", "offsets", ends)}
</Polys>
</Piece>
</PolyData>
</VTKFile>
`;
}

function array(type: string, name: string, values: ArrayLike<number>, components = 1): string {
  const head = `<DataArray type="${type}" Name="${name}" NumberOfComponents="${components}" format="ascii">`;
  return `${head}\n${Array.from(values).join(" ")}\n</DataArray>`;
}
