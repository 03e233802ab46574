//! The interpolated motion of a query at any instant: the double POD of section 3.3, contracted with the weights.
//!
//! The coefficients of the modes are cubic splines in time. Their control vectors are the slices of the core tensor
//! times psi (eqs. 23 and 24). Four of them define the motion between two knots; they are cached, so that another
//! instant there costs four multiplications a coefficient. `spline` evaluates the B-splines.

pub(crate) mod spline;

use crate::Real;
use crate::interpolate::Weights;
use crate::linalg::{LANES, dot, slice_or_empty, slice_or_empty_mut};
use crate::model::wire::{Field, Span};
use crate::model::{Indices, MatrixView, QuantizedRef, QuantizedVectors};
use crate::motion::spline::{ORDER, Splines};
use crate::parts::Parts;
use core::mem::offset_of;

/// Maximum number of parameter modes of the translation.
pub(crate) const AXIAL_MODES: usize = 16;

/// The parameter modes contracted with the weights of a query.
#[derive(Clone, Debug)]
pub(crate) struct Contracted<T: Real, const K: usize> {
    /// The span of time that psi belongs to.
    span: Option<usize>,
    /// psi = Psi^T L (eq. 24), of the shape.
    psi: QuantizedVectors<T, K>,
    /// The same of the translation.
    axial: QuantizedVectors<T, AXIAL_MODES>,
}

/// The last four control vectors: number b is stored in row b mod 4.
#[derive(Clone, Debug)]
pub(crate) struct Controls<T, const K: usize> {
    numbers: [Option<usize>; ORDER],
    rows: [[T; K]; ORDER],
}

/// A field of the capsule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quantity {
    Displacement,
    /// Its coefficients are the derivatives of the displacement's in time.
    Velocity,
}

impl Quantity {
    /// QuantizedRef of the control vectors in the coefficients of the field.
    pub(crate) fn factors<T>(self, splines: Splines<T>) -> [T; ORDER] {
        match self {
            Self::Displacement => splines.values,
            Self::Velocity => splines.rates,
        }
    }
}

/// The interpolated motion of a query, which both methods work on.
#[derive(Debug)]
pub(crate) struct Motion<'a, 's, T: Real, const K: usize> {
    /// Number of leading coefficients, at most K: the translation's and one a mode.
    pub(crate) rank: usize,
    knots: MatrixView<'a>,
    spans: &'s [Span<'a>],
    axial_controls: MatrixView<'a>,
    /// Samples with a weight, and their weights.
    samples: &'s [u16],
    weights: &'s [T],
    contracted: &'s mut Contracted<T, K>,
}

impl<T: Real, const K: usize> Contracted<T, K> {
    pub(crate) const EMPTY: Self = Self {
        span: None,
        psi: QuantizedVectors::ZERO,
        axial: QuantizedVectors::ZERO,
    };

    /// Writes the parts that are not zeros, see [`Workspace::put`](crate::Workspace::put), at an offset.
    pub(crate) fn put(parts: &mut impl Parts, at: usize) {
        parts.put(at + offset_of!(Self, span), None::<usize>);
    }

    /// Sets the weights of a query: contracts the translation's parameter modes, and marks psi of the shape as unknown.
    pub(crate) fn set_weights<const N: usize>(&mut self, field: &Field<'_>, weights: &Weights<T, N>) {
        self.span = None;
        let modes = MatrixView::new(&field.axial_modes);
        let values = slice_or_empty_mut(self.axial.values.as_flattened_mut(), 0..modes.columns());
        let (samples, weights) = weights.as_slices();
        modes.combine(samples, weights, values);
        let controls = MatrixView::new(&field.axial_controls);
        self.axial.quantize(&controls, controls.columns());
    }
}

impl<T: Real, const K: usize> Controls<T, K> {
    pub(crate) const EMPTY: Self = Self {
        numbers: [None; ORDER],
        rows: [[T::ZERO; K]; ORDER],
    };

    /// Writes the parts that are not zeros, see [`Workspace::put`](crate::Workspace::put), at an offset.
    pub(crate) fn put(parts: &mut impl Parts, at: usize) {
        parts.put(at + offset_of!(Self, numbers), [None::<usize>; ORDER]);
    }

    /// Discards the control vectors.
    pub(crate) fn invalidate(&mut self) {
        self.numbers = [None; ORDER];
    }
}

impl<'a, 's, T: Real, const K: usize> Motion<'a, 's, T, K> {
    /// The motion of a field with the weights of a query.
    pub(crate) fn new<const N: usize>(
        field: &'s Field<'a>,
        weights: &'s Weights<T, N>,
        contracted: &'s mut Contracted<T, K>,
    ) -> Self {
        let (samples, weights) = weights.as_slices();
        Self {
            rank: field.modes.columns as usize + 1,
            knots: MatrixView::new(&field.knots),
            spans: &field.spans,
            axial_controls: MatrixView::new(&field.axial_controls),
            samples,
            weights,
            contracted,
        }
    }

    /// The motion in at most so many leading coefficients.
    pub(crate) fn truncate(self, count: usize) -> Self {
        Self {
            rank: self.rank.min(count),
            ..self
        }
    }

    /// out <- the leading coefficients of a field at `t`.
    pub(crate) fn coefficients(&mut self, controls: &mut Controls<T, K>, t: T, quantity: Quantity, out: &mut [T]) {
        let (splines, [a, b, c, d]) = self.load_window(controls, t);
        let [p, q, r, s] = quantity.factors(splines);
        for ((((out, a), b), c), d) in out.iter_mut().zip(a).zip(b).zip(c).zip(d) {
            *out = (p * *a + q * *b) + (r * *c + s * *d);
        }
    }

    /// The translation's coefficient at `t` alone.
    pub(crate) fn translation(&self, t: T, quantity: Quantity) -> T {
        let splines = Splines::at(&self.knots, t);
        let [p, q, r, s] = quantity.factors(splines);
        let term = |factor: T, i| factor * self.axial_control(splines.first + i);
        (term(p, 0) + term(q, 1)) + (term(r, 2) + term(s, 3))
    }

    /// The splines that are nonzero at `t`.
    pub(crate) fn splines(&self, t: T) -> Splines<T> {
        Splines::at(&self.knots, t)
    }

    /// The splines and the four control vectors at an instant; computes those that are not stored.
    fn load_window<'c>(&mut self, controls: &'c mut Controls<T, K>, t: T) -> (Splines<T>, [&'c [T; K]; ORDER]) {
        let splines = Splines::at(&self.knots, t);
        let numbers = controls.numbers.iter_mut().zip(&mut controls.rows).enumerate();
        let offset = splines.first % ORDER;
        for (slot, (number, row)) in numbers {
            // The one of four successive numbers that is stored in this row.
            let wanted = splines.first + (slot + ORDER - offset) % ORDER;
            if *number != Some(wanted) {
                self.control(wanted, slice_or_empty_mut(row, 0..self.rank));
                *number = Some(wanted);
            }
        }
        let [a, b, c, d] = &controls.rows;
        let ordered = match offset {
            0 => [a, b, c, d],
            1 => [b, c, d, a],
            2 => [c, d, a, b],
            _ => [d, a, b, c],
        };
        (splines, ordered)
    }

    /// out <- the leading entries of control vector `b`, the translation's first; zeros beyond the last vector.
    pub(crate) fn control(&mut self, b: usize, out: &mut [T]) {
        out.fill(T::ZERO);
        if let Some((translation, shape)) = out.split_first_mut() {
            *translation = self.axial_control(b);
            self.shape_control(b, shape);
        }
    }

    fn axial_control(&self, b: usize) -> T {
        self.axial_controls.dot(b, self.contracted.axial.quantized())
    }

    /// out <- slice b of the core tensor times psi of its span of time (eq. 23).
    fn shape_control(&mut self, mut b: usize, out: &mut [T]) {
        for (number, span) in self.spans.iter().enumerate() {
            let slices = Indices::new(&span.slices);
            if b >= slices.len() {
                b -= slices.len();
                continue;
            }
            let Contracted { span: current, psi, .. } = &mut *self.contracted;
            let modes = MatrixView::new(&span.parameter_modes);
            let core = MatrixView::new(&span.core);
            if *current != Some(number) {
                let values = slice_or_empty_mut(psi.values.as_flattened_mut(), 0..modes.columns());
                modes.combine(self.samples, self.weights, values);
                psi.quantize(&core, modes.columns());
                *current = Some(number);
            }
            let mut counts = slices.iter();
            let first = counts.by_ref().take(b).sum();
            let rows = LANES * counts.next().unwrap_or_default();
            let rows = rows.min(out.len());
            return multiply(&core, first, psi.quantized(), slice_or_empty_mut(out, 0..rows));
        }
    }
}

/// out <- the rows from panel `first` on times a vector.
fn multiply<T: Real>(rows: &MatrixView<'_>, first: usize, x: QuantizedRef<'_, T>, out: &mut [T]) {
    let (panels, rest) = out.as_chunks_mut::<LANES>();
    rows.successive(first, x, panels.as_chunks_mut().0);
    if !rest.is_empty() {
        let mut last = [[[T::ZERO; LANES]; 1]];
        rows.successive(first + panels.len(), x, &mut last);
        let last = last.as_flattened().as_flattened();
        rest.iter_mut().zip(last).for_each(|(out, product)| *out = *product);
    }
}

/// Number of leading coefficients such that the others have a norm of at most `length`: the modes are orthonormal, so
/// leaving out the others moves the nodes by length / sqrt(N_x), root mean square. A multiple of eight, or all.
pub(crate) fn significant_rank<T: Real>(coefficients: &[T], length: T) -> usize {
    const STEP: usize = 8;
    let mut budget = length * length;
    let mut count = coefficients.len();
    while count > STEP {
        let shorter = (count - 1) / STEP * STEP;
        let last = slice_or_empty(coefficients, shorter..count);
        budget -= dot(last, last);
        // A NaN exceeds the budget.
        if budget >= T::ZERO {
            count = shorter;
        } else {
            break;
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_coefficients_left_out_are_shorter_than_allowed() {
        let coefficients: [f64; 21] = core::array::from_fn(|k| 0.5_f64.powi(k as i32));
        let rest = |from: usize| coefficients[from..].iter().map(|c| c * c).sum::<f64>().sqrt();
        for (length, expected) in [
            (0.0, 21),
            (1.01 * rest(16), 16),
            (0.99 * rest(16), 21),
            (1.01 * rest(8), 8),
            (9.0, 8),
        ] {
            assert_eq!(significant_rank(&coefficients, length), expected);
        }
        assert_eq!(significant_rank(&[f64::NAN; 9], 1.0), 9);
    }
}
