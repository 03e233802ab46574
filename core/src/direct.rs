//! Direct evaluation: any instant at random from the interpolated coefficients of its time interval.
//!
//! Between two stored instants the displacement alpha follows from both ends' values and rates. The membrane relaxes
//! exponentially, at small Ca much faster than the snapshots follow each other, and a cubic would overshoot by up to a
//! sixth of the radius in the first interval. So the interpolant is that of the span of 1, s, s^2 and exp(-m s) over
//! the fraction s of the interval, one m for all coefficients, estimated from the data; m = 0 is the cubic Hermite
//! interpolant, to which it returns as the relaxation slows down. The velocity is its derivative, so that positions
//! stay the integral of velocities.

use crate::Real;
use crate::linalg::{dot, part, part_mut};
use crate::motion::Motion;

/// Displacement coefficients and their rates at the ends of one interval between stored instants.
#[derive(Clone, Debug)]
pub(crate) struct Interval<T, const K: usize> {
    pub(crate) number: Option<usize>,
    values: [[T; K]; 2],
    rates: [[T; K]; 2],
    tension: T,
}

/// An instant within an interval: where it lies, and the interpolant there.
struct Place<T> {
    /// Fraction of the interval before it.
    share: T,
    length: T,
    profile: T,
    slope: T,
}

impl<T: Real, const K: usize> Interval<T, K> {
    pub(crate) const EMPTY: Self = Self {
        number: None,
        values: [[T::ZERO; K]; 2],
        rates: [[T::ZERO; K]; 2],
        tension: T::ZERO,
    };

    /// out <- displacement coefficients at `t`.
    pub(crate) fn displacement(&mut self, motion: &Motion<'_, '_, T>, t: T, out: &mut [T]) {
        if let Some(instant) = stored(motion, t) {
            return motion.displacement.at_instant(instant, out);
        }
        let Place {
            share, length, profile, ..
        } = self.enter(motion, t);
        let late = share * share * T::from_f32(0.5);
        let early = share - late;
        for (k, out) in out.iter_mut().enumerate().take(K) {
            let rise = early * self.rates[0][k] + late * self.rates[1][k] + profile * self.excess(length, k);
            *out = self.values[0][k] + length * rise;
        }
    }

    /// out <- velocity coefficients at `t`: the line between both ends, and what the displacement's mean rate over the
    /// interval has beyond the mean of the ends.
    pub(crate) fn velocity(&mut self, motion: &Motion<'_, '_, T>, t: T, out: &mut [T]) {
        if let Some(instant) = stored(motion, t) {
            return motion.velocity.at_instant(instant, out);
        }
        let place = self.enter(motion, t);
        let number = self.number.unwrap_or_default();
        let mut end = [T::ZERO; K];
        let end = part_mut(&mut end, 0..out.len());
        motion.velocity.at_instant(number, out);
        motion.velocity.at_instant(number + 1, end);
        for (out, end) in out.iter_mut().zip(end) {
            *out += place.share * (*end - *out);
        }
        let mut excess = [T::ZERO; K];
        for (k, excess) in excess.iter_mut().enumerate().take(motion.displacement.rank()) {
            *excess = place.slope * self.excess(place.length, k);
        }
        motion.add_velocity(part(&excess, 0..motion.displacement.rank()), out);
    }

    /// Velocity coefficient 0 at `t`, the translation's, which couples to no mode.
    pub(crate) fn translation_rate(&mut self, motion: &Motion<'_, '_, T>, t: T) -> T {
        if let Some(instant) = stored(motion, t) {
            return motion.velocity.coefficient(instant, 0);
        }
        let Place {
            share, length, slope, ..
        } = self.enter(motion, t);
        let [first, second] = [self.rates[0][0], self.rates[1][0]];
        first + share * (second - first) + slope * self.excess(length, 0)
    }

    /// Mean rate of coefficient `k` over the interval less the mean of its rates at the ends.
    fn excess(&self, length: T, k: usize) -> T {
        let at = |values: &[T; K]| values.get(k).copied().unwrap_or(T::ZERO);
        let ([f0, f1], [g0, g1]) = (self.values.each_ref().map(at), self.rates.each_ref().map(at));
        (f1 - f0) / length - (g0 + g1) * T::from_f32(0.5)
    }

    /// Fetches the interval that holds `t`, if it is not there yet, and places `t` in it.
    fn enter(&mut self, motion: &Motion<'_, '_, T>, t: T) -> Place<T> {
        let number = motion.times.interval(t);
        let [first, second] = [motion.times.get(number), motion.times.get(number + 1)];
        let length: T = second - first;
        if self.number != Some(number) {
            self.fetch(motion, number, length);
        }
        let share = (t - first) / length;
        let [profile, slope] = interpolant(self.tension, share);
        Place {
            share,
            length,
            profile,
            slope,
        }
    }

    /// Fetches both ends of interval `number`: alpha = A psi_u and d alpha/dt = C xi with xi = B psi_v.
    fn fetch(&mut self, motion: &Motion<'_, '_, T>, number: usize, length: T) {
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

        // If the shape's rate falls exponentially, what is left of it on average over the interval, as a share of the
        // fall, tells how fast. A projection on the fall, because the modes are orthonormal.
        let shape = 1..displacement.rank();
        let mut fall = [T::ZERO; K];
        let mut left = [T::ZERO; K];
        for (k, (fall, left)) in fall.iter_mut().zip(&mut left).enumerate() {
            *fall = self.rates[0][k] - self.rates[1][k];
            *left = (self.values[1][k] - self.values[0][k]) / length - self.rates[1][k];
        }
        let (fall, left) = (part(&fall, shape.clone()), part(&left, shape));
        let square = dot(fall, fall);
        self.tension = if square > T::ZERO {
            tension(dot(left, fall) / square)
        } else {
            T::ZERO
        };
    }
}

/// The stored instant at `t`, if there is one.
fn stored<T: Real>(motion: &Motion<'_, '_, T>, t: T) -> Option<usize> {
    let number = motion.times.interval(t);
    [number, number + 1]
        .into_iter()
        .find(|&instant| t == motion.times.get(instant))
}

/// m from the mean of a rate that falls from 1 to 0 like exp(-m s): 1/m - 1/(exp(m) - 1), inverted to within 15 %,
/// which is enough, because the interpolant meets its four conditions with every m. A mean of 1/2 and more is no relaxation.
fn tension<T: Real>(mean: T) -> T {
    let mean = mean.max(T::from_f32(1e-3)).min(T::from_f32(0.5));
    (T::ONE - mean - mean) * (T::ONE + T::from_f32(4.0) * mean) / mean
}

/// The function in the span of 1, s, s^2, exp(-m s) that is 0 at 0 and 1 at 1, with slope 0 at both, and its slope.
fn interpolant<T: Real>(m: T, s: T) -> [T; 2] {
    let ([value, slope], [end, _]) = if m < T::ONE {
        (series(m, s), series(m, T::ONE))
    } else {
        (closed(m, s), closed(m, T::ONE))
    };
    [value / end, slope / end]
}

/// The interpolant but for a factor, and its slope: exp(-m s) - 1 + m s - m (1 - exp(-m)) s^2 / 2.
fn closed<T: Real>(m: T, s: T) -> [T; 2] {
    let bend = m * (T::ONE - (-m).exp());
    let left = (-m * s).exp();
    let value = left - T::ONE + m * s - T::from_f32(0.5) * bend * s * s;
    [value, m - m * left - bend * s]
}

/// The same divided by -m^3, as a power series in m: where m is small, the closed form is lost to rounding. The sum over j
/// of (-m)^j / (j + 2)! times s^2 / 2 - s^(j+3) / (j + 3), or s - s^(j+2) for the slope. At m = 0 it is a cubic.
fn series<T: Real>(m: T, s: T) -> [T; 2] {
    /// The last term is below 1e-16.
    const TERMS: usize = 16;
    let half = T::from_f32(0.5);
    let (mut factor, mut power, mut next) = (half, s * s, T::from_f32(3.0));
    let (mut value, mut slope) = (T::ZERO, T::ZERO);
    let half_square = half * power;
    for _ in 0..TERMS {
        value += factor * (half_square - power * s / next);
        slope += factor * (s - power);
        factor = -(factor * m) / next;
        power *= s;
        next += T::ONE;
    }
    [value, slope]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interpolant_meets_its_conditions_and_is_smooth() {
        for m in [0.0, 1e-2, 0.1, 0.999, 1.001, 10.0, 900.0] {
            for (s, ends) in [(0.0, [0.0, 0.0]), (1.0, [1.0, 0.0])] {
                let found = interpolant(m, s);
                assert!((0..2).all(|i| (found[i] - ends[i]).abs() < 1e-5), "{m} {s} {found:?}");
            }
            for s in [0.1, 0.5, 0.9] {
                let step = 1e-4;
                let [before, after] = [s - step, s + step].map(|s| interpolant(m, s)[0]);
                let [_, slope] = interpolant(m, s);
                assert!(((after - before) / (2.0 * step) - slope).abs() < 1e-5, "{m} {s}");
            }
        }
        // The two forms agree, and so do the two precisions.
        for s in [0.2, 0.7] {
            let step = interpolant(1.0 - 1e-12, s)[0] - interpolant(1.0, s)[0];
            assert!(step.abs() < 1e-11, "{step}");
            for m in [0.3, 1.0, 5.0] {
                let single = interpolant(m as f32, s as f32)[0];
                assert!((f64::from(single) - interpolant(m, s)[0]).abs() < 3e-6, "{m} {s}");
            }
        }
    }

    #[test]
    fn the_tension_of_an_exponential_is_found() {
        for m in [0.1_f64, 1.0, 5.0, 30.0] {
            let mean = 1.0 / m - 1.0 / (m.exp() - 1.0);
            assert!((tension(mean) / m - 1.0).abs() < 0.15, "{m} {}", tension(mean));
        }
        assert_eq!(tension(0.7), 0.0);
        assert!(tension(-3.0).is_finite());
    }
}
