//! The steady limit: the greatest capillary number with a steady shape, as a function of the confinement.

use capsule_database::Entry;
use serde::Serialize;

use crate::tolerances::SAME_ROW;

/// Distance in a/l of the points of the curve that a model carries.
const SPACING: f64 = 0.01;

/// The greatest distance in Ca of a steady and an unsteady sample that tell the limit between.
const BRACKET: f64 = 0.012;

/// Bracket of the steady limit at one confinement.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SteadyLimit {
    /// a/l
    pub confinement: f64,
    /// The greatest capillary number with a steady shape, or known to lie below the limit as it lies below that of a
    /// larger capsule.
    pub largest_steady_ca: Option<f64>,
    /// The least capillary number beyond it without one.
    pub smallest_unsteady_ca: Option<f64>,
    /// The middle of both, if they are close enough to tell it.
    pub limit: Option<f64>,
}

/// The bracket of the steady limit in each row of a database, by rising confinement.
#[must_use]
pub fn steady_limits(entries: &[Entry]) -> Vec<SteadyLimit> {
    let mut rows: Vec<f64> = entries.iter().map(|e| e.parameters[1]).collect();
    rows.sort_by(f64::total_cmp);
    rows.dedup_by(|a, b| (*a - *b).abs() <= SAME_ROW);
    // The limit falls with a/l: what has not settled although a larger capsule does at no smaller Ca only takes long.
    let below_limit = |entry: &Entry| {
        let settles =
            |e: &&Entry| e.status.is_steady() && e.parameters.iter().zip(&entry.parameters).all(|(a, b)| a >= b);
        entries.iter().any(|e| settles(&e))
    };
    let bracket = |confinement: f64| {
        let of_row = |below: bool| {
            let row = entries
                .iter()
                .filter(move |e| (e.parameters[1] - confinement).abs() <= SAME_ROW && below_limit(e) == below);
            row.map(|e| e.parameters[0])
        };
        let largest_steady_ca = of_row(true).max_by(f64::total_cmp);
        let smallest_unsteady_ca = of_row(false)
            .filter(|ca| largest_steady_ca.is_none_or(|steady| *ca > steady))
            .min_by(f64::total_cmp);
        let limit = match (largest_steady_ca, smallest_unsteady_ca) {
            (Some(low), Some(high)) if high - low <= BRACKET => Some(0.5 * (low + high)),
            _ => None,
        };
        SteadyLimit {
            confinement,
            largest_steady_ca,
            smallest_unsteady_ca,
            limit,
        }
    };
    rows.into_iter().map(bracket).collect()
}

/// The limits that are known, and steady samples above the line through them, which the limit exceeds.
fn points(brackets: &[SteadyLimit]) -> Vec<[f64; 2]> {
    let known = brackets.iter().filter_map(|b| Some([b.confinement, b.limit?]));
    let mut points: Vec<[f64; 2]> = known.collect();
    for row in brackets.iter().filter(|row| row.limit.is_none()) {
        let after = points.partition_point(|point| point[0] < row.confinement);
        let line = match (after.checked_sub(1).and_then(|i| points.get(i)), points.get(after)) {
            (Some([x0, y0]), Some([x1, y1])) => y0 + (y1 - y0) * (row.confinement - x0) / (x1 - x0),
            (Some([_, y]), None) | (None, Some([_, y])) => *y,
            (None, None) => 0.0,
        };
        if let Some(steady) = row.largest_steady_ca.filter(|ca| *ca > line) {
            points.insert(after, [row.confinement, steady]);
        }
    }
    points
}

/// The curve (a/l, Ca_lim) through the brackets, by the piecewise cubic of Fritsch and Carlson (SIAM J. Numer. Anal.
/// 17, 1980), which rises and falls where the data do; in steps that are short enough to be joined by lines.
pub(crate) fn curve(brackets: &[SteadyLimit]) -> Vec<[f64; 2]> {
    let points = points(brackets);
    let Some(last) = points.len().checked_sub(1) else {
        return Vec::new();
    };
    let width = |i: usize| points[i + 1][0] - points[i][0];
    let slope = |i: usize| (points[i + 1][1] - points[i][1]) / width(i);
    let tangent = |i: usize| {
        if i == 0 || i == last {
            // The parabola through three points, unless it turns within the interval.
            let (end, next) = if i == 0 {
                (0, 1)
            } else {
                (last - 1, last.saturating_sub(2))
            };
            if last < 2 {
                return slope(0);
            }
            let (near, far) = (width(end), width(next));
            let tangent = slope(end) + near * (slope(end) - slope(next)) / (near + far);
            return if tangent * slope(end) > 0.0 { tangent } else { 0.0 };
        }
        let (before, after) = (slope(i - 1), slope(i));
        if before * after <= 0.0 {
            return 0.0;
        }
        let (w1, w2) = (2.0 * width(i) + width(i - 1), width(i) + 2.0 * width(i - 1));
        (w1 + w2) / (w1 / before + w2 / after)
    };
    let mut curve = Vec::new();
    for i in 0..last {
        let (h, [x0, y0], [_, y1]) = (width(i), points[i], points[i + 1]);
        let (d0, d1) = (tangent(i), tangent(i + 1));
        let count = (h / SPACING - 1e-6).ceil().max(1.0);
        for k in 0..count as usize {
            let s = k as f64 / count;
            let (rest, square) = (1.0 - s, s * s);
            let value = y0 * (1.0 + 2.0 * s) * rest * rest + y1 * square * (3.0 - 2.0 * s);
            curve.push([x0 + s * h, value + h * s * rest * (d0 * rest - d1 * s)]);
        }
    }
    curve.push(points[last]);
    curve
}

#[cfg(test)]
mod tests {
    use super::*;
    use capsule_database::Status;

    fn entry(ca: f64, confinement: f64, status: Status) -> Entry {
        Entry {
            parameters: vec![ca, confinement],
            status,
            snapshots: 1,
            file: String::new(),
        }
    }

    #[test]
    fn each_row_is_bracketed_by_what_is_known() {
        let steady = Status::Steady { time: 5.0 };
        let stopped = Status::Stopped {
            time: 1.0,
            reason: "thin film".to_owned(),
        };
        let entries = [
            entry(0.005, 0.9, stopped),
            entry(0.12, 0.9, steady.clone()),
            entry(0.124, 0.9, Status::Unsteady),
            entry(0.13, 0.9, Status::Unsteady),
            entry(0.13, 0.8, steady.clone()),
            entry(0.12, 0.95, steady.clone()),
            // Not settled, but below the limit of larger capsules.
            entry(0.05, 0.75, steady.clone()),
            entry(0.055, 0.75, Status::Unsteady),
            entry(0.06, 0.98, steady.clone()),
            entry(0.1, 0.98, Status::Unsteady),
            entry(0.09, 1.0, steady),
            entry(0.1, 1.0, Status::Unsteady),
            entry(0.1, 1.1, Status::Unsteady),
        ];
        let rows = steady_limits(&entries);
        let limits: Vec<_> = rows.iter().map(|r| r.limit).collect();
        // Too wide a bracket tells nothing.
        assert_eq!(limits, [None, None, Some(0.122), None, None, Some(0.095), None]);
        assert_eq!(
            (rows[0].largest_steady_ca, rows[0].smallest_unsteady_ca),
            (Some(0.055), None)
        );
        assert_eq!(rows[2].smallest_unsteady_ca, Some(0.124));
        assert_eq!(rows[3].smallest_unsteady_ca, None);
        // Steady samples above the line through the limits raise it, those below do not.
        assert_eq!(points(&rows), [[0.8, 0.13], [0.9, 0.122], [0.95, 0.12], [1.0, 0.095]]);
        let curve = curve(&rows);
        assert_eq!((curve[0], curve[curve.len() - 1]), ([0.8, 0.13], [1.0, 0.095]));
    }

    #[test]
    fn the_curve_is_smooth_between_its_points_and_does_not_overshoot() {
        let exact = |a: f64| 0.3 * (-(a - 0.7) * 2.5).exp();
        let rows: Vec<SteadyLimit> = (0..12)
            .map(|i| {
                let confinement = 0.7 + 0.05 * f64::from(i);
                SteadyLimit {
                    confinement,
                    largest_steady_ca: None,
                    smallest_unsteady_ca: None,
                    limit: Some(exact(confinement)),
                }
            })
            .collect();
        let curve = curve(&rows);
        assert_eq!(curve.len(), 56);
        for [a, ca] in &curve {
            assert!((ca - exact(*a)).abs() < 1e-4, "{a} {ca}");
        }
        assert!(curve.windows(2).all(|w| w[1][1] < w[0][1] && w[1][0] > w[0][0]));
    }
}
