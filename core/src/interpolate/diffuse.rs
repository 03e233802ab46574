//! Second-order diffuse approximation (section 3.4.1 of the paper, eqs. 25 to 31).
//!
//! Four things differ from the print: r weighs Ca and not a/l (as Figure 5 shows; with r on a/l the neighbours of a
//! query lie on one or two rows of the design); R is more than the distance of the M-th sample, which would else have
//! weight 0; and the coordinates are shifted to the query and divided by R, with a small ridge on the second-order
//! terms, which leaves sum L = 1 and the first order untouched where the samples do not determine them; and samples
//! beyond a jump of the solution take no part, because a polynomial through a jump swings on both sides of it.

use super::neighbours::{Neighbour, nearest};
use super::{MONOMIALS, Plane, Weights, at_query};
use crate::Real;
use crate::error::EvaluateError;
use crate::linalg::{Qr, part, part_mut};
use crate::model::wire::Paper;

/// Square root of the ridge on the second-order terms.
const RIDGE: f32 = 1e-4;
/// Degree that is reproduced wherever the samples lie: twelve of them may lie on two rows of a grid.
const SURE_DEGREE: usize = 1;
/// Rows that the ridge takes beside those of the samples: one for each second-order monomial, the last of all.
pub(crate) const RIDGE_ROWS: usize = MONOMIALS - 3;

/// w(d) = 2 d^3 - 3 d^2 + 1 for d <= 1, else 0 (eq. 28).
pub(crate) fn weight<T: Real>(d: T) -> T {
    if d < T::ONE {
        (d + d - T::from_f32(3.0)) * d * d + T::ONE
    } else {
        T::ZERO
    }
}

impl<T: Real, const N: usize> Weights<T, N> {
    /// Weights of the samples (Ca, a/l) at a query (Ca, a/l), by diffuse approximation: A p(theta_q) of eqs. (25) and
    /// (30) is linear in the data, with L = W P (P^T W P)^-1 p(theta_q). Samples beyond the plane's border take no part,
    /// nor does `left_out`.
    ///
    /// # Errors
    /// [`EvaluateError::Weights`] if the samples are too close to each other to be told apart.
    pub fn diffuse(
        settings: &Paper,
        plane: &Plane<'_>,
        samples: impl Iterator<Item = [T; 2]>,
        query: [T; 2],
        left_out: Option<usize>,
    ) -> Result<Self, EvaluateError> {
        const { assert!(N > MONOMIALS, "more neighbours than monomials") };
        let scale = T::from_f64(settings.capillary_scale);
        let offsets = samples.map(|sample| {
            if plane.apart(sample, query) {
                return [T::from_f32(f32::INFINITY); 2];
            }
            [scale * (sample[0] - query[0]), sample[1] - query[1]]
        });
        let mut neighbours = [Neighbour::NONE; N];
        let found = nearest(offsets, left_out, part_mut(&mut neighbours, 0..N - RIDGE_ROWS));
        let holds = usize::from(settings.neighbours).clamp(1, found.max(1));
        let last = part(&neighbours, 0..holds).last().map_or(T::ZERO, |last| last.distance);
        let radius = T::from_f64(settings.radius) * last;
        let within = |neighbour: &&Neighbour<T>| neighbour.distance < radius || neighbour.distance == T::ZERO;
        let n = neighbours.iter().take(found).take_while(within).count();
        let mut weights = Self::new(part(&neighbours, 0..n), radius, SURE_DEGREE);

        let mut columns = weights.monomials();
        let mut roots = [T::ZERO; N];
        for (root, neighbour) in roots.iter_mut().zip(&neighbours).take(n) {
            let d = if radius > T::ZERO {
                neighbour.distance / radius
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
        for (row, column) in columns.iter_mut().skip(MONOMIALS - RIDGE_ROWS).enumerate() {
            if let Some(value) = column.get_mut(n + row) {
                *value = T::from_f32(RIDGE);
            }
        }
        let qr = Qr::new(n + RIDGE_ROWS, columns);
        let mut solution = qr.solve_transposed(&at_query());
        qr.times(&mut solution);
        // The roots are zero where the ridge's rows are.
        weights.values = core::array::from_fn(|j| roots[j] * solution[j]);
        weights.normalised()
    }
}
