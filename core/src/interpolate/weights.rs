//! Weights of the samples at a query: the system's columns and storage, checks, and the error's deviation.

use super::{minus, ridge_rows, scratch_len, square};
use crate::Real;
use crate::error::EvaluateError;
use crate::linalg::{MAX_COLUMNS, slice_or_empty, slice_or_empty_mut};
use crate::model::wire::MAX_PARAMETERS;

/// Maximum distance of a query from the centroid of its samples, in their spread (their root mean square distance from
/// the centroid). The weights that reproduce quadratics grow with the square of this ratio, and with them the rounding
/// errors of the data.
pub(super) const REACH: f32 = 10.0;

/// Rounding error of the variance in single precision, in units of (sum |L_j|)^2. Double precision uses the same, so
/// that both report the same expected error.
const VARIANCE_ROUNDING: f32 = 1e-6;

/// Weights L_j of at most `N` samples at a query, and the offsets of the samples from it.
#[derive(Clone, Debug)]
pub struct Weights<T, const N: usize> {
    pub(super) count: usize,
    pub(super) samples: [u16; N],
    /// The weights; before they are computed, the squared distances of the samples.
    pub(super) values: [T; N],
    /// Number of parameters.
    pub(super) dimensions: usize,
    /// Offsets from the query in the interpolation's coordinates, divided by the radius; zeros beyond the dimensions.
    pub(super) offsets: [[T; MAX_PARAMETERS]; N],
    /// Unit of the offsets, in the interpolation's coordinates.
    pub(super) radius: T,
    /// Degree of the polynomials that the weights reproduce for any position of the samples.
    pub(super) degree: usize,
    /// Squared [`deviation`](Self::deviation) for a radius of 1.
    pub(super) variance: T,
}

impl<T: Real, const N: usize> Weights<T, N> {
    /// Numbers of scratch that the computation needs.
    pub const SCRATCH: usize = scratch_len(N);

    /// No weights.
    pub const EMPTY: Self = Self {
        count: 0,
        degree: 0,
        dimensions: 1,
        samples: [0; N],
        values: [T::ZERO; N],
        offsets: [[T::ZERO; MAX_PARAMETERS]; N],
        radius: T::ZERO,
        variance: T::ZERO,
    };

    /// Distance of the `rank`-th nearest sample, counted from 1, between [`find`](Self::find) and the weights.
    pub(super) fn distance(&self, rank: usize) -> T {
        rank.checked_sub(1)
            .and_then(|j| self.values.get(j))
            .map_or(T::ZERO, |square| square.sqrt())
    }

    /// Sets the radius: divides the offsets by it, and refuses a query that is too far from its samples.
    pub(super) fn set_radius(&mut self, radius: T) -> Result<(), EvaluateError> {
        self.radius = radius;
        let scale = if radius > T::ZERO { T::ONE / radius } else { T::ZERO };
        let mut centroid = [T::ZERO; MAX_PARAMETERS];
        let share = T::ONE / T::from_index(self.count.max(1));
        let offsets = slice_or_empty_mut(&mut self.offsets, 0..self.count);
        for offset in &mut *offsets {
            for (x, mean) in offset.iter_mut().zip(&mut centroid) {
                *x *= scale;
                *mean += *x * share;
            }
        }
        let spread = offsets
            .iter()
            .fold(T::ZERO, |sum, offset| sum + square(minus(*offset, centroid)))
            * share;
        let limit = T::from_f32(REACH);
        if square(centroid) <= limit * limit * spread {
            return Ok(());
        }
        Err(EvaluateError::BeyondExtrapolation {
            distance: (square(centroid) / spread).sqrt().to_f32(),
            limit: REACH,
        })
    }

    /// The monomials up to degree two at the samples, a column each: for two dimensions 1, x, y, x^2, x y, y^2. Entries
    /// beyond the samples are zeros.
    pub(super) fn monomials<'s>(&self, columns: &'s mut [[T; N]]) -> &'s mut [[T; N]] {
        let p = self.dimensions;
        let columns = slice_or_empty_mut(columns, 0..1 + p + ridge_rows(p));
        columns.as_flattened_mut().fill(T::ZERO);
        for (j, offset) in self.offsets.iter().enumerate().take(self.count) {
            let mut entries = columns.iter_mut().filter_map(|column| column.get_mut(j));
            let offset = slice_or_empty(offset, 0..p);
            entries.by_ref().take(1).for_each(|entry| *entry = T::ONE);
            // The entries come second in each zip: it takes an item of the first before it finds the second exhausted.
            for (x, entry) in offset.iter().zip(entries.by_ref()) {
                *entry = *x;
            }
            for (d, x) in offset.iter().enumerate() {
                for (y, entry) in slice_or_empty(offset, d..p).iter().zip(entries.by_ref()) {
                    *entry = *x * *y;
                }
            }
        }
        columns
    }

    /// Divides the weights by their sum, which must be 1 up to rounding.
    pub(super) fn normalise(&mut self) -> Result<(), EvaluateError> {
        let values = slice_or_empty_mut(&mut self.values, 0..self.count);
        let sum = values.iter().copied().sum::<T>();
        if (sum - T::ONE).abs() > T::EPSILON.sqrt() || !sum.is_finite() {
            return Err(EvaluateError::Weights { sum: sum.to_f32() });
        }
        for value in values {
            *value /= sum;
        }
        Ok(())
    }

    /// The samples with a weight, and their weights.
    pub fn iter(&self) -> impl Iterator<Item = (usize, T)> + '_ {
        let (samples, values) = self.as_slices();
        samples
            .iter()
            .zip(values)
            .map(|(&sample, &value)| (sample.into(), value))
    }

    /// The samples with a weight, and their weights.
    pub(crate) fn as_slices(&self) -> (&[u16], &[T]) {
        (
            slice_or_empty(&self.samples, 0..self.count),
            slice_or_empty(&self.values, 0..self.count),
        )
    }

    /// sum |L_j|, the Lebesgue constant: the amplification of errors in the data.
    pub fn lebesgue(&self) -> T {
        self.iter().map(|(_, value)| value.abs()).sum()
    }

    /// Standard deviation of the interpolation error for data with a generalised covariance: -r^5 for weights of the
    /// kernel, which reproduce quadratics, r^3 for the diffuse approximation, which is sure to reproduce linear
    /// functions only. It is the power function of that covariance (Wendland, Scattered Data Approximation, 2005,
    /// chapter 11): 0 at a sample that the weights interpolate, and growing with the distance from the samples to the
    /// power 5/2 or 3/2.
    ///
    /// Far outside the samples cancellation leaves the variance undetermined, also in its sign. It is therefore at
    /// least the rounding error of the squared weights.
    pub fn deviation(&self) -> T {
        let lebesgue = self.lebesgue();
        let rounding = T::from_f32(VARIANCE_ROUNDING) * (lebesgue * lebesgue - T::ONE);
        let powers = 2 * self.degree + 1;
        (0..powers)
            .fold(self.variance.max(rounding).max(T::ZERO), |square, _| {
                square * self.radius
            })
            .sqrt()
    }

    /// Distance of the nearest sample in the coordinates of the interpolation.
    pub fn nearest(&self) -> T {
        let offset = self.offsets.first().filter(|_| self.count > 0);
        offset.map_or(T::ZERO, |offset| square(*offset).sqrt() * self.radius)
    }

    /// Variance of the interpolation error, L^T S L - 2 L^T s, with the covariances S of the samples and s of the
    /// samples with the query.
    pub(super) fn quadratic_form(&self) -> T {
        let two = T::from_f32(2.0);
        let mut sum = T::ZERO;
        let offsets = slice_or_empty(&self.offsets, 0..self.count);
        for (i, (value, offset)) in self.values.iter().zip(offsets).enumerate() {
            let mut row = -covariance(self.degree, square(*offset));
            for (other, other_offset) in self.values.iter().zip(slice_or_empty(offsets, 0..i)) {
                row += *other * covariance(self.degree, square(minus(*offset, *other_offset)));
            }
            sum += two * *value * row;
        }
        sum
    }
}

/// Scratch, divided into the columns of monomials and the kernel's matrix.
pub(super) struct Storage<'s, T, const N: usize> {
    pub(super) columns: &'s mut [[T; N]],
    pub(super) matrix: &'s mut [[T; N]],
}

impl<'s, T: Real, const N: usize> Storage<'s, T, N> {
    pub(super) fn new(scratch: &'s mut [T]) -> Result<Self, EvaluateError> {
        let (required, found) = (Weights::<T, N>::SCRATCH, scratch.len());
        let (rows, _) = scratch.as_chunks_mut::<N>();
        match rows.split_at_mut_checked(MAX_COLUMNS) {
            Some((columns, matrix)) if matrix.len() >= N => Ok(Self { columns, matrix }),
            _ => Err(EvaluateError::BufferTooShort { required, found }),
        }
    }
}

/// Polyharmonic kernel of a squared distance: -r, r^3 or -r^5 for the degree 0, 1 or 2. It is positive definite, in any
/// dimension, on weights that annihilate polynomials of that degree (Wendland 2005, theorem 8.16).
pub(super) fn covariance<T: Real>(degree: usize, square: T) -> T {
    (0..degree).fold(-square.sqrt(), |value, _| -(value * square))
}
