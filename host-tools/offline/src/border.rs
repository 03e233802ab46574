//! Where the solution jumps: at small Ca the rear of the membrane is smooth, and beyond a threshold it buckles into a dent.
//!
//! At small confinements the dent comes at once with a finite depth, and shape and velocity jump with it; at larger ones it
//! grows from nothing and there is no border.

use serde::Serialize;

use crate::samples::{Dent, SAME_ROW, Sample};

/// Least depth of a dent, over a.
const DENT: f64 = 0.01;
/// Least depth with which a dent starts where it counts as a jump, over a.
const JUMP: f64 = 0.05;

/// A dent that starts later than this is late (l/V); most start at 2 to 3.
const LATE: f64 = 5.0;

/// A jump between samples whose Ca differ by more than this factor is known roughly.
const ROUGH: f64 = 1.25;
/// The factor in Ca that samples keep from a line that passes between them.
const CLEAR: f64 = 1.02;

/// A jump in a row of confinements.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Jump {
    /// a/l
    pub confinement: f64,
    /// The greatest capillary number below all dents.
    pub largest_smooth_ca: f64,
    /// The least capillary number with a dent.
    pub smallest_dented_ca: f64,
}

impl Jump {
    fn middle(&self) -> f64 {
        (self.largest_smooth_ca * self.smallest_dented_ca).sqrt()
    }

    /// How roughly it is known.
    fn width(&self) -> f64 {
        self.smallest_dented_ca / self.largest_smooth_ca
    }
}

/// Whether a dent is late. Just beyond the jump the smooth shape is almost steady: it lasts, the longer the nearer, and then
/// buckles at once. At some instants such a configuration lies on the one side of the border and at others on the other, and
/// no neighbour of it on either side is like it.
pub(crate) fn is_late(dent: Dent) -> bool {
    dent.depth > JUMP && dent.start > LATE
}

/// The jumps of all rows, by rising confinement: where the depth of the dent, drawn back from its first two samples in a line to
/// the last sample without one, is still finite.
pub(crate) fn jumps(samples: &[Sample]) -> Vec<Jump> {
    let mut points: Vec<[f64; 3]> = samples
        .iter()
        .filter(|s| s.steady)
        .map(|s| [s.parameters[1], s.parameters[0], s.dent.depth])
        .collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points
        .chunk_by(|a, b| (a[0] - b[0]).abs() <= SAME_ROW)
        .filter_map(jump)
        .collect()
}

/// The jump of a row (a/l, Ca, depth) by rising Ca.
fn jump(row: &[[f64; 3]]) -> Option<Jump> {
    let first = row.iter().position(|point| point[2] >= DENT)?;
    let [confinement, smooth, _] = *row.get(first.checked_sub(1)?)?;
    let [_, dented, depth] = row[first];
    let slope = row
        .get(first + 1)
        .map_or(0.0, |next| (next[2] - depth) / (next[1] - dented));
    (depth - slope * (dented - smooth) > JUMP).then_some(Jump {
        confinement,
        largest_smooth_ca: smooth,
        smallest_dented_ca: dented,
    })
}

/// The border (a/l, Ca): a line through the middles of the jumps that has all samples on their sides. A jump that is known
/// only roughly makes no point of it where the line between its neighbours passes between its two samples anyway. The line
/// is drawn on at both ends to half the way to the next of the `rows`, where there is one.
pub(crate) fn border(jumps: &[Jump], rows: &[f64]) -> Vec<[f64; 2]> {
    let mut by_width: Vec<&Jump> = jumps.iter().collect();
    by_width.sort_by(|a, b| b.width().total_cmp(&a.width()));
    let mut border: Vec<[f64; 2]> = jumps.iter().map(|jump| [jump.confinement, jump.middle()]).collect();
    for jump in by_width.into_iter().take_while(|jump| jump.width() > ROUGH) {
        let place = border
            .iter()
            .position(|[confinement, _]| *confinement == jump.confinement);
        let Some([[x0, y0], _, [x1, y1]]) = place.and_then(|i| border.get(i.checked_sub(1)?..i + 2)) else {
            continue;
        };
        let line = y0 + (y1 - y0) * (jump.confinement - x0) / (x1 - x0);
        if jump.largest_smooth_ca * CLEAR < line && line * CLEAR < jump.smallest_dented_ca {
            border.retain(|[confinement, _]| *confinement != jump.confinement);
        }
    }
    let (Some(&[low, before]), Some(&[high, after])) = (border.first(), border.last()) else {
        return border;
    };
    let rows = || rows.iter().copied();
    let below = rows().filter(|row| *row < low - SAME_ROW).max_by(f64::total_cmp);
    let above = rows().filter(|row| *row > high + SAME_ROW).min_by(f64::total_cmp);
    border.insert(0, [below.map_or(low - SAME_ROW, |row| 0.5 * (row + low)), before]);
    border.push([above.map_or(high + SAME_ROW, |row| 0.5 * (row + high)), after]);
    border
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dent_that_starts_finite_is_a_jump() {
        let row = |depths: [f64; 5]| -> Vec<[f64; 3]> {
            let capillary_numbers = [0.0025, 0.005, 0.01, 0.02, 0.03];
            (0..5).map(|i| [0.9, capillary_numbers[i], depths[i]]).collect()
        };
        let found = jump(&row([0.0, 0.0, 0.10, 0.14, 0.16])).unwrap();
        assert_eq!((found.largest_smooth_ca, found.smallest_dented_ca), (0.005, 0.01));
        // A dent that grows from nothing, one that is always there, none.
        assert_eq!(jump(&row([0.0, 0.0, 0.07, 0.21, 0.35])), None);
        assert_eq!(jump(&row([0.03, 0.04, 0.07, 0.1, 0.12])), None);
        assert_eq!(jump(&row([0.0; 5])), None);
    }

    #[test]
    fn a_deep_dent_that_lasts_to_come_is_late() {
        let late = |depth, start| is_late(Dent { depth, start });
        assert!(late(0.1, 9.4) && !late(0.1, 2.2));
        // One that grows from nothing takes its time.
        assert!(!late(0.02, 6.2));
    }

    #[test]
    fn the_border_ends_between_the_rows_with_a_jump_and_those_without() {
        let jump = |confinement| Jump {
            confinement,
            largest_smooth_ca: 0.01,
            smallest_dented_ca: 0.04,
        };
        let found = border(&[jump(0.7), jump(0.8)], &[0.9, 0.7, 0.8, 0.8, 1.0]);
        let expected = [[0.7, 0.02], [0.7, 0.02], [0.8, 0.02], [0.85, 0.02]];
        assert_eq!(found.len(), 4);
        for (found, expected) in found.iter().zip(expected) {
            assert!((found[0] - expected[0]).abs() < 2e-6 && (found[1] - expected[1]).abs() < 1e-12);
        }
        assert!(found.windows(2).all(|w| w[0][0] < w[1][0]));
        assert!(border(&[], &[0.7, 0.8]).is_empty());
    }

    #[test]
    fn a_rough_bracket_gives_way_to_the_line_between_its_neighbours() {
        let jump = |confinement, largest_smooth_ca, smallest_dented_ca| Jump {
            confinement,
            largest_smooth_ca,
            smallest_dented_ca,
        };
        let (left, right) = (jump(0.7, 0.009, 0.01), jump(0.9, 0.008, 0.009));
        let count = |middle| border(&[left, middle, right], &[0.7, 0.8, 0.9]).len();
        // The line passes at 0.0090.
        assert_eq!(count(jump(0.8, 0.005, 0.012)), 4);
        // It misses this bracket, and this one is good enough to be followed.
        assert_eq!(count(jump(0.8, 0.005, 0.008)), 5);
        assert_eq!(count(jump(0.8, 0.0085, 0.0098)), 5);
    }
}
