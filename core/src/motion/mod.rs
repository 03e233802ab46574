//! One query's motion: the double POD with the parameters already contracted, at any instant.
//!
//! The core's slices times psi (eqs. 23 and 24) are the controls of cubic splines in time. Four of them make an
//! instant, and they are kept, so that an instant beside it costs four multiplications a coefficient.

pub(crate) mod spline;

use crate::Real;
use crate::interpolate::Weights;
use crate::linalg::{LANES, dot, slice_or_empty, slice_or_empty_mut};
use crate::model::wire::{Field, Span};
use crate::model::{Indices, MatrixView, QuantizedRef, QuantizedVectors};
use crate::motion::spline::{ORDER, Splines};
use crate::workspace::Parts;
use core::mem::offset_of;

/// The most modes in which the translation's parameters are kept.
pub(crate) const AXIAL_MODES: usize = 16;

/// What the samples' modes become for a query.
#[derive(Clone, Debug)]
pub(crate) struct Contracted<T: Real, const K: usize> {
    /// The span that psi belongs to: the one that was asked for last.
    span: Option<usize>,
    /// psi = Psi^T L.
    psi: QuantizedVectors<T, K>,
    axial: QuantizedVectors<T, AXIAL_MODES>,
}

/// The controls that were computed last: number b lies at b mod 4.
#[derive(Clone, Debug)]
pub(crate) struct Controls<T, const K: usize> {
    numbers: [Option<usize>; ORDER],
    rows: [[T; K]; ORDER],
}

/// What is asked of the coefficients.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quantity {
    Displacement,
    /// The velocity's coefficients are the rates of the displacement's.
    Velocity,
}

/// The interpolated motion, which both methods work on.
#[derive(Debug)]
pub(crate) struct Motion<'a, 's, T: Real, const K: usize> {
    /// The leading coefficients that are asked for, at most K: the translation and one a mode.
    pub(crate) rank: usize,
    knots: MatrixView<'a>,
    spans: &'s [Span<'a>],
    axial_controls: MatrixView<'a>,
    /// The samples that take part, and their weights.
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

    /// Hands out what is no number, as [`Workspace::put`](crate::Workspace::put), from an offset on.
    pub(crate) fn put(parts: &mut impl Parts, at: usize) {
        parts.put(at + offset_of!(Self, span), None::<usize>);
    }

    /// Takes the weights of a query, with which the translation's modes are contracted at once, for everything needs
    /// them.
    pub(crate) fn enter<const N: usize>(&mut self, field: &Field<'_>, weights: &Weights<T, N>) {
        self.span = None;
        let modes = MatrixView::new(&field.axial_modes);
        let values = slice_or_empty_mut(self.axial.values.as_flattened_mut(), 0..modes.columns());
        let (samples, weights) = weights.parts();
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

    /// Hands out what is no number, as [`Workspace::put`](crate::Workspace::put), from an offset on.
    pub(crate) fn put(parts: &mut impl Parts, at: usize) {
        parts.put(at + offset_of!(Self, numbers), [None::<usize>; ORDER]);
    }

    /// Forgets the query.
    pub(crate) fn invalidate(&mut self) {
        self.numbers = [None; ORDER];
    }
}

impl<'a, 's, T: Real, const K: usize> Motion<'a, 's, T, K> {
    pub(crate) fn new<const N: usize>(
        field: &'s Field<'a>,
        weights: &'s Weights<T, N>,
        contracted: &'s mut Contracted<T, K>,
    ) -> Self {
        let (samples, weights) = weights.parts();
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

    /// The same motion, of which no more leading coefficients are asked for.
    pub(crate) fn leading(self, count: usize) -> Self {
        Self {
            rank: self.rank.min(count),
            ..self
        }
    }

    /// out <- the leading coefficients at `t` of a quantity, as many as `out` holds.
    pub(crate) fn coefficients(&mut self, controls: &mut Controls<T, K>, t: T, quantity: Quantity, out: &mut [T]) {
        let (splines, [a, b, c, d]) = self.enter(controls, t);
        let [p, q, r, s] = splines.of(quantity);
        for ((((out, a), b), c), d) in out.iter_mut().zip(a).zip(b).zip(c).zip(d) {
            *out = (p * *a + q * *b) + (r * *c + s * *d);
        }
    }

    /// The translation's coefficient at `t` alone.
    pub(crate) fn translation(&self, t: T, quantity: Quantity) -> T {
        let splines = Splines::at(&self.knots, t);
        let [p, q, r, s] = splines.of(quantity);
        let part = |factor: T, i| factor * self.axial_control(splines.first + i);
        (part(p, 0) + part(q, 1)) + (part(r, 2) + part(s, 3))
    }

    /// The splines that are not zero at `t`.
    pub(crate) fn splines(&self, t: T) -> Splines<T> {
        Splines::at(&self.knots, t)
    }

    /// Computes the controls of an instant that are not there yet.
    fn enter<'c>(&mut self, controls: &'c mut Controls<T, K>, t: T) -> (Splines<T>, [&'c [T; K]; ORDER]) {
        let splines = Splines::at(&self.knots, t);
        let numbers = controls.numbers.iter_mut().zip(&mut controls.rows).enumerate();
        let turn = splines.first % ORDER;
        for (place, (number, row)) in numbers {
            // The only one of four successive numbers that lies here.
            let wanted = splines.first + (place + ORDER - turn) % ORDER;
            if *number != Some(wanted) {
                self.control(wanted, slice_or_empty_mut(row, 0..self.rank));
                *number = Some(wanted);
            }
        }
        let [a, b, c, d] = &controls.rows;
        let ordered = match turn {
            0 => [a, b, c, d],
            1 => [b, c, d, a],
            2 => [c, d, a, b],
            _ => [d, a, b, c],
        };
        (splines, ordered)
    }

    /// out <- the leading entries of control number `b`, the translation's first; zeros beyond the last control.
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

    /// out <- slice b times psi of its span, as far as there are rows.
    fn shape_control(&mut self, mut b: usize, out: &mut [T]) {
        for (number, span) in self.spans.iter().enumerate() {
            let slices = Indices::new(&span.slices);
            if b >= slices.len() {
                b -= slices.len();
                continue;
            }
            let Contracted { span: known, psi, .. } = &mut *self.contracted;
            let modes = MatrixView::new(&span.parameter_modes);
            let core = MatrixView::new(&span.core);
            if *known != Some(number) {
                let values = slice_or_empty_mut(psi.values.as_flattened_mut(), 0..modes.columns());
                modes.combine(self.samples, self.weights, values);
                psi.quantize(&core, modes.columns());
                *known = Some(number);
            }
            let mut counts = slices.iter();
            let first = counts.by_ref().take(b).sum();
            let rows = LANES * counts.next().unwrap_or_default();
            let rows = rows.min(out.len());
            return multiply(&core, first, psi.quantized(), slice_or_empty_mut(out, 0..rows));
        }
    }
}

/// out <- rows, from a panel on, times a vector.
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

/// How many of the leading coefficients leave no more than a length of the others: the modes are orthonormal, so what
/// is left out moves the nodes by that length divided by sqrt(N_x), root mean square. A multiple of eight, if there are
/// as many.
pub(crate) fn leading<T: Real>(coefficients: &[T], length: T) -> usize {
    const STEP: usize = 8;
    let mut budget = length * length;
    let mut count = coefficients.len();
    while count > STEP {
        let shorter = (count - 1) / STEP * STEP;
        let last = slice_or_empty(coefficients, shorter..count);
        budget -= dot(last, last);
        // Not a number counts as too much.
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
    fn what_is_left_out_is_shorter_than_allowed() {
        let coefficients: [f64; 21] = core::array::from_fn(|k| 0.5_f64.powi(k as i32));
        let rest = |from: usize| coefficients[from..].iter().map(|c| c * c).sum::<f64>().sqrt();
        for (length, expected) in [
            (0.0, 21),
            (1.01 * rest(16), 16),
            (0.99 * rest(16), 21),
            (1.01 * rest(8), 8),
            (9.0, 8),
        ] {
            assert_eq!(leading(&coefficients, length), expected);
        }
        assert_eq!(leading(&[f64::NAN; 9], 1.0), 9);
    }
}
