//! A matrix: singles, or integers with scales.

use capsule_core::model::MatrixView;
use capsule_core::model::panels::Layout;
use capsule_core::model::wire::{Encoding, Matrix, Widths};
use std::ops::Range;

use crate::settings::Storage;

/// A matrix of a model file, with its bytes.
#[derive(Clone)]
pub(crate) struct StoredMatrix {
    pub(super) rows: usize,
    columns: usize,
    encoding: Encoding,
    bytes: Vec<u8>,
}

impl StoredMatrix {
    pub(crate) fn new(rows: usize, columns: usize, value: impl Fn(usize, usize) -> f64) -> Self {
        let value = &value;
        let entries = (0..rows).flat_map(|i| (0..columns).map(move |j| value(i, j) as f32));
        StoredMatrix {
            rows,
            columns,
            encoding: Encoding::F32,
            bytes: entries.flat_map(f32::to_le_bytes).collect(),
        }
    }

    /// As [`StoredMatrix::new`], but quantised if the storage is so: integer multiples of the scales of the columns or
    /// rows, in two bytes in the first `wide_columns` columns, in one byte in the others.
    pub(super) fn quantized(
        storage: Storage,
        encoding: fn(Widths) -> Encoding,
        wide_columns: usize,
        [rows, columns]: [usize; 2],
        value: impl Fn(usize, usize) -> f64,
    ) -> Self {
        let encoding = encoding(Widths {
            wide_columns: wide_columns as u16,
        });
        let layout = Layout::new(encoding, [rows, columns]);
        let Some(layout) = layout.filter(|_| storage != Storage::Single) else {
            return StoredMatrix::new(rows, columns, value);
        };
        let of_rows = matches!(encoding, Encoding::RowPanels(_));
        let greatest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |a: f64, x| a.max(x.abs()));
        let scales: Vec<f32> = if of_rows {
            let part = |i, columns: Range<usize>| greatest(&mut columns.map(|j| value(i, j)));
            let row = |i| scale(part(i, 0..wide_columns), true).max(scale(part(i, wide_columns..columns), false));
            (0..rows).map(row).collect()
        } else {
            let column = |j| greatest(&mut (0..rows).map(|i| value(i, j)));
            (0..columns).map(|j| scale(column(j), j < wide_columns)).collect()
        };
        let integer = |i: usize, j: usize| {
            let scale = f64::from(scales[if of_rows { i } else { j }]);
            let multiple = if scale > 0.0 { value(i, j) / scale } else { 0.0 };
            // A scale is rounded to single precision, so a multiple may exceed the greatest by one.
            let greatest = greatest_multiple(j < wide_columns);
            multiple.round().clamp(-greatest, greatest) as i32
        };
        let mut bytes = vec![0; layout.byte_len()];
        layout.pack(&scales, integer, &mut bytes);
        StoredMatrix {
            rows,
            columns,
            encoding,
            bytes,
        }
    }

    /// The matrix times a factor: of a quantised one the scales.
    pub(super) fn times(&self, factor: f64) -> Self {
        let numbers = self.layout().map_or(self.rows * self.columns, |layout| layout.scales());
        let mut bytes = self.bytes.clone();
        for number in bytes.as_chunks_mut::<4>().0.iter_mut().take(numbers) {
            *number = ((f64::from(f32::from_le_bytes(*number)) * factor) as f32).to_le_bytes();
        }
        StoredMatrix { bytes, ..*self }
    }

    fn layout(&self) -> Option<Layout> {
        Layout::new(self.encoding, [self.rows, self.columns])
    }

    pub(crate) fn column(values: &[f64]) -> Self {
        StoredMatrix::new(values.len(), 1, |i, _| values[i])
    }

    /// Entry (row, column).
    pub(crate) fn get(&self, row: usize, column: usize) -> f64 {
        MatrixView::new(&self.matrix()).get(row, column).into()
    }

    /// Without the rows at these places. The scales are those of columns, so they stay.
    pub(super) fn without(&self, out: &[usize]) -> Self {
        let kept: Vec<usize> = (0..self.rows).filter(|row| !out.contains(row)).collect();
        let bytes = if let (Some(layout), Some(left)) =
            (self.layout(), Layout::new(self.encoding, [kept.len(), self.columns]))
        {
            let scales = self.bytes.as_chunks().0.iter().take(layout.scales());
            let scales: Vec<f32> = scales.map(|bytes| f32::from_le_bytes(*bytes)).collect();
            let integer = |i: usize, j| layout.unpack(&self.bytes, kept[i], j).unwrap_or(0);
            let mut bytes = vec![0; left.byte_len()];
            left.pack(&scales, integer, &mut bytes);
            bytes
        } else {
            let width = self.bytes.len() / self.rows.max(1);
            let row = |row: &usize| &self.bytes[row * width..(row + 1) * width];
            kept.iter().flat_map(row).copied().collect()
        };
        StoredMatrix {
            rows: kept.len(),
            bytes,
            ..*self
        }
    }

    /// Bytes of the blob.
    pub(super) fn byte_len(&self) -> usize {
        self.bytes.len()
    }

    pub(super) fn matrix(&self) -> Matrix<'_> {
        Matrix::new(self.rows as u32, self.columns as u32, self.encoding, &self.bytes)
    }
}

/// The scale with which the greatest number becomes the greatest integer of two bytes or of one.
fn scale(greatest: f64, wide: bool) -> f32 {
    (greatest / greatest_multiple(wide)) as f32
}

/// The greatest integer of two bytes or of one.
fn greatest_multiple(wide: bool) -> f64 {
    let byte = f64::from(i8::MAX);
    if wide { 256.0 * byte + byte } else { byte }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHAPE: [usize; 2] = [11, 5];

    fn value(i: usize, j: usize) -> f64 {
        0.5f64.powi(j as i32) * ((3 * i + 5 * j) as f64).cos()
    }

    #[test]
    fn an_entry_is_read_within_half_its_scale() {
        for encoding in [Encoding::Columns, Encoding::ColumnPanels, Encoding::RowPanels] {
            for wide_columns in [0, 2, 5] {
                let stored = StoredMatrix::quantized(Storage::Integer, encoding, wide_columns, SHAPE, value);
                for (factor, stored) in [(1.0, stored.clone()), (-4.0, stored.times(-4.0))] {
                    let matrix = stored.matrix();
                    let view = MatrixView::new(&matrix);
                    assert_eq!([view.rows(), view.columns()], SHAPE);
                    for (i, j) in (0..SHAPE[0]).flat_map(|i| (0..SHAPE[1]).map(move |j| (i, j))) {
                        let error = (f64::from(view.get(i, j)) - factor * value(i, j)).abs();
                        // No entry of column k exceeds 2^-k. A row has one scale for columns of both widths.
                        let scale = |k: usize| 0.5f64.powi(k as i32) / if k < wide_columns { 32_639.0 } else { 127.0 };
                        let of_row = (0..SHAPE[1]).map(scale).fold(0.0, f64::max);
                        let of_rows = matches!(stored.encoding, Encoding::RowPanels(_));
                        let scale = if of_rows { of_row } else { scale(j) };
                        assert!(
                            error <= 0.501 * f64::abs(factor) * scale,
                            "{wide_columns}: {i} {j}: {error:e}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn rows_that_are_left_out_change_no_other() {
        for stored in [
            StoredMatrix::new(SHAPE[0], SHAPE[1], value),
            StoredMatrix::quantized(Storage::Integer, Encoding::Columns, 2, SHAPE, value),
        ] {
            let left = stored.without(&[0, 4, 10]);
            for (place, row) in [1, 2, 3, 5, 6, 7, 8, 9].into_iter().enumerate() {
                for column in 0..SHAPE[1] {
                    assert_eq!(left.get(place, column), stored.get(row, column));
                }
            }
            assert_eq!(left.rows, 8);
        }
    }
}
