//! Quintic kernel with a quadratic tail on the nearest samples.
//!
//! The weights minimise the error's variance under the generalised covariance -r^5 and a little scatter, subject to the
//! exact reproduction of quadratics. They are found in the null space of the constraints, where the kernel's matrix is positive definite:
//! then single precision keeps sum L = 1 to rounding, which a stored inverse or the full indefinite system does not.

use super::coordinates::apart;
use super::neighbours::{Neighbour, nearest};
use super::{Coordinates, Weights, at_query, covariance, minus, square};
use crate::error::EvaluateError;
use crate::linalg::{Qr, cholesky, dot, part, part_mut};
use crate::model::wire::Kernel;
use crate::{Parameters, Real};

/// Degree of the tail.
const DEGREE: usize = 2;
/// Variance of the data's own scatter, in the units of the kernel at the distance of the farthest sample: what two samples
/// closer than a tenth of that differ by is not extrapolated. Without it, samples close to each other (0.00125 in Ca beside
/// the steady limit) leave a matrix that single precision cannot solve: one answer in a hundred was wrong by up to 0.3 a.
const SCATTER: f32 = 3e-5;

impl<T: Real, const N: usize> Weights<T, N> {
    /// Weights of the samples at a query with as many parameters, by the quintic kernel. `left_out` is a sample that takes
    /// no part. `scratch` holds N^2 entries.
    ///
    /// Where the nearest samples lie on a surface of second degree, the monomials that they cannot tell
    /// apart are left out of the tail.
    ///
    /// # Errors
    /// [`EvaluateError::Weights`] if the samples are too close to each other to be told apart;
    /// [`EvaluateError::BufferTooShort`] for the scratch.
    pub fn kernel(
        settings: &Kernel,
        coordinates: &Coordinates<'_>,
        samples: impl Iterator<Item = Parameters<T>>,
        query: &Parameters<T>,
        left_out: Option<usize>,
        scratch: &mut [T],
    ) -> Result<Self, EvaluateError> {
        match query.as_slice().len() {
            1 => Self::kernel_in::<1, 3>(settings, coordinates, samples, query.array(), left_out, scratch),
            2 => Self::kernel_in::<2, 6>(settings, coordinates, samples, query.array(), left_out, scratch),
            3 => Self::kernel_in::<3, 10>(settings, coordinates, samples, query.array(), left_out, scratch),
            _ => Self::kernel_in::<4, 15>(settings, coordinates, samples, query.array(), left_out, scratch),
        }
    }

    /// In `P` parameters, in which there are `C` monomials up to degree two.
    #[inline(never)]
    fn kernel_in<const P: usize, const C: usize>(
        settings: &Kernel,
        coordinates: &Coordinates<'_>,
        samples: impl Iterator<Item = Parameters<T>>,
        query: [T; P],
        left_out: Option<usize>,
        scratch: &mut [T],
    ) -> Result<Self, EvaluateError> {
        let (origin, side) = (coordinates.place(query), coordinates.side(query));
        let offset = |sample: Parameters<T>, limit| {
            let sample: [T; P] = sample.array();
            if coordinates.least_square(minus(sample, query)) >= limit {
                return None;
            }
            let offset = minus(coordinates.place(sample), origin);
            let near = square(offset) < limit && !apart(coordinates.side(sample), side);
            near.then_some(offset)
        };
        let mut neighbours = [Neighbour::NONE; N];
        let wanted = usize::from(settings.neighbours).min(N);
        let n = nearest(samples, left_out, offset, part_mut(&mut neighbours, 0..wanted));
        let neighbours = part(&neighbours, 0..n);
        let radius = neighbours.last().map_or(T::ZERO, Neighbour::distance);
        let mut weights = Self::new(neighbours, radius, DEGREE);

        let found = scratch.len();
        let (rows, _) = scratch.as_chunks_mut::<N>();
        let matrix = rows
            .get_mut(..n)
            .ok_or(EvaluateError::BufferTooShort { required: N * n, found })?;
        let offsets: [[T; P]; N] = weights.offsets_in();
        let offsets = part(&offsets, 0..n);
        let mut right = [T::ZERO; N];
        // The matrix is symmetric: its lower half is enough.
        for (i, ((row, right), a)) in matrix.iter_mut().zip(&mut right).zip(offsets).enumerate() {
            for (j, (value, b)) in row.iter_mut().zip(offsets).enumerate().take(i + 1) {
                let scatter = if i == j { T::from_f32(SCATTER) } else { T::ZERO };
                *value = covariance(DEGREE, *a, *b) + scatter;
            }
            *right = covariance(DEGREE, *a, [T::ZERO; P]);
        }

        // L = Q (c + y): c in the first entries meets the constraints, y in the others is free.
        let qr: Qr<T, N, C> = Qr::new(n, weights.monomials::<P, C>());
        qr.conjugate(matrix);
        qr.transpose_times(&mut right);
        let c = qr.solve_transposed(&at_query());
        let mut y = [T::ZERO; N];
        for ((y, right), row) in y.iter_mut().zip(right).zip(&*matrix).skip(qr.rank()) {
            *y = right - dot(part(row, 0..qr.rank()), part(&c, 0..qr.rank()));
        }
        cholesky::solve(matrix, qr.rank(), &mut y);
        weights.values = core::array::from_fn(|i| c[i] + y[i]);
        qr.times(&mut weights.values);
        weights.normalised()
    }
}
