//! A snapshot in local coordinates.

use crate::Real;

/// A snapshot in local coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Snapshot<T, const M: usize> {
    pub(crate) alpha: [T; M],
    pub(crate) xi: [T; M],
    /// Q xi, the rate of alpha (eq. 47).
    pub(crate) rate: [T; M],
}

impl<T: Real, const M: usize> Snapshot<T, M> {
    pub(crate) const ZERO: Self = Self {
        alpha: [T::ZERO; M],
        xi: [T::ZERO; M],
        rate: [T::ZERO; M],
    };
}
