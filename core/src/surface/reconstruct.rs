//! Reconstruction of vectors at the nodes from coefficients of the modes, for the requested nodes only.

use crate::error::{EvaluateError, finite};
use crate::linalg::{LANES, TWO_PANELS};
use crate::model::{DIAGONAL, MIDPLANE, MatrixView, Mesh, Model, QuantizedRef, apply};
use crate::{Nodes, Real};

/// A field at the nodes: positions `(a/l) X + Phi alpha` or velocities `Phi xi`, with an axial translation. `B` fields
/// share one pass over the modes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Snapshot<'a, 's, T: Real, const B: usize = 1> {
    pub(crate) mesh: Mesh<'a>,
    pub(crate) modes: MatrixView<'a>,
    /// Coefficients of the leading modes.
    pub(crate) coefficients: QuantizedRef<'s, T, B>,
    /// Factor of the reference nodes X: a/l for positions, 0 for velocities.
    pub(crate) scale: T,
    /// Axial translation of all nodes.
    pub(crate) translation: T,
}

/// Values of a component at the eight nodes of a panel.
pub(crate) type Lanes<T> = [T; LANES];

/// Plane through the axis that holds an outline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Plane {
    /// z = 0
    Mirror,
    /// y = z
    Diagonal,
    /// None: a set of nodes without a symmetry plane.
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
    /// Components at the sector's nodes of a panel, for `P` pairs (axis, panel).
    pub(crate) fn panels<const P: usize>(&self, pairs: [(usize, usize); P]) -> [[Lanes<T>; B]; P] {
        let rows = pairs.map(|(axis, panel)| axis * self.mesh.panels() + panel);
        let mut values = [[[T::ZERO; LANES]; B]; P];
        self.modes.panels(rows, self.coefficients, &mut values);
        for (values, &(axis, panel)) in values.iter_mut().zip(&pairs) {
            let nodes = self.mesh.sector_panel(panel);
            for values in values {
                for (value, node) in values.iter_mut().zip(nodes) {
                    *value += self.base_component(node, axis);
                }
            }
        }
        values
    }

    /// A component without the modes: of the scaled reference node and the translation.
    fn base_component(&self, node: &[[u8; 4]; 3], axis: usize) -> T {
        let component = node.get(axis).copied().unwrap_or_default();
        let reference = self.scale * T::from_f32(f32::from_le_bytes(component));
        if axis == 0 {
            reference + self.translation
        } else {
            reference
        }
    }
}

impl<'a, 's, T: Real> Snapshot<'a, 's, T> {
    /// out <- the vectors at the nodes of a scene; returns their number.
    ///
    /// # Errors
    /// Those of [`node`](Self::node); [`EvaluateError::UnknownNodeSet`]; [`EvaluateError::BufferTooShort`].
    pub(crate) fn fill(&self, model: &Model<'_>, nodes: Nodes<'_>, out: &mut [[T; 3]]) -> Result<usize, EvaluateError> {
        match nodes {
            Nodes::All => self.fill_all(out),
            Nodes::Set(name) => {
                let set = model.node_set(name).ok_or(EvaluateError::UnknownNodeSet)?;
                let mut cache = self.panel_cache();
                fill(set.iter(), set.len(), out, |node| cache.node(node))
            }
            Nodes::List(list) => {
                let nodes = || list.iter().map(|&node| node.into());
                // All nodes are checked before the first is written.
                nodes().try_for_each(|node| self.origin(node).map(|_| ()))?;
                fill(nodes(), list.len(), out, |node| self.node(node))
            }
        }
    }

    /// out <- the vectors at the sector's nodes.
    ///
    /// # Errors
    /// [`EvaluateError::NotFinite`].
    pub(crate) fn fill_sector(&self, out: &mut [[T; 3]]) -> Result<(), EvaluateError> {
        for (panel, out) in out.chunks_mut(LANES).enumerate() {
            for (out, vector) in out.iter_mut().zip(&self.vectors(panel)) {
                *out = finite(*vector)?;
            }
        }
        Ok(())
    }

    /// Computes every sector node once, in its entry of the full mesh, and mirrors it from there.
    fn fill_all(&self, out: &mut [[T; 3]]) -> Result<usize, EvaluateError> {
        let count = self.mesh.nodes();
        let out = prefix_mut(out, count)?;
        let mut sector = self.mesh.sector_nodes().iter();
        for panel in 0..self.mesh.panels() {
            for (vector, node) in self.vectors(panel).iter().zip(sector.by_ref()) {
                if let Some(out) = out.get_mut(node) {
                    *out = finite(*vector)?;
                }
            }
        }
        self.mirror(out);
        Ok(count)
    }

    /// Copies the sector's vectors, in their entries of the full mesh, to all images.
    fn mirror(&self, out: &mut [[T; 3]]) {
        let sector = self.mesh.sector_nodes();
        for (operation, images) in self.mesh.images().skip(1) {
            for (node, image) in sector.iter().zip(images.iter()) {
                let vector = out.get(node).copied();
                if let (Some(vector), Some(out)) = (vector, out.get_mut(image)) {
                    *out = apply(operation, vector);
                }
            }
        }
    }

    /// The vectors at the sector's nodes of a panel.
    fn vectors(&self, panel: usize) -> [[T; 3]; LANES] {
        let [[x], [y], [z]] = self.panels([(0, panel), (1, panel), (2, panel)]);
        core::array::from_fn(|lane| [x[lane], y[lane], z[lane]])
    }

    /// The vector at a node of the full mesh.
    ///
    /// # Errors
    /// [`EvaluateError::UnknownNode`]; [`EvaluateError::NotFinite`].
    pub(crate) fn node(&self, node: usize) -> Result<[T; 3], EvaluateError> {
        let (representative, operation) = self.origin(node)?;
        let rows = LANES * self.mesh.panels();
        let reference = self.mesh.sector_node(representative);
        let vector = core::array::from_fn(|axis| {
            let displacement = self.modes.dot(axis * rows + representative, self.coefficients);
            displacement + self.base_component(&reference, axis)
        });
        finite(apply(operation, vector))
    }

    /// Sector node that represents a node, and the symmetry operation between them.
    fn origin(&self, node: usize) -> Result<(usize, u8), EvaluateError> {
        self.mesh.origin(node).ok_or(EvaluateError::UnknownNode {
            node,
            nodes: self.mesh.nodes(),
        })
    }

    /// Access to single nodes that caches panels.
    pub(crate) fn panel_cache(&self) -> PanelCache<'_, 'a, 's, T> {
        PanelCache {
            field: self,
            cached: [(usize::MAX, [T::ZERO; LANES]); 3],
        }
    }
}

/// Access to single nodes. Successive nodes of an outline share panels, which are computed once.
pub(crate) struct PanelCache<'f, 'a, 's, T: Real> {
    field: &'f Snapshot<'a, 's, T>,
    /// The last panel of each component: its number and its values.
    cached: [(usize, Lanes<T>); 3],
}

impl<T: Real> PanelCache<'_, '_, '_, T> {
    /// A component at a sector node. Where products take two panels at once, the next axis is computed with it.
    #[inline(always)]
    fn component(&mut self, sector_node: usize, axis: usize) -> T {
        let panel = sector_node / LANES;
        let cached = self.cached.get(axis).map(|(cached, _)| *cached);
        if cached != Some(panel) {
            if TWO_PANELS && axis < 2 {
                self.compute(panel, [axis, axis + 1]);
            } else {
                self.compute(panel, [axis]);
            }
        }
        self.cached
            .get(axis)
            .map_or(T::ZERO, |(_, lanes)| lanes[sector_node % LANES])
    }

    #[inline(never)]
    fn compute<const P: usize>(&mut self, panel: usize, axes: [usize; P]) {
        let values = self.field.panels(axes.map(|axis| (axis, panel)));
        for (axis, [lanes]) in axes.into_iter().zip(values) {
            if let Some(cached) = self.cached.get_mut(axis) {
                *cached = (panel, lanes);
            }
        }
    }

    /// The vector at a node, the same bits as [`Snapshot::node`].
    ///
    /// # Errors
    /// Those of [`Snapshot::node`].
    fn node(&mut self, node: usize) -> Result<[T; 3], EvaluateError> {
        let (representative, operation) = self.field.origin(node)?;
        let vector = [0, 1, 2].map(|axis| self.component(representative, axis));
        finite(apply(operation, vector))
    }

    /// A node of an outline as [x, r] with r = sqrt(y^2 + z^2).
    ///
    /// # Errors
    /// Those of [`Snapshot::node`].
    pub(crate) fn axial_radial(&mut self, node: usize, plane: Plane) -> Result<[T; 2], EvaluateError> {
        let (representative, operation) = self.field.origin(node)?;
        let x = self.component(representative, 0);
        let radius = match plane {
            // The nodes lie in the plane z = 0 (or its image y = 0), so one component is 0.
            Plane::Mirror if operation & 4 == 0 => self.component(representative, 1).abs(),
            Plane::Mirror => self.component(representative, 2).abs(),
            Plane::Diagonal => (self.component(representative, 1) * T::from_f64(core::f64::consts::SQRT_2)).abs(),
            Plane::Other => {
                let (y, z) = (self.component(representative, 1), self.component(representative, 2));
                (y * y + z * z).sqrt()
            }
        };
        finite([x, radius])
    }

    /// The derivative of [`axial_radial`](Self::axial_radial), of a field of derivatives, for a node of a plane. The
    /// surface is on the side of the plane's axis on which its reference is.
    ///
    /// # Errors
    /// Those of [`Snapshot::node`].
    pub(crate) fn axial_radial_derivative(&mut self, node: usize, plane: Plane) -> Result<[T; 2], EvaluateError> {
        let (representative, operation) = self.field.origin(node)?;
        let axis = if plane == Plane::Mirror && operation & 4 != 0 {
            2
        } else {
            1
        };
        let [x, across] = [0, axis].map(|axis| self.component(representative, axis));
        let reference = self.field.mesh.sector_node(representative);
        let component = reference.get(axis).copied().unwrap_or_default();
        let sign = if f32::from_le_bytes(component) < 0.0 {
            -T::ONE
        } else {
            T::ONE
        };
        let factor = match plane {
            Plane::Diagonal => T::from_f64(core::f64::consts::SQRT_2),
            _ => T::ONE,
        };
        finite([x, sign * factor * across])
    }
}

/// out <- the vectors at `count` nodes.
fn fill<T: Real>(
    nodes: impl Iterator<Item = usize>,
    count: usize,
    out: &mut [[T; 3]],
    mut vector: impl FnMut(usize) -> Result<[T; 3], EvaluateError>,
) -> Result<usize, EvaluateError> {
    for (node, out) in nodes.zip(prefix_mut(out, count)?) {
        *out = vector(node)?;
    }
    Ok(count)
}

/// The first `required` entries of a caller's buffer.
///
/// # Errors
/// [`EvaluateError::BufferTooShort`].
pub(crate) fn prefix_mut<E>(out: &mut [E], required: usize) -> Result<&mut [E], EvaluateError> {
    let found = out.len();
    out.get_mut(..required)
        .ok_or(EvaluateError::BufferTooShort { required, found })
}
