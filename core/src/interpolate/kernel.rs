//! Quintic kernel with a quadratic tail on the nearest samples (universal kriging).
//!
//! The weights minimise the variance of the error under the generalised covariance -r^5 with a nugget, subject to the
//! exact reproduction of quadratics. They are computed in the null space of the constraints, where the kernel's matrix
//! is positive definite: so sum L = 1 holds to rounding in single precision, which neither a stored inverse nor the
//! full indefinite system achieves.

use super::search::Search;
use super::weights::{Storage, covariance};
use super::{Coordinates, Weights, minus, square};
use crate::error::EvaluateError;
use crate::linalg::{Qr, cholesky, dot_in_order, slice_or_empty, slice_or_empty_mut, symmetric_times};
use crate::model::MatrixView;
use crate::model::wire::{Kernel, MAX_PARAMETERS, Matrix, Samples};
use crate::{Parameters, Real};

/// Degree of the tail.
const DEGREE: usize = 2;
/// Nugget (variance of the data's own scatter) in units of the kernel at the distance of the farthest sample:
/// differences between samples closer than a tenth of that distance are not extrapolated. Without it, samples close to
/// each other (0.00125 in Ca near the steady limit) make the matrix too ill-conditioned for single precision: one
/// answer in a hundred is wrong by up to 0.3 a.
const NUGGET: f32 = 3e-5;
/// Squared distance, in that of the farthest sample, up to which the nugget is constant.
const NEAR: f32 = 0.6;
/// Nugget of the farthest sample.
const FAR_NUGGET: f32 = 3.0;

/// Nugget of a sample at a squared distance, in that of the farthest. It grows smoothly towards the farthest, whose
/// weight it makes small: samples that enter or leave the stencil as the query moves have small weights. A constant
/// nugget would make the answer jump there, by up to 8 % of a near the jump curve.
#[inline(never)]
pub(super) fn nugget<T: Real>(square: T) -> T {
    let far = (square - T::from_f32(NEAR)).max(T::ZERO) / T::from_f32(1.0 - NEAR);
    T::from_f32(NUGGET) + T::from_f32(FAR_NUGGET) * far * far * far
}

/// Factors of the system of the weights.
pub(super) struct Factors<'s, T, const N: usize> {
    /// Of the columns of the tail.
    pub(super) qr: Qr<'s, T, N>,
    /// Cholesky factor of the kernel's matrix in their null space.
    pub(super) matrix: &'s [[T; N]],
}

/// The derivative of [`nugget`] by the squared distance.
pub(super) fn nugget_slope<T: Real>(square: T) -> T {
    let far = (square - T::from_f32(NEAR)).max(T::ZERO) / T::from_f32(1.0 - NEAR);
    T::from_f32(3.0 * FAR_NUGGET / (1.0 - NEAR)) * far * far
}

impl<T: Real, const N: usize> Weights<T, N> {
    /// Weights of the samples at a query by the quintic kernel in the coordinates. `query` has the samples' number of
    /// parameters. `left_out` is a sample that is not used: the offline stage leaves out one sample at a time to
    /// measure the errors; the online stage passes none. `scratch` has [`SCRATCH`](Self::SCRATCH) numbers.
    ///
    /// Where the nearest samples lie on a surface of second degree, the dependent monomials are left out of the tail.
    /// Where the query's side of the jump curve holds too few samples, those of the other side are used too, and the
    /// weights reproduce quadratics plus a constant jump at the curve.
    ///
    /// # Errors
    /// [`EvaluateError::Weights`] if the samples are so close to each other that the system is singular;
    /// [`EvaluateError::BeyondExtrapolation`] if the query is too far from its samples;
    /// [`EvaluateError::BufferTooShort`] if `scratch` is.
    #[inline(never)]
    pub fn kernel(
        &mut self,
        settings: &Kernel,
        coordinates: &Coordinates<'_>,
        samples: &Samples<'_>,
        query: &Parameters<T>,
        left_out: Option<usize>,
        scratch: &mut [T],
    ) -> Result<(), EvaluateError> {
        self.solve_kernel(settings, coordinates, samples, query, left_out, scratch)?;
        Ok(())
    }

    /// Computes the weights, and returns the factors of their system.
    #[inline(always)]
    pub(super) fn solve_kernel<'s>(
        &mut self,
        settings: &Kernel,
        coordinates: &Coordinates<'_>,
        samples: &Samples<'_>,
        query: &Parameters<T>,
        left_out: Option<usize>,
        scratch: &'s mut [T],
    ) -> Result<Factors<'s, T, N>, EvaluateError> {
        let wanted = settings.neighbours as usize;
        let mut search = Search {
            dimensions: query.as_slice().len(),
            points: &samples.places,
            parameters: &samples.parameters,
            query: coordinates.transform(query),
            scales: [T::ONE; MAX_PARAMETERS],
            jump_curve: coordinates.jump_curve,
            side: coordinates.side(query.array()),
        };
        self.find(&search, left_out, wanted);
        let crosses = self.count < wanted && search.side.is_some();
        if crosses {
            search.side = None;
            self.find(&search, left_out, wanted);
        }
        self.degree = DEGREE;
        self.set_radius(self.distance(self.count))?;
        let n = self.count;
        let Storage { columns, matrix } = Storage::<T, N>::new(scratch)?;
        let mut count = self.monomials(columns).len();
        if let Some(column) = columns.get_mut(count).filter(|_| crosses) {
            self.indicate_jump(coordinates, &samples.parameters, query, column);
            count += 1;
        }
        let qr = Qr::new(n, slice_or_empty_mut(columns, 0..count));
        let matrix = slice_or_empty_mut(matrix, 0..n);
        let offsets = slice_or_empty(&self.offsets, 0..n);
        for (i, (row, a)) in matrix.iter_mut().zip(offsets).enumerate() {
            for (value, b) in row.iter_mut().zip(offsets).take(i) {
                *value = covariance(DEGREE, square(minus(*a, *b)));
            }
            if let Some(diagonal) = row.get_mut(i) {
                *diagonal = nugget(square(*a));
            }
        }

        // L = x + Q y: x is the least-norm solution of the constraints, y lies in their null space.
        let x = qr.first();
        let mut right = [T::ZERO; N];
        symmetric_times(matrix, &x, &mut right);
        // With s the covariances with the query, L^T S L - 2 L^T s = -x^T (2 s - S x) - y^T Q^T (s - S x).
        let mut variance = T::ZERO;
        for ((right, offset), x) in right.iter_mut().zip(offsets).zip(&x) {
            let to_query = covariance(DEGREE, square(*offset));
            *right = to_query - *right;
            variance += *x * (to_query + *right);
        }
        qr.transpose_times(&mut right);
        qr.conjugate(matrix);
        let mut y = right;
        slice_or_empty_mut(&mut y, 0..qr.rank()).fill(T::ZERO);
        cholesky::solve(matrix, qr.rank(), &mut y);
        variance += dot_in_order(&y, &right);
        qr.times(&mut y);
        for ((weight, x), y) in self.values.iter_mut().zip(&x).zip(&y) {
            *weight = *x + *y;
        }
        self.normalise()?;
        // The deviation is that of the kernel, without the nugget's share.
        let weighted = self.values.iter().zip(slice_or_empty(&self.offsets, 0..n));
        let of_nugget = weighted.fold(T::ZERO, |sum, (weight, offset)| {
            sum + nugget(square(*offset)) * *weight * *weight
        });
        self.variance = -variance - of_nugget;
        Ok(Factors { qr, matrix })
    }

    /// column <- 1 at the samples beyond the jump curve, else 0: the constraint on this column makes the weights
    /// reproduce a constant jump.
    fn indicate_jump(
        &self,
        coordinates: &Coordinates<'_>,
        samples: &Matrix<'_>,
        query: &Parameters<T>,
        column: &mut [T; N],
    ) {
        let samples = MatrixView::new(samples);
        column.fill(T::ZERO);
        for (entry, sample) in column.iter_mut().zip(slice_or_empty(&self.samples, 0..self.count)) {
            let parameter = |d| T::from_f32(samples.get((*sample).into(), d));
            let separated = coordinates.separated(query.array(), [parameter(0), parameter(1)]);
            *entry = if separated { T::ONE } else { T::ZERO };
        }
    }
}
