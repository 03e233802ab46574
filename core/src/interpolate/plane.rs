//! The plane in which the kernel takes distances, and where it is cut.
//!
//! The solution varies fast at small Ca, where the square root stretches the plane, and along the steady limit
//! Ca_lim(a/l), towards which the plane is bent a little, so that a query near the limit finds samples as near to it on the rows
//! beside its own. How much is a compromise: away from the limit the solution follows Ca alone. Where the solution jumps, because the rear of the membrane buckles, the plane is cut: no
//! interpolation crosses a jump well.

use super::coordinates::apart;
use crate::Real;
use crate::model::Curve;

/// Coordinates (s sqrt(Ca) / Ca_lim(a/l)^(1/8), a/l), cut along a border.
#[derive(Clone, Copy, Debug)]
pub struct Plane<'a> {
    /// s
    pub capillary_scale: f64,
    /// Ca_lim(a/l)
    pub limit: Curve<'a>,
    /// Parameters on different sides know nothing of each other.
    pub border: Curve<'a>,
}

impl Plane<'_> {
    /// Where parameters (Ca, a/l) lie.
    pub(super) fn place<T: Real>(&self, [capillary_number, confinement]: [T; 2]) -> [T; 2] {
        let limit = self.limit.at(confinement).unwrap_or(T::ONE);
        let ratio = capillary_number.max(T::ZERO) / limit.sqrt().sqrt();
        [T::from_f64(self.capillary_scale) * ratio.sqrt(), confinement]
    }

    /// Whether the border lies between two pairs of parameters.
    pub fn apart<T: Real>(&self, a: [T; 2], b: [T; 2]) -> bool {
        apart(self.side(a), self.side(b))
    }

    /// On which side of the border parameters lie, if it reaches there.
    pub(super) fn side<T: Real>(&self, parameters: [T; 2]) -> Option<bool> {
        self.border.below(parameters)
    }
}
