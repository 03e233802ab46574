//! The instants at which a model stores snapshots.

use crate::Real;
use crate::model::MatrixView;

/// The stored instants, in rising order.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Times<'a>(pub(crate) MatrixView<'a>);

impl Times<'_> {
    /// Number of instants.
    pub(crate) fn count(&self) -> usize {
        self.0.rows()
    }

    /// Instant `i`.
    pub(crate) fn get<T: Real>(&self, i: usize) -> T {
        T::from_f32(self.0.get(i, 0))
    }

    /// The i of the interval [t_i, t_i+1] that holds t, by bisection; the first or last interval outside.
    pub(crate) fn interval<T: Real>(&self, t: T) -> usize {
        let (mut low, mut high) = (0, self.count() - 1);
        while high - low > 1 {
            let middle = (low + high) / 2;
            *(if t < self.get(middle) { &mut high } else { &mut low }) = middle;
        }
        low
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::wire::Matrix;

    #[test]
    fn the_interval_holds_the_instant() {
        let bytes = [0.0_f32, 0.5, 2.0, 3.0].map(f32::to_le_bytes);
        let times = Times(MatrixView::new(&Matrix::f32(4, 1, bytes.as_flattened())));
        for (t, interval) in [
            (-1.0, 0),
            (0.0, 0),
            (0.49, 0),
            (0.5, 1),
            (1.9, 1),
            (2.0, 2),
            (3.0, 2),
            (9.0, 2),
        ] {
            assert_eq!(times.interval(t), interval, "{t}");
        }
    }
}
