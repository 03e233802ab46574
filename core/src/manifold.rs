//! xi = M(alpha, t): the learned quasi-static equilibrium (section 3.4.4 of the paper, eqs. 44 to 46).
//!
//! A first-order fit on the few snapshots near t has fewer snapshots than unknowns, so the normal equations of eq. (45)
//! are singular. The least-norm solution is taken instead, from the dual system of the snapshots, with the regressors
//! centred and scaled by the window's weights: in raw monomials the constant competes with the translation and the
//! solution drifts. The translation has a scale of its own; the shape's coordinates share one, because they are
//! orthonormal: scaled one by one, the smallest modes, which hardly move, would steer the others and the state blows
//! up. Where the shape rests, its rest is not amplified either: a state that is a little off stays where it is.

use crate::Real;
use crate::interpolate::weight;
use crate::linalg::{cholesky, dot};
use crate::model::MatrixView;

/// The most snapshots that a window holds.
const MOST: usize = 8;
/// Ridge of the dual system, as a share of its trace: directions in which the window's snapshots differ by less than a
/// hundredth of what they do at most are not extrapolated.
const RIDGE: f32 = 1e-4;
/// Least spread of the shape that counts as motion, as a share of the shape's displacement.
const REST: f32 = 1e-2;

/// The stored instants.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Times<'a>(pub(crate) MatrixView<'a>);

impl Times<'_> {
    /// Number of instants.
    pub(crate) fn count(&self) -> usize {
        self.0.rows()
    }

    /// Instant `i`.
    pub(crate) fn get<T: Real>(&self, i: usize) -> T {
        T::from_f32(self.0.get(i, 0))
    }

    /// The interval [t_i, t_i+1] that holds t, by halving; the first or last one outside.
    pub(crate) fn interval<T: Real>(&self, t: T) -> usize {
        let (mut low, mut high) = (0, self.count() - 1);
        while high - low > 1 {
            let middle = (low + high) / 2;
            *(if t < self.get(middle) { &mut high } else { &mut low }) = middle;
        }
        low
    }
}

/// Snapshots in local coordinates around an instant, kept as the instant moves on.
#[derive(Clone, Debug)]
pub(crate) struct Manifold<T, const M: usize> {
    /// Stored instant in each slot.
    instants: [Option<usize>; MOST],
    alpha: [[T; M]; MOST],
    xi: [[T; M]; MOST],
}

impl<T: Real, const M: usize> Manifold<T, M> {
    pub(crate) const EMPTY: Self = Self {
        instants: [None; MOST],
        alpha: [[T::ZERO; M]; MOST],
        xi: [[T::ZERO; M]; MOST],
    };

    /// Forgets all snapshots.
    pub(crate) fn forget(&mut self) {
        self.instants = [None; MOST];
    }

    /// Fetches the snapshots that have weight at `t`, with R = `window` times the snapshot interval that holds t, and
    /// returns the weights by slot. `snapshot` gives alpha^D and xi^D at a stored instant; it is asked once as long as
    /// the instant stays in the window.
    fn fetch(
        &mut self,
        times: &Times<'_>,
        window: T,
        t: T,
        mut snapshot: impl FnMut(usize, &mut [T; M], &mut [T; M]),
    ) -> [T; MOST] {
        let interval = times.interval(t);
        let radius = window * (times.get::<T>(interval + 1) - times.get(interval));
        let first = (interval + 1).saturating_sub(MOST / 2);
        let last = (interval + MOST / 2).min(times.count() - 1);
        let mut weights = [T::ZERO; MOST];
        for instant in first..=last {
            let slot = instant % MOST;
            weights[slot] = weight((t - times.get(instant)).abs() / radius);
            if weights[slot] > T::ZERO {
                self.hold(instant, &mut snapshot);
            }
        }
        weights
    }

    /// Brings a snapshot to its slot, if it is not there; returns the slot.
    fn hold(&mut self, instant: usize, snapshot: &mut impl FnMut(usize, &mut [T; M], &mut [T; M])) -> usize {
        let slot = instant % MOST;
        if self.instants[slot] != Some(instant) {
            snapshot(instant, &mut self.alpha[slot], &mut self.xi[slot]);
            self.instants[slot] = Some(instant);
        }
        slot
    }

    /// alpha at `t` on the trajectory that is learned from: the cubic through the snapshots at both ends of the interval,
    /// with their rates Q xi.
    pub(crate) fn trajectory(
        &mut self,
        times: &Times<'_>,
        t: T,
        q: &[[T; M]; M],
        mut snapshot: impl FnMut(usize, &mut [T; M], &mut [T; M]),
    ) -> [T; M] {
        let interval = times.interval(t);
        let start = self.hold(interval, &mut snapshot);
        let end = self.hold(interval + 1, &mut snapshot);
        let before = times.get::<T>(interval);
        let length = times.get::<T>(interval + 1) - before;
        let s = (t - before) / length;
        let rest = T::ONE - s;
        let [to_start, to_end] = [rest * rest * s * length, -(s * s * rest * length)];
        let rise = s * s * (T::from_f32(3.0) - s - s);
        // Slots are below their number; taken modulo it, no panic is linked.
        let (a, xi_a) = (&self.alpha[start % MOST], &self.xi[start % MOST]);
        let (b, xi_b) = (&self.alpha[end % MOST], &self.xi[end % MOST]);
        core::array::from_fn(|k| {
            let (rate_a, rate_b) = (dot(&q[k], xi_a), dot(&q[k], xi_b));
            a[k] + rise * (b[k] - a[k]) + to_start * rate_a + to_end * rate_b
        })
    }

    /// xi at (alpha, t); see [`fetch`](Self::fetch).
    pub(crate) fn velocity(
        &mut self,
        times: &Times<'_>,
        window: T,
        t: T,
        alpha: &[T; M],
        snapshot: impl FnMut(usize, &mut [T; M], &mut [T; M]),
    ) -> [T; M] {
        let weights = self.fetch(times, window, t, snapshot);
        fit(&weights, &self.alpha, &self.xi, alpha)
    }

    /// How fast the shape relaxes at `t`: the greatest change of the velocity over that of the displacement between
    /// snapshots of the window; see [`fetch`](Self::fetch).
    pub(crate) fn stiffness(
        &mut self,
        times: &Times<'_>,
        window: T,
        t: T,
        snapshot: impl FnMut(usize, &mut [T; M], &mut [T; M]),
    ) -> T {
        let weights = self.fetch(times, window, t, snapshot);
        let snapshots = || {
            self.alpha
                .iter()
                .zip(&self.xi)
                .zip(&weights)
                .filter(|(_, weight)| **weight > T::ZERO)
        };
        let mut stiffness = T::ZERO;
        for (i, ((alpha, xi), _)) in snapshots().enumerate() {
            for ((other, velocity), _) in snapshots().take(i) {
                let displacement = shape_distance(alpha, other);
                if displacement > T::ZERO {
                    stiffness = stiffness.max(shape_distance(xi, velocity) / displacement);
                }
            }
        }
        stiffness
    }
}

/// The weighted least-norm first-order fit of xi over alpha, at `query`.
fn fit<T: Real, const M: usize>(
    weights: &[T; MOST],
    alpha: &[[T; M]; MOST],
    xi: &[[T; M]; MOST],
    query: &[T; M],
) -> [T; M] {
    let sum = weights.iter().copied().sum::<T>();
    let weights = weights.map(|weight| weight / sum);
    let centre = mean(&weights, alpha);
    let variance = mean(&weights, &alpha.map(|alpha| square_difference(&alpha, &centre)));
    let rest = T::from_f32(REST * REST) * dot(&centre[1..], &centre[1..]);
    let shape = reciprocal_root(variance[1..].iter().copied().sum::<T>() + rest);
    let mut scale = [shape; M];
    scale[0] = reciprocal_root(variance[0]);

    let regressor = |alpha: &[T; M]| -> [T; M] { core::array::from_fn(|k| (alpha[k] - centre[k]) * scale[k]) };
    let roots = weights.map(T::sqrt);
    let mut rows = [[T::ZERO; M]; MOST];
    for ((row, alpha), root) in rows.iter_mut().zip(alpha).zip(roots) {
        *row = if root > T::ZERO {
            regressor(alpha).map(|x| root * x)
        } else {
            *row
        };
    }
    let query = regressor(query);
    let mut dual = [[T::ZERO; MOST]; MOST];
    let mut share = [T::ZERO; MOST];
    for i in 0..MOST {
        dual[i] = core::array::from_fn(|j| dot(&rows[i], &rows[j]));
        share[i] = dot(&rows[i], &query);
    }
    let trace = (0..MOST).map(|i| dual[i][i]).sum::<T>();
    for i in 0..MOST {
        dual[i][i] += T::from_f32(RIDGE) * trace;
    }
    cholesky::solve(&mut dual, 0, &mut share);

    let centre = mean(&weights, xi);
    let mut result = centre;
    for ((share, root), xi) in share.iter().zip(roots).zip(xi) {
        for (k, result) in result.iter_mut().enumerate() {
            *result += *share * root * (xi[k] - centre[k]);
        }
    }
    result
}

fn mean<T: Real, const M: usize>(weights: &[T; MOST], vectors: &[[T; M]; MOST]) -> [T; M] {
    core::array::from_fn(|k| {
        weights
            .iter()
            .zip(vectors)
            .map(|(weight, vector)| *weight * vector[k])
            .sum()
    })
}

fn square_difference<T: Real, const M: usize>(a: &[T; M], b: &[T; M]) -> [T; M] {
    core::array::from_fn(|k| (a[k] - b[k]) * (a[k] - b[k]))
}

/// 1/sqrt(x), or 0 for 0.
fn reciprocal_root<T: Real>(x: T) -> T {
    if x > T::ZERO { T::ONE / x.sqrt() } else { T::ZERO }
}

/// Distance of two states without the translation.
fn shape_distance<T: Real, const M: usize>(a: &[T; M], b: &[T; M]) -> T {
    square_difference(a, b)[1..].iter().copied().sum::<T>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_affine_law_of_few_coordinates_is_found() {
        // Two coordinates that move, four snapshots: the law is determined.
        let law = |a: &[f64; 4]| [1.0 + 2.0 * a[0] - a[1], 0.5 - a[1], 3.0, 0.0];
        let alpha: [[f64; 4]; MOST] = core::array::from_fn(|i| [100.0 + i as f64, 0.1 * (i * i) as f64, 7.0, 0.0]);
        let xi = alpha.map(|alpha| law(&alpha));
        let weights = core::array::from_fn(|i| if i < 4 { 1.0 + i as f64 } else { 0.0 });
        let query = [101.3, 0.2, 7.0, 0.0];
        let found = fit(&weights, &alpha, &xi, &query);
        for (found, exact) in found.iter().zip(law(&query)) {
            assert!((found - exact).abs() < 0.01 * exact.abs().max(0.1), "{found} {exact}");
        }
    }

    #[test]
    fn snapshots_are_returned_where_coordinates_outnumber_them() {
        let alpha: [[f32; 6]; MOST] =
            core::array::from_fn(|i| core::array::from_fn(|k| ((i + 1) as f32 * (k + 2) as f32).sin()));
        let xi: [[f32; 6]; MOST] = core::array::from_fn(|i| core::array::from_fn(|k| ((i * i + k) as f32).cos()));
        let weights = core::array::from_fn(|i| if i < 4 { 0.25 } else { 0.0 });
        for i in 0..4 {
            let found = fit(&weights, &alpha, &xi, &alpha[i]);
            for k in 0..6 {
                assert!((found[k] - xi[i][k]).abs() < 1e-2, "{} {}", found[k], xi[i][k]);
            }
        }
    }
}
