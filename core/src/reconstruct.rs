//! From coefficients to vectors at the nodes, for the asked nodes only.

use crate::error::EvaluateError;
use crate::model::{MatrixView, Mesh, Model, apply};
use crate::{Nodes, Real};

/// A field at an instant: positions `(a/l) X + Phi alpha`, or velocities `Phi xi`, and an axial translation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Snapshot<'a, 's, T> {
    pub(crate) mesh: Mesh<'a>,
    pub(crate) modes: MatrixView<'a>,
    /// Coefficients of the leading shape modes, in the units of their columns.
    pub(crate) coefficients: &'s [T],
    /// Factor of the reference nodes: a/l for positions, 0 for velocities.
    pub(crate) scale: T,
    /// Added to the axial component.
    pub(crate) translation: T,
}

impl<T: Real> Snapshot<'_, '_, T> {
    /// The vector at a sector node.
    fn sector_node(&self, node: usize) -> [T; 3] {
        let reference = self.mesh.sector_reference(node);
        let [x, y, z] = core::array::from_fn(|axis| {
            self.scale * T::from_f32(reference[axis]) + self.modes.dot(3 * node + axis, self.coefficients)
        });
        [x + self.translation, y, z]
    }

    /// The vector at a node.
    ///
    /// # Errors
    /// No such node; a result that is not finite.
    pub(crate) fn node(&self, node: usize) -> Result<[T; 3], EvaluateError> {
        let unknown = EvaluateError::UnknownNode {
            node,
            nodes: self.mesh.nodes(),
        };
        let (representative, operation) = self.mesh.origin(node).ok_or(unknown)?;
        finite(apply(operation, self.sector_node(representative)))
    }

    /// The vectors of a choice of nodes; returns how many there are.
    ///
    /// # Errors
    /// As [`node`](Self::node); no such node set; a buffer that is too short.
    pub(crate) fn fill(&self, model: &Model<'_>, nodes: Nodes<'_>, out: &mut [[T; 3]]) -> Result<usize, EvaluateError> {
        match nodes {
            Nodes::All => self.fill_all(room(out, self.mesh.nodes())?),
            Nodes::Set(name) => {
                let set = model.node_set(name).ok_or(EvaluateError::UnknownNodeSet)?;
                self.fill_some(set.iter(), room(out, set.len())?)
            }
            Nodes::List(list) => self.fill_some(list.iter().map(|&node| node.into()), room(out, list.len())?),
        }
    }

    fn fill_some(&self, nodes: impl Iterator<Item = usize>, out: &mut [[T; 3]]) -> Result<usize, EvaluateError> {
        for (node, out) in nodes.zip(&mut *out) {
            *out = self.node(node)?;
        }
        Ok(out.len())
    }

    /// The vectors of the sector's nodes, as many as `out` holds.
    ///
    /// # Errors
    /// A result that is not finite.
    pub(crate) fn fill_sector(&self, out: &mut [[T; 3]]) -> Result<(), EvaluateError> {
        for (index, out) in out.iter_mut().enumerate() {
            *out = finite(self.sector_node(index))?;
        }
        Ok(())
    }

    /// Computes every sector node once, in its place of the full mesh, and mirrors it from there.
    fn fill_all(&self, out: &mut [[T; 3]]) -> Result<usize, EvaluateError> {
        let sector = self.mesh.sector_nodes();
        for (index, node) in sector.iter().enumerate() {
            if let Some(out) = out.get_mut(node) {
                *out = finite(self.sector_node(index))?;
            }
        }
        for node in 0..out.len() {
            let origin = self
                .mesh
                .origin(node)
                .and_then(|(index, operation)| Some((sector.get(index)?, operation)));
            // Validation found a representative for every node and a full node for every representative.
            let Some((origin, operation)) = origin else { continue };
            if let Some(vector) = out.get(origin).copied() {
                out[node] = apply(operation, vector);
            }
        }
        Ok(out.len())
    }
}

/// The first `required` entries of a caller's buffer.
pub(crate) fn room<E>(out: &mut [E], required: usize) -> Result<&mut [E], EvaluateError> {
    let found = out.len();
    out.get_mut(..required)
        .ok_or(EvaluateError::BufferTooShort { required, found })
}

fn finite<T: Real>(vector: [T; 3]) -> Result<[T; 3], EvaluateError> {
    if vector.iter().all(|component| component.is_finite()) {
        Ok(vector)
    } else {
        Err(EvaluateError::NotFinite)
    }
}
