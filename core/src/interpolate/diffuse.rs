//! Second-order diffuse approximation (section 3.4.1 of the paper, eqs. 25 to 31).
//!
//! Three things differ from the print: r weighs Ca and not a/l (as Figure 5 shows; with r on a/l the neighbours of a
//! query lie on one or two rows of the design); R is more than the distance of the M-th sample, which would else have
//! weight 0; and the coordinates are shifted to the query and divided by R, with a small ridge on the second-order
//! terms, which leaves sum L = 1 and the first order untouched where the samples do not determine them.

use super::neighbours::{Neighbour, nearest};
use super::{MONOMIALS, Weights, at_query};
use crate::Real;
use crate::error::EvaluateError;
use crate::linalg::Qr;
use crate::model::wire::Paper;

/// Square root of the ridge on the second-order terms.
const RIDGE: f32 = 1e-4;
/// Degree that is reproduced wherever the samples lie: twelve of them may lie on two rows of a grid.
const SURE_DEGREE: usize = 1;
/// Numbers of the second-order monomials.
const SECOND_ORDER: core::ops::Range<usize> = 3..MONOMIALS;
/// Rows that the ridge takes beside those of the samples.
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
    /// (30) is linear in the data, with L = W P (P^T W P)^-1 p(theta_q). `left_out` is a sample that takes no part.
    ///
    /// # Errors
    /// [`EvaluateError::Weights`] if the samples are too close to each other to be told apart.
    pub fn diffuse(
        settings: &Paper,
        samples: impl Iterator<Item = [T; 2]>,
        query: [T; 2],
        left_out: Option<usize>,
    ) -> Result<Self, EvaluateError> {
        const { assert!(N > SECOND_ORDER.end, "more neighbours than monomials") };
        let scale = T::from_f64(settings.capillary_scale);
        let offsets = samples.map(|sample| [scale * (sample[0] - query[0]), sample[1] - query[1]]);
        let mut neighbours = [Neighbour::NONE; N];
        // The ridge takes some of the rows.
        let capacity = N - RIDGE_ROWS;
        let found = nearest(offsets, left_out, &mut neighbours[..capacity]);
        let holds = usize::from(settings.neighbours).clamp(1, found.max(1));
        let radius = T::from_f64(settings.radius) * neighbours[holds - 1].distance;
        let within = |neighbour: &&Neighbour<T>| neighbour.distance < radius || neighbour.distance == T::ZERO;
        let n = neighbours[..found].iter().take_while(within).count();
        let mut weights = Self::new(&neighbours[..n], radius, SURE_DEGREE);

        let mut columns = weights.monomials();
        let mut roots = [T::ZERO; N];
        for (j, neighbour) in neighbours[..n].iter().enumerate() {
            let d = if radius > T::ZERO {
                neighbour.distance / radius
            } else {
                T::ZERO
            };
            roots[j] = weight(d).sqrt();
            for column in &mut columns {
                column[j] *= roots[j];
            }
        }
        for (row, monomial) in SECOND_ORDER.enumerate() {
            columns[monomial][n + row] = T::from_f32(RIDGE);
        }
        let qr = Qr::new(n + RIDGE_ROWS, columns);
        let mut solution = [T::ZERO; N];
        qr.solve_transposed(&at_query(), &mut solution);
        qr.times(&mut solution[..n + RIDGE_ROWS]);
        for j in 0..n {
            weights.values[j] = roots[j] * solution[j];
        }
        weights.normalised()
    }
}
