//! The membrane's surface as triangles to draw: each P2 element, sampled on a finer grid of its own.

use std::collections::HashMap;

/// Linear triangles that follow the P2 elements. Neighbouring elements share the vertices on their common edge, so a
/// closed mesh gives a closed surface.
#[derive(Debug)]
pub struct Surface {
    /// Nodes of the element that holds each vertex, and the P2 shape functions there.
    vertices: Vec<([u16; 6], [f32; 6])>,
    /// Vertices of each triangle, in the elements' orientation.
    triangles: Vec<[u32; 3]>,
}

/// The identity of a vertex: its own within an element, or its place on an edge or at a corner.
#[derive(PartialEq, Eq, Hash)]
enum Place {
    Corner(u16),
    Edge { from: u16, to: u16, step: usize },
    Inside { element: usize, steps: [usize; 2] },
}

impl Surface {
    /// Divides each side of the elements into `divisions` pieces; 2 gives the mesh's own nodes.
    pub fn new(elements: &[[u16; 6]], divisions: usize) -> Self {
        let mut surface = Self {
            vertices: Vec::new(),
            triangles: Vec::new(),
        };
        let mut known = HashMap::new();
        for (number, element) in elements.iter().enumerate() {
            let mut vertex = |i: usize, j: usize| {
                let steps = [divisions - i - j, i, j];
                *known.entry(place(number, element, steps)).or_insert_with(|| {
                    let along = steps.map(|step| step as f32 / divisions as f32);
                    surface.vertices.push((*element, shape_functions(along)));
                    (surface.vertices.len() - 1) as u32
                })
            };
            for i in 0..divisions {
                for j in 0..divisions - i {
                    surface
                        .triangles
                        .push([vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)]);
                    if i + j + 2 <= divisions {
                        surface
                            .triangles
                            .push([vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
                    }
                }
            }
        }
        surface
    }

    /// Vertices of each triangle.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Positions of the vertices from those of the nodes.
    pub fn positions(&self, nodes: &[[f32; 3]]) -> Vec<[f32; 3]> {
        let position = |(element, shape): &([u16; 6], [f32; 6])| {
            let mut sum = [0.0; 3];
            for (&node, &weight) in element.iter().zip(shape) {
                let at = nodes.get(usize::from(node)).copied().unwrap_or_default();
                for axis in 0..3 {
                    sum[axis] += weight * at[axis];
                }
            }
            sum
        };
        self.vertices.iter().map(position).collect()
    }

    /// Numbers at the vertices from those at the nodes.
    pub fn numbers(&self, nodes: &[f32]) -> Vec<f32> {
        let number = |(element, shape): &([u16; 6], [f32; 6])| {
            let at = |node: &u16| nodes.get(usize::from(*node)).copied().unwrap_or_default();
            element.iter().zip(shape).map(|(node, weight)| weight * at(node)).sum()
        };
        self.vertices.iter().map(number).collect()
    }
}

/// Unit normals at the vertices, outward where the triangles are oriented so: the mean of those of the triangles
/// around, weighted by their areas. A vertex without area has none: zero.
pub fn normals(triangles: &[[u32; 3]], positions: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let mut normals = vec![[0.0; 3]; positions.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|vertex| positions.get(vertex as usize).copied().unwrap_or_default());
        let [u, v] = [b, c].map(|to: [f32; 3]| [to[0] - a[0], to[1] - a[1], to[2] - a[2]]);
        let cross = [
            u[1] * v[2] - u[2] * v[1],
            u[2] * v[0] - u[0] * v[2],
            u[0] * v[1] - u[1] * v[0],
        ];
        for &vertex in triangle {
            if let Some(normal) = normals.get_mut(vertex as usize) {
                for (sum, part) in normal.iter_mut().zip(cross) {
                    *sum += part;
                }
            }
        }
    }
    for normal in &mut normals {
        let length = normal.iter().map(|x| x * x).sum::<f32>().sqrt();
        if length > 0.0 {
            normal.iter_mut().for_each(|x| *x /= length);
        }
    }
    normals
}

/// Barycentric coordinates times the number of divisions, put in a form that both neighbours of an edge agree on.
fn place(element: usize, nodes: &[u16; 6], steps: [usize; 3]) -> Place {
    let present: Vec<usize> = (0..3).filter(|&corner| steps[corner] > 0).collect();
    match present[..] {
        [corner] => Place::Corner(nodes[corner]),
        [a, b] if nodes[a] < nodes[b] => Place::Edge {
            from: nodes[a],
            to: nodes[b],
            step: steps[b],
        },
        [a, b] => Place::Edge {
            from: nodes[b],
            to: nodes[a],
            step: steps[a],
        },
        _ => Place::Inside {
            element,
            steps: [steps[1], steps[2]],
        },
    }
}

/// Quadratic shape functions at barycentric coordinates; nodes: corners 0 1 2, mid-edges (0,1) (1,2) (2,0).
fn shape_functions([a, b, c]: [f32; 3]) -> [f32; 6] {
    [
        a * (2.0 * a - 1.0),
        b * (2.0 * b - 1.0),
        c * (2.0 * c - 1.0),
        4.0 * a * b,
        4.0 * b * c,
        4.0 * c * a,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The octahedron's eight faces as P2 elements, mid-edge nodes placed by `bulge`.
    fn octahedron(bulge: f32) -> (Vec<[f32; 3]>, Vec<[u16; 6]>) {
        let mut nodes: Vec<[f32; 3]> = vec![
            [1.0, 0.0, 0.0],
            [-1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, -1.0, 0.0],
            [0.0, 0.0, 1.0],
            [0.0, 0.0, -1.0],
        ];
        let mut middles = HashMap::new();
        let mut elements = Vec::new();
        for face in 0..8_u16 {
            let (x, y, z) = (face & 1, 2 + (face >> 1 & 1), 4 + (face >> 2 & 1));
            // An odd number of mirrored axes turns the face inside out.
            let corners = if face.count_ones() % 2 == 0 {
                [x, y, z]
            } else {
                [x, z, y]
            };
            let middle = |a: u16, b: u16, nodes: &mut Vec<[f32; 3]>, middles: &mut HashMap<(u16, u16), u16>| {
                *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    let (p, q) = (nodes[usize::from(a)], nodes[usize::from(b)]);
                    nodes.push([0, 1, 2].map(|axis| bulge * (p[axis] + q[axis])));
                    (nodes.len() - 1) as u16
                })
            };
            let [a, b, c] = corners;
            elements.push([
                a,
                b,
                c,
                middle(a, b, &mut nodes, &mut middles),
                middle(b, c, &mut nodes, &mut middles),
                middle(c, a, &mut nodes, &mut middles),
            ]);
        }
        (nodes, elements)
    }

    #[test]
    fn two_divisions_are_the_nodes() {
        let (nodes, elements) = octahedron(0.7);
        let positions = Surface::new(&elements, 2).positions(&nodes);
        assert_eq!(positions.len(), nodes.len());
        assert!(positions.iter().all(|position| nodes.contains(position)));
    }

    #[test]
    fn numbers_at_the_vertices_are_interpolated_as_the_positions_are() {
        let (nodes, elements) = octahedron(0.7);
        let surface = Surface::new(&elements, 3);
        let heights: Vec<f32> = nodes.iter().map(|node| node[2]).collect();
        let positions = surface.positions(&nodes);
        for (number, position) in surface.numbers(&heights).iter().zip(&positions) {
            assert!((number - position[2]).abs() < 1e-6);
        }
    }

    #[test]
    fn normals_of_a_ball_point_outward() {
        // Mid-edge nodes on the unit sphere.
        let (nodes, elements) = octahedron(std::f32::consts::FRAC_1_SQRT_2);
        let surface = Surface::new(&elements, 4);
        let at = surface.positions(&nodes);
        for (normal, position) in normals(surface.triangles(), &at).iter().zip(&at) {
            let length = position.iter().map(|x| x * x).sum::<f32>().sqrt();
            let along: f32 = normal.iter().zip(position).map(|(n, x)| n * x / length).sum();
            assert!(along > 0.95, "{normal:?} at {position:?}");
        }
    }

    #[test]
    fn the_surface_is_closed_and_oriented_outward() {
        let (nodes, elements) = octahedron(0.5);
        for divisions in 1..6 {
            let surface = Surface::new(&elements, divisions);
            let mut edges = HashMap::new();
            for &[a, b, c] in surface.triangles() {
                for edge in [(a, b), (b, c), (c, a)] {
                    *edges.entry(edge).or_insert(0) += 1;
                }
            }
            assert!(
                edges
                    .iter()
                    .all(|(&(a, b), &count)| count == 1 && edges.contains_key(&(b, a)))
            );
            assert_eq!(surface.triangles().len(), 8 * divisions * divisions);
            let at = surface.positions(&nodes);
            let six_volumes: f64 = surface
                .triangles()
                .iter()
                .map(|triangle| {
                    let [p, q, r] = triangle.map(|vertex| at[vertex as usize].map(f64::from));
                    p[0] * (q[1] * r[2] - q[2] * r[1])
                        + p[1] * (q[2] * r[0] - q[0] * r[2])
                        + p[2] * (q[0] * r[1] - q[1] * r[0])
                })
                .sum();
            // Mid-edge nodes in the middle leave the flat octahedron, of volume 4/3, whatever the divisions.
            assert!((six_volumes / 6.0 - 4.0 / 3.0).abs() < 1e-6);
        }
    }
}
