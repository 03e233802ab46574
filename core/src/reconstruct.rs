//! From coefficients to vectors at the nodes, for the asked nodes only.

use crate::error::EvaluateError;
use crate::model::{DIAGONAL, MIDPLANE, MatrixView, Mesh, Model, apply};
use crate::{Nodes, Real};

/// A field at `B` instants: positions `(a/l) X + Phi alpha`, or velocities `Phi xi`, and an axial translation. Several
/// instants share one pass over the modes, and come to the same bits as each alone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Snapshot<'a, 's, T, const B: usize = 1> {
    pub(crate) mesh: Mesh<'a>,
    pub(crate) modes: MatrixView<'a>,
    /// Coefficients of the leading shape modes, in the units of their columns; as many at each instant.
    pub(crate) coefficients: [&'s [T]; B],
    /// Factor of the reference nodes: a/l for positions, 0 for velocities.
    pub(crate) scale: T,
    /// Added to the axial component.
    pub(crate) translation: [T; B],
}

/// The plane through the axis in which an outline lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Plane {
    /// z = 0
    Mirror,
    /// y = z
    Diagonal,
    /// Of a set of nodes that is not known to stay in a plane.
    Other,
}

impl Plane {
    /// The plane of a named set of nodes.
    pub(crate) fn of(name: &str) -> Self {
        match name {
            MIDPLANE => Self::Mirror,
            DIAGONAL => Self::Diagonal,
            _ => Self::Other,
        }
    }
}

impl<T: Real, const B: usize> Snapshot<'_, '_, T, B> {
    /// The vectors at a sector node.
    fn sector_node(&self, node: usize) -> [[T; 3]; B] {
        let [x, y, z] = [0, 1, 2].map(|axis| self.component(node, axis));
        // All have as many entries.
        core::array::from_fn(|b| [x[b] + self.translation[b], y[b], z[b]])
    }

    /// A component of the vectors at a sector node, without the translation.
    fn component(&self, node: usize, axis: usize) -> [T; B] {
        let reference = self.scale * T::from_f32(self.mesh.sector_reference_component(node, axis));
        self.modes
            .dots(3 * node + axis, self.coefficients)
            .map(|displacement| reference + displacement)
    }

    /// Sector node and operation of a node.
    fn origin(&self, node: usize) -> Result<(usize, u8), EvaluateError> {
        self.mesh.origin(node).ok_or(EvaluateError::UnknownNode {
            node,
            nodes: self.mesh.nodes(),
        })
    }

    /// The vectors of a choice of nodes, those of one instant after those of another; returns how many there are of each.
    ///
    /// # Errors
    /// As [`node`](Self::node); no such node set; a buffer that is too short.
    pub(crate) fn fill(&self, model: &Model<'_>, nodes: Nodes<'_>, out: &mut [[T; 3]]) -> Result<usize, EvaluateError> {
        match nodes {
            Nodes::All => self.fill_all(out),
            Nodes::Set(name) => {
                let set = model.node_set(name).ok_or(EvaluateError::UnknownNodeSet)?;
                self.fill_some(set.iter(), set.len(), out)
            }
            Nodes::List(list) => self.fill_some(list.iter().map(|&node| node.into()), list.len(), out),
        }
    }

    fn fill_some(
        &self,
        nodes: impl Iterator<Item = usize>,
        count: usize,
        out: &mut [[T; 3]],
    ) -> Result<usize, EvaluateError> {
        let out = room(out, B * count)?;
        for (place, node) in nodes.enumerate() {
            let (representative, operation) = self.origin(node)?;
            let vectors = self.sector_node(representative);
            place_all(out, count, place, vectors.map(|vector| apply(operation, vector)))?;
        }
        Ok(count)
    }

    /// The vectors of the sector's nodes, as many as `out` holds.
    ///
    /// # Errors
    /// A result that is not finite.
    pub(crate) fn fill_sector(&self, out: &mut [[T; 3]]) -> Result<(), EvaluateError> {
        let count = out.len() / B;
        (0..count).try_for_each(|index| place_all(out, count, index, self.sector_node(index)))
    }

    /// Computes every sector node once, in its place of the full mesh, and mirrors it from there.
    fn fill_all(&self, out: &mut [[T; 3]]) -> Result<usize, EvaluateError> {
        let count = self.mesh.nodes();
        let out = room(out, B * count)?;
        let sector = self.mesh.sector_nodes();
        for (index, node) in sector.iter().enumerate() {
            place_all(out, count, node, self.sector_node(index))?;
        }
        for node in 0..count {
            let origin = self
                .mesh
                .origin(node)
                .and_then(|(index, operation)| Some((sector.get(index)?, operation)));
            // Validation found a representative for every node and a full node for every representative.
            let Some((origin, operation)) = origin else { continue };
            for frame in out.chunks_exact_mut(count) {
                if let (Some(vector), Some(out)) = (frame.get(origin).copied(), frame.get_mut(node)) {
                    *out = apply(operation, vector);
                }
            }
        }
        Ok(count)
    }
}

/// Puts the vectors of a node into the frames of the instants, each of `count` nodes.
fn place_all<T: Real, const B: usize>(
    out: &mut [[T; 3]],
    count: usize,
    place: usize,
    vectors: [[T; 3]; B],
) -> Result<(), EvaluateError> {
    for (b, vector) in vectors.into_iter().enumerate() {
        if let Some(out) = out.get_mut(b * count + place) {
            *out = finite(vector)?;
        }
    }
    Ok(())
}

impl<T: Real> Snapshot<'_, '_, T> {
    /// The vector at a node.
    ///
    /// # Errors
    /// No such node; a result that is not finite.
    pub(crate) fn node(&self, node: usize) -> Result<[T; 3], EvaluateError> {
        let (representative, operation) = self.origin(node)?;
        let [vector] = self.sector_node(representative);
        finite(apply(operation, vector))
    }

    /// A node of an outline as [x, r] with r = sqrt(y^2 + z^2).
    ///
    /// # Errors
    /// As [`node`](Self::node).
    pub(crate) fn axial_radial(&self, node: usize, plane: Plane) -> Result<[T; 2], EvaluateError> {
        let (representative, operation) = self.origin(node)?;
        let component = |axis| {
            let [component] = self.component(representative, axis);
            component
        };
        let [translation] = self.translation;
        let [y, z] = match plane {
            // The mirror plane holds its nodes: what is across it is 0.
            Plane::Mirror => [component(if operation & 4 == 0 { 1 } else { 2 }), T::ZERO],
            Plane::Diagonal => [component(1) * T::from_f64(core::f64::consts::SQRT_2), T::ZERO],
            Plane::Other => [component(1), component(2)],
        };
        let radius = match plane {
            Plane::Other => (y * y + z * z).sqrt(),
            _ => y.abs(),
        };
        let [x, radius, _] = finite([component(0) + translation, radius, T::ZERO])?;
        Ok([x, radius])
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
