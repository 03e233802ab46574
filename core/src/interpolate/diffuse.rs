//! Second-order diffuse approximation (section 3.4.1 of the paper, eqs. 25 to 31).
//!
//! Four things differ from the print: r weighs Ca and not a/l (as Figure 5 shows; with r on a/l the neighbours of a
//! query lie on one or two rows of the design); R is more than the distance of the M-th sample, which would else have
//! weight 0; and the coordinates are shifted to the query and divided by R, with a small ridge on the second-order
//! terms, which leaves sum L = 1 and the first order untouched where the samples do not determine them; and samples
//! beyond a jump of the solution take no part, because a polynomial through a jump swings on both sides of it.

use super::coordinates::{apart, scaled};
use super::neighbours::{Neighbour, nearest};
use super::{Coordinates, Weights, at_query, minus, square};
use crate::error::EvaluateError;
use crate::linalg::{Qr, part, part_mut};
use crate::model::wire::Paper;
use crate::{Parameters, Real};

/// Square root of the ridge on the second-order terms.
const RIDGE: f32 = 1e-4;
/// Degree that is reproduced wherever the samples lie: twelve of them may lie on two rows of a grid.
const SURE_DEGREE: usize = 1;

/// Rows that the ridge takes beside those of the samples: one for each second-order monomial, the last of all.
pub(crate) const fn ridge_rows(parameters: usize) -> usize {
    parameters * (parameters + 1) / 2
}

/// w(d) = 2 d^3 - 3 d^2 + 1 for d <= 1, else 0 (eq. 28).
pub(crate) fn weight<T: Real>(d: T) -> T {
    if d < T::ONE {
        (d + d - T::from_f32(3.0)) * d * d + T::ONE
    } else {
        T::ZERO
    }
}

impl<T: Real, const N: usize> Weights<T, N> {
    /// Weights of the samples at a query with as many parameters, by diffuse approximation: A p(theta_q) of eqs. (25) and
    /// (30) is linear in the data, with L = W P (P^T W P)^-1 p(theta_q). Samples beyond a border of
    /// the coordinates take no part, nor does `left_out`.
    ///
    /// # Errors
    /// [`EvaluateError::Weights`] if the samples are too close to each other to be told apart.
    pub fn diffuse(
        settings: &Paper,
        coordinates: &Coordinates<'_>,
        samples: impl Iterator<Item = Parameters<T>>,
        query: &Parameters<T>,
        left_out: Option<usize>,
    ) -> Result<Self, EvaluateError> {
        match query.as_slice().len() {
            1 => Self::diffuse_in::<1, 3>(settings, coordinates, samples, query.array(), left_out),
            2 => Self::diffuse_in::<2, 6>(settings, coordinates, samples, query.array(), left_out),
            3 => Self::diffuse_in::<3, 10>(settings, coordinates, samples, query.array(), left_out),
            _ => Self::diffuse_in::<4, 15>(settings, coordinates, samples, query.array(), left_out),
        }
    }

    /// In `P` parameters, in which there are `C` monomials up to degree two.
    #[inline(never)]
    fn diffuse_in<const P: usize, const C: usize>(
        settings: &Paper,
        coordinates: &Coordinates<'_>,
        samples: impl Iterator<Item = Parameters<T>>,
        query: [T; P],
        left_out: Option<usize>,
    ) -> Result<Self, EvaluateError> {
        let ridge_rows = ridge_rows(P);
        let side = coordinates.side(query);
        let offset = |sample: Parameters<T>, limit| {
            let sample: [T; P] = sample.array();
            let offset = scaled(&settings.scales, minus(sample, query));
            let near = square(offset) < limit && !apart(coordinates.side(sample), side);
            near.then_some(offset)
        };
        let mut neighbours = [Neighbour::NONE; N];
        let found = nearest(
            samples,
            left_out,
            offset,
            part_mut(&mut neighbours, 0..N.saturating_sub(ridge_rows)),
        );
        let holds = usize::from(settings.neighbours).clamp(1, found.max(1));
        let last = part(&neighbours, 0..holds).last().map_or(T::ZERO, Neighbour::distance);
        let radius = T::from_f64(settings.radius) * last;
        let within = |neighbour: &&Neighbour<T, P>| neighbour.distance() < radius || neighbour.distance() == T::ZERO;
        let n = neighbours.iter().take(found).take_while(within).count();
        let mut weights = Self::new(part(&neighbours, 0..n), radius, SURE_DEGREE);

        let mut columns = weights.monomials::<P, C>();
        let mut roots = [T::ZERO; N];
        for (root, neighbour) in roots.iter_mut().zip(&neighbours).take(n) {
            let d = if radius > T::ZERO {
                neighbour.distance() / radius
            } else {
                T::ZERO
            };
            *root = weight(d).sqrt();
        }
        for column in &mut columns {
            for (value, root) in column.iter_mut().zip(&roots) {
                *value *= *root;
            }
        }
        for (row, column) in columns.iter_mut().skip(1 + P).enumerate() {
            if let Some(value) = column.get_mut(n + row) {
                *value = T::from_f32(RIDGE);
            }
        }
        let qr = Qr::new(n + ridge_rows, columns);
        let mut solution = qr.solve_transposed(&at_query());
        qr.times(&mut solution);
        // The roots are zero where the ridge's rows are.
        weights.values = core::array::from_fn(|j| roots[j] * solution[j]);
        weights.normalised()
    }
}
