//! The coordinates in which the kernel takes distances.

use super::Plane;
use crate::Real;
use crate::model::Curve;
use crate::model::wire::{Contents, MAX_PARAMETERS};

/// Coordinates of the parameters.
#[derive(Clone, Copy, Debug)]
pub enum Coordinates<'a> {
    /// Of a capsule in the channel.
    Channel(Plane<'a>),
    /// Each parameter times a factor.
    Scaled([f64; MAX_PARAMETERS]),
}

impl<'a> Coordinates<'a> {
    /// The coordinates of a model: those of the channel if it has a steady limit.
    pub fn new(contents: &Contents<'a>) -> Self {
        let scales = contents.kernel.scales;
        if contents.steady_limit.rows == 0 {
            return Self::Scaled(scales);
        }
        Self::Channel(Plane {
            capillary_scale: scales[0],
            limit: Curve::new(&contents.steady_limit),
            border: Curve::new(&contents.border),
        })
    }

    /// Where parameters lie.
    pub(super) fn place<T: Real, const P: usize>(&self, parameters: [T; P]) -> [T; P] {
        match self {
            Self::Channel(plane) => {
                let mut place = parameters;
                if let Some(pair) = place.first_chunk_mut() {
                    *pair = plane.place(*pair);
                }
                place
            }
            Self::Scaled(scales) => scaled(scales, parameters),
        }
    }

    /// On which side of a border parameters lie, if there is one.
    pub(super) fn side<T: Real, const P: usize>(&self, parameters: [T; P]) -> Option<bool> {
        match (self, parameters.first_chunk()) {
            (Self::Channel(plane), Some(pair)) => plane.side(*pair),
            _ => None,
        }
    }

    /// The square of a distance that samples of these differences of the parameters have at least, found without their
    /// places: a/l is a coordinate of the channel as it is.
    pub(super) fn least_square<T: Real, const P: usize>(&self, differences: [T; P]) -> T {
        match (self, differences.first_chunk()) {
            (Self::Channel(_), Some([_, confinement])) => *confinement * *confinement,
            _ => T::ZERO,
        }
    }
}

/// Whether a border lies between two sides.
pub(super) fn apart(a: Option<bool>, b: Option<bool>) -> bool {
    a.zip(b).is_some_and(|(a, b)| a != b)
}

/// Each number times its factor.
pub(super) fn scaled<T: Real, const P: usize>(scales: &[f64; MAX_PARAMETERS], values: [T; P]) -> [T; P] {
    core::array::from_fn(|d| values[d] * T::from_f64(scales.get(d).copied().unwrap_or(1.0)))
}
