//! Expected error of an answer: the standard deviation of the interpolation at the query, calibrated by the
//! leave-one-out errors of the neighbouring samples and their deviations.

use crate::Real;
use crate::interpolate::Weights;
use crate::model::MatrixView;
use crate::model::wire::{Cluster, Errors};

/// floor + deviation * mean over the samples j, weighted by |L_j|, of (leave-one-out error_j(t) / deviation_j), as a
/// fraction of a. The errors are linear in time between their instants and constant beyond.
pub(crate) fn expected_error<T: Real, const N: usize>(
    errors: &Errors<'_>,
    instants: &MatrixView<'_>,
    weights: &Weights<T, N>,
    t: T,
) -> T {
    let (left_out, deviations) = (MatrixView::new(&errors.left_out), MatrixView::new(&errors.deviation));
    let between = Interval::new(instants, t);
    let ratio =
        |sample: usize| between.value(|instant| left_out.get(sample, instant)) / T::from_f32(deviations.get(sample, 0));
    let sum = weights
        .iter()
        .map(|(sample, weight)| weight.abs() * ratio(sample))
        .sum::<T>();
    T::from_f64(errors.floor) + weights.deviation() * sum / weights.lebesgue()
}

/// Additional error of an extrapolation, a guess: a share of the change of the solution over the distance to the
/// nearest sample, times sum |L_j| - 1. Between samples sum |L_j| is little more than 1; outside it grows with the
/// square of the distance. The leave-one-out errors do not show this error, because along dense rows a sample left out
/// is interpolated.
pub(crate) fn extrapolation_error<T: Real, const N: usize>(
    errors: &Errors<'_>,
    instants: &MatrixView<'_>,
    weights: &Weights<T, N>,
    t: T,
) -> T {
    /// Upper end of the range measured at seven configurations around the domain of the shipped model, 0.01 to 0.05.
    const SHARE: f32 = 0.05;
    let changes = MatrixView::new(&errors.changes);
    let change = Interval::new(instants, t).value(|instant| changes.get(instant, 0));
    T::from_f32(SHARE) * (weights.lebesgue() - T::ONE).max(T::ZERO) * change * weights.nearest()
}

/// Error of the interpolation in time between two stored instants, expected and its bound: the mean of the samples'
/// errors in the middle of the interval, weighted by |L_j|, times 4 s (1 - s) with the share s of the interval that has
/// passed. 0 for a model without these errors.
pub(crate) fn interval_error<T: Real, const N: usize>(
    cluster: &Cluster<'_>,
    instants: &MatrixView<'_>,
    weights: &Weights<T, N>,
    t: T,
) -> [T; 2] {
    if cluster.interval_errors.rows == 0 {
        return [T::ZERO; 2];
    }
    let Interval { lower, share, .. } = Interval::new(instants, t);
    let errors = MatrixView::new(&cluster.interval_errors);
    let factor = T::from_f32(MatrixView::new(&cluster.interval_bound_factors).get(lower, 0));
    let middle = weights
        .iter()
        .map(|(sample, weight)| weight.abs() * T::from_f32(errors.get(sample, lower)))
        .sum::<T>();
    let expected = T::from_f32(4.0) * share * (T::ONE - share) * middle / weights.lebesgue();
    [expected, factor * expected]
}

/// Bound that 95 % of the errors stay below, as a multiple of the expected error.
pub(crate) fn bound_factor<T: Real>(errors: &Errors<'_>, instants: &MatrixView<'_>, t: T) -> T {
    let factors = MatrixView::new(&errors.bound_factors);
    Interval::new(instants, t).value(|instant| factors.get(instant, 0))
}

/// Linear interpolation in time: two instants, and the share of the interval between them that has passed.
struct Interval<T> {
    lower: usize,
    upper: usize,
    share: T,
}

impl<T: Real> Interval<T> {
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
