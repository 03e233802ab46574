//! The symmetry of the square duct: which nodes are images of which.

use crate::DatabaseError;
use crate::error::length;

/// Nodes that an operation should bring into coincidence may miss each other by this much (unit sphere).
const TOLERANCE: f64 = 1e-7;

/// Applies operation `operation` (0..8) of the square's symmetry group to a point or vector.
///
/// Bit 2 swaps y and z and acts first, then bit 0 changes the sign of y and bit 1 that of z.
#[must_use]
pub fn apply(operation: u8, [x, y, z]: [f64; 3]) -> [f64; 3] {
    let (y, z) = if operation & 4 == 0 { (y, z) } else { (z, y) };
    [
        x,
        if operation & 1 == 0 { y } else { -y },
        if operation & 2 == 0 { z } else { -z },
    ]
}

/// The symmetry of a mesh: every node is the image of one node of a sector.
///
/// For a mesh with the whole group of the square (order 8) the sector is 0 <= z <= y.
#[derive(Debug, Clone, PartialEq)]
pub struct Symmetry {
    /// The operations that map the mesh onto itself; the first is 0, the identity.
    pub operations: Vec<u8>,
    /// The nodes of the sector, ascending.
    pub sector: Vec<u32>,
    /// For each node, the index INTO `sector` of the node that it is an image of.
    pub representative: Vec<u32>,
    /// For each node, the operation that maps its representative to it.
    pub operation: Vec<u8>,
}

impl Symmetry {
    /// Finds the operations of the square's group that map `nodes` onto themselves, and the sector they leave.
    #[must_use]
    pub fn detect(nodes: &[[f64; 3]]) -> Self {
        Self::detect_where(nodes, |_, _| true)
    }

    /// As [`Symmetry::detect`], of the operations that `holds` accepts, which is given each with the node to which it
    /// takes every node. Those accepted must form a group.
    #[must_use]
    pub fn detect_where(nodes: &[[f64; 3]], holds: impl Fn(u8, &[u32]) -> bool) -> Self {
        let finder = Finder::new(nodes);
        let images = (0..8).filter_map(|g| Some((g, finder.images(g)?)));
        let images: Vec<(u8, Vec<u32>)> = images.filter(|(g, image)| *g == 0 || holds(*g, image)).collect();
        let mut origin = vec![0u32; nodes.len()];
        let mut operation = vec![0u8; nodes.len()];
        let mut sector = Vec::new();
        let mut seen = vec![false; nodes.len()];
        for i in 0..nodes.len() {
            if seen[i] {
                continue;
            }
            // Of an orbit, the node with the largest y, then the largest z: it lies in 0 <= z <= y for the whole group.
            let orbit = images.iter().map(|(_, image)| image[i] as usize);
            let best = orbit.fold(i, |best, k| if precedes(nodes[k], nodes[best]) { k } else { best });
            for (g, image) in &images {
                let k = image[best] as usize;
                if !seen[k] {
                    seen[k] = true;
                    origin[k] = best as u32;
                    operation[k] = *g;
                }
            }
            sector.push(best as u32);
        }
        sector.sort_unstable();
        let mut index = vec![0u32; nodes.len()];
        for (s, node) in sector.iter().enumerate() {
            index[*node as usize] = s as u32;
        }
        let representative = origin.iter().map(|node| index[*node as usize]).collect();
        Symmetry {
            operations: images.into_iter().map(|(g, _)| g).collect(),
            sector,
            representative,
            operation,
        }
    }

    /// Checks that every node of the mesh is the image of its representative.
    ///
    /// # Errors
    /// [`DatabaseError::BadMesh`] with the first node for which it is not.
    pub fn validate(&self, nodes: &[[f64; 3]]) -> Result<(), DatabaseError> {
        length(
            "symmetry table `representative`",
            nodes.len(),
            self.representative.len(),
        )?;
        length("symmetry table `operation`", nodes.len(), self.operation.len())?;
        for (i, node) in nodes.iter().enumerate() {
            let origin = self
                .sector
                .get(self.representative[i] as usize)
                .and_then(|s| nodes.get(*s as usize));
            let image = origin.map(|origin| apply(self.operation[i], *origin));
            if !image.is_some_and(|p| (0..3).all(|d| (p[d] - node[d]).abs() <= TOLERANCE)) {
                let reason = format!("node {i} is not the image that the symmetry tables make of its representative");
                return Err(DatabaseError::BadMesh { reason });
            }
        }
        Ok(())
    }

    /// The order of the group: 8 for the whole group of the square, 1 without symmetry.
    #[must_use]
    pub fn order(&self) -> usize {
        self.operations.len()
    }

    /// The number of images of each sector node; they add up to the number of nodes.
    #[must_use]
    pub fn orbit_sizes(&self) -> Vec<u32> {
        let mut sizes = vec![0; self.sector.len()];
        for r in &self.representative {
            sizes[*r as usize] += 1;
        }
        sizes
    }

    /// The values of a field at the sector's nodes.
    ///
    /// # Errors
    /// [`DatabaseError::WrongLength`] when the field is not one value a node.
    pub fn restrict(&self, field: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, DatabaseError> {
        length("nodes of a field", self.representative.len(), field.len())?;
        Ok(self.sector.iter().map(|node| field[*node as usize]).collect())
    }

    /// The field at all nodes from its values at the sector's nodes.
    ///
    /// # Errors
    /// [`DatabaseError::WrongLength`] when the field is not one value a sector node.
    pub fn expand(&self, field: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, DatabaseError> {
        length("sector nodes of a field", self.sector.len(), field.len())?;
        let images = self.representative.iter().zip(&self.operation);
        Ok(images.map(|(r, g)| apply(*g, field[*r as usize])).collect())
    }

    /// The largest difference, in any component at any node, between a field and the expansion of its sector.
    ///
    /// # Errors
    /// [`DatabaseError::WrongLength`] when the field is not one value a node.
    pub fn deviation(&self, field: &[[f64; 3]]) -> Result<f64, DatabaseError> {
        let expanded = self.expand(&self.restrict(field)?)?;
        let pairs = expanded.as_flattened().iter().zip(field.as_flattened());
        Ok(pairs.fold(0.0, |worst, (a, b)| f64::max(worst, (a - b).abs())))
    }
}

/// Whether `a` is to represent an orbit rather than `b`.
fn precedes(a: [f64; 3], b: [f64; 3]) -> bool {
    let (dy, dz) = (a[1] - b[1], a[2] - b[2]);
    dy > TOLERANCE || (dy > -TOLERANCE && dz > TOLERANCE)
}

/// Finds nodes by position: sorted by x, searched in the slice of nearly equal x.
struct Finder<'a> {
    nodes: &'a [[f64; 3]],
    order: Vec<u32>,
}

impl<'a> Finder<'a> {
    fn new(nodes: &'a [[f64; 3]]) -> Self {
        let mut order: Vec<u32> = (0..nodes.len() as u32).collect();
        order.sort_by(|a, b| nodes[*a as usize][0].total_cmp(&nodes[*b as usize][0]));
        Finder { nodes, order }
    }

    fn find(&self, point: [f64; 3]) -> Option<u32> {
        let start = self
            .order
            .partition_point(|k| self.nodes[*k as usize][0] < point[0] - TOLERANCE);
        let near = |a: f64, b: f64| (a - b).abs() <= TOLERANCE;
        let slice = self.order[start..]
            .iter()
            .take_while(|k| self.nodes[**k as usize][0] <= point[0] + TOLERANCE);
        slice.copied().find(|k| {
            let node = self.nodes[*k as usize];
            near(node[1], point[1]) && near(node[2], point[2])
        })
    }

    /// For each node the node at its image, or `None` when an image is not a node.
    fn images(&self, operation: u8) -> Option<Vec<u32>> {
        self.nodes
            .iter()
            .map(|node| self.find(apply(operation, *node)))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::tests::octahedral;

    #[test]
    fn the_operations_form_a_group() {
        let point = [0.3, 0.5, 0.2];
        let images: Vec<_> = (0..8).map(|g| apply(g, point)).collect();
        for a in 0..8 {
            for b in 0..8 {
                assert!(images.contains(&apply(a, apply(b, point))));
            }
            assert_eq!(images.iter().filter(|p| **p == images[a as usize]).count(), 1);
        }
    }

    #[test]
    fn an_octahedral_mesh_has_the_whole_group() {
        let mesh = octahedral(4);
        let symmetry = Symmetry::detect(&mesh.nodes);
        assert_eq!(symmetry.order(), 8);
        for node in &symmetry.sector {
            let [_, y, z] = mesh.nodes[*node as usize];
            assert!(z >= -1e-12 && z <= y + 1e-12, "({y}, {z}) is not in the sector");
        }
        assert_eq!(symmetry.orbit_sizes().iter().sum::<u32>() as usize, mesh.nodes.len());
        assert!(symmetry.deviation(&mesh.nodes).unwrap() < 1e-12);
        // Burnside: the orbits are the mean number of nodes that an operation leaves in place.
        let fixed = |g: u8| {
            let stays = |n: &&[f64; 3]| apply(g, **n).iter().zip(**n).all(|(a, b)| (a - b).abs() < 1e-9);
            mesh.nodes.iter().filter(stays).count()
        };
        assert_eq!(symmetry.sector.len(), (0..8).map(fixed).sum::<usize>() / 8);
    }

    #[test]
    fn a_perturbed_mesh_keeps_the_symmetry_that_it_has() {
        // One node moved, and its mirror image in y: only the mirror (operation 1) is left.
        let mut mesh = octahedral(4);
        let generic = |n: &[f64; 3]| n[1].abs() > 0.1 && n[2].abs() > 0.1 && (n[1].abs() - n[2].abs()).abs() > 0.1;
        let node = mesh.nodes.iter().position(generic).unwrap();
        let mirror = mesh
            .nodes
            .iter()
            .position(|n| apply(1, *n) == mesh.nodes[node])
            .unwrap();
        mesh.nodes[node][2] += 1e-3;
        assert_eq!(Symmetry::detect(&mesh.nodes).order(), 1);
        mesh.nodes[mirror][2] += 1e-3;
        let symmetry = Symmetry::detect(&mesh.nodes);
        assert_eq!(symmetry.operations, [0, 1]);
        assert!(symmetry.deviation(&mesh.nodes).unwrap() < 1e-12);
    }

    #[test]
    fn without_symmetry_every_node_stands_for_itself() {
        let mut mesh = octahedral(2);
        mesh.nodes[7][1] += 1e-3;
        let symmetry = Symmetry::detect(&mesh.nodes);
        assert_eq!(symmetry.order(), 1);
        assert_eq!(symmetry.sector.len(), mesh.nodes.len());
        assert_eq!(symmetry.deviation(&mesh.nodes).unwrap(), 0.0);
    }

    #[test]
    fn a_field_of_another_mesh_is_refused() {
        let symmetry = Symmetry::detect(&octahedral(2).nodes);
        assert!(symmetry.restrict(&[[0.0; 3]; 5]).is_err());
        assert!(symmetry.expand(&[[0.0; 3]; 5]).is_err());
    }
}
