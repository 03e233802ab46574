//! Joins the pieces of a surface: nodes of different pieces at the same place are one.

use std::collections::HashMap;

use super::vtu::Snapshot;

/// Which nodes are one.
pub(super) struct Weld {
    /// The number of nodes of each piece.
    pub pieces: Vec<usize>,
    /// The number in the joined surface of each node.
    number: Vec<u32>,
    /// The first node of each number.
    first: Vec<usize>,
}

impl Weld {
    /// Nodes of different pieces are one if they coincide exactly.
    pub fn of(snapshot: &Snapshot) -> Self {
        let mut weld = Self {
            pieces: snapshot.pieces.clone(),
            number: Vec::new(),
            first: Vec::new(),
        };
        // At each place: the numbers there, each with the last piece that has it.
        let mut places: HashMap<[u64; 3], Vec<(u32, usize)>> = HashMap::new();
        let pieces = weld
            .pieces
            .iter()
            .enumerate()
            .flat_map(|(piece, nodes)| std::iter::repeat_n(piece, *nodes));
        for (node, (piece, position)) in pieces.zip(&snapshot.positions).enumerate() {
            // Adding 0 makes -0 the same as 0.
            let here = places.entry(position.map(|x| (x + 0.0).to_bits())).or_default();
            match here.iter_mut().find(|(_, last)| *last != piece) {
                Some((number, last)) => {
                    *last = piece;
                    weld.number.push(*number);
                }
                None => {
                    let number = weld.first.len() as u32;
                    here.push((number, piece));
                    weld.number.push(number);
                    weld.first.push(node);
                }
            }
        }
        weld
    }

    /// Triangles with the joined nodes.
    pub fn triangles(&self, triangles: &[[u32; 6]]) -> Vec<[u32; 6]> {
        let joined = |triangle: &[u32; 6]| triangle.map(|node| self.number[node as usize]);
        triangles.iter().map(joined).collect()
    }

    /// A snapshot of the joined surface.
    ///
    /// # Errors
    /// Nodes that are one, but not at the same place.
    pub fn join(&self, snapshot: Snapshot) -> Result<Snapshot, String> {
        for (node, number) in self.number.iter().enumerate() {
            let first = self.first[*number as usize];
            if snapshot.positions[node] != snapshot.positions[first] {
                return Err(format!(
                    "there the pieces share a node, here their nodes {first} and {node} (counted through all pieces) \
                     are apart"
                ));
            }
        }
        let chosen = |values: Vec<[f64; 3]>| self.first.iter().map(|node| values[*node]).collect();
        Ok(Snapshot {
            triangles: self.triangles(&snapshot.triangles),
            positions: chosen(snapshot.positions),
            velocities: snapshot.velocities.map(chosen),
            ..snapshot
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two halves of a tetrahedron, which share an edge; the second numbers its nodes otherwise.
    fn halves() -> Snapshot {
        let [a, b, c, d] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let positions = vec![a, b, c, d, d, c, b, [-0.0; 3]];
        Snapshot {
            velocities: Some(positions.iter().map(|x| x.map(|x: f64| 2.0 * x)).collect()),
            positions,
            triangles: vec![
                [0, 2, 1, 0, 2, 1],
                [0, 1, 3, 0, 1, 3],
                [7, 4, 5, 7, 4, 5],
                [6, 5, 4, 6, 5, 4],
            ],
            pieces: vec![4, 4],
            left_out: 0,
        }
    }

    #[test]
    fn pieces_share_the_nodes_at_the_same_place() {
        let weld = Weld::of(&halves());
        let joined = weld.join(halves()).unwrap();
        assert_eq!(joined.positions, halves().positions[..4]);
        assert_eq!(joined.velocities.as_ref().unwrap()[3], [0.0, 0.0, 2.0]);
        let corners: Vec<_> = joined.triangles.iter().map(|triangle| &triangle[..3]).collect();
        assert_eq!(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]);
    }

    #[test]
    fn nodes_of_one_piece_stay_apart() {
        let mut one = halves();
        one.pieces = vec![8];
        let joined = Weld::of(&one).join(halves()).unwrap();
        assert_eq!(joined.positions, halves().positions);
        assert_eq!(joined.triangles, halves().triangles);
    }

    #[test]
    fn shared_nodes_that_part_are_named() {
        let mut torn = halves();
        torn.positions[5][2] += 1e-9;
        let error = Weld::of(&halves()).join(torn).unwrap_err();
        assert!(error.contains("nodes 2 and 5"), "{error}");
    }
}
