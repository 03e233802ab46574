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
use crate::linalg::{add_scaled, dot_in_order, part, part_mut};
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
    /// Stored instant in each slot; instant i lies in slot i mod 8.
    instants: [Option<usize>; MOST],
    snapshots: [Snapshot<T, M>; MOST],
    window: Window<T>,
    /// Local coordinates that there are, the translation's among them; the others are 0.
    rank: usize,
}

/// A snapshot in local coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Snapshot<T, const M: usize> {
    pub(crate) alpha: [T; M],
    pub(crate) xi: [T; M],
    /// Q xi, the rate of alpha.
    pub(crate) rate: [T; M],
}

impl<T: Real, const M: usize> Snapshot<T, M> {
    pub(crate) const ZERO: Self = Self {
        alpha: [T::ZERO; M],
        xi: [T::ZERO; M],
        rate: [T::ZERO; M],
    };
}

/// The snapshots that have weight, and what of the fit does not change as long as they are the same.
#[derive(Clone, Copy, Debug)]
struct Window<T> {
    /// It is the same from the first of these instants to before the second.
    span: [T; 2],
    /// The interval of stored instants, and its ends.
    interval: usize,
    ends: [T; 2],
    /// R of eq. (45).
    radius: T,
    /// The first stored instant that has weight, and how many follow.
    first: usize,
    count: usize,
    places: [Place<T>; MOST],
    /// Square of the shape at the interval's start.
    square: T,
    stiffness: T,
}

/// Where a snapshot lies as seen from that at the interval's start. Products are those of the shapes.
#[derive(Clone, Copy, Debug)]
struct Place<T> {
    time: T,
    /// Difference of the translation.
    shift: T,
    /// Products of the difference with the others.
    products: [T; MOST],
    /// Products of the difference with the shape at the interval's start, ...
    start: T,
    /// ... with the difference of that at its end, and with the rates at both.
    along: [T; 3],
}

impl<T: Real> Window<T> {
    const NONE: Self = Self {
        span: [T::ZERO; 2],
        interval: 0,
        ends: [T::ZERO; 2],
        radius: T::ZERO,
        first: 0,
        count: 0,
        places: [Place {
            time: T::ZERO,
            shift: T::ZERO,
            products: [T::ZERO; MOST],
            start: T::ZERO,
            along: [T::ZERO; 3],
        }; MOST],
        square: T::ZERO,
        stiffness: T::ZERO,
    };

    /// Finds the snapshots that have weight at `t`, with R = `width` times the snapshot interval that holds t.
    fn find(&mut self, times: &Times<'_>, width: T, t: T) {
        let last = times.count() - 1;
        self.interval = times.interval(t);
        self.ends = [times.get(self.interval), times.get(self.interval + 1)];
        self.radius = width * (self.ends[1] - self.ends[0]);
        self.span = self.ends;
        if self.interval + 1 == last {
            self.span[1] = T::from_f32(f32::INFINITY);
        }
        (self.first, self.count) = (0, 0);
        let nearest = (self.interval + 1).saturating_sub(MOST / 2)..=(self.interval + MOST / 2).min(last);
        for instant in nearest {
            let time = times.get::<T>(instant);
            let borders = [time - self.radius, time + self.radius];
            for border in borders {
                let [from, to] = &mut self.span;
                if border <= t {
                    *from = from.max(border);
                } else {
                    *to = to.min(border);
                }
            }
            if borders[0] <= t
                && t < borders[1]
                && let Some(place) = self.places.get_mut(self.count)
            {
                place.time = time;
                if self.count == 0 {
                    self.first = instant;
                }
                self.count += 1;
            }
        }
    }

    /// At `t` on the cubic through the snapshots at both ends of the interval with their rates: the factors of their
    /// difference and of the rates.
    fn cubic(&self, t: T) -> [T; 3] {
        let [start, end] = self.ends;
        let length = end - start;
        let s = (t - start) / length;
        let rest = T::ONE - s;
        [
            s * s * (T::from_f32(3.0) - s - s),
            rest * rest * s * length,
            -(s * s * rest * length),
        ]
    }
}

impl<T: Real, const M: usize> Manifold<T, M> {
    pub(crate) const EMPTY: Self = Self {
        instants: [None; MOST],
        snapshots: [Snapshot::ZERO; MOST],
        window: Window::NONE,
        rank: M,
    };

    /// Forgets all snapshots; those to come have so many coordinates.
    pub(crate) fn forget(&mut self, rank: usize) {
        self.rank = rank;
        self.instants = [None; MOST];
        self.window.span = [T::ZERO; 2];
    }

    /// Goes to `t`, with R = `width` times the snapshot interval that holds t. `fetch` gives the snapshot at a stored
    /// instant; it is asked once as long as the instant stays in the window.
    pub(crate) fn enter(
        &mut self,
        times: &Times<'_>,
        width: T,
        t: T,
        mut fetch: impl FnMut(usize, &mut Snapshot<T, M>),
    ) {
        let Self {
            instants,
            snapshots,
            window,
            rank,
        } = self;
        let product = |a: &[T; M], b: &[T; M]| product(a, b, *rank);
        let [from, to] = window.span;
        if from <= t && t < to {
            return;
        }
        window.find(times, width, t);
        let (start, end) = (window.interval, window.interval + 1);
        let weighted = window.first..window.first + window.count;
        for instant in [start, end].into_iter().chain(weighted) {
            let slot = instant % MOST;
            if instants[slot] != Some(instant) {
                fetch(instant, &mut snapshots[slot]);
                instants[slot] = Some(instant);
            }
        }
        let [start, end] = [start, end].map(|instant| &snapshots[instant % MOST]);
        let rise = difference(&end.alpha, &start.alpha);
        window.square = product(&start.alpha, &start.alpha);
        window.stiffness = T::ZERO;
        let (first, count) = (window.first, window.count);
        let snapshots = |j: usize| &snapshots[(first + j) % MOST];
        for (j, place) in part_mut(&mut window.places, 0..count).iter_mut().enumerate() {
            let here = snapshots(j);
            let alpha = difference(&here.alpha, &start.alpha);
            place.shift = alpha[0];
            place.start = product(&alpha, &start.alpha);
            place.along = [&rise, &start.rate, &end.rate].map(|other| product(&alpha, other));
            for (i, products) in place.products.iter_mut().enumerate().take(count) {
                let other = snapshots(i);
                *products = product(&alpha, &difference(&other.alpha, &start.alpha));
                let apart = difference(&here.alpha, &other.alpha);
                let apart = product(&apart, &apart).sqrt();
                if i < j && apart > T::ZERO {
                    let change = difference(&here.xi, &other.xi);
                    window.stiffness = window.stiffness.max(product(&change, &change).sqrt() / apart);
                }
            }
        }
    }

    /// alpha^D at the start of the interval.
    pub(crate) fn start(&self) -> [T; M] {
        self.snapshots[self.window.interval % MOST].alpha
    }

    /// How fast the shape relaxes in the window: the greatest change of the velocity over that of the displacement
    /// between its snapshots.
    pub(crate) fn stiffness(&self) -> T {
        self.window.stiffness
    }

    /// d alpha / dt = Q M(alpha, t), for an Euler step of a length from there.
    pub(crate) fn rate(&self, t: T, step: T, alpha: &[T; M]) -> [T; M] {
        let shares = self.shares(t, step, alpha);
        self.sum(&shares, |snapshot| &snapshot.rate)
    }

    /// xi = M(alpha, t) (eq. 49).
    pub(crate) fn velocity(&self, t: T, alpha: &[T; M]) -> [T; M] {
        let shares = self.shares(t, T::ZERO, alpha);
        self.sum(&shares, |snapshot| &snapshot.xi)
    }

    /// The shares of the window's snapshots in M(alpha, t), for an Euler step of a length from there.
    ///
    /// The manifold is a line through a few snapshots that follow each other. Where these drift apart from their mean it
    /// amplifies whatever deviates from them, without bound. So the response to the deviation of the state from
    /// the learned trajectory counts only as far as the step does not enlarge the deviation: then what a step errs is
    /// added to the errors before it, and never multiplied.
    fn shares(&self, t: T, step: T, alpha: &[T; M]) -> [T; MOST] {
        let window = &self.window;
        let cubic = window.cubic(t);
        let [rise, to_start, to_end] = cubic;
        let [start, end] = [0, 1].map(|end| &self.snapshots[(window.interval + end) % MOST]);
        // Down to the translation, whose change is asked for too.
        let mut change = T::ZERO;
        let mut deviation = [T::ZERO; M];
        for k in (0..self.rank.min(M)).rev() {
            change = rise * (end.alpha[k] - start.alpha[k]) + to_start * start.rate[k] + to_end * end.rate[k];
            deviation[k] = alpha[k] - (start.alpha[k] + change);
        }
        let sides = |place: &Place<T>, j: usize| {
            let snapshot = &self.snapshots[(window.first + j) % MOST];
            [
                dot_in_order(&cubic, &place.along),
                product(&snapshot.alpha, &deviation, self.rank),
            ]
        };
        let [mut shares, response] = window.fit(t, sides, [change, deviation[0]]);
        let rate = self.sum(&response, |snapshot| &snapshot.rate);
        // |deviation + step share rate| <= |deviation|
        let used = part(&rate, 0..self.rank);
        let (closing, limit) = (-dot_in_order(used, &deviation), step * dot_in_order(used, used));
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

    /// The sum of the window's snapshots, or of a part of them, by their shares.
    fn sum(&self, shares: &[T; MOST], of: impl Fn(&Snapshot<T, M>) -> &[T; M]) -> [T; M] {
        let mut sum = [T::ZERO; M];
        for (j, share) in shares.iter().enumerate().take(self.window.count) {
            let snapshot = of(&self.snapshots[(self.window.first + j) % MOST]);
            add_scaled(&mut sum, *share, part(snapshot, 0..self.rank));
        }
        sum
    }
}

impl<T: Real> Window<T> {
    /// The weighted least-norm first-order fit at `t`: the share that each snapshot has in the fitted value at a place, and
    /// in what the fit adds for a deviation. `sides` gives the products of both with a snapshot, up to what is the same
    /// for all snapshots; `shifts` are their translations.
    ///
    /// With the weights W on a diagonal, the products K of the centred and scaled differences, and their products k with
    /// what is asked for, the shares are W u with (K W + ridge) u = k. This is the dual system of eq. (45); as it
    /// stands, it needs no roots of weights.
    fn fit(&self, t: T, sides: impl Fn(&Place<T>, usize) -> [T; 2], shifts: [T; 2]) -> [[T; MOST]; 2] {
        let count = self.count;
        let places = || part(&self.places, 0..count).iter();
        let mut weights = [T::ZERO; MOST];
        let mut sum = T::ZERO;
        for (value, place) in weights.iter_mut().zip(places()) {
            *value = weight((t - place.time).abs() / self.radius);
            sum += *value;
        }
        let weights = weights.map(|weight| weight / sum);
        let weights = part(&weights, 0..count);

        // Products with the weights' mean, to centre all others.
        let mut rows = [Row::ZERO; MOST];
        let rows = part_mut(&mut rows, 0..count);
        let mut mean = Row::ZERO;
        let (mut spread, mut start) = (T::ZERO, T::ZERO);
        for (j, ((row, place), weight)) in rows.iter_mut().zip(places()).zip(weights).enumerate() {
            *row = Row {
                mean: dot_in_order(part(&place.products, 0..count), weights),
                shift: place.shift,
                sides: sides(place, j),
            };
            mean.mean += *weight * row.mean;
            mean.shift += *weight * row.shift;
            add_scaled(&mut mean.sides, *weight, &row.sides);
            spread += *weight * place.products.get(j).copied().unwrap_or(T::ZERO);
            start += *weight * place.start;
        }
        let spread = (spread - mean.mean).max(T::ZERO);
        let mut variance = T::ZERO;
        for (row, weight) in rows.iter_mut().zip(weights) {
            row.shift -= mean.shift;
            variance += *weight * row.shift * row.shift;
        }
        let rest = T::from_f32(REST * REST) * (self.square + start + start + mean.mean);
        let [scale, shift_scale] = [spread + rest, variance].map(reciprocal);
        let ridge = T::from_f32(RIDGE) * (scale * spread + shift_scale * variance);

        let shifts = [shifts[0] - mean.shift, shifts[1]];
        let mut matrix = [[T::ZERO; MOST]; MOST];
        let matrix = part_mut(&mut matrix, 0..count);
        let mut solution = [[T::ZERO; 2]; MOST];
        let solution = part_mut(&mut solution, 0..count);
        for (j, ((entries, sides), (row, place))) in matrix
            .iter_mut()
            .zip(solution.iter_mut())
            .zip(rows.iter().zip(places()))
            .enumerate()
        {
            // The place is seen from the start of the interval, the deviation is none of a place.
            let centres = [mean.sides[0] + row.mean - mean.mean, mean.sides[1]];
            for (((out, side), centre), shift) in sides.iter_mut().zip(row.sides).zip(centres).zip(shifts) {
                *out = scale * (side - centre) + shift_scale * row.shift * shift;
            }
            let others = rows.iter().zip(place.products).zip(weights);
            for (i, (out, ((other, product), weight))) in entries.iter_mut().zip(others).enumerate() {
                let shape = product - row.mean - other.mean + mean.mean;
                *out = (scale * shape + shift_scale * row.shift * other.shift) * *weight;
                if i == j {
                    *out += ridge;
                }
            }
        }
        solve(matrix, solution);

        let mut shares = [[T::ZERO; MOST]; 2];
        for (side, shares) in shares.iter_mut().enumerate() {
            let mut sum = T::ZERO;
            for ((share, solution), weight) in shares.iter_mut().zip(solution.iter()).zip(weights) {
                *share = *weight * solution[side];
                sum += *share;
            }
            // The fit at the mean is the mean; a deviation adds nothing to it.
            let rest = if side == 0 { T::ONE - sum } else { -sum };
            add_scaled(shares, rest, weights);
        }
        shares
    }
}

/// What is known of a snapshot at an instant: its product with the mean, its translation from there, and the products with
/// what is asked for.
#[derive(Clone, Copy)]
struct Row<T> {
    mean: T,
    shift: T,
    sides: [T; 2],
}

impl<T: Real> Row<T> {
    const ZERO: Self = Self {
        mean: T::ZERO,
        shift: T::ZERO,
        sides: [T::ZERO; 2],
    };
}

/// Solves a system for two right sides in their places, by elimination. Its rows and columns divided by the roots of the
/// weights, it is symmetric and positive definite: no exchange is needed.
fn solve<T: Real>(matrix: &mut [[T; MOST]], sides: &mut [[T; 2]]) {
    for i in 0..matrix.len() {
        let Some((_, [pivot, below @ ..])) = matrix.split_at_mut_checked(i) else {
            return;
        };
        let Some((_, [side, sides_below @ ..])) = sides.split_at_mut_checked(i) else {
            return;
        };
        let inverse = reciprocal(pivot.get(i).copied().unwrap_or(T::ZERO));
        for (row, below) in below.iter_mut().zip(sides_below) {
            let factor = -inverse * row.get(i).copied().unwrap_or(T::ZERO);
            for (entry, pivot) in row.iter_mut().zip(pivot.iter()).skip(i) {
                *entry += factor * *pivot;
            }
            add_scaled(below, factor, side);
        }
    }
    for i in (0..matrix.len()).rev() {
        let (Some(row), Some((_, [side, solved @ ..]))) = (matrix.get(i), sides.split_at_mut_checked(i)) else {
            return;
        };
        for (entry, solved) in row.iter().skip(i + 1).zip(solved.iter()) {
            add_scaled(side, -*entry, solved);
        }
        let inverse = reciprocal(row.get(i).copied().unwrap_or(T::ZERO));
        for side in side {
            *side *= inverse;
        }
    }
}

/// 1/x, or 0 for 0.
fn reciprocal<T: Real>(x: T) -> T {
    if x > T::ZERO { T::ONE / x } else { T::ZERO }
}

fn difference<T: Real, const M: usize>(a: &[T; M], b: &[T; M]) -> [T; M] {
    core::array::from_fn(|k| a[k] - b[k])
}

/// Product of two states without the translation.
#[inline(never)]
fn product<T: Real, const M: usize>(a: &[T; M], b: &[T; M], rank: usize) -> T {
    dot_in_order(part(a, 1..rank), part(b, 1..rank))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::wire::Matrix;

    /// A manifold through four snapshots, at equal distances in time.
    fn through<T: Real, const M: usize>(alpha: [[T; M]; 4], xi: [[T; M]; 4]) -> Manifold<T, M> {
        let bytes: [[u8; 4]; 4] = [0.0_f32, 1.0, 2.0, 3.0].map(f32::to_le_bytes);
        let times = Times(MatrixView::new(&Matrix::f32(4, 1, bytes.as_flattened())));
        let mut manifold = Manifold::EMPTY;
        manifold.enter(&times, T::from_f32(4.0), T::from_f32(1.5), |instant, out| {
            *out = Snapshot {
                alpha: alpha[instant],
                xi: xi[instant],
                // Whatever deviates is damped, so that the response to it counts.
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
}
