//! Surfaces as binary STL, for CAD programs and 3D printers.

use std::path::Path;

use stl_io::{Normal, Triangle, Vertex};

use crate::error::{finite, length};
use crate::{DatabaseError, Mesh, atomic};

/// Writes the mesh with its nodes at `positions` as flat triangles between the nodes, four for each quadratic element.
///
/// # Errors
/// As [`crate::vtu::write()`].
pub fn write(path: &Path, mesh: &Mesh, positions: &[[f64; 3]]) -> Result<(), DatabaseError> {
    length("positions for the STL file", mesh.nodes.len(), positions.len())?;
    finite("positions for the STL file", positions.as_flattened())?;
    let triangles: Vec<Triangle> = mesh
        .elements
        .iter()
        .flat_map(parts)
        .map(|corners| triangle(corners.map(|node| positions[node as usize])))
        .collect();
    let mut bytes = Vec::new();
    stl_io::write_stl(&mut bytes, triangles.iter()).map_err(DatabaseError::io("write", path))?;
    atomic::write(path, &bytes)
}

/// The flat triangles of an element: the corners with their mid-edges, and the mid-edges.
fn parts(element: &[u32; 6]) -> Vec<[u32; 3]> {
    let [a, b, c, ab, bc, ca] = *element;
    if Mesh::is_flat(element) {
        vec![[a, b, c]]
    } else {
        vec![[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    }
}

fn triangle([a, b, c]: [[f64; 3]; 3]) -> Triangle {
    let [u, v] = [b, c].map(|to: [f64; 3]| [0, 1, 2].map(|d| to[d] - a[d]));
    let cross = [
        u[1] * v[2] - u[2] * v[1],
        u[2] * v[0] - u[0] * v[2],
        u[0] * v[1] - u[1] * v[0],
    ];
    let size = cross.iter().map(|x| x * x).sum::<f64>().sqrt();
    // A triangle without area has no normal.
    let scale = if size > 0.0 { 1.0 / size } else { 0.0 };
    Triangle {
        normal: Normal::new(cross.map(|x| (scale * x) as f32)),
        vertices: [a, b, c].map(|corner| Vertex::new(corner.map(|x| x as f32))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::tests::octahedral;

    #[test]
    fn a_surface_is_closed_and_faces_outwards() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("capsule.stl");
        let mesh = octahedral(4);
        let positions: Vec<_> = mesh
            .nodes
            .iter()
            .map(|[x, y, z]| [3.0 + 1.5 * x, 0.8 * y, 0.7 * z])
            .collect();
        write(&path, &mesh, &positions).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let count = 4 * mesh.elements.len();
        assert_eq!(bytes.len(), 84 + 50 * count);
        assert!(!bytes.starts_with(b"solid"), "text");
        let surface = stl_io::read_stl(&mut std::io::Cursor::new(bytes)).unwrap();
        // Each edge of the surface belongs to two triangles, and no node is lost.
        surface.validate().unwrap();
        assert_eq!((surface.faces.len(), surface.vertices.len()), (count, mesh.nodes.len()));
        let mut volume = 0.0;
        for face in &surface.faces {
            let [a, b, c] = face.vertices.map(|v| surface.vertices[v].0.map(f64::from));
            let normal = face.normal.0.map(f64::from);
            // The divergence theorem, with the stored normal.
            let size = |u: [f64; 3]| u.iter().map(|x| x * x).sum::<f64>().sqrt();
            let sides = [[a, b], [b, c], [c, a]].map(|[p, q]| size([0, 1, 2].map(|d| q[d] - p[d])));
            let half = 0.5 * sides.iter().sum::<f64>();
            let area = sides.iter().fold(half, |product, side| product * (half - side)).sqrt();
            volume += area * normal[0] * (a[0] + b[0] + c[0]) / 3.0;
        }
        let exact = 4.0 / 3.0 * std::f64::consts::PI * 1.5 * 0.8 * 0.7;
        // Flat triangles between nodes of the ellipsoid lie within it.
        assert!(volume < exact && volume > 0.97 * exact, "{volume} {exact}");
    }

    #[test]
    fn positions_of_another_mesh_are_refused() {
        let mesh = octahedral(2);
        let error = write(Path::new("/nonexistent/a.stl"), &mesh, &mesh.nodes[1..]).unwrap_err();
        assert!(error.to_string().contains("66"), "{error}");
    }
}
