//! xi = M(alpha, t): the learned quasi-static equilibrium (section 3.4.4 of the paper, eqs. 44 to 46).
//!
//! A first-order fit on the few snapshots near t has fewer snapshots than unknowns, so the normal equations of eq. (45)
//! are singular. The least-norm solution is taken instead, from the dual system of the snapshots, with the regressors
//! scaled by the window's weights and a constant that costs nothing: in raw monomials it competes with the translation
//! and the solution drifts. The translation has a scale of its own; the shape's coordinates share one, because they are
//! orthonormal: scaled one by one, the smallest modes, which hardly move, would steer the others and the state blows
//! up. Where the shape rests, its rest is not amplified either: a state that is a little off stays where it is.

use crate::Real;
use crate::interpolate::weight;
use crate::linalg::{add_scaled, dot_in_order, slice_or_empty, slice_or_empty_mut};
use crate::model::MatrixView;
use crate::workspace::Parts;
use core::mem::offset_of;

/// Snapshots of a window: two on each side of an instant. The paper's R, twice their interval, holds no more of equal
/// ones.
const NEAR: usize = 4;
/// Those of them that are seen from the first, at the start of the interval: at its end, after it, and before it.
const OTHERS: usize = NEAR - 1;
/// Ridge of the dual system, as a share of its trace: directions in which the window's snapshots differ by less than a
/// hundredth of what they do at most are not extrapolated.
const RIDGE: f32 = 1e-4;
/// Weight of a snapshot that has none.
const NONE: f32 = 1e-9;
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

/// Snapshots in local coordinates around an instant, kept as the instant moves on. Instant i lies in slot i mod 4.
#[derive(Clone, Debug)]
pub(crate) struct Manifold<T, const M: usize> {
    instants: [Option<usize>; NEAR],
    snapshots: [Snapshot<T, M>; NEAR],
    window: Window<T, M>,
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

/// The parts of the fit that do not change within an interval of the stored instants: the snapshots around it, as
/// differences from that at its start. Products are those of shapes.
#[derive(Clone, Debug)]
struct Window<T, const M: usize> {
    /// Instants for which it is the same: from the first to before the second.
    span: [T; 2],
    /// The interval, and its ends.
    interval: usize,
    ends: [T; 2],
    /// R of eq. (45).
    radius: T,
    times: [T; NEAR],
    alpha: [[T; M]; OTHERS],
    rate: [[T; M]; OTHERS],
    /// Differences of the translation.
    shifts: [T; OTHERS],
    /// Products of the differences with each other, ...
    products: [[T; OTHERS]; OTHERS],
    /// ... with the shape at the start, ...
    starts: [T; OTHERS],
    /// ... and with the difference at the end, the rate at the start, and the difference of the rate at the end.
    along: [[T; 3]; OTHERS],
    /// Square of the shape at the start.
    square: T,
    stiffness: T,
}

impl<T: Real, const M: usize> Window<T, M> {
    const NONE: Self = Self {
        span: [T::ZERO; 2],
        interval: 0,
        ends: [T::ZERO; 2],
        radius: T::ZERO,
        times: [T::ZERO; NEAR],
        alpha: [[T::ZERO; M]; OTHERS],
        rate: [[T::ZERO; M]; OTHERS],
        shifts: [T::ZERO; OTHERS],
        products: [[T::ZERO; OTHERS]; OTHERS],
        starts: [T::ZERO; OTHERS],
        along: [[T::ZERO; 3]; OTHERS],
        square: T::ZERO,
        stiffness: T::ZERO,
    };

    /// Finds the interval that holds `t`, with R = `width` times its length. Returns the instants of the snapshots,
    /// which may lie beyond the last one.
    fn find(&mut self, times: &Times<'_>, width: T, t: T) -> [usize; NEAR] {
        let last = times.count() - 1;
        self.interval = times.interval(t);
        self.ends = [times.get(self.interval), times.get(self.interval + 1)];
        self.radius = width * (self.ends[1] - self.ends[0]);
        self.span = self.ends;
        if self.interval + 1 == last {
            self.span[1] = T::from_f32(f32::INFINITY);
        }
        let first = self.interval.saturating_sub(1).min((last + 1).saturating_sub(NEAR));
        core::array::from_fn(|place| {
            let slot = (self.interval + place) % NEAR;
            first + (slot + NEAR - first % NEAR) % NEAR
        })
    }

    /// Relates the snapshots to each other; their instants are those that were found.
    #[inline(never)]
    fn relate(&mut self, snapshots: [&Snapshot<T, M>; NEAR], rank: usize) {
        let product = |a: &[T; M], b: &[T; M]| product(a, b, rank);
        let [start, others @ ..] = snapshots;
        self.square = product(&start.alpha, &start.alpha);
        let differences = self.alpha.iter_mut().zip(&mut self.rate);
        let numbers = self.shifts.iter_mut().zip(&mut self.starts);
        for (((alpha, rate), (shift, with_start)), other) in differences.zip(numbers).zip(others) {
            subtract(alpha, &other.alpha, &start.alpha);
            subtract(rate, &other.rate, &start.rate);
            (*shift, *with_start) = (alpha[0], product(alpha, &start.alpha));
        }
        let ([rise, ..], [change, ..]) = (&self.alpha, &self.rate);
        for ((alpha, products), along) in self.alpha.iter().zip(&mut self.products).zip(&mut self.along) {
            for (out, other) in products.iter_mut().zip(&self.alpha) {
                *out = product(alpha, other);
            }
            *along = [
                product(alpha, rise),
                product(alpha, &start.rate),
                product(alpha, change),
            ];
        }
        let mut stiffness = T::ZERO;
        for (i, a) in snapshots.iter().enumerate() {
            for b in snapshots.iter().skip(i + 1) {
                let [change, apart] = [apart(&a.xi, &b.xi, rank), apart(&a.alpha, &b.alpha, rank)];
                stiffness = stiffness.max(change * reciprocal(apart));
            }
        }
        self.stiffness = stiffness.sqrt();
    }

    /// At `t` on the cubic through the snapshots at both ends of the interval with their rates: the factors of the
    /// difference at its end, of the rate at its start, and of the difference of the rate.
    fn cubic(&self, t: T) -> [T; 3] {
        let [start, end] = self.ends;
        let length = end - start;
        let s = (t - start) / length;
        let rest = T::ONE - s;
        let to_end = -(s * s * rest * length);
        [
            s * s * (T::from_f32(3.0) - s - s),
            rest * rest * s * length + to_end,
            to_end,
        ]
    }
}

impl<T: Real, const M: usize> Manifold<T, M> {
    pub(crate) const EMPTY: Self = Self {
        instants: [None; NEAR],
        snapshots: [Snapshot::ZERO; NEAR],
        window: Window::NONE,
        rank: M,
    };

    /// Hands out what is no number, as [`Workspace::put`](crate::Workspace::put), from an offset on.
    pub(crate) fn put(parts: &mut impl Parts, at: usize) {
        parts.put(at + offset_of!(Self, instants), [None::<usize>; NEAR]);
    }

    /// Forgets all snapshots; those to come have so many coordinates.
    pub(crate) fn invalidate(&mut self, rank: usize) {
        self.rank = rank;
        self.instants = [None; NEAR];
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
        let [from, to] = self.window.span;
        if from <= t && t < to {
            return;
        }
        let instants = self.window.find(times, width, t);
        let last = times.count() - 1;
        for (&instant, time) in instants.iter().zip(&mut self.window.times) {
            let slot = instant % NEAR;
            if self.instants[slot] != Some(instant) {
                fetch(instant.min(last), &mut self.snapshots[slot]);
                self.instants[slot] = Some(instant);
            }
            // What is not stored has no weight.
            *time = if instant > last {
                T::from_f32(f32::INFINITY)
            } else {
                times.get(instant)
            };
        }
        let snapshots = instants.map(|instant| &self.snapshots[instant % NEAR]);
        self.window.relate(snapshots, self.rank);
    }

    /// The snapshot at the start of the interval.
    fn first(&self) -> &Snapshot<T, M> {
        &self.snapshots[self.window.interval % NEAR]
    }

    /// alpha^D at the start of the interval.
    pub(crate) fn start(&self) -> [T; M] {
        self.first().alpha
    }

    /// How fast the shape relaxes in the window: the greatest change of the velocity over that of the displacement
    /// between its snapshots.
    pub(crate) fn stiffness(&self) -> T {
        self.window.stiffness
    }

    /// d alpha / dt = Q M(alpha, t), for an Euler step of a length from there.
    ///
    /// The manifold is a line through a few snapshots that follow each other. Where these drift apart from their mean
    /// it amplifies whatever deviates from them, without bound. So the response to the deviation of the state from the
    /// learned trajectory counts only as far as the step does not enlarge the deviation: then what a step errs is added
    /// to the errors before it, and never multiplied.
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
        for (place, share) in shares.iter().enumerate() {
            let other = &self.snapshots[(self.window.interval + 1 + place) % NEAR];
            subtract(&mut difference, &other.xi, &self.first().xi);
            add_scaled(&mut xi, *share, &difference);
        }
        xi
    }

    /// The shares that the differences from the first snapshot have in M(alpha, t), for an Euler step of a length from
    /// there.
    fn shares(&self, t: T, step: T, alpha: &[T; M]) -> [T; OTHERS] {
        let window = &self.window;
        let cubic = window.cubic(t);
        let [to_rise, to_rate, to_change] = cubic;
        let (start, [rise, ..], [change, ..]) = (self.first(), &window.alpha, &window.rate);
        // Down to the translation, whose way is asked for too.
        let mut way = T::ZERO;
        let mut deviation = [T::ZERO; M];
        for k in (0..self.rank.min(M)).rev() {
            way = to_rise * rise[k] + to_rate * start.rate[k] + to_change * change[k];
            deviation[k] = alpha[k] - (start.alpha[k] + way);
        }
        let mut sides = [[T::ZERO; OTHERS]; 2];
        let [at_place, aside] = &mut sides;
        let differences = window.along.iter().zip(&window.alpha);
        for ((place, aside), (along, alpha)) in at_place.iter_mut().zip(aside).zip(differences) {
            (*place, *aside) = (dot3(along, &cubic), product(alpha, &deviation, self.rank));
        }
        let [mut shares, response] = window.fit(t, sides, [way, deviation[0]]);
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

impl<T: Real, const M: usize> Window<T, M> {
    /// The weighted least-norm first-order fit at `t`: the shares of the differences in the fitted value at a place,
    /// and in what the fit adds for a deviation. `sides` gives the products of both with the differences; `shifts` are
    /// their translations.
    ///
    /// With the products K of the scaled differences, their products k with what is asked for, and the weights W on a
    /// diagonal, the shares s of all snapshots are those of (K + ridge / W) s + mu = k with a sum of 1 at a place and
    /// of 0 for a deviation: the dual system of eq. (45), the constant not damped. The first snapshot's own difference
    /// is 0, so that its equation gives mu. Written out: optimised for size, a map over three numbers is a loop that
    /// keeps them in memory.
    fn fit(&self, t: T, [place, deviation]: [[T; OTHERS]; 2], [way, aside]: [T; 2]) -> [[T; OTHERS]; 2] {
        let weight = |time| weight((t - time).abs() / self.radius);
        let [first, p, q, r] = self.times.map(weight);
        let sum = first + total(&[p, q, r]);
        let (first, weights) = (first / sum, [p / sum, q / sum, r / sum]);

        let mean = |values: &[T; OTHERS]| dot3(values, &weights);
        let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = self.products;
        let [first_products, second_products, third_products] = &self.products;
        let middle = mean(&[mean(first_products), mean(second_products), mean(third_products)]);
        let spread = (mean(&[xx, yy, zz]) - middle).max(T::ZERO);
        let shift = mean(&self.shifts);
        let [a, b, c] = self.shifts;
        let variance = (mean(&[a * a, b * b, c * c]) - shift * shift).max(T::ZERO);
        let start = mean(&self.starts);
        let rest = T::from_f32(REST * REST) * (self.square + start + start + middle);
        let (scale, shift_scale) = (reciprocal(spread + rest), reciprocal(variance));
        let ridge = T::from_f32(RIDGE) * (scale * spread + shift_scale * variance);

        let [x, y, z] = [shift_scale * a, shift_scale * b, shift_scale * c];
        let damped = |product: T, weight: T| product + ridge / weight.max(T::from_f32(NONE));
        let solve = solve([
            [
                damped(scale * xx + x * a, weights[0]),
                scale * xy + x * b,
                scale * xz + x * c,
            ],
            [T::ZERO, damped(scale * yy + y * b, weights[1]), scale * yz + y * c],
            [T::ZERO, T::ZERO, damped(scale * zz + z * c, weights[2])],
        ]);
        let ones = solve([T::ONE; OTHERS]);
        let mu = ridge / (first + ridge * total(&ones));
        let shares = |[p, q, r]: [T; OTHERS], way: T, sum: T| {
            let mut shares = solve([scale * p + x * way, scale * q + y * way, scale * r + z * way]);
            let mu = mu * (total(&shares) - sum);
            add_scaled(&mut shares, -mu, &ones);
            shares
        };
        [shares(place, way, T::ONE), shares(deviation, aside, T::ZERO)]
    }
}

/// How to solve a symmetric positive definite system, given by its upper half: L D L^T.
fn solve<T: Real>([[a, b, c], [_, d, e], [_, _, f]]: [[T; OTHERS]; OTHERS]) -> impl Fn([T; OTHERS]) -> [T; OTHERS] {
    let a = reciprocal(a);
    let (l, m) = (a * b, a * c);
    let e = e - l * c;
    let d = reciprocal(d - l * b);
    let n = d * e;
    let f = reciprocal(f - m * c - n * e);
    move |[x, y, z]| {
        let y = y - l * x;
        let z = f * (z - m * x - n * y);
        let y = d * y - n * z;
        [a * x - l * y - m * z, y, z]
    }
}

/// 1/x, or 0 for 0.
fn reciprocal<T: Real>(x: T) -> T {
    if x > T::ZERO { T::ONE / x } else { T::ZERO }
}

fn dot3<T: Real>([a, b, c]: &[T; 3], [x, y, z]: &[T; 3]) -> T {
    *a * *x + *b * *y + *c * *z
}

fn total<T: Real>([a, b, c]: &[T; 3]) -> T {
    *a + *b + *c
}

/// out <- a - b.
fn subtract<T: Real>(out: &mut [T], a: &[T], b: &[T]) {
    for ((out, a), b) in out.iter_mut().zip(a).zip(b) {
        *out = *a - *b;
    }
}

/// Product of two states without the translation.
#[inline(never)]
fn product<T: Real, const M: usize>(a: &[T; M], b: &[T; M], rank: usize) -> T {
    dot_in_order(slice_or_empty(a, 1..rank), slice_or_empty(b, 1..rank))
}

/// Square of the distance between two states without the translation.
fn apart<T: Real, const M: usize>(a: &[T; M], b: &[T; M], rank: usize) -> T {
    let both = slice_or_empty(a, 1..rank).iter().zip(slice_or_empty(b, 1..rank));
    both.fold(T::ZERO, |sum, (a, b)| sum + (*a - *b) * (*a - *b))
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

    #[test]
    fn the_solution_of_a_system_solves_it() {
        let matrix: [[f64; 3]; 3] = [[4.0, 1.0, -2.0], [1.0, 3.0, 0.5], [-2.0, 0.5, 5.0]];
        let right = [1.0, -2.0, 3.0];
        let x = solve(matrix)(right);
        for (row, right) in matrix.iter().zip(right) {
            assert!((dot3(row, &x) - right).abs() < 1e-14);
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
            manifold.enter(&times, 2.0, t, |instant, out| *out = snapshot(instant));
            let found = manifold.velocity(t, &snapshot(instant).alpha);
            for (found, exact) in found.iter().zip(snapshot(instant).xi) {
                assert!((found - exact).abs() < 1e-3, "{found} {exact}");
            }
        }
    }
}
