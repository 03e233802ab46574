//! What the interpolation in time leaves between the instants of other people's data.
//!
//! No snapshot says it. But a model of every other instant can be asked for those that were left out, and one of every fourth
//! for half of these: from the one to the other the error falls as it does from the first to the whole model (Richardson). By
//! how much is taken from all samples together, interval by interval: 16 where the motion is smooth, 2 at a kink, and
//! never less than 1.

use capsule_core::model::wire::Method;

use crate::OfflineError;
use crate::plan::{Assembled, Plan};

/// The most by which an error falls when the interval is halved: the splines are of fourth order.
const MOST_FALL: f64 = 16.0;

/// Errors `[N_c][N_t - 1]` of a cluster in the middle of each interval of the instants, as a fraction of the radius.
///
/// `two` and `four` are models of every other and every fourth instant, as far as there are enough of them.
pub(crate) fn interval_errors(
    plan: &Plan,
    cluster: usize,
    floor: f64,
    [two, four]: [Option<&Assembled>; 2],
) -> Result<Vec<Vec<f64>>, OfflineError> {
    let above_floor = |model: &Assembled| -> Result<Vec<Vec<f64>>, OfflineError> {
        let errors = model.own_errors(cluster, Method::Direct, |sample| &sample.held_out)?.into_iter();
        Ok(errors
            .map(|row| row.into_iter().map(|error| (error - floor).max(0.0)).collect())
            .collect())
    };
    let intervals = plan.times().len() - 1;
    let Some(two) = two else {
        return plan.quarter_steps(cluster);
    };
    let two = above_floor(two)?;
    let four = four.map(above_floor).transpose()?;
    Ok(refined(intervals, &two, four.as_deref()))
}

/// Errors in the middle of the intervals, from those of models of every other instant `two` (in the middle of its first
/// interval, its second, ...) and of every fourth `four`; a row for each sample.
fn refined(intervals: usize, two: &[Vec<f64>], four: Option<&[Vec<f64>]>) -> Vec<Vec<f64>> {
    let sum = |errors: &[Vec<f64>], place: usize| errors.iter().map(|row| row[place.min(row.len() - 1)]).sum::<f64>();
    let fall = |place: usize| {
        let [before, after] = [four.map_or(0.0, |four| sum(four, place / 2)), sum(two, place)];
        if before > after { (before / after).min(MOST_FALL) } else { 1.0 }
    };
    let error = |row: &Vec<f64>, interval: usize| {
        let place = (interval / 2).min(row.len() - 1);
        row[place] / fall(place)
    };
    let errors = |row| (0..intervals).map(|interval| error(row, interval)).collect();
    two.iter().map(errors).collect()
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
            let [one, two, four] = [0.1, 0.2, 0.4].map(|length| errors(f, 3.2, length));
            let found = &refined(one.len(), &[two], Some(&[four]))[0];
            let [found, exact] = [found, &one].map(|errors| errors.iter().fold(0.0, |m: f64, e| m.max(*e)));
            assert!(found > exact / within && found < within * exact, "{name}: {found:e}, {exact:e}");
        }
    }
}
