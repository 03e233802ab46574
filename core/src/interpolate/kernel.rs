//! Quintic kernel with a quadratic tail on the nearest samples.
//!
//! The weights minimise the error's variance under the generalised covariance -r^5, subject to the exact reproduction
//! of quadratics. They are found in the null space of the constraints, where the kernel's matrix is positive definite:
//! then single precision keeps sum L = 1 to rounding, which a stored inverse or the full indefinite system does not.

use super::neighbours::{Neighbour, nearest};
use super::{Plane, Weights, at_query, covariance};
use crate::Real;
use crate::error::EvaluateError;
use crate::linalg::{Qr, cholesky, dot, part, part_mut};
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
        plane: &Plane<'_>,
        samples: impl Iterator<Item = [T; 2]>,
        query: [T; 2],
        left_out: Option<usize>,
        scratch: &mut [T],
    ) -> Result<Self, EvaluateError> {
        let origin = plane.place(query);
        let offsets = samples.map(|sample| {
            if plane.apart(sample, query) {
                return [T::from_f32(f32::INFINITY); 2];
            }
            let place = plane.place(sample);
            [place[0] - origin[0], place[1] - origin[1]]
        });
        let mut neighbours = [Neighbour::NONE; N];
        let wanted = usize::from(settings.neighbours).min(N);
        let n = nearest(offsets, left_out, part_mut(&mut neighbours, 0..wanted));
        let neighbours = part(&neighbours, 0..n);
        let radius = neighbours.last().map_or(T::ZERO, |last| last.distance);
        let mut weights = Self::new(neighbours, radius, DEGREE);

        let found = scratch.len();
        let (rows, _) = scratch.as_chunks_mut::<N>();
        let matrix = rows
            .get_mut(..n)
            .ok_or(EvaluateError::BufferTooShort { required: N * n, found })?;
        let offsets = part(&weights.offsets, 0..n);
        let mut right = [T::ZERO; N];
        for ((row, right), a) in matrix.iter_mut().zip(&mut right).zip(offsets) {
            *row = [T::ZERO; N];
            for (value, b) in row.iter_mut().zip(offsets) {
                *value = covariance(DEGREE, *a, *b);
            }
            *right = covariance(DEGREE, *a, [T::ZERO; 2]);
        }

        // L = Q (c + y): c in the first entries meets the constraints, y in the others is free.
        let qr = Qr::new(n, weights.monomials());
        qr.conjugate(matrix);
        qr.transpose_times(&mut right);
        let c = qr.solve_transposed(&at_query());
        let mut y = [T::ZERO; N];
        for ((y, right), row) in y.iter_mut().zip(right).zip(&*matrix).skip(qr.rank()) {
            *y = right - dot(row, &c);
        }
        cholesky::solve(matrix, qr.rank(), &mut y);
        weights.values = core::array::from_fn(|i| c[i] + y[i]);
        qr.times(&mut weights.values);
        weights.normalised()
    }
}
