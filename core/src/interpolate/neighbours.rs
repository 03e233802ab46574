//! The samples nearest to a query, or the nodes nearest to a node.

use super::norm;
use crate::Real;
use crate::model::MOST_SAMPLES;

/// A sample near the query.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Neighbour<T, const P: usize> {
    /// Number of the sample.
    pub(crate) sample: usize,
    /// Its place minus the query's, in the interpolation's coordinates.
    pub(crate) offset: [T; P],
    /// Length of the offset.
    pub(crate) distance: T,
}

/// The nearest samples in order of distance (at equal distance, of their number), as many as `out` holds; returns how
/// many there are. Those at no finite distance take no part.
pub(crate) fn nearest<T: Real, const P: usize>(
    offsets: impl Iterator<Item = [T; P]>,
    left_out: Option<usize>,
    out: &mut [Neighbour<T, P>],
) -> usize {
    let mut count = 0;
    for (sample, offset) in offsets.enumerate().take(MOST_SAMPLES) {
        if Some(sample) == left_out {
            continue;
        }
        let distance = norm(offset);
        if !distance.is_finite() {
            continue;
        }
        // Most are farther than all that are kept.
        if count == out.len() && out.last().is_some_and(|last| last.distance <= distance) {
            continue;
        }
        let place = out
            .iter()
            .take(count)
            .take_while(|neighbour| neighbour.distance <= distance)
            .count();
        count = (count + 1).min(out.len());
        // Every one from its place on moves up by one, and the last falls out.
        let mut moved = Neighbour {
            sample,
            offset,
            distance,
        };
        for neighbour in out.iter_mut().take(count).skip(place) {
            core::mem::swap(neighbour, &mut moved);
        }
    }
    count
}

impl<T: Real, const P: usize> Neighbour<T, P> {
    /// A place holder.
    pub(crate) const NONE: Self = Self {
        sample: 0,
        offset: [T::ZERO; P],
        distance: T::ZERO,
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keeps_the_nearest_in_order() {
        let offsets = [[3.0, 0.0], [0.0, 1.0], [2.0, 0.0], [0.0, -1.0], [0.5, 0.0]];
        let mut out = [Neighbour::NONE; 3];
        assert_eq!(nearest(offsets.into_iter(), None, &mut out), 3);
        assert_eq!(out.map(|neighbour| neighbour.sample), [4, 1, 3]);
        assert_eq!(nearest(offsets.into_iter(), Some(4), &mut out), 3);
        assert_eq!(out.map(|neighbour| neighbour.sample), [1, 3, 2]);
        assert_eq!(nearest(offsets.into_iter().take(1), None, &mut out), 1);
        let apart = offsets.map(|[x, y]| if x > 1.0 { [f64::INFINITY; 2] } else { [x, y] });
        assert_eq!(nearest(apart.into_iter(), None, &mut out), 3);
        assert_eq!(out.map(|neighbour| neighbour.sample), [4, 1, 3]);
    }
}
