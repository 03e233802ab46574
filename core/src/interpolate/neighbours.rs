//! The samples nearest to a query, or the nodes nearest to a node.

use super::square;
use crate::Real;
use crate::linalg::part;
use crate::model::MOST_SAMPLES;

/// A sample near the query.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Neighbour<T, const P: usize> {
    /// Number of the sample.
    pub(crate) sample: usize,
    /// Its place minus the query's, in the interpolation's coordinates.
    pub(crate) offset: [T; P],
    /// Square of the offset's length.
    square: T,
}

/// The nearest samples in order of distance (at equal distance, of their number), as many as `out` holds; returns how
/// many there are. `offset` gives the offset of a sample; it may give none where the square of its length is no less than
/// the limit that it is given, or where the sample takes no part. Nor do those at no finite distance.
pub(crate) fn nearest<S, T: Real, const P: usize>(
    samples: impl Iterator<Item = S>,
    left_out: Option<usize>,
    offset: impl Fn(S, T) -> Option<[T; P]>,
    out: &mut [Neighbour<T, P>],
) -> usize {
    let mut count = 0;
    // Most samples are farther than all that are kept.
    let mut limit = T::from_f32(f32::INFINITY);
    for (sample, given) in samples.enumerate().take(MOST_SAMPLES) {
        if Some(sample) == left_out {
            continue;
        }
        let Some(offset) = offset(given, limit) else { continue };
        let Some(square) = Some(square(offset)).filter(|square| *square < limit) else {
            continue;
        };
        let place = part(out, 0..count).partition_point(|neighbour| neighbour.square <= square);
        count = (count + 1).min(out.len());
        // Every one from its place on moves up by one, and the last falls out.
        if let Some(moved @ [_, ..]) = out.get_mut(place..count) {
            moved.rotate_right(1);
            moved[0] = Neighbour { sample, offset, square };
        }
        if let (true, Some(last)) = (count == out.len(), out.last()) {
            limit = last.square;
        }
    }
    count
}

impl<T: Real, const P: usize> Neighbour<T, P> {
    /// A place holder.
    pub(crate) const NONE: Self = Self {
        sample: 0,
        offset: [T::ZERO; P],
        square: T::ZERO,
    };

    /// Length of the offset.
    pub(crate) fn distance(&self) -> T {
        self.square.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keeps_the_nearest_in_order() {
        let offsets = [[3.0, 0.0], [0.0, 1.0], [2.0, 0.0], [0.0, -1.0], [0.5, 0.0]];
        let mut out = [Neighbour::NONE; 3];
        let mut search = |offsets: &[[f64; 2]], left_out| {
            let found = nearest(offsets.iter(), left_out, |offset, _| Some(*offset), &mut out);
            (found, out.map(|neighbour| neighbour.sample))
        };
        assert_eq!(search(&offsets, None), (3, [4, 1, 3]));
        assert_eq!(search(&offsets, Some(4)), (3, [1, 3, 2]));
        assert_eq!(search(&offsets[..1], None).0, 1);
        let apart = offsets.map(|[x, y]| if x > 1.0 { [f64::INFINITY; 2] } else { [x, y] });
        assert_eq!(search(&apart, None), (3, [4, 1, 3]));
    }

    #[test]
    fn what_is_beyond_the_limit_need_not_be_measured() {
        let offsets: [[f64; 1]; 40] = core::array::from_fn(|i| [((7 * i) % 40) as f64 - 19.3]);
        let mut out = [[Neighbour::NONE; 5]; 2];
        let lazy = |offset: &[f64; 1], limit| (offset[0] * offset[0] < limit).then_some(*offset);
        nearest(offsets.iter(), None, |offset, _| Some(*offset), &mut out[0]);
        nearest(offsets.iter(), None, lazy, &mut out[1]);
        assert_eq!(
            out[0].map(|neighbour| neighbour.sample),
            out[1].map(|neighbour| neighbour.sample)
        );
    }
}
