//! The membrane mesh: quadratic or flat triangles, and the volume centroid of the body that they enclose.

use crate::DatabaseError;
use crate::error::{finite, length};

/// A closed surface mesh of quadratic or of flat triangles, in its reference state.
///
/// Node order of an element: corners 0 1 2, then the mid-edges of (0, 1), (1, 2), (2, 0), counter-clockwise from
/// outside. A flat triangle names its corners again in the place of mid-edges, see [`Mesh::is_flat`].
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Reference positions; in a [`Database`](crate::Database) on the unit sphere, and times a/l the stress-free state.
    pub nodes: Vec<[f64; 3]>,
    /// Node indices of each element.
    pub elements: Vec<[u32; 6]>,
}

/// Quadrature on the unit triangle, exact for polynomials of degree 6 (Dunavant 1985, 12 points): barycentric
/// coordinates of one point of each symmetry orbit, and the weight relative to the triangle's area.
const QUADRATURE: [([f64; 3], f64); 3] = [
    (
        [0.501_426_509_658_179, 0.249_286_745_170_910, 0.249_286_745_170_911],
        0.116_786_275_726_379,
    ),
    (
        [0.873_821_971_016_996, 0.063_089_014_491_502, 0.063_089_014_491_502],
        0.050_844_906_370_207,
    ),
    (
        [0.053_145_049_844_817, 0.310_352_451_033_784, 0.636_502_499_121_399],
        0.082_851_075_618_374,
    ),
];

impl Mesh {
    /// Whether an element has no mid-edge nodes.
    #[must_use]
    pub fn is_flat(element: &[u32; 6]) -> bool {
        element[0] == element[3]
    }

    /// Checks that the mesh has nodes and elements, that they are finite, and that every element's nodes exist.
    ///
    /// # Errors
    /// [`DatabaseError::BadMesh`] or [`DatabaseError::NotFinite`].
    pub fn validate(&self) -> Result<(), DatabaseError> {
        let bad = |reason: String| Err(DatabaseError::BadMesh { reason });
        if self.nodes.is_empty() || self.elements.is_empty() {
            let (n, e) = (self.nodes.len(), self.elements.len());
            return bad(format!("{n} nodes and {e} elements, expected at least one of each"));
        }
        finite("mesh nodes", self.nodes.as_flattened())?;
        for (e, element) in self.elements.iter().enumerate() {
            if let Some(node) = element.iter().find(|node| **node as usize >= self.nodes.len()) {
                return bad(format!(
                    "element {e} names node {node}, but there are {} nodes",
                    self.nodes.len()
                ));
            }
        }
        Ok(())
    }

    /// Volume and axial position of its centroid when the nodes are at `positions`, exact on the quadratic surface.
    ///
    /// # Errors
    /// [`DatabaseError::WrongLength`] when there is not one position a node.
    pub fn volume_and_centroid(&self, positions: &[[f64; 3]]) -> Result<(f64, f64), DatabaseError> {
        let m = self.moments(positions, positions)?;
        Ok((m.volume, m.first / m.volume))
    }

    /// Axial velocity of the volume centroid when the nodes move at `velocities`.
    ///
    /// By Reynolds' theorem the first moment of the volume changes at the rate of int x (v . n) dS, which the
    /// quadrature integrates exactly on the quadratic surface.
    ///
    /// # Errors
    /// [`DatabaseError::WrongLength`] when there is not one position and one velocity a node.
    pub fn centroid_velocity(&self, positions: &[[f64; 3]], velocities: &[[f64; 3]]) -> Result<f64, DatabaseError> {
        let m = self.moments(positions, velocities)?;
        Ok((m.first_rate - m.first / m.volume * m.volume_rate) / m.volume)
    }

    fn moments(&self, positions: &[[f64; 3]], velocities: &[[f64; 3]]) -> Result<Moments, DatabaseError> {
        length("node positions", self.nodes.len(), positions.len())?;
        length("node velocities", self.nodes.len(), velocities.len())?;
        let mut m = Moments::default();
        for element in &self.elements {
            let x = nodal(element, positions);
            let v = nodal(element, velocities);
            for (orbit, weight) in QUADRATURE {
                // The cyclic images of a point are distinct; a point with three different coordinates has their
                // mirror images too.
                let mirrored = (orbit[1] - orbit[2]).abs() > 1e-3;
                for k in 0..if mirrored { 6 } else { 3 } {
                    let mut b = [orbit[k % 3], orbit[(k + 1) % 3], orbit[(k + 2) % 3]];
                    if k >= 3 {
                        b.swap(1, 2);
                    }
                    m.add(&x, &v, b, 0.5 * weight);
                }
            }
        }
        Ok(m)
    }
}

/// The values at the six nodes of an element; halfway between the corners where it is flat.
fn nodal(element: &[u32; 6], values: &[[f64; 3]]) -> [[f64; 3]; 6] {
    let mut nodal = element.map(|n| values[n as usize]);
    if Mesh::is_flat(element) {
        for (middle, [a, b]) in [[0, 1], [1, 2], [2, 0]].into_iter().enumerate() {
            nodal[3 + middle] = std::array::from_fn(|d| 0.5 * (nodal[a][d] + nodal[b][d]));
        }
    }
    nodal
}

/// Volume, its first axial moment, and their rates of change.
#[derive(Default)]
struct Moments {
    volume: f64,
    first: f64,
    volume_rate: f64,
    first_rate: f64,
}

impl Moments {
    /// Adds the quadrature point with barycentric coordinates `[a, b, c]`.
    fn add(&mut self, positions: &[[f64; 3]; 6], velocities: &[[f64; 3]; 6], [a, b, c]: [f64; 3], weight: f64) {
        let shape = [
            a * (2.0 * a - 1.0),
            b * (2.0 * b - 1.0),
            c * (2.0 * c - 1.0),
            4.0 * a * b,
            4.0 * b * c,
            4.0 * c * a,
        ];
        // Derivatives along the edges 0 -> 1 and 0 -> 2.
        let along_b = [1.0 - 4.0 * a, 4.0 * b - 1.0, 0.0, 4.0 * (a - b), 4.0 * c, -4.0 * c];
        let along_c = [1.0 - 4.0 * a, 0.0, 4.0 * c - 1.0, -4.0 * b, 4.0 * b, 4.0 * (a - c)];
        let at = |weights: &[f64; 6], nodal: &[[f64; 3]; 6]| -> [f64; 3] {
            std::array::from_fn(|d| weights.iter().zip(nodal).map(|(w, n)| w * n[d]).sum())
        };
        let (x, v) = (at(&shape, positions), at(&shape, velocities));
        let (s, t) = (at(&along_b, positions), at(&along_c, positions));
        let normal = [
            s[1] * t[2] - s[2] * t[1],
            s[2] * t[0] - s[0] * t[2],
            s[0] * t[1] - s[1] * t[0],
        ];
        let flux = v[0] * normal[0] + v[1] * normal[1] + v[2] * normal[2];
        self.volume += weight * x[0] * normal[0];
        self.first += weight * 0.5 * x[0] * x[0] * normal[0];
        self.volume_rate += weight * flux;
        self.first_rate += weight * x[0] * flux;
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use std::collections::HashMap;

    /// An octahedral geodesic mesh of the unit sphere with `8 n^2` elements, for tests.
    pub(crate) fn octahedral(n: i32) -> Mesh {
        let m = 2 * n;
        let mut nodes = Vec::new();
        let mut index = HashMap::new();
        let mut node = |p: [i32; 3]| -> u32 {
            *index.entry(p).or_insert_with(|| {
                let s = p.map(|k| (std::f64::consts::FRAC_PI_2 * f64::from(k) / f64::from(m)).sin());
                let norm = (s[0] * s[0] + s[1] * s[1] + s[2] * s[2]).sqrt();
                nodes.push(s.map(|c| c / norm));
                nodes.len() as u32 - 1
            })
        };
        let mut elements = Vec::new();
        for octant in 0..8 {
            let sign = [0, 1, 2].map(|d| if octant >> d & 1 == 0 { 1 } else { -1 });
            let flipped = sign.iter().product::<i32>() < 0;
            let mut triangle = |a: [i32; 2], b: [i32; 2], c: [i32; 2]| {
                let corners = if flipped { [a, c, b] } else { [a, b, c] };
                let point = |p: [i32; 2]| [sign[0] * p[0], sign[1] * p[1], sign[2] * (m - p[0] - p[1])];
                let middle = |p: [i32; 2], q: [i32; 2]| [(p[0] + q[0]) / 2, (p[1] + q[1]) / 2];
                let [a, b, c] = corners;
                elements.push([a, b, c, middle(a, b), middle(b, c), middle(c, a)].map(|p| node(point(p))));
            };
            for i in (0..m).step_by(2) {
                for j in (0..m - i).step_by(2) {
                    triangle([i, j], [i + 2, j], [i, j + 2]);
                    if i + j + 2 < m {
                        triangle([i + 2, j], [i + 2, j + 2], [i, j + 2]);
                    }
                }
            }
        }
        Mesh { nodes, elements }
    }

    #[test]
    fn quadrature_is_exact_to_degree_6() {
        // int b^p c^q over the unit triangle = p! q! / (p + q + 2)!
        let factorial = |n: usize| (1..=n).product::<usize>() as f64;
        for p in 0..=6 {
            for q in 0..=6 - p {
                let mut sum = 0.0;
                for (o, w) in QUADRATURE {
                    let mirrored = (o[1] - o[2]).abs() > 1e-3;
                    for k in 0..if mirrored { 6 } else { 3 } {
                        let mut b = [o[k % 3], o[(k + 1) % 3], o[(k + 2) % 3]];
                        if k >= 3 {
                            b.swap(1, 2);
                        }
                        sum += 0.5 * w * b[1].powi(p as i32) * b[2].powi(q as i32);
                    }
                }
                let exact = factorial(p) * factorial(q) / factorial(p + q + 2);
                assert!((sum - exact).abs() < 1e-14, "b^{p} c^{q}: {sum} {exact}");
            }
        }
    }

    #[test]
    fn an_ellipsoid_has_its_volume_and_centroid() {
        let mesh = octahedral(8);
        assert_eq!((mesh.nodes.len(), mesh.elements.len()), (1026, 512));
        let nodes: Vec<_> = mesh
            .nodes
            .iter()
            .map(|[x, y, z]| [3.0 + 1.5 * x, 0.8 * y, 0.7 * z])
            .collect();
        let (volume, centroid) = mesh.volume_and_centroid(&nodes).unwrap();
        let exact = 4.0 / 3.0 * std::f64::consts::PI * 1.5 * 0.8 * 0.7;
        assert!((volume / exact - 1.0).abs() < 1e-4, "{volume} {exact}");
        assert!((centroid - 3.0).abs() < 1e-12, "{centroid}");
    }

    #[test]
    fn flat_triangles_enclose_a_polyhedron() {
        // A tetrahedron with its tip at (1, 0, 0) over the base x = 0: volume 1/6, centroid a quarter of the height up.
        let nodes = vec![[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]];
        let flat = |[a, b, c]: [u32; 3]| [a, b, c, a, b, c];
        let elements = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]].map(flat).to_vec();
        let mesh = Mesh { nodes, elements };
        let (volume, centroid) = mesh.volume_and_centroid(&mesh.nodes).unwrap();
        assert!(
            (volume - 1.0 / 6.0).abs() < 1e-15 && (centroid - 0.25).abs() < 1e-15,
            "{volume} {centroid}"
        );
    }

    #[test]
    fn the_centroid_moves_at_its_velocity() {
        // Against a central difference of the position itself, for a motion that changes shape and volume.
        let mesh = octahedral(3);
        let velocities: Vec<_> = mesh
            .nodes
            .iter()
            .map(|[x, y, z]| [0.3 + x * x - y * z, x * y, 0.2 * z])
            .collect();
        let moved = |t: f64| -> Vec<[f64; 3]> {
            let pairs = mesh.nodes.iter().zip(&velocities);
            pairs
                .map(|(x, v)| [x[0] + t * v[0], x[1] + t * v[1], x[2] + t * v[2]])
                .collect()
        };
        let centroid = |t: f64| mesh.volume_and_centroid(&moved(t)).unwrap().1;
        let difference = (centroid(1e-4) - centroid(-1e-4)) / 2e-4;
        let velocity = mesh.centroid_velocity(&mesh.nodes, &velocities).unwrap();
        assert!((velocity - difference).abs() < 1e-8, "{velocity} {difference}");
    }

    #[test]
    fn bad_meshes_are_named() {
        let mut mesh = octahedral(2);
        mesh.elements[5][3] = 999;
        assert!(
            mesh.validate()
                .unwrap_err()
                .to_string()
                .contains("element 5 names node 999")
        );
        let empty = Mesh {
            nodes: vec![],
            elements: vec![],
        };
        assert!(matches!(empty.validate(), Err(DatabaseError::BadMesh { .. })));
        let mut mesh = octahedral(2);
        mesh.nodes[2][1] = f64::NAN;
        assert!(matches!(
            mesh.validate(),
            Err(DatabaseError::NotFinite { index: 7, .. })
        ));
    }
}
