//! The membrane at an instant, and integrals over it.

use super::deformation::energy_density;
use super::poiseuille::undisturbed_velocity;
use super::{Deformation, Stencil, determinant, metric};
use crate::Real;
use crate::error::{EvaluateError, finite};
use crate::model::{Mesh, apply};
use crate::surface::quadrature::integrate;

/// The membrane at an instant of a query; made by [`Instant::membrane`](crate::Instant::membrane). Every method
/// computes what it returns and nothing else.
#[derive(Clone, Copy, Debug)]
pub struct Membrane<'a, 's, T> {
    mesh: Mesh<'a>,
    /// Current positions of the sector's nodes.
    sector: &'s [[T; 3]],
    radius: T,
    capillary_number: T,
}

/// Integrals over the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Totals<T> {
    /// Area of the surface, in l^2.
    pub area: T,
    /// Elastic energy, in G_s l^2.
    pub energy: T,
    /// Additional pressure drop by the reciprocal theorem, (1/4) int v_inf . q dS, in mu V / l.
    pub pressure_drop: T,
}

impl<'a, 's, T: Real> Membrane<'a, 's, T> {
    /// A membrane whose stress-free state is the sphere of `radius`.
    pub(crate) fn new(mesh: Mesh<'a>, sector: &'s [[T; 3]], radius: T, capillary_number: T) -> Self {
        Self {
            mesh,
            sector,
            radius,
            capillary_number,
        }
    }

    /// The deformation at a stencil's node, in the centroid's frame.
    ///
    /// # Errors
    /// [`EvaluateError::UnknownNode`] for a stencil of another mesh; [`EvaluateError::NotFinite`].
    pub fn deformation(&self, stencil: &Stencil<T>) -> Result<Deformation<T>, EvaluateError> {
        stencil.deformation(self.radius, |node| self.position(node))
    }

    /// The integrals over the surface.
    ///
    /// # Errors
    /// [`EvaluateError::NotFinite`].
    pub fn totals(&self) -> Result<Totals<T>, EvaluateError> {
        let node = |node| {
            let [x, y, z] = self.position(node)?;
            let [a, b, c] = self.reference(node)?;
            Ok([x, y, z, a, b, c, undisturbed_velocity(y, z)])
        };
        let [area, energy, power] = integrate(&self.mesh, node, |point, nodes| {
            let [[x1, y1, z1, a1, b1, c1, v1], [x2, y2, z2, a2, b2, c2, v2]] = point.derivatives(nodes);
            let [m11, m22, m12] = metric(&[[x1, y1, z1], [x2, y2, z2]]);
            let [r11, r22, r12] = metric(&[[a1, b1, c1], [a2, b2, c2]]);
            let (current, square) = (determinant([m11, m22, m12]), determinant([r11, r22, r12]));
            let trace = (r22 * m11 + r11 * m22 - T::from_f32(2.0) * r12 * m12) / square;
            // Virtual power of the tension, S^ab x_,a . v_,b per stress-free area; v is axial.
            let pull = square / (current * current);
            let s11 = r22 / square - pull * m22;
            let s22 = r11 / square - pull * m11;
            let s12 = pull * m12 - r12 / square;
            let power = s11 * x1 * v1 + s22 * x2 * v2 + s12 * (x1 * v2 + x2 * v1);
            let stress_free = square.sqrt();
            let energy = energy_density(trace, current / square);
            [current.sqrt(), stress_free * energy, stress_free * power]
        })?;
        let [pressure_drop] = finite([power / (T::from_f32(4.0) * self.capillary_number)])?;
        Ok(Totals {
            area,
            energy,
            pressure_drop,
        })
    }

    /// Current position of a node.
    fn position(&self, node: usize) -> Result<[T; 3], EvaluateError> {
        let unknown = EvaluateError::UnknownNode {
            node,
            nodes: self.mesh.nodes(),
        };
        let (index, operation) = self.mesh.origin(node).ok_or(unknown)?;
        let position = self.sector.get(index).ok_or(unknown)?;
        Ok(apply(operation, *position))
    }

    /// Position of a node in the stress-free state.
    fn reference(&self, node: usize) -> Result<[T; 3], EvaluateError> {
        let unknown = EvaluateError::UnknownNode {
            node,
            nodes: self.mesh.nodes(),
        };
        let reference = self.mesh.reference(node).ok_or(unknown)?;
        Ok(reference.map(|x| self.radius * T::from_f32(x)))
    }
}
