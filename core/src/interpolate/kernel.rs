//! Quintic kernel with a quadratic tail on the nearest samples.
//!
//! The weights minimise the error's variance under the generalised covariance -r^5 and a little scatter, subject to the
//! exact reproduction of quadratics. They are found in the null space of the constraints, where the kernel's matrix is
//! positive definite: then single precision keeps sum L = 1 to rounding, which a stored inverse or the full indefinite
//! system does not.

use super::{Coordinates, Search, Storage, Weights, covariance, minus, square};
use crate::error::EvaluateError;
use crate::linalg::{Qr, cholesky, dot_in_order, slice_or_empty, slice_or_empty_mut, symmetric_times};
use crate::model::MatrixView;
use crate::model::wire::{Kernel, MAX_PARAMETERS, Matrix, Samples};
use crate::{Parameters, Real};

/// Degree of the tail.
const DEGREE: usize = 2;
/// Variance of the data's own scatter, in the units of the kernel at the distance of the farthest sample: what two
/// samples closer than a tenth of that differ by is not extrapolated. Without it, samples close to each other (0.00125
/// in Ca beside the steady limit) leave a matrix that single precision cannot solve: one answer in a hundred was wrong
/// by up to 0.3 a.
const SCATTER: f32 = 3e-5;
/// The share of the squared distance of the farthest sample up to which no sample counts as more scattered than that.
const NEAR: f32 = 0.6;
/// Variance of the scatter that the farthest sample counts as having.
const FAR_SCATTER: f32 = 3.0;

/// Variance of the scatter that a sample counts as having, by the square of its distance in that of the farthest. It
/// grows without a jump towards the farthest, whose weight it makes small: else the answer would jump where, as the
/// query moves, one sample takes the place of another among the nearest (by up to 8 % of a beside the border of
/// buckling).
#[inline(never)]
fn scatter<T: Real>(square: T) -> T {
    let far = (square - T::from_f32(NEAR)).max(T::ZERO) / T::from_f32(1.0 - NEAR);
    T::from_f32(SCATTER) + T::from_f32(FAR_SCATTER) * far * far * far
}

impl<T: Real, const N: usize> Weights<T, N> {
    /// Weights of the samples at a query with as many parameters as they have, by the quintic kernel in the
    /// coordinates. `left_out` is a sample that takes no part. `scratch` holds [`SCRATCH`](Self::SCRATCH) numbers.
    ///
    /// Where the nearest samples lie on a surface of second degree, the monomials that they cannot tell apart are left
    /// out of the tail. Where the query's side of the border holds fewer samples than are wanted, those of the other
    /// side take part, and the weights reproduce a jump at the border beside the quadratics.
    ///
    /// # Errors
    /// [`EvaluateError::Weights`] if the samples are too close to each other to be told apart;
    /// [`EvaluateError::BeyondExtrapolation`]; [`EvaluateError::BufferTooShort`] for the scratch.
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
        let wanted = settings.neighbours as usize;
        let mut search = Search {
            dimensions: query.as_slice().len(),
            points: &samples.places,
            parameters: &samples.parameters,
            query: coordinates.place(query),
            scales: [T::ONE; MAX_PARAMETERS],
            border: coordinates.border,
            side: coordinates.side(query.array()),
        };
        self.find(&search, left_out, wanted);
        let crosses = self.count < wanted && search.side.is_some();
        if crosses {
            search.side = None;
            self.find(&search, left_out, wanted);
        }
        self.degree = DEGREE;
        self.scale(self.distance(self.count))?;
        let n = self.count;
        let Storage { columns, matrix } = Storage::<T, N>::new(scratch)?;
        let mut count = self.monomials(columns).len();
        if let Some(column) = columns.get_mut(count).filter(|_| crosses) {
            self.beyond(coordinates, &samples.parameters, query, column);
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
                *diagonal = scatter(square(*a));
            }
        }

        // L = x + Q y: x meets the constraints, y is free where they leave it so.
        let x = qr.first();
        let mut right = [T::ZERO; N];
        symmetric_times(matrix, &x, &mut right);
        // With s the covariances with the query, -2 L^T s + L^T S L comes to -x^T (2 s - S x) - y^T Q^T (s - S x).
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
        // What the scatter adds is not the kernel's.
        let weighted = self.values.iter().zip(slice_or_empty(&self.offsets, 0..n));
        let scattered = weighted.fold(T::ZERO, |sum, (weight, offset)| {
            sum + scatter(square(*offset)) * *weight * *weight
        });
        self.variance = -variance - scattered;
        Ok(())
    }

    /// 1 at the samples beyond the border, else 0: what the data jump by there. The query is on its own side.
    fn beyond(&self, coordinates: &Coordinates<'_>, samples: &Matrix<'_>, query: &Parameters<T>, column: &mut [T; N]) {
        let samples = MatrixView::new(samples);
        column.fill(T::ZERO);
        for (entry, sample) in column.iter_mut().zip(slice_or_empty(&self.samples, 0..self.count)) {
            let parameter = |d| T::from_f32(samples.get((*sample).into(), d));
            let apart = coordinates.apart(query.array(), [parameter(0), parameter(1)]);
            *entry = if apart { T::ONE } else { T::ZERO };
        }
    }
}
