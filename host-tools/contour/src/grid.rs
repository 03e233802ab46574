//! Brightness at pixels and between them.

use image::imageops::blur;
use image::{ImageBuffer, Luma};

/// Brightness from 0 to 1.
pub(crate) type Grey = ImageBuffer<Luma<f32>, Vec<f32>>;

/// Numbers at the pixels of a picture.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Grid {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Row by row.
    pub(crate) values: Vec<f64>,
}

impl Grid {
    /// A picture after a Gaussian of this standard deviation, in pixels.
    pub(crate) fn blurred(grey: &Grey, deviation: f32) -> Self {
        Self::of(&blur(grey, deviation))
    }

    /// A picture as it is.
    pub(crate) fn of(grey: &Grey) -> Self {
        Self {
            width: grey.width() as usize,
            height: grey.height() as usize,
            values: grey.as_raw().iter().map(|value| f64::from(*value)).collect(),
        }
    }

    /// Rows become columns.
    pub(crate) fn transposed(&self) -> Self {
        let (width, height) = (self.height, self.width);
        let values = (0..width * height).map(|i| self.at(i / width, i % width)).collect();
        Self { width, height, values }
    }

    /// The difference from a grid of the same size.
    pub(crate) fn minus(mut self, other: &Self) -> Self {
        for (value, other) in self.values.iter_mut().zip(&other.values) {
            *value -= other;
        }
        self
    }

    /// The value of a pixel.
    pub(crate) fn at(&self, x: usize, y: usize) -> f64 {
        self.values[y * self.width + x]
    }

    /// All values times a factor.
    pub(crate) fn times(mut self, factor: f64) -> Self {
        self.values.iter_mut().for_each(|value| *value *= factor);
        self
    }

    /// The value at a place, by the cubic convolution of Keys (IEEE Trans. ASSP 29, 1981) with a = -1/2, whose
    /// derivatives are continuous; beyond the border, that of the border.
    pub(crate) fn sample(&self, [x, y]: [f64; 2]) -> f64 {
        let weights = |share: f64| {
            let [s, s2, s3] = [share, share * share, share * share * share];
            [
                0.5 * (-s + 2.0 * s2 - s3),
                1.0 - 2.5 * s2 + 1.5 * s3,
                0.5 * (s + 4.0 * s2 - 3.0 * s3),
                0.5 * (s3 - s2),
            ]
        };
        let (x, y) = (x - 0.5, y - 0.5);
        let (column, row) = (x.floor(), y.floor());
        let (wx, wy) = (weights(x - column), weights(y - row));
        let inside =
            |at: f64, step: usize, size: usize| (at + step as f64 - 1.0).clamp(0.0, (size - 1) as f64) as usize;
        let line = |j: usize| {
            let y = inside(row, j, self.height);
            (0..4)
                .map(|i| wx[i] * self.at(inside(column, i, self.width), y))
                .sum::<f64>()
        };
        (0..4).map(|j| wy[j] * line(j)).sum()
    }
}

/// The middle of some numbers by size.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// By how much of a step a parabola through three values at -1, 0 and 1 has its extremum off 0.
pub(crate) fn vertex([before, at, after]: [f64; 3]) -> f64 {
    let bend = before - 2.0 * at + after;
    if bend == 0.0 {
        0.0
    } else {
        (0.5 * (before - after) / bend).clamp(-0.5, 0.5)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_sampled_exactly_inside() {
        let (width, height) = (8, 6);
        let surface = |x: f64, y: f64| 0.3 + 0.1 * x - 0.2 * y + 0.05 * x * x - 0.02 * y * y;
        let values = (0..width * height)
            .map(|i| surface((i % width) as f64 + 0.5, (i / width) as f64 + 0.5))
            .collect();
        let grid = Grid { width, height, values };
        for (x, y) in [(2.0, 2.0), (3.3, 2.7), (5.9, 4.1)] {
            assert!((grid.sample([x, y]) - surface(x, y)).abs() < 1e-12);
            assert!((grid.transposed().sample([y, x]) - surface(x, y)).abs() < 1e-12);
        }
        assert!((vertex([1.0, 0.0, 2.0]) + 1.0 / 6.0).abs() < 1e-12);
        assert_eq!(median(&mut [3.0, 1.0, 2.0]), 2.0);
    }
}
