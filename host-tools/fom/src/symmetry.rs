//! The symmetry of the square channel: 8 operations on `(y, z)` and the reduction of nodal fields to one eighth.
//!
//! Operation `g` in `0..8`: bit 2 exchanges y and z (applied first), then bit 0 reverses y and bit 1 reverses z. The
//! fundamental sector is `0 <= z <= y`.

use std::collections::HashMap;

use crate::{FomError, Mesh};

/// Orbits of the mesh nodes under the operations of the square.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Symmetry {
    /// Node indices (into the full mesh) at which fields are evaluated.
    pub sector: Vec<u32>,
    /// For each node of the mesh, the index INTO `sector` of the node that represents it.
    pub representative: Vec<u32>,
    /// For each node of the mesh, the operation that takes its representative there.
    pub operation: Vec<u8>,
    /// 8 if reduced, 1 if every node represents itself.
    pub order: usize,
}

/// The image of a vector (or point) under operation `g`.
pub fn apply(g: u8, [x, y, z]: [f64; 3]) -> [f64; 3] {
    let (y, z) = if g & 4 == 0 { (y, z) } else { (z, y) };
    [x, if g & 1 == 0 { y } else { -y }, if g & 2 == 0 { z } else { -z }]
}

impl Symmetry {
    /// The trivial group: every node is evaluated.
    pub fn unreduced(mesh: &Mesh) -> Self {
        let all: Vec<u32> = (0..mesh.nodes.len() as u32).collect();
        Self {
            operation: vec![0; all.len()],
            representative: all.clone(),
            sector: all,
            order: 1,
        }
    }

    /// The reduction to the sector `0 <= z <= y`, found by mapping the nodes onto each other.
    ///
    /// # Errors
    /// [`FomError::Asymmetric`] if a node has no image in the sector.
    pub fn reduced(mesh: &Mesh) -> Result<Self, FomError> {
        let sector: Vec<u32> = (0..mesh.nodes.len() as u32)
            .filter(|&i| {
                let [_, y, z] = mesh.nodes[i as usize];
                (-TOLERANCE..=y + TOLERANCE).contains(&z)
            })
            .collect();
        let mut orbit = HashMap::new();
        for (s, &i) in (0..).zip(&sector) {
            for g in 0..8 {
                // A node on a symmetry plane is reached by several operations; the first will do.
                orbit.entry(key(apply(g, mesh.nodes[i as usize]))).or_insert((s, g));
            }
        }
        let (representative, operation) = mesh
            .nodes
            .iter()
            .enumerate()
            .map(|(node, &point)| {
                orbit
                    .get(&key(point))
                    .copied()
                    .ok_or(FomError::Asymmetric { node, point })
            })
            .collect::<Result<_, _>>()?;
        Ok(Self {
            sector,
            representative,
            operation,
            order: 8,
        })
    }

    /// The full field of a field on the sector: `full(i) = g(i) field(representative(i))`.
    ///
    /// `sector_field` has `sector.len()` entries, `full` one for each node of the mesh.
    pub fn expand(&self, sector_field: &[[f64; 3]], full: &mut [[f64; 3]]) {
        for ((value, &s), &g) in full.iter_mut().zip(&self.representative).zip(&self.operation) {
            *value = apply(g, sector_field[s as usize]);
        }
    }

    /// Makes a field on the sector compatible with the symmetry, in place: no component across the planes `z = 0`
    /// and `y = z` at the nodes that lie there. Does nothing if unreduced.
    pub fn symmetrise(&self, mesh: &Mesh, sector_field: &mut [[f64; 3]]) {
        if self.order == 1 {
            return;
        }
        for (value, &i) in sector_field.iter_mut().zip(&self.sector) {
            let [_, y, z] = mesh.nodes[i as usize];
            if (y - z).abs() < TOLERANCE {
                let mean = 0.5 * (value[1] + value[2]);
                (value[1], value[2]) = (mean, mean);
            }
            if z.abs() < TOLERANCE {
                value[2] = 0.0;
                if y.abs() < TOLERANCE {
                    value[1] = 0.0;
                }
            }
        }
    }

    /// Number of mesh nodes that each sector node represents.
    pub fn multiplicities(&self) -> Vec<f64> {
        let mut count = vec![0.0; self.sector.len()];
        for &s in &self.representative {
            count[s as usize] += 1.0;
        }
        count
    }
}

/// Two reference points closer than this (radius 1) are the same.
const TOLERANCE: f64 = 1e-9;

fn key(point: [f64; 3]) -> [i64; 3] {
    point.map(|c| (c / TOLERANCE).round() as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sector_is_an_eighth_and_expands_to_the_same_bits() {
        for n in [2, 3, 8, 13] {
            let mesh = Mesh::octahedral(n).unwrap();
            let symmetry = Symmetry::reduced(&mesh).unwrap();
            let sector: Vec<_> = symmetry.sector.iter().map(|&i| mesh.nodes[i as usize]).collect();
            let mut full = vec![[0.0; 3]; mesh.nodes.len()];
            symmetry.expand(&sector, &mut full);
            assert_eq!(full, mesh.nodes);
            assert_eq!(symmetry.multiplicities().iter().sum::<f64>(), mesh.nodes.len() as f64);
            assert!((sector.len() as f64) < mesh.nodes.len() as f64 / 8.0 + 4.0 * n as f64);
        }
    }

    #[test]
    fn operations_map_the_mesh_onto_itself() {
        let mesh = Mesh::octahedral(5).unwrap();
        let keys: std::collections::HashSet<_> = mesh.nodes.iter().map(|&p| key(p)).collect();
        for g in 0..8 {
            assert!(mesh.nodes.iter().all(|&p| keys.contains(&key(apply(g, p)))));
        }
    }

    #[test]
    fn symmetrised_fields_are_invariant_under_the_group() {
        let mesh = Mesh::octahedral(4).unwrap();
        let symmetry = Symmetry::reduced(&mesh).unwrap();
        let mut field: Vec<_> = (0..symmetry.sector.len())
            .map(|i| [(i as f64).sin(), (2.0 * i as f64).cos(), (3.0 * i as f64).sin()])
            .collect();
        symmetry.symmetrise(&mesh, &mut field);
        let mut full = vec![[0.0; 3]; mesh.nodes.len()];
        symmetry.expand(&field, &mut full);
        let node: HashMap<_, _> = mesh.nodes.iter().enumerate().map(|(i, &p)| (key(p), i)).collect();
        for g in 0..8 {
            for (i, &p) in mesh.nodes.iter().enumerate() {
                let image = full[node[&key(apply(g, p))]];
                let expected = apply(g, full[i]);
                assert!((0..3).all(|d| (image[d] - expected[d]).abs() < 1e-15));
            }
        }
    }

    #[test]
    fn an_asymmetric_mesh_is_refused() {
        let mut mesh = Mesh::octahedral(2).unwrap();
        let node = mesh.nodes.iter().position(|p| p[1] < -0.3 && p[2] < -0.5).unwrap();
        mesh.nodes[node][0] += 0.01;
        assert!(matches!(Symmetry::reduced(&mesh), Err(FomError::Asymmetric { .. })));
    }
}
