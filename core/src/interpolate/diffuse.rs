//! Second-order diffuse approximation (section 3.4.1 of the paper, eqs. 25 to 31).
//!
//! Four things differ from the printed method. The ratio r scales Ca and not a/l, as Figure 5 shows: with r on a/l the
//! neighbours of a query lie on one or two rows of the design. R exceeds the distance of the M-th sample, whose weight
//! would be 0. The coordinates are relative to the query and divided by R, with a small ridge on the second-order
//! terms, which keeps sum L = 1 and the first order exact where the samples do not determine the second. Samples beyond
//! a jump of the solution are not used, because a polynomial through a jump oscillates on both sides.

use super::search::Search;
use super::weights::Storage;
use super::{Coordinates, Weights};
use crate::error::EvaluateError;
use crate::linalg::{Qr, slice_or_empty};
use crate::model::wire::{Paper, Samples};
use crate::{Parameters, Real};

/// Square root of the ridge on the second-order terms.
const RIDGE: f32 = 1e-4;
/// Degree that is reproduced for any position of the samples: twelve samples may lie on two rows of a grid.
const SURE_DEGREE: usize = 1;

/// Rows of the ridge in the least-squares system, after those of the samples: one for each second-order monomial.
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
    /// Weights of the samples at a query by diffuse approximation: A p(theta_q) of eqs. (25) and (30) is linear in the
    /// data, with L = W P (P^T W P)^-1 p(theta_q). `query` has the samples' number of parameters. Samples beyond the
    /// jump curve are not used. `left_out` is a sample that is not used either: the offline stage leaves out one sample
    /// at a time to measure the errors; the online stage passes none. `scratch` has [`SCRATCH`](Self::SCRATCH) numbers.
    ///
    /// # Errors
    /// As [`kernel`](Self::kernel).
    #[inline(never)]
    pub fn diffuse(
        &mut self,
        settings: &Paper,
        coordinates: &Coordinates<'_>,
        samples: &Samples<'_>,
        query: &Parameters<T>,
        left_out: Option<usize>,
        scratch: &mut [T],
    ) -> Result<(), EvaluateError> {
        self.degree = SURE_DEGREE;
        let search = Search {
            dimensions: query.as_slice().len(),
            points: &samples.parameters,
            parameters: &samples.parameters,
            query: query.array(),
            scales: settings.scales.map(T::from_f64),
            jump_curve: coordinates.jump_curve,
            side: coordinates.side(query.array()),
        };
        let ridge_rows = ridge_rows(query.as_slice().len());
        self.find(&search, left_out, N.saturating_sub(ridge_rows));
        let enclosed = (settings.neighbours as usize).clamp(1, self.count.max(1));
        let radius = T::from_f64(settings.radius) * self.distance(enclosed);
        let near = |distance: T| distance < radius || distance == T::ZERO;
        self.count = (0..self.count).take_while(|j| near(self.distance(j + 1))).count();
        let n = self.count;
        let mut roots = [T::ZERO; N];
        for (square, root) in slice_or_empty(&self.values, 0..n).iter().zip(&mut roots) {
            let share = if radius > T::ZERO {
                square.sqrt() / radius
            } else {
                T::ZERO
            };
            *root = weight(share).sqrt();
        }
        self.set_radius(radius)?;

        let columns = self.monomials(Storage::<T, N>::new(scratch)?.columns);
        for column in &mut *columns {
            for (value, root) in column.iter_mut().zip(&roots) {
                *value *= *root;
            }
        }
        for (row, column) in columns.iter_mut().skip(1 + self.dimensions).enumerate() {
            if let Some(value) = column.get_mut(n + row) {
                *value = T::from_f32(RIDGE);
            }
        }
        let solution = Qr::new(n + ridge_rows, columns).first();
        // The roots are 0 in the rows of the ridge.
        for ((weight, root), value) in self.values.iter_mut().zip(&roots).zip(&solution) {
            *weight = *root * *value;
        }
        self.normalise()?;
        self.variance = self.quadratic_form();
        Ok(())
    }
}
