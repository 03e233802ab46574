//! Where the solution jumps: at small Ca the rear of the membrane is smooth, and beyond a threshold it buckles into a
//! dent.
//!
//! At small confinements the dent comes at once with a finite depth, and shape and velocity jump with it; at larger
//! ones it grows from nothing and there is no border.

use serde::Serialize;

use crate::samples::{Dent, Sample};
use crate::tolerances::SAME_ROW;

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

/// A steady sample: a/l, Ca, and the depth of its dent over a.
pub(crate) type Place = [f64; 3];

/// The steady samples by rising confinement and Ca. A late dent counts as none: the border lies where dents begin to
/// come early, for most of the time a late one is on the smooth side of it.
pub(crate) fn places(samples: &[Sample]) -> Vec<Place> {
    let mut places: Vec<Place> = samples
        .iter()
        .filter(|s| s.steady)
        .map(|s| [s.parameters[1], s.parameters[0], early_depth(s.dent)])
        .collect();
    places.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    places
}

/// The depth of a dent over a, 0 of a late one.
fn early_depth(dent: Dent) -> f64 {
    if is_late(dent) { 0.0 } else { dent.depth }
}

/// Whether a dent is late. Just beyond the jump the smooth shape is almost steady: it lasts, the longer the nearer, and
/// then buckles at once. At some instants such a configuration lies on the one side of the border and at others on the
/// other, and no neighbour of it on either side is like it.
pub(crate) fn is_late(dent: Dent) -> bool {
    dent.depth > JUMP && dent.start > LATE
}

/// The jumps of all rows, by rising confinement: where the depth of the dent, drawn back from its first two samples in
/// a line to the last sample without one, is still finite.
pub(crate) fn jumps(places: &[Place]) -> Vec<Jump> {
    places
        .chunk_by(|a, b| (a[0] - b[0]).abs() <= SAME_ROW)
        .filter_map(jump)
        .collect()
}

/// The jump of a row (a/l, Ca, depth) by rising Ca.
fn jump(row: &[Place]) -> Option<Jump> {
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

/// The border (a/l, Ca): a line through the middles of the jumps that has all places on their sides. A jump that is
/// known only roughly makes no point of it where the line between its neighbours passes between its two samples anyway.
/// The line is drawn on at both ends to half the way to the next row, where there is one.
pub(crate) fn border(jumps: &[Jump], places: &[Place]) -> Vec<[f64; 2]> {
    let mut by_width: Vec<&Jump> = jumps.iter().collect();
    by_width.sort_by(|a, b| b.width().total_cmp(&a.width()));
    let mut border: Vec<[f64; 2]> = jumps.iter().map(|jump| [jump.confinement, jump.middle()]).collect();
    for jump in by_width.into_iter().take_while(|jump| jump.width() > ROUGH) {
        let place = border
            .iter()
            .position(|[confinement, _]| *confinement == jump.confinement);
        let Some(&[before, _, after]) = place.and_then(|i| border.get(i.checked_sub(1)?..i + 2)?.first_chunk()) else {
            continue;
        };
        let line = between(before, after, jump.confinement);
        if jump.largest_smooth_ca * CLEAR < line && line * CLEAR < jump.smallest_dented_ca {
            border.retain(|[confinement, _]| *confinement != jump.confinement);
        }
    }
    drawn_by(&mut border, places);
    let (Some(&[low, before]), Some(&[high, after])) = (border.first(), border.last()) else {
        return border;
    };
    let rows = || places.iter().map(|place| place[0]);
    let below = rows().filter(|row| *row < low - SAME_ROW).max_by(f64::total_cmp);
    let above = rows().filter(|row| *row > high + SAME_ROW).min_by(f64::total_cmp);
    border.insert(0, [below.map_or(low - SAME_ROW, |row| 0.5 * (row + low)), before]);
    border.push([above.map_or(high + SAME_ROW, |row| 0.5 * (row + high)), after]);
    border
}

/// A place that a line has on the wrong side, or too near, draws it past itself: first the one that does so farthest.
/// Where the line has a point already, it is one of the jump that was measured there.
fn drawn_by(border: &mut Vec<[f64; 2]>, places: &[Place]) {
    let drawn = |border: &[[f64; 2]], [confinement, ca, depth]: Place| -> Option<(f64, [f64; 2])> {
        let next = border.iter().position(|point| point[0] > confinement - SAME_ROW)?;
        let &[before, after] = border.get(next.checked_sub(1)?..=next)?.first_chunk()?;
        if after[0] < confinement + SAME_ROW {
            return None;
        }
        let line = between(before, after, confinement);
        // How much too far the line is, as a factor, and where it belongs.
        let (excess, belongs) = match depth {
            depth if depth < DENT => (ca * CLEAR / line, ca * CLEAR),
            depth if depth > JUMP => (line * CLEAR / ca, ca / CLEAR),
            _ => return None,
        };
        (excess > 1.0 + 1e-9).then_some((excess, [confinement, belongs]))
    };
    while let Some((_, point)) = places
        .iter()
        .filter_map(|place| drawn(border, *place))
        .max_by(|a, b| a.0.total_cmp(&b.0))
    {
        let next = border.partition_point(|other| other[0] < point[0]);
        border.insert(next, point);
    }
}

/// The line through two points, at a confinement.
fn between([x0, y0]: [f64; 2], [x1, y1]: [f64; 2], x: f64) -> f64 {
    y0 + (y1 - y0) * (x - x0) / (x1 - x0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Places in rows, far from any border.
    fn rows(confinements: &[f64]) -> Vec<Place> {
        confinements
            .iter()
            .map(|confinement| [*confinement, 1e-3, 0.0])
            .collect()
    }

    #[test]
    fn places_beside_the_rows_draw_the_line_to_their_sides() {
        let jump = |confinement| Jump {
            confinement,
            largest_smooth_ca: 0.008,
            smallest_dented_ca: 0.009,
        };
        let jumps = [jump(0.8), jump(0.9)];
        // The line passes at 0.0085; one place on the wrong side, one too near, two where they should be, one between.
        let places = [
            [0.82, 0.0080, 0.1],
            [0.84, 0.00845, 0.0],
            [0.86, 0.0095, 0.1],
            [0.87, 0.0070, 0.0],
            [0.88, 0.0070, 0.03],
        ];
        let found = border(&jumps, &places);
        let confinements: Vec<f64> = found.iter().map(|point| point[0]).collect();
        assert_eq!(confinements[1..5], [0.8, 0.82, 0.84, 0.9]);
        for [confinement, ca, depth] in places {
            let next = found.iter().position(|point| point[0] >= confinement).unwrap();
            let line = between(found[next - 1], found[next], confinement);
            assert!(depth == 0.03 || (line > ca) == (depth == 0.0), "{confinement} {line}");
        }
        // Two that contradict each other do not keep it from ending.
        border(&jumps, &[[0.84, 0.0095, 0.0], [0.84, 0.0075, 0.1]]);
    }

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
        assert_eq!(
            [9.4, 2.2].map(|start| early_depth(Dent { depth: 0.1, start })),
            [0.0, 0.1]
        );
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
        let found = border(&[jump(0.7), jump(0.8)], &rows(&[0.7, 0.8, 0.8, 0.9, 1.0]));
        let expected = [[0.7, 0.02], [0.7, 0.02], [0.8, 0.02], [0.85, 0.02]];
        assert_eq!(found.len(), 4);
        for (found, expected) in found.iter().zip(expected) {
            assert!((found[0] - expected[0]).abs() < 2e-6 && (found[1] - expected[1]).abs() < 1e-12);
        }
        assert!(found.windows(2).all(|w| w[0][0] < w[1][0]));
        assert!(border(&[], &rows(&[0.7, 0.8])).is_empty());
    }

    #[test]
    fn a_rough_bracket_gives_way_to_the_line_between_its_neighbours() {
        let jump = |confinement, largest_smooth_ca, smallest_dented_ca| Jump {
            confinement,
            largest_smooth_ca,
            smallest_dented_ca,
        };
        let (left, right) = (jump(0.7, 0.009, 0.01), jump(0.9, 0.008, 0.009));
        let count = |middle| border(&[left, middle, right], &rows(&[0.7, 0.8, 0.9])).len();
        // The line passes at 0.0090.
        assert_eq!(count(jump(0.8, 0.005, 0.012)), 4);
        // It misses this bracket, and this one is good enough to be followed.
        assert_eq!(count(jump(0.8, 0.005, 0.008)), 5);
        assert_eq!(count(jump(0.8, 0.0085, 0.0098)), 5);
    }
}
