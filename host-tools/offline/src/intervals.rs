//! The error of the interpolation in time between the instants of other people's data.
//!
//! No snapshot says it. But a model of every other instant can be asked for those that were left out of it, and so can
//! models of every fourth and every eighth: from one to the next the errors fall, and so they will to the whole model
//! (Richardson). By how much is taken from all samples together, interval by interval, and the less of the last two
//! falls counts (one alone may be chance): 16 where the motion is smooth, about 2 at a kink, and 1 where it is faster
//! than the instants.

use capsule_core::Method;

use crate::OfflineError;
use crate::assembled::Assembled;
use crate::plan::Plan;

/// The most by which an error falls when the interval is halved: the splines are of fourth order.
const MAX_FALL: f64 = 16.0;

/// Errors of a model of every so many instants at those that it does not know.
struct Coarse {
    /// In the middle of each interval, a row for each sample.
    middle: Vec<Vec<f64>>,
    /// The greatest error within an interval over that in its middle, both by the profile 4 s (1 - s); at least 1.
    peak: Vec<f64>,
}

impl Coarse {
    /// `errors` are those at the instants within each interval, equally many in all, one after the other; a row for
    /// each sample.
    fn new(errors: &[Vec<f64>], within: usize) -> Self {
        let intervals = errors[0].len() / within;
        let sum = |interval: usize, place: usize| errors.iter().map(|row| row[interval * within + place]).sum::<f64>();
        let peak = |interval: usize| {
            let by_profile = |place: usize| {
                let share = (place + 1) as f64 / (within + 1) as f64;
                sum(interval, place) / (4.0 * share * (1.0 - share))
            };
            let greatest = (0..within).map(by_profile).fold(0.0, f64::max);
            let middle = by_profile(within / 2);
            if middle > 0.0 { greatest / middle } else { 1.0 }
        };
        let middles = |row: &Vec<f64>| row.chunks_exact(within).map(|errors| errors[within / 2]).collect();
        Coarse {
            middle: errors.iter().map(middles).collect(),
            peak: (0..intervals).map(peak).collect(),
        }
    }

    /// Errors of a model at the instants that it leaves out, beyond its errors at those that it knows.
    fn of(model: &Assembled, cluster: usize, floor: f64) -> Result<Self, OfflineError> {
        let errors = model
            .own_errors(cluster, Method::Direct, |sample| &sample.held_out)?
            .into_iter();
        let above_floor = |row: Vec<f64>| row.into_iter().map(|error| (error - floor).max(0.0)).collect();
        let errors: Vec<Vec<f64>> = errors.map(above_floor).collect();
        Ok(Coarse::new(&errors, model.plan.stride - 1))
    }

    /// The interval that holds one of a model with intervals shorter by a factor, or the last.
    fn around(&self, interval: usize, factor: usize) -> usize {
        (interval / factor).min(self.peak.len() - 1)
    }

    /// The sum over the samples.
    fn sum(&self, interval: usize) -> f64 {
        self.middle.iter().map(|row| row[interval]).sum()
    }
}

/// Errors `[N_c][N_t - 1]` of a cluster in the middle of each interval of the instants, as a fraction of the radius.
///
/// `coarser` are models of every 2nd, 4th and 8th of its instants, as far as there are enough of them.
pub(crate) fn interval_errors(
    plan: &Plan,
    cluster: usize,
    floor: f64,
    coarser: [Option<&Assembled>; 3],
) -> Result<Vec<Vec<f64>>, OfflineError> {
    let coarse = |model: Option<&Assembled>| model.map(|model| Coarse::of(model, cluster, floor)).transpose();
    let [two, four, eight] = coarser;
    match coarse(two)? {
        Some(two) => Ok(refined(plan.times().len() - 1, &two, [coarse(four)?, coarse(eight)?])),
        None => plan.quarter_steps(cluster),
    }
}

/// Errors in the middle of so many intervals, from those of coarser models.
fn refined(intervals: usize, two: &Coarse, [four, eight]: [Option<Coarse>; 2]) -> Vec<Vec<f64>> {
    let fall = |before: f64, after: f64| {
        if before > after {
            (before / after).min(MAX_FALL)
        } else {
            1.0
        }
    };
    // Factor by which the error in the middle of an interval of the model of every other instant is multiplied.
    let factor = |interval: usize| {
        let Some(four) = &four else { return 1.0 };
        let wide = four.around(interval, 2);
        let Some(eight) = &eight else { return four.peak[wide] };
        let last = fall(four.sum(wide), two.sum(interval));
        let before = fall(eight.sum(eight.around(interval, 4)), four.sum(wide));
        four.peak[wide] / last.min(before)
    };
    // The middle of an interval may be where an error happens to change its sign: no sample errs by less than the mean
    // of all.
    let error = |row: &Vec<f64>, interval: usize| {
        let wide = two.around(interval, 2);
        let mean = two.sum(wide) / two.middle.len() as f64;
        row[wide].max(mean) * factor(wide)
    };
    let errors = |row| (0..intervals).map(|interval| error(row, interval)).collect();
    two.middle.iter().map(errors).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The cubic through the values and rates of a function at two ends, in their middle.
    fn middle(f: impl Fn(f64) -> [f64; 2], start: f64, end: f64) -> f64 {
        let ([a, u], [b, v]) = (f(start), f(end));
        (a + b) / 2.0 + (end - start) * (u - v) / 8.0
    }

    /// Errors of the cubics at intervals of a length, in their middles.
    fn errors(f: impl Fn(f64) -> [f64; 2] + Copy, end: f64, length: f64) -> Vec<f64> {
        let count = (end / length).round() as usize;
        let error = |i: usize| {
            let start = i as f64 * length;
            (middle(f, start, start + length) - f(start + length / 2.0)[0]).abs()
        };
        (0..count).map(error).collect()
    }

    #[test]
    fn the_error_of_cubics_is_found_from_those_of_coarser_ones() {
        let smooth = |t: f64| [(1.3 * t).sin(), 1.3 * (1.3 * t).cos()];
        let stiff = |t: f64| [(-4.0 * t).exp(), -4.0 * (-4.0 * t).exp()];
        let kinked = |t: f64| [(t - 1.33).abs(), (t - 1.33).signum()];
        for (name, f, within) in [
            ("smooth", &smooth as &dyn Fn(f64) -> [f64; 2], 1.5),
            ("stiff", &stiff, 4.0),
            ("kinked", &kinked, 4.0),
        ] {
            let [one, two, four, eight] = [0.1, 0.2, 0.4, 0.8].map(|length| errors(f, 3.2, length));
            let coarse = |errors: Vec<f64>| Coarse::new(&[errors], 1);
            let found = &refined(one.len(), &coarse(two), [four, eight].map(coarse).map(Some))[0];
            let [found, exact] = [found, &one].map(|errors| errors.iter().fold(0.0, |m: f64, e| m.max(*e)));
            assert!(
                found > exact / within && found < within * exact,
                "{name}: {found:e}, {exact:e}"
            );
        }
    }
}
