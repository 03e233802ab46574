//! Octahedral geodesic mesh of the unit sphere in six-node (P2) triangles.
//!
//! Each face of the octahedron is divided with frequency `n`: 8 n² elements and 16 n² + 2 nodes. The mesh has the
//! full symmetry of the square channel (8 operations about the x axis), with nodes exactly on the axis and on the
//! symmetry planes, which an icosahedral mesh cannot have.

use std::collections::HashMap;

use crate::FomError;

/// A closed surface of six-node triangles.
///
/// Node order of an element: corners 0 1 2, then the mid-edges 3 = (0, 1), 4 = (1, 2), 5 = (2, 0), as in VTK's
/// quadratic triangle; counter-clockwise seen from outside.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Reference positions `(x, y, z)` on the unit sphere.
    pub nodes: Vec<[f64; 3]>,
    /// Node indices of each element.
    pub elements: Vec<[u32; 6]>,
}

/// The least frequency: below it an element spans a quarter of a great circle.
pub const MINIMUM_FREQUENCY: usize = 2;
/// The greatest frequency: beyond it (65,000 nodes) the dense sums are out of reach.
pub const MAX_FREQUENCY: usize = 64;

impl Mesh {
    /// The geodesic mesh of frequency `n` (even or odd).
    ///
    /// With `m = 2 n`, the nodes of the octant of signs `s` are `(s_x sin(π i / 2m), s_y sin(π j / 2m),
    /// s_z sin(π k / 2m))` normalised, for `i + j + k = m`: the sines keep the element sizes within 20 % of each
    /// other. Coordinates are symmetric to the bit under the operations of the square.
    ///
    /// # Errors
    /// [`FomError::MeshFrequency`] outside [`MINIMUM_FREQUENCY`]..=[`MAX_FREQUENCY`].
    pub fn octahedral(frequency: usize) -> Result<Self, FomError> {
        if !(MINIMUM_FREQUENCY..=MAX_FREQUENCY).contains(&frequency) {
            return Err(FomError::MeshFrequency { frequency });
        }
        let n = frequency as i32;
        let m = 2 * n;
        let mut mesh = Self {
            nodes: Vec::with_capacity(16 * frequency * frequency + 2),
            elements: Vec::with_capacity(8 * frequency * frequency),
        };
        let mut index = HashMap::new();
        for octant in 0..8 {
            let signs = [0, 1, 2].map(|axis| if octant >> axis & 1 == 0 { 1 } else { -1 });
            let outward = signs.iter().product::<i32>() > 0;
            let mut triangle = |corners: [[i32; 3]; 3]| {
                let [a, b, c] = if outward {
                    corners
                } else {
                    [corners[0], corners[2], corners[1]]
                };
                let middle = |p: [i32; 3], q: [i32; 3]| [0, 1, 2].map(|d| (p[d] + q[d]) / 2);
                let lattice = [a, b, c, middle(a, b), middle(b, c), middle(c, a)];
                mesh.elements.push(lattice.map(|p| {
                    let key = [0, 1, 2].map(|d| signs[d] * p[d]);
                    *index.entry(key).or_insert_with(|| {
                        mesh.nodes.push(on_sphere(key, m));
                        (mesh.nodes.len() - 1) as u32
                    })
                }));
            };
            for i in 0..n {
                for j in 0..n - i {
                    let corner = |i: i32, j: i32| [2 * i, 2 * j, m - 2 * i - 2 * j];
                    triangle([corner(i, j), corner(i + 1, j), corner(i, j + 1)]);
                    if i + j < n - 1 {
                        triangle([corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)]);
                    }
                }
            }
        }
        Ok(mesh)
    }
}

/// The point of the unit sphere at the signed lattice point `key`, `|i| + |j| + |k| = m`.
fn on_sphere(key: [i32; 3], m: i32) -> [f64; 3] {
    let quarter_turn = std::f64::consts::FRAC_PI_2;
    let point = key.map(|i| f64::from(i.signum()) * (quarter_turn * f64::from(i.abs()) / f64::from(m)).sin());
    let [x, y, z] = point;
    // y and z first: the sum must not change when they are exchanged.
    let radius = (x * x + (y * y + z * z)).sqrt();
    point.map(|c| c / radius)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vectors::norm;
    use nalgebra::Vector3;

    #[test]
    fn counts_and_euler_characteristic() {
        for n in [2, 3, 5, 8] {
            let mesh = Mesh::octahedral(n).unwrap();
            assert_eq!(mesh.elements.len(), 8 * n * n);
            assert_eq!(mesh.nodes.len(), 16 * n * n + 2);
            // Every directed edge once, with its reverse in the neighbour: closed and consistently oriented.
            let mut edges = HashMap::new();
            for e in &mesh.elements {
                for (a, b, middle) in [(0, 1, 3), (1, 2, 4), (2, 0, 5)] {
                    assert!(edges.insert((e[a], e[b]), e[middle]).is_none());
                }
            }
            assert!(edges.iter().all(|(&(a, b), middle)| edges.get(&(b, a)) == Some(middle)));
        }
    }

    #[test]
    fn elements_point_outward_and_have_like_sizes() {
        for n in [5, 8, 13] {
            let mesh = Mesh::octahedral(n).unwrap();
            let (mut least, mut greatest) = (f64::INFINITY, 0.0_f64);
            for e in &mesh.elements {
                let [a, b, c] = [0, 1, 2].map(|k| Vector3::from(mesh.nodes[e[k] as usize]));
                let centre = (a + b + c) / 3.0;
                assert!((b - a).cross(&(c - a)).dot(&centre) > 0.0);
                let radius = [a, b, c].map(|p| norm(p - centre)).into_iter().fold(0.0, f64::max);
                (least, greatest) = (least.min(radius), greatest.max(radius));
            }
            assert!(greatest / least < 1.25, "{}", greatest / least);
        }
    }

    #[test]
    fn poles_lie_on_the_axis_and_the_radius_is_one() {
        let mesh = Mesh::octahedral(7).unwrap();
        for pole in [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]] {
            assert_eq!(mesh.nodes.iter().filter(|&&p| p == pole).count(), 1);
        }
        for p in &mesh.nodes {
            assert!((p.iter().map(|c| c * c).sum::<f64>() - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn refuses_frequencies_out_of_range() {
        for frequency in [0, 1, 65] {
            assert!(matches!(
                Mesh::octahedral(frequency),
                Err(FomError::MeshFrequency { .. })
            ));
        }
    }
}
