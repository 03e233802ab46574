//! Cubic B-splines in time (de Boor, A Practical Guide to Splines, 2001, chapters IX and X).

use crate::Real;
use crate::model::MatrixView;

/// Order of the splines: number of them that are nonzero between two knots.
pub(crate) const ORDER: usize = 4;

/// The B-splines that are nonzero at an instant, numbers `first` to `first + 3`: values, and derivatives in time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Splines<T> {
    pub(crate) first: usize,
    pub(crate) values: [T; ORDER],
    pub(crate) rates: [T; ORDER],
}

impl<T: Real> Splines<T> {
    /// The splines of validated knots at t in [0, T].
    pub(crate) fn at(knots: &MatrixView<'_>, t: T) -> Self {
        let knot = |i: usize| T::from_f32(knots.get(i, 0));
        // Bisection: t lies in [knot(low), knot(low + 1)), or at the end of the last interval.
        let (mut low, mut high) = (ORDER - 1, knots.rows().saturating_sub(ORDER).max(ORDER));
        while high - low > 1 {
            let middle = (low + high) / 2;
            *(if t < knot(middle) { &mut high } else { &mut low }) = middle;
        }
        // The six knots around the interval: t_-2 to t_3.
        let [a, b, c, d, e, f] = core::array::from_fn(|i| knot(low - 2 + i));
        let share = |start: T, end: T| (t - start) / (end - start);
        // Degrees 1, 2 and 3: each spline is a convex combination of two of the degree below (eq. X.15 there).
        let [one_b, one_c] = [T::ONE - share(c, d), share(c, d)];
        let (left, right) = (share(b, d), share(c, e));
        let two = [
            (T::ONE - left) * one_b,
            left * one_b + (T::ONE - right) * one_c,
            right * one_c,
        ];
        let (left, middle, right) = (share(a, d), share(b, e), share(c, f));
        let values = [
            (T::ONE - left) * two[0],
            left * two[0] + (T::ONE - middle) * two[1],
            middle * two[1] + (T::ONE - right) * two[2],
            right * two[2],
        ];
        // The derivative of a spline of degree 3 is 3 times the difference of two of degree 2, each divided by the
        // length of its support (X.12).
        let three = T::from_f32(3.0);
        let slopes = [
            three * two[0] / (d - a),
            three * two[1] / (e - b),
            three * two[2] / (f - c),
        ];
        let rates = [-slopes[0], slopes[0] - slopes[1], slopes[1] - slopes[2], slopes[2]];
        Self {
            first: low - (ORDER - 1),
            values,
            rates,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::wire::Matrix;

    #[test]
    fn cubics_are_reproduced_with_their_rates() {
        // The control of knots (u, v, w) is the polar form of the polynomial: of t^3 it is u v w.
        let knots = [0.0_f32, 0.0, 0.0, 0.0, 0.5, 0.5, 1.25, 2.0, 2.0, 3.0, 3.0, 3.0, 3.0];
        let mut bytes = [0; 52];
        for (bytes, knot) in bytes.chunks_exact_mut(4).zip(knots) {
            bytes.copy_from_slice(&knot.to_le_bytes());
        }
        let view = MatrixView::new(&Matrix::f32(13, 1, &bytes));
        let polar = |i: usize| {
            let [u, v, w] = [1, 2, 3].map(|j| f64::from(knots[i + j]));
            2.0 - (u + v + w) / 3.0 + 0.5 * (u * v + v * w + w * u) / 3.0 - u * v * w
        };
        for t in [0.0, 0.2, 0.5, 0.7, 1.25, 1.9999, 2.0, 2.5, 3.0_f64] {
            let splines = Splines::at(&view, t);
            let sum = |weights: [f64; 4]| (0..4).map(|j| weights[j] * polar(splines.first + j)).sum::<f64>();
            let exact = [2.0 - t + 0.5 * t * t - t * t * t, -1.0 + t - 3.0 * t * t];
            assert!((sum(splines.values) - exact[0]).abs() < 1e-14, "{t}");
            assert!((sum(splines.rates) - exact[1]).abs() < 1e-13, "{t}");
            assert!((splines.values.iter().sum::<f64>() - 1.0).abs() < 1e-15);
        }
    }
}
