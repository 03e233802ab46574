//! Quintic kernel with a quadratic tail on the nearest samples.
//!
//! The weights minimise the error's variance under the generalised covariance -r^5, subject to the exact reproduction
//! of quadratics. They are found in the null space of the constraints, where the kernel's matrix is positive definite:
//! then single precision keeps sum L = 1 to rounding, which a stored inverse or the full indefinite system does not.

use super::neighbours::{Neighbour, nearest};
use super::{Weights, at_query, covariance};
use crate::Real;
use crate::error::EvaluateError;
use crate::linalg::{Qr, cholesky, dot};
use crate::model::wire::Kernel;

/// Degree of the tail.
const DEGREE: usize = 2;

impl<T: Real, const N: usize> Weights<T, N> {
    /// Weights of the samples (Ca, a/l) at a query (Ca, a/l), by the quintic kernel. `left_out` is a sample that takes
    /// no part. `scratch` holds N^2 entries.
    ///
    /// Where the nearest samples lie on a curve of second degree or on a line, the monomials that they cannot tell
    /// apart are left out of the tail.
    ///
    /// # Errors
    /// [`EvaluateError::Weights`] if the samples are too close to each other to be told apart;
    /// [`EvaluateError::BufferTooShort`] for the scratch.
    pub fn kernel(
        settings: &Kernel,
        samples: impl Iterator<Item = [T; 2]>,
        query: [T; 2],
        left_out: Option<usize>,
        scratch: &mut [T],
    ) -> Result<Self, EvaluateError> {
        let scale = T::from_f64(settings.capillary_scale);
        let root = |capillary_number: T| scale * capillary_number.max(T::ZERO).sqrt();
        let origin = [root(query[0]), query[1]];
        let offsets = samples.map(|sample| [root(sample[0]) - origin[0], sample[1] - origin[1]]);
        let mut neighbours = [Neighbour::NONE; N];
        let wanted = usize::from(settings.neighbours).min(N);
        let n = nearest(offsets, left_out, &mut neighbours[..wanted]);
        if n == 0 {
            return Err(EvaluateError::Weights { sum: 0.0 });
        }
        let neighbours = &neighbours[..n];
        let mut weights = Self::new(
            neighbours,
            neighbours.last().map_or(T::ZERO, |last| last.distance),
            DEGREE,
        );

        let found = scratch.len();
        let matrix = scratch
            .get_mut(..n * n)
            .ok_or(EvaluateError::BufferTooShort { required: n * n, found })?;
        let offsets = &weights.offsets[..n];
        for i in 0..n {
            for j in 0..i {
                let value = covariance(DEGREE, offsets[i], offsets[j]);
                matrix[i * n + j] = value;
                matrix[j * n + i] = value;
            }
            matrix[i * n + i] = T::ZERO;
        }
        let mut right = [T::ZERO; N];
        for (right, offset) in right.iter_mut().zip(offsets) {
            *right = covariance(DEGREE, *offset, [T::ZERO; 2]);
        }

        // L = Q [c; y]: c meets the constraints, y is free.
        let qr = Qr::new(n, weights.monomials());
        let rank = qr.rank();
        qr.conjugate(matrix);
        qr.transpose_times(&mut right[..n]);
        let values = &mut weights.values[..n];
        qr.solve_transposed(&at_query(), values);
        let (c, y) = values.split_at_mut(rank);
        for (i, y) in y.iter_mut().enumerate() {
            *y = right[rank + i] - dot(&matrix[(rank + i) * n..][..rank], c);
        }
        cholesky::solve(matrix, n, rank, y);
        qr.times(values);
        weights.normalised()
    }
}
