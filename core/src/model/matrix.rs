//! Views that read numbers in place, from wherever the file lies.

use super::wire::{Blob, Matrix};
use crate::Real;
use crate::linalg::dot_by;

/// A stored matrix, row-major; reads single by single where the bytes are not aligned.
#[derive(Clone, Copy, Debug)]
pub struct MatrixView<'a> {
    rows: usize,
    columns: usize,
    entries: Entries<'a>,
}

#[derive(Clone, Copy, Debug)]
enum Entries<'a> {
    Aligned(&'a [f32]),
    Bytes(&'a [[u8; 4]]),
}

impl<'a> MatrixView<'a> {
    /// A view of a matrix; entries that its bytes do not hold read as 0.
    pub fn new(matrix: &Matrix<'a>) -> Self {
        let data = matrix.blob.data;
        let entries = match bytemuck::try_cast_slice(data) {
            Ok(singles) if cfg!(target_endian = "little") => Entries::Aligned(singles),
            _ => Entries::Bytes(data.as_chunks().0),
        };
        Self {
            rows: matrix.rows as usize,
            columns: matrix.columns as usize,
            entries,
        }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Entry (row, column); 0 outside.
    pub fn get(&self, row: usize, column: usize) -> f32 {
        let index = row * self.columns + column;
        match self.entries {
            Entries::Aligned(entries) => entries.get(index).copied().unwrap_or_default(),
            Entries::Bytes(entries) => entries.get(index).map_or(0.0, |bytes| f32::from_le_bytes(*bytes)),
        }
    }

    /// The rows of a matrix of two columns.
    pub fn pairs<T: Real>(self) -> impl Iterator<Item = [T; 2]> + use<'a, T> {
        (0..self.rows).map(move |row| [0, 1].map(|column| T::from_f32(self.get(row, column))))
    }

    /// Row times vector, over the row's columns.
    pub(crate) fn dot<T: Real>(&self, row: usize, x: &[T]) -> T {
        let range = row * self.columns..(row + 1) * self.columns;
        match self.entries {
            Entries::Aligned(entries) => dot_by(entries.get(range).unwrap_or_default(), x, T::from_f32),
            Entries::Bytes(entries) => dot_by(entries.get(range).unwrap_or_default(), x, |bytes| {
                T::from_f32(f32::from_le_bytes(bytes))
            }),
        }
    }

    /// out <- the rows from `first` on times a vector, as many as `out` holds.
    pub(crate) fn multiply<T: Real>(&self, first: usize, x: &[T], out: &mut [T]) {
        for (row, out) in out.iter_mut().enumerate() {
            *out = self.dot(first + row, x);
        }
    }

    /// out <- out + factor times a row.
    pub(crate) fn add_row<T: Real>(&self, row: usize, factor: T, out: &mut [T]) {
        for (column, out) in out.iter_mut().enumerate().take(self.columns) {
            *out += factor * T::from_f32(self.get(row, column));
        }
    }
}

/// A stored list of node indices.
#[derive(Clone, Copy, Debug)]
pub struct Indices<'a>(&'a [[u8; 2]]);

impl<'a> Indices<'a> {
    /// A view of a blob of little-endian u16.
    pub fn new(blob: &Blob<'a>) -> Self {
        Self(blob.data.as_chunks().0)
    }

    /// Number of indices.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Index number `i`, if there is one.
    pub fn get(&self, i: usize) -> Option<usize> {
        self.0.get(i).map(|bytes| usize::from(u16::from_le_bytes(*bytes)))
    }

    /// All indices in order.
    pub fn iter(self) -> impl DoubleEndedIterator<Item = usize> + ExactSizeIterator + use<'a> {
        self.0.iter().map(|bytes| usize::from(u16::from_le_bytes(*bytes)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn aligned_and_unaligned_bytes_read_alike() {
        let values: [f32; 6] = [1.5, -2.0, 3.25, 1e-20, 7.0, -0.5];
        let mut bytes = [0_u8; 40];
        let start = bytes.as_ptr().align_offset(4);
        let x = [0.1_f32, 0.7, -1.3];
        let mut found = [[0.0_f32; 2]; 2];
        for (shift, found) in found.iter_mut().enumerate() {
            for (i, value) in values.iter().enumerate() {
                bytes[start + shift + 4 * i..][..4].copy_from_slice(&value.to_le_bytes());
            }
            let view = MatrixView::new(&Matrix::f32(2, 3, &bytes[start + shift..][..24]));
            assert_eq!(matches!(view.entries, Entries::Aligned(_)), shift == 0);
            assert_eq!(view.get(1, 2), -0.5);
            view.multiply(0, &x, found);
        }
        assert_eq!(found[0], found[1]);
        assert!((found[0][0] - (0.15 - 1.4 - 4.225)).abs() < 1e-6);
    }
}
