//! The nearest of many points: of samples to a query, of nodes to a node.

use crate::Real;
use crate::linalg::slice_or_empty_mut;

/// The nearest of the points offered, at most `N`, sorted by insertion. Offsets stay in their slots; the order moves.
#[derive(Debug)]
pub(crate) struct Nearest<T, const P: usize, const N: usize> {
    wanted: usize,
    count: usize,
    limit: T,
    order: [Neighbour<T>; N],
    offsets: [[T; P]; N],
}

/// One of the nearest points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Neighbour<T> {
    /// Squared distance.
    pub(crate) square: T,
    /// Index of the point.
    pub(crate) number: u16,
    /// Slot of its offset.
    slot: u16,
}

impl<T: Real, const P: usize, const N: usize> Nearest<T, P, N> {
    /// An empty list for the `wanted` nearest points.
    pub(crate) fn new(wanted: usize) -> Self {
        Self {
            wanted: wanted.min(N),
            count: 0,
            limit: T::from_f32(f32::INFINITY),
            order: core::array::from_fn(|slot| Neighbour {
                square: T::ZERO,
                number: 0,
                slot: slot as u16,
            }),
            offsets: [[T::ZERO; P]; N],
        }
    }

    /// Squared distance at and beyond which points are rejected: that of the farthest of a full list, else infinity.
    pub(crate) fn limit(&self) -> T {
        self.limit
    }

    /// Number of points in the list.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// Inserts the point `number` at `offset`, with the squared length `square`, if it is near enough. Points at equal
    /// distance keep the order in which they were offered; points at no finite distance are rejected. Indices fit a
    /// u16, as those of a model's samples and nodes do.
    pub(crate) fn offer(&mut self, number: usize, square: T, offset: [T; P]) {
        let near = square < self.limit;
        if !near {
            return;
        }
        // The point takes the slot of the farthest.
        self.count = (self.count + 1).min(self.wanted);
        let kept = slice_or_empty_mut(&mut self.order, 0..self.count);
        let Some(Neighbour { slot, .. }) = kept.last().copied() else {
            return;
        };
        if let Some(stored) = self.offsets.get_mut(usize::from(slot)) {
            *stored = offset;
        }
        // Farther points move up by one.
        let Some((mut free, nearer)) = kept.split_last_mut() else {
            return;
        };
        for other in nearer.iter_mut().rev().take_while(|other| other.square > square) {
            *free = *other;
            free = other;
        }
        *free = Neighbour {
            square,
            number: number as u16,
            slot,
        };
        if self.count == self.wanted {
            self.limit = kept.last().map_or(T::ZERO, |last| last.square);
        }
    }

    /// The points in order of distance, with their offsets.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (&Neighbour<T>, &[T; P])> {
        let offset = |neighbour: &Neighbour<T>| self.offsets.get(usize::from(neighbour.slot));
        self.order
            .iter()
            .take(self.count)
            .filter_map(move |neighbour| Some((neighbour, offset(neighbour)?)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square<const P: usize>(offset: [f64; P]) -> f64 {
        offset.iter().map(|x| x * x).sum()
    }

    /// The indices in order.
    fn numbers<const P: usize, const N: usize>(offsets: &[[f64; P]]) -> [Option<u16>; N] {
        let mut nearest = Nearest::<f64, P, N>::new(N);
        for (number, offset) in offsets.iter().enumerate() {
            nearest.offer(number, square(*offset), *offset);
        }
        let mut numbers = [None; N];
        for (out, (neighbour, offset)) in numbers.iter_mut().zip(nearest.iter()) {
            assert_eq!(*offset, offsets[usize::from(neighbour.number)]);
            assert_eq!(neighbour.square, square(*offset));
            *out = Some(neighbour.number);
        }
        numbers
    }

    #[test]
    fn keeps_the_nearest_in_order() {
        let offsets = [[3.0, 0.0], [0.0, 1.0], [2.0, 0.0], [0.0, -1.0], [0.5, 0.0]];
        assert_eq!(numbers(&offsets), [4, 1, 3].map(Some));
        assert_eq!(numbers(&offsets[..1]), [Some(0), None]);
        assert_eq!(numbers(&offsets[..3]), [Some(1), Some(2), Some(0), None]);
        let distant = offsets.map(|[x, y]| if x > 1.0 { [f64::INFINITY; 2] } else { [x, y] });
        assert_eq!(numbers(&distant), [Some(4), Some(1), Some(3), None]);
        assert_eq!(numbers(&offsets), []);
    }

    #[test]
    fn agrees_with_sorting() {
        let offsets: [[f64; 1]; 40] = core::array::from_fn(|i| [((7 * i) % 40) as f64 - 19.3]);
        let mut sorted: [u16; 40] = core::array::from_fn(|i| i as u16);
        sorted.sort_by(|a, b| {
            let [a, b] = [a, b].map(|i| offsets[usize::from(*i)][0].abs());
            a.total_cmp(&b)
        });
        assert_eq!(numbers::<1, 5>(&offsets)[..], sorted.map(Some)[..5]);
        assert_eq!(numbers(&offsets), sorted.map(Some));
    }
}
