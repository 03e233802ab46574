//! Curves of the parameter plane: a capillary number for each confinement.

use super::wire::Matrix;
use crate::Real;

/// Points (a/l, Ca) by rising a/l, joined by lines.
#[derive(Clone, Copy, Debug)]
pub struct Curve<'a>(&'a [[[u8; 4]; 2]]);

impl<'a> Curve<'a> {
    /// A view of rows (a/l, Ca) of singles.
    pub fn new(points: &Matrix<'a>) -> Self {
        Self(points.blob.data.as_chunks().0.as_chunks().0)
    }

    /// Whether there is no point.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The points (a/l, Ca).
    pub fn points<T: Real>(self) -> impl Iterator<Item = [T; 2]> + use<'a, T> {
        (0..self.0.len()).map(move |row| self.point(row))
    }

    fn point<T: Real>(&self, row: usize) -> [T; 2] {
        let point = self.0.get(row).copied().unwrap_or_default();
        point.map(|bytes| T::from_f32(f32::from_le_bytes(bytes)))
    }

    fn abscissa<T: Real>(&self, row: usize) -> T {
        let [abscissa, _] = self.point(row);
        abscissa
    }

    /// The two points around a confinement, the first or last two beyond the ends; none if there is no point.
    #[inline(always)]
    fn segment<T: Real>(&self, confinement: T) -> Option<[[T; 2]; 2]> {
        let (mut low, mut high) = (0, self.0.len().checked_sub(1)?);
        while high - low > 1 {
            let middle = (low + high) / 2;
            let before = confinement < self.abscissa(middle);
            *(if before { &mut high } else { &mut low }) = middle;
        }
        Some([self.point(low), self.point(high)])
    }

    /// The capillary number at a confinement, constant beyond the ends; none if there is no point.
    pub fn at<T: Real>(&self, confinement: T) -> Option<T> {
        let [[x0, y0], [x1, y1]] = self.segment(confinement)?;
        Some(if confinement <= x0 {
            y0
        } else if confinement >= x1 {
            y1
        } else {
            y0 + (y1 - y0) * (confinement - x0) / (x1 - x0)
        })
    }

    /// The derivative of [`at`](Self::at), at a point that of the line after it; none if there is no point.
    pub fn slope<T: Real>(&self, confinement: T) -> Option<T> {
        let [[x0, y0], [x1, y1]] = self.segment(confinement)?;
        let between = confinement >= x0 && confinement < x1;
        Some(if between { (y1 - y0) / (x1 - x0) } else { T::ZERO })
    }

    /// As [`at`](Self::at), but none where the curve does not reach.
    pub fn within<T: Real>(&self, confinement: T) -> Option<T> {
        let last = self.0.len().checked_sub(1)?;
        let reaches = confinement >= self.abscissa(0) && confinement <= self.abscissa(last);
        if reaches { self.at(confinement) } else { None }
    }

    /// Whether parameters (Ca, a/l) lie below the curve; none where it does not reach.
    pub fn below<T: Real>(&self, [capillary_number, confinement]: [T; 2]) -> Option<bool> {
        self.within(confinement).map(|border| capillary_number < border)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_is_linear_between_its_points_and_knows_its_sides() {
        let mut bytes = [0; 24];
        for (bytes, value) in bytes.chunks_exact_mut(4).zip([0.75_f32, 0.14, 0.9, 0.13, 1.2, 0.05]) {
            bytes.copy_from_slice(&value.to_le_bytes());
        }
        let curve = Curve::new(&Matrix::f32(3, 2, &bytes));
        for (confinement, expected) in [(0.5_f64, 0.14), (0.825, 0.135), (1.05, 0.09), (2.0, 0.05)] {
            assert!((curve.at(confinement).unwrap() - expected).abs() < 1e-7);
        }
        for (confinement, expected) in [(0.5_f64, 0.0), (0.825, -0.01 / 0.15), (1.05, -0.08 / 0.3), (2.0, 0.0)] {
            assert!((curve.slope(confinement).unwrap() - expected).abs() < 1e-6);
        }
        assert_eq!(curve.below([0.08, 1.05]), Some(true));
        assert_eq!(curve.below([0.10, 1.05]), Some(false));
        assert_eq!(curve.below([0.14_f32, 0.75]), Some(false), "a point of the curve");
        assert_eq!((curve.below([0.10, 0.7]), curve.below([0.10, 1.3])), (None, None));
        let none = Curve::new(&Matrix::f32(0, 2, &[]));
        assert_eq!((none.at(0.9), none.below([0.1, 0.9])), (None, None));
    }
}
