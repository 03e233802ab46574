//! The coordinates in which distances are taken, and where they are cut.
//!
//! For a capsule in the channel they are (s_0 sqrt(Ca) / Ca_lim(a/l)^(1/8), s_1 a/l): the solution varies fast at small
//! Ca, where the square root stretches the plane, and along the steady limit Ca_lim(a/l), towards which the plane is
//! bent a little, so that a query near the limit finds samples as near to it on the rows beside its own. How much is a
//! compromise: away from the limit the solution follows Ca alone. Where the solution jumps, because the rear of the
//! membrane buckles, the plane is cut: no interpolation crosses a jump well.

use super::times;
use crate::model::Curve;
use crate::model::wire::{Contents, MAX_PARAMETERS};
use crate::{Parameters, Real};

/// Coordinates of the parameters: each times its scale, but for a capsule in the channel (see the module).
#[derive(Clone, Copy, Debug)]
pub struct Coordinates<'a> {
    /// Factor of each parameter.
    pub scales: [f64; MAX_PARAMETERS],
    /// Ca_lim(a/l) of a capsule in the channel.
    pub limit: Option<Curve<'a>>,
    /// Parameters (Ca, a/l) on different sides know nothing of each other; without points it parts nothing.
    pub border: Curve<'a>,
}

impl<'a> Coordinates<'a> {
    /// The coordinates of a model: those of the channel if it has a steady limit.
    pub fn new(contents: &Contents<'a>) -> Self {
        Self {
            scales: contents.kernel.scales,
            limit: (contents.steady_limit.rows > 0).then(|| Curve::new(&contents.steady_limit)),
            border: Curve::new(&contents.border),
        }
    }

    /// The side of the border on which parameters (Ca, a/l) lie: whether below it; none where it does not reach.
    pub fn side<T: Real>(&self, [first, second, ..]: [T; MAX_PARAMETERS]) -> Option<bool> {
        self.border.below([first, second])
    }

    /// Whether the border lies between two pairs of parameters.
    pub fn apart<T: Real>(&self, a: [T; 2], b: [T; 2]) -> bool {
        let [a, b] = [a, b].map(|parameters| self.border.below(parameters));
        a.zip(b).is_some_and(|(a, b)| a != b)
    }

    /// The coordinates of parameters; zeros beyond the dimensions.
    pub fn place<T: Real>(&self, parameters: &Parameters<T>) -> [T; MAX_PARAMETERS] {
        let mut place = times(self.scales.map(T::from_f64), parameters.array());
        if let Some(limit) = self.limit {
            let limit = limit.at(parameters.get(1)).unwrap_or(T::ONE);
            let scale = T::from_f64(self.scales[0]);
            let stretched = scale * scale * parameters.get(0).max(T::ZERO) / limit.sqrt().sqrt();
            place[0] = stretched.sqrt();
        }
        place
    }
}
