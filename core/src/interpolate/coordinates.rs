//! Coordinates of the interpolation, in which distances are taken.
//!
//! For a capsule in the channel they are (s_0 sqrt(Ca) / Ca_lim(a/l)^(1/8), s_1 a/l). The solution varies fast at small
//! Ca, which the square root stretches, and along the steady limit Ca_lim(a/l). The division makes samples of
//! neighbouring rows of a/l that are equally close to the limit close to each other. Its exponent is a compromise: far
//! from the limit the solution depends on Ca alone.
//!
//! At the jump curve the rear of the membrane buckles and the solution jumps. Samples beyond it are not used, because
//! interpolation across a jump is inaccurate.

use super::times;
use crate::model::Curve;
use crate::model::wire::{Contents, MAX_PARAMETERS};
use crate::{Parameters, Real};

/// Coordinates of the interpolation: scaled parameters, and for a capsule in the channel
/// (s_0 sqrt(Ca) / Ca_lim(a/l)^(1/8), s_1 a/l).
#[derive(Clone, Copy, Debug)]
pub struct Coordinates<'a> {
    /// Factor of each parameter.
    pub scales: [f64; MAX_PARAMETERS],
    /// Steady limit Ca_lim(a/l) of a capsule in the channel.
    pub limit: Option<Curve<'a>>,
    /// Curve in (Ca, a/l) at which the solution jumps; without points there is no jump.
    pub jump_curve: Curve<'a>,
}

impl<'a> Coordinates<'a> {
    /// The coordinates of a model: those of the channel if it has a steady limit.
    pub fn new(contents: &Contents<'a>) -> Self {
        Self {
            scales: contents.kernel.scales,
            limit: (contents.steady_limit.rows > 0).then(|| Curve::new(&contents.steady_limit)),
            jump_curve: Curve::new(&contents.border),
        }
    }

    /// Whether parameters (Ca, a/l) lie below the jump curve; none beyond its ends.
    pub fn side<T: Real>(&self, [first, second, ..]: [T; MAX_PARAMETERS]) -> Option<bool> {
        self.jump_curve.below([first, second])
    }

    /// Whether the jump curve lies between two pairs of parameters.
    pub fn separated<T: Real>(&self, a: [T; 2], b: [T; 2]) -> bool {
        let [a, b] = [a, b].map(|parameters| self.jump_curve.below(parameters));
        a.zip(b).is_some_and(|(a, b)| a != b)
    }

    /// Transforms parameters to coordinates; zeros beyond the dimensions.
    pub fn transform<T: Real>(&self, parameters: &Parameters<T>) -> [T; MAX_PARAMETERS] {
        let mut transformed = times(self.scales.map(T::from_f64), parameters.array());
        if let Some(limit) = self.limit {
            let limit = limit.at(parameters.get(1)).unwrap_or(T::ONE);
            let scale = T::from_f64(self.scales[0]);
            let stretched = scale * scale * parameters.get(0).max(T::ZERO) / limit.sqrt().sqrt();
            transformed[0] = stretched.sqrt();
        }
        transformed
    }

    /// Derivatives of the coordinates by a parameter; zeros beyond the dimensions. Where the steady limit bends, those
    /// above the point.
    pub(super) fn derivative<T: Real>(&self, parameters: &Parameters<T>, parameter: usize) -> [T; MAX_PARAMETERS] {
        let mut derivative = [T::ZERO; MAX_PARAMETERS];
        if let (Some(entry), Some(scale)) = (derivative.get_mut(parameter), self.scales.get(parameter)) {
            *entry = T::from_f64(*scale);
        }
        if let Some(limit) = self.limit {
            // d ln x_0 = d ln Ca / 2 - d ln Ca_lim / 8
            let [first, ..] = self.transform(parameters);
            let (capillary_number, confinement) = (parameters.get(0), parameters.get(1));
            let at = limit.at(confinement).unwrap_or(T::ONE);
            derivative[0] = match parameter {
                0 => T::from_f32(0.5) * first / capillary_number,
                1 => T::from_f32(-0.125) * first * limit.slope(confinement).unwrap_or(T::ZERO) / at,
                _ => T::ZERO,
            };
        }
        derivative
    }
}
