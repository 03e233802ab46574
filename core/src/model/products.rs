//! Products of a stored matrix with vectors.

use super::matrix::{Entries, MatrixView, Scales};
use super::panels::{HIGH, Panels};
use super::quantized::{QuantScale, QuantizedRef};
use crate::Real;
use crate::linalg::{Block, LANES, TWO_PANELS, add_by, slice_or_empty};

/// Rows that are combined at a time.
const ROWS: usize = 16;

impl MatrixView<'_> {
    /// Row times a vector. The bits are those of its [panel](Self::panels).
    pub(crate) fn dot<T: Real>(&self, row: usize, x: QuantizedRef<'_, T>) -> T {
        if let Entries::Panels(stored) = self.entries {
            let panel = stored.panel(row / LANES, self.columns);
            let lane = row % LANES;
            let [scale] = x.scales;
            let sum = panel
                .iter()
                .zip(x.factors)
                .fold(T::ZERO_SUM, |sum, (block, [factors])| {
                    let word = block.get(lane / 2).copied().unwrap_or_default();
                    let [first, second] = T::add_products([sum; 2], word, *factors);
                    if lane.is_multiple_of(2) { first } else { second }
                });
            return self.scale_row(row, scale * T::from_sum(sum));
        }
        self.dot_by_entry(row, x.values.as_flattened().iter().copied())
    }

    /// Row times a vector, entry by entry.
    fn dot_by_entry<T: Real>(&self, row: usize, x: impl ExactSizeIterator<Item = T>) -> T {
        let sum = if let Entries::Singles(entries) = self.entries {
            let start = row * self.columns;
            let entries = slice_or_empty(entries, start..start + x.len()).iter().zip(x);
            entries.fold(T::ZERO, |sum, (entry, x)| {
                sum + T::from_f32(f32::from_le_bytes(*entry)) * x
            })
        } else {
            x.enumerate().fold(T::ZERO, |sum, (column, x)| {
                sum + T::from_f32(self.entry(row, column)) * x
            })
        };
        self.scale_row(row, sum)
    }

    /// A product with a row times the scale of the row, if it has one.
    fn scale_row<T: Real>(&self, row: usize, product: T) -> T {
        self.scales
            .of_row(row)
            .map_or(product, |scale| product * T::from_f32(scale))
    }

    /// products <- the eight rows of each of some panels times some vectors. A panel's bits do not depend on the
    /// others.
    #[inline(always)]
    pub(crate) fn panels<T: Real, const B: usize, const P: usize>(
        &self,
        panels: [usize; P],
        x: QuantizedRef<'_, T, B>,
        products: &mut [[[T; LANES]; B]; P],
    ) {
        if TWO_PANELS {
            self.multiply_panels(panels, x, products);
        } else {
            for (panel, products) in panels.iter().zip(products.as_chunks_mut().0) {
                self.multiply_panels::<T, B, 1>([*panel], x, products);
            }
        }
    }

    /// products <- the rows of successive panels times some vectors.
    pub(crate) fn successive<T: Real, const B: usize>(
        &self,
        first: usize,
        x: QuantizedRef<'_, T, B>,
        products: &mut [[[T; LANES]; B]],
    ) {
        let mut panel = first;
        let mut products = products;
        if TWO_PANELS {
            let (twos, rest) = products.as_chunks_mut();
            for two in twos {
                self.multiply_panels::<T, B, 2>([panel, panel + 1], x, two);
                panel += 2;
            }
            products = rest;
        }
        for single in products.as_chunks_mut().0 {
            self.multiply_panels::<T, B, 1>([panel], x, single);
            panel += 1;
        }
    }

    #[inline(never)]
    fn multiply_panels<T: Real, const B: usize, const P: usize>(
        &self,
        panels: [usize; P],
        x: QuantizedRef<'_, T, B>,
        products: &mut [[[T; LANES]; B]; P],
    ) {
        let Entries::Panels(stored) = self.entries else {
            for (panel, products) in panels.into_iter().zip(products) {
                for (b, products) in products.iter_mut().enumerate() {
                    for (lane, product) in products.iter_mut().enumerate() {
                        *product = self.dot_by_entry(LANES * panel + lane, x.values.iter().map(|x| x[b]));
                    }
                }
            }
            return;
        };
        let blocks = panels.map(|panel| stored.panel(panel, self.columns));
        T::multiply(blocks, x.factors, x.scales, products);
        if let Scales::OfRows(scales) = self.scales {
            for (panel, products) in panels.into_iter().zip(products) {
                // Rows beyond the last one are zeros.
                let scales = slice_or_empty(scales, LANES * panel..scales.len());
                for products in products {
                    for (product, scale) in products.iter_mut().zip(scales) {
                        *product *= T::from_f32(f32::from_le_bytes(*scale));
                    }
                }
            }
        }
    }

    /// out <- the sum of some rows times factors; as long as a row.
    pub(crate) fn combine<T: Real>(&self, rows: &[u16], factors: &[T], out: &mut [T]) {
        out.fill(T::ZERO);
        match self.entries {
            Entries::Transposed(stored) => {
                for (rows, factors) in rows.chunks(ROWS).zip(factors.chunks(ROWS)) {
                    self.add_rows(&stored, rows, factors, out);
                }
            }
            Entries::Singles(entries) => {
                for (row, factor) in rows.iter().map(|row| usize::from(*row)).zip(factors) {
                    let entries = slice_or_empty(entries, row * self.columns..(row + 1) * self.columns);
                    add_by(out, *factor, entries, |entry| T::from_f32(f32::from_le_bytes(entry)));
                }
            }
            Entries::Panels(_) => {
                for (row, factor) in rows.iter().map(|row| usize::from(*row)).zip(factors) {
                    let factor = self.scale_row(row, *factor);
                    for (column, out) in out.iter_mut().enumerate() {
                        *out += factor * T::from_f32(self.entry(row, column));
                    }
                }
            }
        }
        if let Scales::OfColumns(scales) = self.scales {
            for (out, scale) in out.iter_mut().zip(scales) {
                *out *= T::from_f32(f32::from_le_bytes(*scale));
            }
        }
    }

    /// out <- out + the sum of at most [`ROWS`] rows times factors, without the scales of the columns.
    fn add_rows<T: Real>(&self, stored: &Panels<'_>, rows: &[u16], factors: &[T], out: &mut [T]) {
        let mut quant = QuantScale::ZERO;
        factors.iter().for_each(|factor| quant.include(*factor));
        let (scale, inverse) = (quant.scale(), quant.inverse());
        // A block of the transpose holds two rows: the numbers of the blocks that take part, and the factors of both
        // rows of each. The memory of the factors is free for the blocks afterwards.
        let mut numbers = [0_u16; ROWS];
        let mut packed = [[T::ZERO_FACTORS]; ROWS];
        let mut count = 0;
        {
            let mut of_both = [[T::ZERO; 2]; ROWS];
            for (row, factor) in rows.iter().zip(factors) {
                let known = slice_or_empty(&numbers, 0..count)
                    .iter()
                    .position(|number| *number == row / 2);
                let place = known.unwrap_or(count);
                if let (Some(number), Some(factors)) = (numbers.get_mut(place), of_both.get_mut(place)) {
                    *number = row / 2;
                    factors[usize::from(row % 2)] = inverse * *factor;
                    count += usize::from(known.is_none());
                }
            }
            for (packed, [first, second]) in packed.iter_mut().zip(slice_or_empty(&of_both, 0..count)) {
                *packed = [T::pack(*first, *second)];
            }
        }
        let numbers = slice_or_empty(&numbers, 0..count);
        let mut blocks = [Block::default(); ROWS];
        let mut sums = [[[T::ZERO; LANES]; 1]];
        for first in (0..self.columns + stored.wide_columns).step_by(LANES) {
            let panel = stored.transposed_panel(first / LANES, self.rows);
            for (block, number) in blocks.iter_mut().zip(numbers) {
                // Word by word: the compiler calls a slower function to move bytes.
                if let Some([a, b, c, d]) = panel.get(usize::from(*number)) {
                    *block = [*a, *b, *c, *d];
                }
            }
            T::multiply([slice_or_empty(&blocks, 0..count)], &packed, [scale], &mut sums);
            for (place, sum) in (first..).zip(sums.as_flattened().as_flattened()) {
                if let Some(out) = out.get_mut(place) {
                    *out += *sum;
                } else if let Some(out) = out.get_mut(place.wrapping_sub(self.columns)) {
                    *out += T::from_f32(HIGH) * *sum;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::ProductScalar;
    use crate::model::panels::Layout;
    use crate::model::quantized::QuantizedVectors;
    use crate::model::wire::{Encoding, Matrix, Widths};
    use std::vec;
    use std::vec::Vec;

    const ROWS: usize = 11;
    const COLUMNS: usize = 5;
    const WIDTHS: Widths = Widths { wide_columns: 2 };
    const ENCODINGS: [Encoding; 3] = [
        Encoding::Columns(WIDTHS),
        Encoding::ColumnPanels(WIDTHS),
        Encoding::RowPanels(WIDTHS),
    ];

    /// An integer of two bytes in the first two columns, of one in the others.
    fn integer(row: usize, column: usize) -> i32 {
        let any = (row * 7919 + column * 104_729 + 13) as i32;
        if column < 2 {
            any % 65_279 - 32_639
        } else {
            any % 256 - 128
        }
    }

    fn scale(i: usize) -> f32 {
        [0.25, 0.125, 0.0625, 0.031_25][i % 4]
    }

    /// The matrix in an encoding, and its entries.
    fn stored(encoding: Encoding) -> (Vec<u8>, [[f64; COLUMNS]; ROWS]) {
        let of_rows = matches!(encoding, Encoding::RowPanels(_));
        let layout = Layout::new(encoding, [ROWS, COLUMNS]).unwrap();
        let scales: Vec<f32> = (0..layout.scales()).map(scale).collect();
        let mut bytes = vec![0; layout.byte_len()];
        layout.pack(&scales, integer, &mut bytes);
        let entry =
            |row, column| f64::from(integer(row, column)) * f64::from(scale(if of_rows { row } else { column }));
        let entries = core::array::from_fn(|row| core::array::from_fn(|column| entry(row, column)));
        (bytes, entries)
    }

    fn view(encoding: Encoding, bytes: &[u8]) -> MatrixView<'_> {
        MatrixView::new(&Matrix::new(ROWS as u32, COLUMNS as u32, encoding, bytes))
    }

    #[test]
    fn entries_and_products_are_the_same_however_they_are_stored() {
        for encoding in ENCODINGS {
            let (bytes, entries) = stored(encoding);
            let view = view(encoding, &bytes);
            for columns in 0..=COLUMNS {
                let plain: [Vec<f64>; 3] =
                    [0.5, -3.0, 1e-3].map(|first| (0..columns).map(|k| first + k as f64).collect());
                let vectors = |vectors: [&[f64]; 3]| {
                    let mut quantized = QuantizedVectors::<f64, COLUMNS, 3>::ZERO;
                    for (b, vector) in vectors.into_iter().enumerate() {
                        vector.iter().enumerate().for_each(|(k, x)| quantized.values[k][b] = *x);
                    }
                    quantized.quantize(&view, columns);
                    quantized
                };
                let interleaved = vectors(plain.each_ref().map(Vec::as_slice));
                let mut together = [[[0.0; LANES]; 3]; 2];
                view.panels([0, 1], interleaved.quantized(), &mut together);
                for (panel, together) in together.iter().enumerate() {
                    for lane in 0..LANES {
                        let row = LANES * panel + lane;
                        for b in 0..3 {
                            let exact: f64 = entries.get(row).map_or(0.0, |entries| {
                                entries.iter().zip(&plain[b]).map(|(entry, x)| entry * x).sum()
                            });
                            let mut single = QuantizedVectors::<f64, COLUMNS>::ZERO;
                            single.values.as_flattened_mut()[..columns].copy_from_slice(&plain[b]);
                            single.quantize(&view, columns);
                            let mut products = [[[0.0; LANES]; 1]];
                            view.panels([panel], single.quantized(), &mut products);
                            let [[alone]] = products;
                            assert!((together[b][lane] - exact).abs() <= 1e-9, "{encoding:?} {row}");
                            let dot = view.dot(row, single.quantized());
                            assert_eq!([alone[lane], dot], [together[b][lane]; 2]);
                        }
                    }
                }
            }
            let mut sum = [0.0_f64; COLUMNS];
            view.combine(&[0, 9], &[2.0, -1.0], &mut sum);
            for (column, sum) in sum.iter().enumerate() {
                let exact = 2.0 * entries[0][column] - entries[9][column];
                assert!((sum - exact).abs() < 1e-9, "{encoding:?} {column}: {sum} {exact}");
            }
            for row in 0..ROWS + 6 {
                for column in 0..COLUMNS + 1 {
                    let entry = entries.get(row).and_then(|row| row.get(column));
                    assert_eq!(f64::from(view.get(row, column)), *entry.unwrap_or(&0.0));
                }
            }
        }
    }

    #[test]
    fn quantisation_errs_by_half_a_scale_each_and_no_sum_overflows() {
        // The greatest entries there are, along and against factors that are far apart, as many as fit.
        const MAX: usize = 256;
        for entry in [i8::MIN, i8::MAX] {
            let mut bytes: Vec<u8> = (0..MAX).flat_map(|_| 1.0_f32.to_le_bytes()).collect();
            bytes.extend(core::iter::repeat_n(entry as u8, 2 * MAX * LANES));
            let encoding = Encoding::ColumnPanels(Widths {
                wide_columns: MAX as u16,
            });
            let entry = 257.0 * f64::from(entry);
            let view = MatrixView::new(&Matrix::new(LANES as u32, MAX as u32, encoding, &bytes));
            for sign in [1.0_f32, -1.0] {
                let mut x = QuantizedVectors::<f32, MAX>::ZERO;
                let factor = |k: usize| sign.powi(k as i32) * 3.0 * 0.999_f32.powi(k as i32);
                (0..MAX).for_each(|k| x.values[k][0] = factor(k));
                x.quantize(&view, MAX);
                let sum = |size: &dyn Fn(f64) -> f64| (0..MAX).map(|k| size(factor(k).into())).sum::<f64>();
                let exact = entry * sum(&|x| x);
                let found = f64::from(view.dot(0, x.quantized()));
                // Of the factor of either byte, times the byte.
                let scale = 256.0 * 3.0 / f64::from(f32::MAX_FACTOR);
                let rounding = 4.0 * f64::from(f32::EPSILON) * entry.abs() * sum(&f64::abs);
                let error = (found - exact).abs();
                assert!(
                    error < 0.5 * 2.0 * MAX as f64 * 128.0 * scale + rounding,
                    "{entry} {sign}: {found} {exact}"
                );
            }
        }
    }

    #[test]
    fn a_vector_that_is_not_finite_gives_nan() {
        let (bytes, _) = stored(Encoding::ColumnPanels(WIDTHS));
        let view = view(Encoding::ColumnPanels(WIDTHS), &bytes);
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            for column in 0..COLUMNS {
                let mut x = QuantizedVectors::<f32, COLUMNS>::ZERO;
                x.values[column][0] = value;
                x.quantize(&view, COLUMNS);
                assert!(!view.dot(1, x.quantized()).is_finite(), "{value} {column}");
            }
        }
    }

    #[test]
    fn an_entry_out_of_bounds_is_found_whatever_its_scale() {
        for encoding in ENCODINGS {
            let (mut bytes, entries) = stored(encoding);
            let greatest = entries.as_flattened().iter().fold(0.0, |a: f64, x| a.max(x.abs())) as f32;
            let outside = |bytes: &[u8], bound: f32| view(encoding, bytes).out_of_range(-bound, bound);
            // The scales allow greater entries than there are.
            assert_eq!(outside(&bytes, greatest), None);
            let (index, value) = outside(&bytes, 0.999 * greatest).unwrap();
            assert_eq!(f64::from(value), entries[index / COLUMNS][index % COLUMNS]);
            bytes[4..8].copy_from_slice(&f32::NAN.to_le_bytes());
            assert!(outside(&bytes, 1e9).is_some());
        }
    }
}
