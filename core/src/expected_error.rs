//! Expected error of an answer, without the truth: how uncertain the interpolation is at the query, in units of how
//! much the neighbours' own predictions erred for theirs.

use crate::Real;
use crate::interpolate::Weights;
use crate::model::MatrixView;
use crate::model::wire::{Cluster, Errors};

/// floor + deviation * mean over the neighbours j, weighted by |L_j|, of (left-out error_j(t) / deviation_j), with the
/// errors linear in time between their instants and constant beyond. A fraction of a.
pub(crate) fn expected_error<T: Real, const N: usize>(
    errors: &Errors<'_>,
    instants: &MatrixView<'_>,
    weights: &Weights<T, N>,
    t: T,
) -> T {
    let (left_out, deviations) = (MatrixView::new(&errors.left_out), MatrixView::new(&errors.deviation));
    let between = Between::new(instants, t);
    let ratio =
        |sample: usize| between.value(|instant| left_out.get(sample, instant)) / T::from_f32(deviations.get(sample, 0));
    let sum = weights
        .iter()
        .map(|(sample, weight)| weight.abs() * ratio(sample))
        .sum::<T>();
    T::from_f64(errors.floor) + weights.deviation() * sum / weights.lebesgue()
}

/// Guess of the error of an extrapolation beyond that: a share of the change of the solution over the distance to
/// the nearest sample, which grows with the weights. Between samples sum |L_j| is little more than 1, outside of them
/// it grows with the square of the distance. That the leave-one-out errors ask along dense rows makes them blind to it.
pub(crate) fn extrapolation_error<T: Real, const N: usize>(
    errors: &Errors<'_>,
    instants: &MatrixView<'_>,
    weights: &Weights<T, N>,
    t: T,
) -> T {
    /// At seven configurations around the domain of the shipped model 0.01 to 0.05 would have been right.
    const SHARE: f32 = 0.05;
    let changes = MatrixView::new(&errors.changes);
    let change = Between::new(instants, t).value(|instant| changes.get(instant, 0));
    T::from_f32(SHARE) * (weights.lebesgue() - T::ONE).max(T::ZERO) * change * weights.nearest()
}

/// Error of the interpolation in time between two stored instants, expected and its bound: the errors in the middle of
/// the interval, weighted by |L_j|, times 4 s (1 - s) with s the way from one instant to the other. 0 where none are
/// stored.
pub(crate) fn interval_error<T: Real, const N: usize>(
    cluster: &Cluster<'_>,
    instants: &MatrixView<'_>,
    weights: &Weights<T, N>,
    t: T,
) -> [T; 2] {
    if cluster.interval_errors.rows == 0 {
        return [T::ZERO; 2];
    }
    let Between { lower, share, .. } = Between::new(instants, t);
    let errors = MatrixView::new(&cluster.interval_errors);
    let factor = T::from_f32(MatrixView::new(&cluster.interval_bound_factors).get(lower, 0));
    let middle = weights
        .iter()
        .map(|(sample, weight)| weight.abs() * T::from_f32(errors.get(sample, lower)))
        .sum::<T>();
    let expected = T::from_f32(4.0) * share * (T::ONE - share) * middle / weights.lebesgue();
    [expected, factor * expected]
}

/// The bound that 95 % of the errors stay below, as a multiple of the expected error.
pub(crate) fn bound_factor<T: Real>(errors: &Errors<'_>, instants: &MatrixView<'_>, t: T) -> T {
    let factors = MatrixView::new(&errors.bound_factors);
    Between::new(instants, t).value(|instant| factors.get(instant, 0))
}

/// Two instants of the errors and a place between them.
struct Between<T> {
    lower: usize,
    upper: usize,
    share: T,
}

impl<T: Real> Between<T> {
    fn new(instants: &MatrixView<'_>, t: T) -> Self {
        let instant = |i| T::from_f32(instants.get(i, 0));
        let last = instants.rows().saturating_sub(1);
        let upper = (0..last).find(|&i| instant(i) >= t).unwrap_or(last);
        let lower = upper.saturating_sub(1);
        let share = if lower == upper {
            T::ZERO
        } else {
            ((t - instant(lower)) / (instant(upper) - instant(lower))).min(T::ONE)
        };
        Self { lower, upper, share }
    }

    fn value(&self, at: impl Fn(usize) -> f32) -> T {
        let (before, after) = (T::from_f32(at(self.lower)), T::from_f32(at(self.upper)));
        before + self.share * (after - before)
    }
}
