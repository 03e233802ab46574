//! Direct evaluation: any instant at random from the interpolated coefficients of its time interval.

use crate::Real;
use crate::linalg::part_mut;
use crate::motion::Motion;

/// Displacement coefficients and their rates at the ends of one interval between stored instants.
#[derive(Clone, Debug)]
pub(crate) struct Interval<T, const K: usize> {
    pub(crate) number: Option<usize>,
    values: [[T; K]; 2],
    rates: [[T; K]; 2],
}

impl<T: Real, const K: usize> Interval<T, K> {
    pub(crate) const EMPTY: Self = Self {
        number: None,
        values: [[T::ZERO; K]; 2],
        rates: [[T::ZERO; K]; 2],
    };

    /// Fetches both ends of interval `number`: alpha = A psi_u and d alpha/dt = C xi with xi = B psi_v.
    fn fetch(&mut self, motion: &Motion<'_, '_, T>, number: usize) {
        let Motion {
            displacement, velocity, ..
        } = motion;
        let mut xi = [T::ZERO; K];
        let xi = part_mut(&mut xi, 0..velocity.rank());
        for (end, (values, rates)) in self.values.iter_mut().zip(&mut self.rates).enumerate() {
            displacement.at_instant(number + end, part_mut(values, 0..displacement.rank()));
            velocity.at_instant(number + end, xi);
            motion.rate(xi, part_mut(rates, 0..displacement.rank()));
        }
        self.number = Some(number);
    }

    /// out <- displacement coefficients at `t`: stored instants as they are, cubic Hermite with the true rates between.
    pub(crate) fn displacement(&mut self, motion: &Motion<'_, '_, T>, t: T, out: &mut [T]) {
        let times = &motion.times;
        let number = times.interval(t);
        if let Some(end) = (0..2).find(|end| t == times.get(number + end)) {
            return motion.displacement.at_instant(number + end, out);
        }
        if self.number != Some(number) {
            self.fetch(motion, number);
        }
        let [t0, t1] = [times.get(number), times.get(number + 1)];
        let (share, length) = ((t - t0) / (t1 - t0), t1 - t0);
        let ([f0, f1], [g0, g1]) = (&self.values, &self.rates);
        for ((((out, f0), f1), g0), g1) in out.iter_mut().zip(f0).zip(f1).zip(g0).zip(g1) {
            *out = hermite(share, length, [*f0, *f1], [*g0, *g1]);
        }
    }
}

/// Velocity coefficient `k` at `t`: cubic Hermite between stored instants with the slopes of the parabolas through each
/// end and its neighbours, so that the velocity is smooth.
pub(crate) fn velocity<T: Real>(motion: &Motion<'_, '_, T>, k: usize, t: T) -> T {
    let Motion { times, velocity, .. } = motion;
    let number = times.interval(t);
    if let Some(end) = (0..2).find(|end| t == times.get(number + end)) {
        return velocity.coefficient(number + end, k);
    }
    let last = times.count() - 1;
    let node = |i: usize| (times.get::<T>(i), velocity.coefficient(i, k));
    let (left, right) = (node(number), node(number + 1));
    let secant = |a: (T, T), b: (T, T)| (b.1 - a.1) / (b.0 - a.0);
    // Slope at b of the parabola through a, b, c.
    let inner = |a: (T, T), b: (T, T), c: (T, T)| secant(a, b) + secant(b, c) - secant(a, c);
    let slope_left = if number > 0 {
        Some(inner(node(number - 1), left, right))
    } else {
        None
    };
    let slope_right = if number + 1 < last {
        Some(inner(left, right, node(number + 2)))
    } else {
        None
    };
    let middle = secant(left, right);
    // A parabola's slopes at two points have the secant between them as their mean.
    let mirrored = |slope: T| middle + middle - slope;
    let slopes = match (slope_left, slope_right) {
        (Some(a), Some(b)) => [a, b],
        (Some(a), None) => [a, mirrored(a)],
        (None, Some(b)) => [mirrored(b), b],
        (None, None) => [middle; 2],
    };
    hermite(
        (t - left.0) / (right.0 - left.0),
        right.0 - left.0,
        [left.1, right.1],
        slopes,
    )
}

/// Cubic Hermite interpolant at the fraction `s` of an interval of length `h`.
fn hermite<T: Real>(s: T, h: T, [f0, f1]: [T; 2], [g0, g1]: [T; 2]) -> T {
    let r = T::ONE - s;
    let step = s * s * (T::from_f32(3.0) - s - s);
    f0 + step * (f1 - f0) + s * r * h * (r * g0 - s * g1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hermite_reproduces_cubics() {
        let f = |t: f64| 2.0 - t + 0.5 * t * t - 3.0 * t * t * t;
        let g = |t: f64| -1.0 + t - 9.0 * t * t;
        let (a, b) = (0.4, 0.7);
        for s in [0.0, 0.2, 0.9, 1.0] {
            let value = hermite(s, b - a, [f(a), f(b)], [g(a), g(b)]);
            assert!((value - f(a + s * (b - a))).abs() < 1e-14);
        }
    }
}
