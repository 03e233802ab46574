//! The snapshots around an instant and the fit through them (eqs. 44 to 46).
//!
//! A first-order fit on the few snapshots near t has fewer snapshots than unknowns, so the normal equations of eq. (45)
//! are singular. The least-norm solution is taken instead, from the dual system of the snapshots, with the regressors
//! scaled by the spread of the window's snapshots and an undamped constant: in raw monomials the constant competes with
//! the translation, and the solution drifts. The translation has a scale of its own. The shape's coordinates share one,
//! because they are orthonormal: with a scale each, the smallest modes, which hardly move, would dominate and the state
//! would diverge. A floor of the shape's scale keeps a window in which the shape is at rest from amplifying a
//! deviation.

use super::snapshot::Snapshot;
use super::times::Times;
use crate::Real;
use crate::interpolate::weight;
use crate::linalg::ldl::{self, reciprocal};
use crate::linalg::{add_scaled, dot_in_order, slice_or_empty};

/// Snapshots of a window: two on each side of an instant. The paper's R, twice their interval, holds no more where they
/// are equidistant.
pub(super) const NEAR: usize = 4;
/// Snapshots other than the one at the start of the interval: the one at its end, the one after it, the one before it.
pub(super) const OTHERS: usize = NEAR - 1;
/// Ridge of the dual system, as a share of its trace: directions in which the window's snapshots differ by less than a
/// hundredth of their greatest difference are not extrapolated.
const RIDGE: f32 = 1e-4;
/// Least weight of a snapshot, which keeps ridge / weight finite.
const MIN_WEIGHT: f32 = 1e-9;
/// Least spread of the shape that counts as motion, as a share of the shape's displacement.
const MIN_SPREAD: f32 = 1e-2;

/// The quantities of the fit that are constant within an interval of the stored instants: the snapshots around it, as
/// differences from the one at its start. Scalar products leave out the translation.
#[derive(Clone, Debug)]
pub(super) struct Window<T, const M: usize> {
    /// The half-open range of instants for which the window holds.
    pub(super) span: [T; 2],
    /// Index of the interval, and its ends.
    pub(super) interval: usize,
    ends: [T; 2],
    /// R of eq. (45).
    radius: T,
    pub(super) times: [T; NEAR],
    /// Differences of alpha and of the rate Q xi.
    pub(super) alpha: [[T; M]; OTHERS],
    pub(super) rate: [[T; M]; OTHERS],
    /// Differences of the translation.
    shifts: [T; OTHERS],
    /// Scalar products of the differences with each other, ...
    products: [[T; OTHERS]; OTHERS],
    /// ... with the shape at the start, ...
    starts: [T; OTHERS],
    /// ... and with the difference at the end, the rate at the start, and the difference of the rate at the end.
    pub(super) along: [[T; 3]; OTHERS],
    /// Squared norm of the shape at the start.
    square: T,
    pub(super) stiffness: T,
}

impl<T: Real, const M: usize> Window<T, M> {
    pub(super) const EMPTY: Self = Self {
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

    /// Finds the interval that holds `t`, with R = `width` times its length. Returns the indices of the window's
    /// instants, which may lie beyond the last stored one.
    pub(super) fn locate(&mut self, times: &Times<'_>, width: T, t: T) -> [usize; NEAR] {
        let last = times.count() - 1;
        self.interval = times.interval(t);
        self.ends = [times.get(self.interval), times.get(self.interval + 1)];
        self.radius = width * (self.ends[1] - self.ends[0]);
        self.span = self.ends;
        if self.interval + 1 == last {
            self.span[1] = T::from_f32(f32::INFINITY);
        }
        let first = self.interval.saturating_sub(1).min((last + 1).saturating_sub(NEAR));
        core::array::from_fn(|i| {
            let slot = (self.interval + i) % NEAR;
            first + (slot + NEAR - first % NEAR) % NEAR
        })
    }

    /// Computes the differences of the snapshots at the instants of [`locate`](Self::locate), and their products.
    #[inline(never)]
    pub(super) fn set_snapshots(&mut self, snapshots: [&Snapshot<T, M>; NEAR], rank: usize) {
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
                let (change, distance) = (
                    squared_distance(&a.xi, &b.xi, rank),
                    squared_distance(&a.alpha, &b.alpha, rank),
                );
                stiffness = stiffness.max(change * reciprocal(distance));
            }
        }
        self.stiffness = stiffness.sqrt();
    }

    /// The cubic Hermite polynomial through both ends of the interval, at `t`: factors of the difference at the end, of
    /// the rate at the start, and of the difference of the rate.
    pub(super) fn cubic(&self, t: T) -> [T; 3] {
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

    /// The weighted least-norm first-order fit at `t`: the shares of the differences in the fitted value at a state,
    /// and in the response to a deviation from it. `products` are the scalar products of both with the differences,
    /// `shifts` their translations.
    ///
    /// Let K be the products of the scaled differences, k their products with the state, and W the diagonal of weights.
    /// The shares s of all snapshots solve the dual system of eq. (45), (K + ridge W^-1) s + mu = k, with the sum 1 for
    /// a state and 0 for a deviation; the constant is not damped. The first snapshot's own difference is 0, so that its
    /// equation gives mu. Written out for the same reason as [`ldl`].
    pub(super) fn fit(
        &self,
        t: T,
        [state, deviation]: [[T; OTHERS]; 2],
        [state_shift, deviation_shift]: [T; 2],
    ) -> [[T; OTHERS]; 2] {
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
        let floor = T::from_f32(MIN_SPREAD * MIN_SPREAD) * (self.square + start + start + middle);
        let (scale, shift_scale) = (reciprocal(spread + floor), reciprocal(variance));
        let ridge = T::from_f32(RIDGE) * (scale * spread + shift_scale * variance);

        let [x, y, z] = [shift_scale * a, shift_scale * b, shift_scale * c];
        let damped = |product: T, weight: T| product + ridge / weight.max(T::from_f32(MIN_WEIGHT));
        let solve = ldl::factor([
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
        let shares = |[p, q, r]: [T; OTHERS], shift: T, sum: T| {
            let mut shares = solve([scale * p + x * shift, scale * q + y * shift, scale * r + z * shift]);
            let mu = mu * (total(&shares) - sum);
            add_scaled(&mut shares, -mu, &ones);
            shares
        };
        [
            shares(state, state_shift, T::ONE),
            shares(deviation, deviation_shift, T::ZERO),
        ]
    }
}

/// Scalar product of two vectors of three.
pub(super) fn dot3<T: Real>([a, b, c]: &[T; 3], [x, y, z]: &[T; 3]) -> T {
    *a * *x + *b * *y + *c * *z
}

fn total<T: Real>([a, b, c]: &[T; 3]) -> T {
    *a + *b + *c
}

/// out <- a - b.
pub(super) fn subtract<T: Real>(out: &mut [T], a: &[T], b: &[T]) {
    for ((out, a), b) in out.iter_mut().zip(a).zip(b) {
        *out = *a - *b;
    }
}

/// Scalar product of two states without the translation.
#[inline(never)]
pub(super) fn product<T: Real, const M: usize>(a: &[T; M], b: &[T; M], rank: usize) -> T {
    dot_in_order(slice_or_empty(a, 1..rank), slice_or_empty(b, 1..rank))
}

/// Squared distance of two states without the translation.
fn squared_distance<T: Real, const M: usize>(a: &[T; M], b: &[T; M], rank: usize) -> T {
    let both = slice_or_empty(a, 1..rank).iter().zip(slice_or_empty(b, 1..rank));
    both.fold(T::ZERO, |sum, (a, b)| sum + (*a - *b) * (*a - *b))
}
