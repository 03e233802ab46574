//! QuantizedVectors quantised for products with a matrix of integers.

use super::matrix::{Entries, MatrixView, Scales};
use super::panels::HIGH;
use crate::Real;
use crate::linalg::{slice_or_empty, slice_or_empty_mut};

/// At most `K` entries of `B` vectors, for products with a matrix: the first entry of each, then the second, and so on.
#[derive(Clone, Debug)]
pub(crate) struct QuantizedVectors<T: Real, const K: usize, const B: usize = 1> {
    pub(crate) values: [[T; B]; K],
    /// The values as integer multiples of the scales, two factors to a block: one block for two narrow columns, or for
    /// a wide one.
    factors: [[T::PackedFactors; B]; K],
    scales: [T; B],
    /// How many values and blocks of factors are quantised.
    counts: [usize; 2],
}

/// Quantised vectors.
#[derive(Clone, Copy, Debug)]
pub(crate) struct QuantizedRef<'s, T: Real, const B: usize = 1> {
    pub(super) values: &'s [[T; B]],
    pub(super) factors: &'s [[T::PackedFactors; B]],
    pub(super) scales: [T; B],
}

impl<T: Real, const K: usize, const B: usize> QuantizedVectors<T, K, B> {
    pub(crate) const ZERO: Self = Self {
        values: [[T::ZERO; B]; K],
        factors: [[T::ZERO_FACTORS; B]; K],
        scales: [T::ZERO; B],
        counts: [0; 2],
    };

    /// Quantises the leading `count` entries for products with a matrix: multiplies them by the scales of its columns
    /// and rounds them to integer multiples of one scale a vector. Where an entry is not finite, every product is NaN.
    pub(crate) fn quantize(&mut self, matrix: &MatrixView<'_>, count: usize) {
        let values = slice_or_empty_mut(&mut self.values, 0..count);
        self.counts = [values.len(), 0];
        if let Scales::OfColumns(scales) = matrix.scales {
            for (values, scale) in values.iter_mut().zip(scales) {
                let scale = T::from_f32(f32::from_le_bytes(*scale));
                values.iter_mut().for_each(|value| *value *= scale);
            }
        }
        let Entries::Panels(panels) = matrix.entries else {
            return;
        };
        let high = T::from_f32(HIGH);
        let (wide, narrow) = values.split_at(panels.wide_columns.min(values.len()));
        for (b, scale) in self.scales.iter_mut().enumerate() {
            let mut quant = QuantScale::ZERO;
            wide.iter().for_each(|x| quant.include(high * x[b]));
            narrow.iter().for_each(|x| quant.include(x[b]));
            *scale = quant.scale();
            let inverse = quant.inverse();
            let (of_wide, of_narrow) = self.factors.split_at_mut(wide.len());
            for (factors, x) in of_wide.iter_mut().zip(wide) {
                let x = inverse * x[b];
                factors[b] = T::pack(high * x, x);
            }
            let (twos, last) = narrow.as_chunks::<2>();
            for (factors, [x, y]) in of_narrow.iter_mut().zip(twos) {
                factors[b] = T::pack(inverse * x[b], inverse * y[b]);
            }
            for (factors, x) in of_narrow.iter_mut().skip(twos.len()).zip(last) {
                factors[b] = T::pack(inverse * x[b], T::ZERO);
            }
        }
        self.counts[1] = panels.blocks_of(count);
    }

    /// The entries that are quantised.
    pub(crate) fn quantized(&self) -> QuantizedRef<'_, T, B> {
        let [values, factors] = self.counts;
        QuantizedRef {
            values: slice_or_empty(&self.values, 0..values),
            factors: slice_or_empty(&self.factors, 0..factors),
            scales: self.scales,
        }
    }
}

/// Scale of the integers that some numbers are rounded to: the greatest number becomes [`Real::MAX_FACTOR`].
#[derive(Clone, Copy, Debug)]
pub(super) struct QuantScale<T> {
    greatest: T,
    sum: T,
}

impl<T: Real> QuantScale<T> {
    pub(super) const ZERO: Self = Self {
        greatest: T::ZERO,
        sum: T::ZERO,
    };

    pub(super) fn include(&mut self, number: T) {
        self.greatest = self.greatest.max(number.abs());
        self.sum += number;
    }

    /// The number that the integer 1 stands for; NaN if one of the numbers is not finite.
    pub(super) fn scale(&self) -> T {
        self.greatest / T::MAX_FACTOR + T::ZERO * self.sum
    }

    /// The factor from a number to its integer; 0 where all numbers are 0.
    pub(super) fn inverse(&self) -> T {
        if self.greatest > T::ZERO {
            T::MAX_FACTOR / self.greatest
        } else {
            T::ZERO
        }
    }
}
