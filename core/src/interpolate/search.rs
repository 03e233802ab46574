//! The samples nearest to a query.

use super::{Weights, square};
use crate::Real;
use crate::linalg::slice_or_empty;
use crate::model::Curve;
use crate::model::wire::{MAX_PARAMETERS, Matrix};
use crate::nearest::Nearest;

/// A search among the samples of a cluster.
pub(super) struct Search<'s, 'a, T> {
    pub(super) dimensions: usize,
    /// Coordinates of the samples `[N_c, P]`, sorted by the last one, and their parameters `[N_c, P]`.
    pub(super) points: &'s Matrix<'a>,
    pub(super) parameters: &'s Matrix<'a>,
    /// The query's coordinates, and the scales of differences from it.
    pub(super) query: [T; MAX_PARAMETERS],
    pub(super) scales: [T; MAX_PARAMETERS],
    /// The jump curve, and the query's side of it if it has one.
    pub(super) jump_curve: Curve<'a>,
    pub(super) side: Option<bool>,
}

fn value<T: Real>(bytes: &[u8; 4]) -> T {
    T::from_f32(f32::from_le_bytes(*bytes))
}

impl<T: Real> Search<'_, '_, T> {
    /// Scaled difference of a point from the query.
    #[inline(always)]
    fn offset(&self, point: &[[u8; 4]]) -> [T; MAX_PARAMETERS] {
        let difference = |d: usize, bytes| self.scales[d] * (value::<T>(bytes) - self.query[d]);
        match point {
            [a, b] => [difference(0, a), difference(1, b), T::ZERO, T::ZERO],
            _ => core::array::from_fn(|d| point.get(d).map_or(T::ZERO, |bytes| difference(d, bytes))),
        }
    }

    /// Whether the jump curve lies between the query and a sample. `cached` holds the last a/l and Ca of the curve
    /// there, because samples come in rows of equal a/l.
    fn separated(&self, sample: usize, cached: &mut (T, Option<T>)) -> bool {
        let (numbers, _) = self.parameters.blob.data.as_chunks::<4>();
        let (Some(side), Some([first, second])) = (
            self.side,
            slice_or_empty(numbers, 2 * sample..2 * sample + 2).as_array(),
        ) else {
            return false;
        };
        let confinement = value(second);
        if confinement != cached.0 {
            *cached = (confinement, self.jump_curve.within(confinement));
        }
        cached.1.is_some_and(|jump| (value::<T>(first) < jump) != side)
    }
}

impl<T: Real, const N: usize> Weights<T, N> {
    /// Takes the `wanted` samples nearest to a query, in order of distance: sets the samples, their offsets, and their
    /// squared distances in place of the weights. `left_out` is skipped.
    #[inline(never)]
    pub(super) fn find(&mut self, search: &Search<'_, '_, T>, left_out: Option<usize>, wanted: usize) {
        let dimensions = search.dimensions.max(1);
        let mut nearest = Nearest::<T, MAX_PARAMETERS, N>::new(wanted);
        let (numbers, _) = search.points.blob.data.as_chunks::<4>();
        let last = |values: &[T; MAX_PARAMETERS]| values.get(dimensions - 1).copied().unwrap_or(T::ONE);
        let (own, scale) = (last(&search.query), last(&search.scales));
        // The points are sorted by the last coordinate. The search starts at the query's and goes down and up, the
        // nearer first, until the difference in this coordinate alone exceeds the distance of all points in the list.
        let [mut start, mut end] = [0, numbers.len() / dimensions];
        while start < end {
            let middle = (start + end) / 2;
            let before = numbers.get((middle + 1) * dimensions - 1).map(value) < Some(own);
            *(if before { &mut start } else { &mut end }) = if before { middle + 1 } else { middle };
        }
        let (below, above) = numbers.split_at_checked(start * dimensions).unwrap_or_default();
        let (mut below, mut above) = (below.rchunks_exact(dimensions), above.chunks_exact(dimensions));
        let along = |point: Option<&[[u8; 4]]>| {
            let last = point.and_then(<[_]>::last).map(value::<T>);
            let difference = last.map_or(T::from_f32(f32::INFINITY), |last| scale * (last - own));
            difference * difference
        };
        // The next point down and up, its squared difference in the last coordinate, and its index.
        let mut next = [below.next(), above.next()];
        let mut distances = next.map(along);
        let mut numbers = [start, start];
        let mut jump = (T::ZERO, search.jump_curve.within(T::ZERO));
        loop {
            let [down, up] = distances;
            let (point, distance, number);
            if up <= down {
                (point, distance, number) = (next[1], up, numbers[1]);
                next[1] = above.next();
                distances[1] = along(next[1]);
                numbers[1] += 1;
            } else {
                numbers[0] = numbers[0].wrapping_sub(1);
                (point, distance, number) = (next[0], down, numbers[0]);
                next[0] = below.next();
                distances[0] = along(next[0]);
            }
            let (true, Some(point)) = (distance < nearest.limit(), point) else {
                break;
            };
            let offset = search.offset(point);
            let square = square(offset);
            if square < nearest.limit() && Some(number) != left_out && !search.separated(number, &mut jump) {
                nearest.offer(number, square, offset);
            }
        }
        self.dimensions = dimensions;
        self.count = nearest.count();
        let entries = self.samples.iter_mut().zip(&mut self.values).zip(&mut self.offsets);
        for (((sample, square), own_offset), (neighbour, offset)) in entries.zip(nearest.iter()) {
            (*sample, *square, *own_offset) = (neighbour.number, neighbour.square, *offset);
        }
    }
}
