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

    /// Whether a border lies between two sets of parameters.
    pub(super) fn apart<T: Real, const P: usize>(&self, a: [T; P], b: [T; P]) -> bool {
        match (self, a.first_chunk(), b.first_chunk()) {
            (Self::Channel(plane), Some(a), Some(b)) => plane.apart(*a, *b),
            _ => false,
        }
    }
}

/// Each number times its factor.
pub(super) fn scaled<T: Real, const P: usize>(scales: &[f64; MAX_PARAMETERS], values: [T; P]) -> [T; P] {
    core::array::from_fn(|d| values[d] * T::from_f64(scales.get(d).copied().unwrap_or(1.0)))
}
