//! Derivatives of the kernel's weights by the parameters.
//!
//! In lengths of the radius r at the query, a query that moves by e changes of the system S L + Q mu = s, Q^T L = m
//! (see `kernel`) the right-hand sides and the nugget D on the diagonal of S alone, because S and Q belong to the
//! samples:
//!
//! ```text
//! S L' + Q mu' = s' - D' L,     Q^T L' = m'
//! m' = e for the linear monomials, else 0
//! s'_j = 5 |o_j|^3 (o_j . e)
//! D'_j = 5 p D(|o_j|^2) - 2 D'(|o_j|^2) (o_j . e + p |o_j|^2),     p = r'/r = -(o_N . e)
//! ```
//!
//! with the offsets o_j of the samples from the query, o_N that of the farthest. D is the nugget of the moved query in
//! the old unit: r^5 times a function of |x_j - x|^2 / r^2. The factors are those of the weights.
//!
//! The derivative is that of a stencil that stays: where a sample enters or leaves it the weights are continuous but
//! for the farthest sample's small weight, and their derivative jumps.

use super::kernel::{Factors, nugget, nugget_slope};
use super::weights::covariance;
use super::{Coordinates, Weights, minus, square, times};
use crate::error::EvaluateError;
use crate::linalg::{cholesky, slice_or_empty, slice_or_empty_mut};
use crate::model::wire::{Kernel, MAX_PARAMETERS, Samples};
use crate::{Parameters, Real};

/// a . b.
fn dot<T: Real>(a: [T; MAX_PARAMETERS], b: [T; MAX_PARAMETERS]) -> T {
    times(a, b).into_iter().sum()
}

impl<T: Real, const N: usize> Weights<T, N> {
    /// The weights of [`kernel`](Self::kernel), and their derivatives by each parameter. With the derivatives in place
    /// of the weights, whatever is linear in them becomes its derivative.
    ///
    /// # Errors
    /// Those of [`kernel`](Self::kernel).
    #[inline(never)]
    pub fn kernel_derivatives(
        &mut self,
        settings: &Kernel,
        coordinates: &Coordinates<'_>,
        samples: &Samples<'_>,
        query: &Parameters<T>,
        scratch: &mut [T],
    ) -> Result<[[T; N]; MAX_PARAMETERS], EvaluateError> {
        let factors = self.solve_kernel(settings, coordinates, samples, query, None, scratch)?;
        let mut derivatives = [[T::ZERO; N]; MAX_PARAMETERS];
        for (parameter, out) in derivatives.iter_mut().enumerate().take(self.dimensions) {
            let way = coordinates.derivative(query, parameter);
            *out = self.derivative_along(&factors, way.map(|x| x / self.radius));
        }
        Ok(derivatives)
    }

    /// The derivative of the weights for a query that moves by e, in lengths of the radius.
    fn derivative_along(&self, Factors { qr, matrix }: &Factors<'_, T, N>, e: [T; MAX_PARAMETERS]) -> [T; N] {
        let (two, five) = (T::from_f32(2.0), T::from_f32(5.0));
        let offsets = slice_or_empty(&self.offsets, 0..self.count);
        let growth = offsets.last().map_or(T::ZERO, |farthest| -dot(*farthest, e));
        // Column 0 holds ones, the next the linear monomials.
        let entry = |column: usize| column.checked_sub(1).and_then(|d| e.get(d)).copied();
        let x = qr.least_norm_of_all(|column| entry(column).unwrap_or(T::ZERO));
        let mut right = [T::ZERO; N];
        for (i, ((right, own), weight)) in right.iter_mut().zip(offsets).zip(&self.values).enumerate() {
            let (length, along) = (square(*own), dot(*own, e));
            let by_query = five * length * length.sqrt() * along;
            let by_nugget = five * growth * nugget(length) - two * nugget_slope(length) * (along + growth * length);
            *right = by_query - by_nugget * *weight;
            for (j, (other, x)) in offsets.iter().zip(&x).enumerate() {
                let entry = if i == j {
                    nugget(length)
                } else {
                    covariance(self.degree, square(minus(*own, *other)))
                };
                *right -= entry * *x;
            }
        }
        // L' = x + Q y, y in the null space of the constraints.
        qr.transpose_times(&mut right);
        slice_or_empty_mut(&mut right, 0..qr.rank()).fill(T::ZERO);
        cholesky::solve_again(matrix, qr.rank(), &mut right);
        qr.times(&mut right);
        for (derivative, x) in right.iter_mut().zip(&x) {
            *derivative += *x;
        }
        // The weights sum to 1.
        let sum = slice_or_empty(&right, 0..self.count).iter().copied().sum::<T>();
        for (derivative, weight) in right.iter_mut().zip(slice_or_empty(&self.values, 0..self.count)) {
            *derivative -= sum * *weight;
        }
        right
    }

    /// Puts other numbers in the place of the weights, of the same samples.
    pub(crate) fn replace(&mut self, values: &[T]) {
        for (own, value) in self.values.iter_mut().zip(values) {
            *own = *value;
        }
    }
}
