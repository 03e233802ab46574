//! The whole membrane at an instant.

use super::deformation::energy_density;
use super::poiseuille::undisturbed_velocity;
use super::{Deformation, Stencil, determinant, metric};
use crate::Real;
use crate::error::EvaluateError;
use crate::model::{Mesh, apply};
use crate::surface::{combine, integrate};

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

    /// Area of the surface, in l^2.
    ///
    /// # Errors
    /// [`EvaluateError::NotFinite`].
    pub fn area(&self) -> Result<T, EvaluateError> {
        integrate(
            &self.mesh,
            [T::ZERO; 3],
            |node| self.position(node),
            |point, nodes| determinant(metric(&point.tangents(nodes))).sqrt(),
        )
    }

    /// Elastic energy, in G_s l^2.
    ///
    /// # Errors
    /// [`EvaluateError::NotFinite`].
    pub fn energy(&self) -> Result<T, EvaluateError> {
        integrate(
            &self.mesh,
            ([T::ZERO; 3], [T::ZERO; 3]),
            |node| Ok((self.position(node)?, self.reference(node)?)),
            |point, nodes| {
                let current = metric(&point.tangents(&nodes.map(|(position, _)| position)));
                let [r11, r22, r12] = metric(&point.tangents(&nodes.map(|(_, reference)| reference)));
                let square = determinant([r11, r22, r12]);
                let [m11, m22, m12] = current;
                let trace = (r22 * m11 + r11 * m22 - T::from_f32(2.0) * r12 * m12) / square;
                square.sqrt() * energy_density(trace, determinant(current) / square)
            },
        )
    }

    /// Additional pressure drop by the reciprocal theorem, (1/4) int v_inf . q dS, in mu V / l.
    ///
    /// # Errors
    /// [`EvaluateError::NotFinite`].
    pub fn pressure_drop(&self) -> Result<T, EvaluateError> {
        let power = integrate(
            &self.mesh,
            ([T::ZERO; 3], [T::ZERO; 3], T::ZERO),
            |node| {
                let position = self.position(node)?;
                let [_, y, z] = position;
                Ok((position, self.reference(node)?, undisturbed_velocity(y, z)))
            },
            |point, nodes| {
                // The tension's virtual power S^ab x_,a . v_,b per stress-free area, v being axial.
                let [first, second] = point.tangents(&nodes.map(|(position, ..)| position));
                let [m11, m22, m12] = metric(&[first, second]);
                let [r11, r22, r12] = metric(&point.tangents(&nodes.map(|(_, reference, _)| reference)));
                let (current, square) = (determinant([m11, m22, m12]), determinant([r11, r22, r12]));
                let pull = square / (current * current);
                let s11 = r22 / square - pull * m22;
                let s22 = r11 / square - pull * m11;
                let s12 = pull * m12 - r12 / square;
                let [v1, v2] = point
                    .gradient
                    .each_ref()
                    .map(|gradient| combine(gradient, |i| nodes[i].2));
                let [x1, x2] = [first[0], second[0]];
                square.sqrt() * (s11 * x1 * v1 + s22 * x2 * v2 + s12 * (x1 * v2 + x2 * v1))
            },
        )?;
        let pressure_drop = power / (T::from_f32(4.0) * self.capillary_number);
        if pressure_drop.is_finite() {
            Ok(pressure_drop)
        } else {
            Err(EvaluateError::NotFinite)
        }
    }

    fn position(&self, node: usize) -> Result<[T; 3], EvaluateError> {
        let unknown = EvaluateError::UnknownNode {
            node,
            nodes: self.mesh.nodes(),
        };
        let (index, operation) = self.mesh.origin(node).ok_or(unknown)?;
        let position = self.sector.get(index).ok_or(unknown)?;
        Ok(apply(operation, *position))
    }

    /// The node in the stress-free state.
    fn reference(&self, node: usize) -> Result<[T; 3], EvaluateError> {
        let unknown = EvaluateError::UnknownNode {
            node,
            nodes: self.mesh.nodes(),
        };
        let reference = self.mesh.reference(node).ok_or(unknown)?;
        Ok(reference.map(|x| self.radius * T::from_f32(x)))
    }
}
