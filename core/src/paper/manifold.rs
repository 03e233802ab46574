//! xi = M(alpha, t): the learned quasi-static equilibrium (section 3.4.4 of the paper, eqs. 44 to 46).

use super::snapshot::Snapshot;
use super::times::Times;
use super::window::{NEAR, OTHERS, Window, dot3, product, subtract};
use crate::Real;
use crate::linalg::{add_scaled, dot_in_order, slice_or_empty_mut};
use crate::parts::Parts;
use core::mem::offset_of;

/// Snapshots in local coordinates around an instant, and the fit through them. Both are kept while the instant stays in
/// the window. Instant i is stored in slot i mod 4.
#[derive(Clone, Debug)]
pub(crate) struct Manifold<T, const M: usize> {
    instants: [Option<usize>; NEAR],
    snapshots: [Snapshot<T, M>; NEAR],
    window: Window<T, M>,
    /// Number of local coordinates, the translation's among them; the entries beyond are 0.
    rank: usize,
}

impl<T: Real, const M: usize> Manifold<T, M> {
    pub(crate) const EMPTY: Self = Self {
        instants: [None; NEAR],
        snapshots: [Snapshot::ZERO; NEAR],
        window: Window::EMPTY,
        rank: M,
    };

    /// Writes the parts that are not zeros, see [`Workspace::put`](crate::Workspace::put), at an offset.
    pub(crate) fn put(parts: &mut impl Parts, at: usize) {
        parts.put(at + offset_of!(Self, instants), [None::<usize>; NEAR]);
    }

    /// Discards all snapshots; the next ones have `rank` coordinates.
    pub(crate) fn invalidate(&mut self, rank: usize) {
        self.rank = rank;
        self.instants = [None; NEAR];
        self.window.span = [T::ZERO; 2];
    }

    /// Moves the window to `t`, with R = `width` times the snapshot interval that holds t. `fetch` computes the
    /// snapshot at a stored instant, once for as long as the instant stays in the window.
    pub(crate) fn move_to(
        &mut self,
        times: &Times<'_>,
        width: T,
        t: T,
        mut fetch: impl FnMut(usize, &mut Snapshot<T, M>),
    ) {
        let [from, to] = self.window.span;
        if from <= t && t < to {
            return;
        }
        let instants = self.window.locate(times, width, t);
        let last = times.count() - 1;
        for (&instant, time) in instants.iter().zip(&mut self.window.times) {
            let slot = instant % NEAR;
            if self.instants[slot] != Some(instant) {
                fetch(instant.min(last), &mut self.snapshots[slot]);
                self.instants[slot] = Some(instant);
            }
            // At an infinite distance an instant that is not stored has the weight 0.
            *time = if instant > last {
                T::from_f32(f32::INFINITY)
            } else {
                times.get(instant)
            };
        }
        let snapshots = instants.map(|instant| &self.snapshots[instant % NEAR]);
        self.window.set_snapshots(snapshots, self.rank);
    }

    /// The snapshot at the start of the interval.
    fn first(&self) -> &Snapshot<T, M> {
        &self.snapshots[self.window.interval % NEAR]
    }

    /// alpha^D at the start of the interval.
    pub(crate) fn start(&self) -> [T; M] {
        self.first().alpha
    }

    /// Relaxation rate of the shape in the window: the greatest ratio of the difference of the velocity to that of the
    /// displacement between two of its snapshots.
    pub(crate) fn stiffness(&self) -> T {
        self.window.stiffness
    }

    /// d alpha / dt = Q M(alpha, t) (eq. 47), for an Euler step of the given length from there.
    ///
    /// The manifold is a line through a few successive snapshots. Where these diverge from their mean, it amplifies
    /// deviations from them without bound. So the response to the deviation of the state from the learned trajectory is
    /// limited: the step must not enlarge the deviation. The errors of steps then add up, and are not multiplied.
    pub(crate) fn rate(&self, t: T, step: T, alpha: &[T; M]) -> [T; M] {
        let shares = self.shares(t, step, alpha);
        let mut rate = self.first().rate;
        for (share, difference) in shares.iter().zip(&self.window.rate) {
            add_scaled(slice_or_empty_mut(&mut rate, 0..self.rank), *share, difference);
        }
        rate
    }

    /// xi = M(alpha, t) (eq. 49).
    pub(crate) fn velocity(&self, t: T, alpha: &[T; M]) -> [T; M] {
        let shares = self.shares(t, T::ZERO, alpha);
        let mut xi = self.first().xi;
        let mut difference = [T::ZERO; M];
        for (i, share) in shares.iter().enumerate() {
            let other = &self.snapshots[(self.window.interval + 1 + i) % NEAR];
            subtract(&mut difference, &other.xi, &self.first().xi);
            add_scaled(&mut xi, *share, &difference);
        }
        xi
    }

    /// Shares of the differences from the first snapshot in M(alpha, t), for an Euler step of the given length from
    /// there.
    fn shares(&self, t: T, step: T, alpha: &[T; M]) -> [T; OTHERS] {
        let window = &self.window;
        let cubic = window.cubic(t);
        let [to_rise, to_rate, to_change] = cubic;
        let (start, [rise, ..], [change, ..]) = (self.first(), &window.alpha, &window.rate);
        // The learned trajectory is the cubic. The translation comes last, because its way is needed below.
        let mut way = T::ZERO;
        let mut deviation = [T::ZERO; M];
        for k in (0..self.rank.min(M)).rev() {
            way = to_rise * rise[k] + to_rate * start.rate[k] + to_change * change[k];
            deviation[k] = alpha[k] - (start.alpha[k] + way);
        }
        let mut products = [[T::ZERO; OTHERS]; 2];
        let [with_way, with_deviation] = &mut products;
        let differences = window.along.iter().zip(&window.alpha);
        for ((with_way, with_deviation), (along, alpha)) in with_way.iter_mut().zip(with_deviation).zip(differences) {
            (*with_way, *with_deviation) = (dot3(along, &cubic), product(alpha, &deviation, self.rank));
        }
        let [mut shares, response] = window.fit(t, products, [way, deviation[0]]);
        let mut rate = [T::ZERO; M];
        let rate = slice_or_empty_mut(&mut rate, 0..self.rank);
        for (share, difference) in response.iter().zip(&window.rate) {
            add_scaled(rate, *share, difference);
        }
        // |deviation + step share rate| <= |deviation|
        let (closing, limit) = (-dot_in_order(rate, &deviation), step * dot_in_order(rate, rate));
        let share = if closing <= T::ZERO {
            T::ZERO
        } else if closing + closing < limit {
            (closing + closing) / limit
        } else {
            T::ONE
        };
        add_scaled(&mut shares, share, &response);
        shares
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::MatrixView;
    use crate::model::wire::Matrix;

    /// A manifold through four snapshots, at equal distances in time.
    fn through<T: Real, const M: usize>(alpha: [[T; M]; 4], xi: [[T; M]; 4]) -> Manifold<T, M> {
        let bytes: [[u8; 4]; 4] = [0.0_f32, 1.0, 2.0, 3.0].map(f32::to_le_bytes);
        let times = Times(MatrixView::new(&Matrix::f32(4, 1, bytes.as_flattened())));
        let mut manifold = Manifold::EMPTY;
        manifold.move_to(&times, T::from_f32(4.0), T::from_f32(1.5), |instant, out| {
            *out = Snapshot {
                alpha: alpha[instant],
                xi: xi[instant],
                // Deviations are damped, so that the response to them counts.
                rate: alpha[instant].map(|alpha| -alpha),
            };
        });
        manifold
    }

    #[test]
    fn an_affine_law_of_few_coordinates_is_found() {
        // Two coordinates that move, four snapshots: the law is determined.
        let law = |a: &[f64; 4]| [1.0 + 2.0 * a[0] - a[1], 0.5 - a[1], 3.0, 0.0];
        let alpha: [[f64; 4]; 4] = core::array::from_fn(|i| [100.0 + i as f64, 0.1 * (i * i) as f64, 7.0, 0.0]);
        let manifold = through(alpha, alpha.map(|alpha| law(&alpha)));
        let query = [101.3, 0.2, 7.0, 0.0];
        let found = manifold.velocity(1.5, &query);
        for (found, exact) in found.iter().zip(law(&query)) {
            assert!((found - exact).abs() < 0.01 * exact.abs().max(0.1), "{found} {exact}");
        }
    }

    #[test]
    fn snapshots_are_returned_where_coordinates_outnumber_them() {
        let alpha: [[f32; 6]; 4] =
            core::array::from_fn(|i| core::array::from_fn(|k| ((i + 1) as f32 * (k + 2) as f32).sin()));
        let xi: [[f32; 6]; 4] = core::array::from_fn(|i| core::array::from_fn(|k| ((i * i + k) as f32).cos()));
        let manifold = through(alpha, xi);
        for i in 0..4 {
            let found = manifold.velocity(1.5, &alpha[i]);
            for k in 0..6 {
                assert!((found[k] - xi[i][k]).abs() < 1e-2, "{} {}", found[k], xi[i][k]);
            }
        }
    }

    #[test]
    fn two_instants_are_enough() {
        let bytes: [[u8; 4]; 2] = [0.0_f32, 1.0].map(f32::to_le_bytes);
        let times = Times(MatrixView::new(&Matrix::f32(2, 1, bytes.as_flattened())));
        let snapshot = |instant: usize| Snapshot {
            alpha: [100.0 + instant as f64, 0.3 * instant as f64, 1.0],
            xi: [1.0, 0.5 - instant as f64, 0.2],
            rate: [1.0, 0.3, 0.0],
        };
        let mut manifold = Manifold::EMPTY;
        for (t, instant) in [(0.0, 0), (1.0, 1)] {
            manifold.move_to(&times, 2.0, t, |instant, out| *out = snapshot(instant));
            let found = manifold.velocity(t, &snapshot(instant).alpha);
            for (found, exact) in found.iter().zip(snapshot(instant).xi) {
                assert!((found - exact).abs() < 1e-3, "{found} {exact}");
            }
        }
    }
}
