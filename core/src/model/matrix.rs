//! Views that read numbers in place, from wherever the file lies.

use super::wire::{Blob, Encoding, Matrix};
use crate::Real;
use crate::linalg::{dot_by, dot_scaled, part};

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
    /// Integers in the units of their columns.
    Scaled {
        units: &'a [[u8; 4]],
        integers: &'a [[u8; 2]],
    },
}

impl<'a> MatrixView<'a> {
    /// A view of a matrix; entries that its bytes do not hold read as 0.
    pub fn new(matrix: &Matrix<'a>) -> Self {
        let data = matrix.blob.data;
        let entries = match (matrix.encoding, bytemuck::try_cast_slice(data)) {
            (Encoding::F32, Ok(singles)) if cfg!(target_endian = "little") => Entries::Aligned(singles),
            (Encoding::F32, _) => Entries::Bytes(data.as_chunks().0),
            (Encoding::I16, _) => {
                let (units, integers) = data.split_at_checked(4 * matrix.columns as usize).unwrap_or_default();
                Entries::Scaled {
                    units: units.as_chunks().0,
                    integers: integers.as_chunks().0,
                }
            }
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
            Entries::Scaled { units, integers } => match (units.get(column), integers.get(index)) {
                (Some(unit), Some(integer)) => f32::from_le_bytes(*unit) * f32::from(i16::from_le_bytes(*integer)),
                _ => 0.0,
            },
        }
    }

    /// The rows of a matrix of two columns.
    pub fn pairs<T: Real>(self) -> impl Iterator<Item = [T; 2]> + use<'a, T> {
        self.rows_of()
    }

    /// The first `C` columns of every row; zeros where the matrix has fewer.
    pub(crate) fn rows_of<T: Real, const C: usize>(self) -> impl Iterator<Item = [T; C]> + use<'a, T, C> {
        let entry = move |row, column| {
            if column < self.columns {
                T::from_f32(self.get(row, column))
            } else {
                T::ZERO
            }
        };
        (0..self.rows).map(move |row| core::array::from_fn(|column| entry(row, column)))
    }

    /// Row times vector, over the row's columns.
    pub(crate) fn dot<T: Real>(&self, row: usize, x: &[T]) -> T {
        let range = row * self.columns..(row + 1) * self.columns;
        match self.entries {
            Entries::Aligned(entries) => dot_by(entries.get(range).unwrap_or_default(), x, T::from_f32),
            Entries::Bytes(entries) => dot_by(entries.get(range).unwrap_or_default(), x, |bytes| {
                T::from_f32(f32::from_le_bytes(bytes))
            }),
            Entries::Scaled { units, integers } => {
                let integers = integers.get(range).unwrap_or_default();
                dot_scaled(integers, units, x, |integer, unit| {
                    T::from_f32(f32::from(i16::from_le_bytes(integer)) * f32::from_le_bytes(unit))
                })
            }
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
        let range = row * self.columns..(row + 1) * self.columns;
        match self.entries {
            Entries::Aligned(entries) => add_by(out, factor, part(entries, range), |value| value),
            Entries::Bytes(entries) => add_by(out, factor, part(entries, range), f32::from_le_bytes),
            Entries::Scaled { units, integers } => {
                for ((out, integer), unit) in out.iter_mut().zip(part(integers, range)).zip(units) {
                    let value = f32::from(i16::from_le_bytes(*integer)) * f32::from_le_bytes(*unit);
                    *out += factor * T::from_f32(value);
                }
            }
        }
    }
}

/// out <- out + factor times stored entries.
fn add_by<E: Copy, T: Real>(out: &mut [T], factor: T, entries: &[E], value: impl Fn(E) -> f32) {
    for (out, entry) in out.iter_mut().zip(entries) {
        *out += factor * T::from_f32(value(*entry));
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
    fn integers_read_in_the_units_of_their_columns() {
        let (units, integers) = ([0.5_f32, 1e-3], [3_i16, -2000, -32767, 7, 0, 1]);
        let mut bytes = [0_u8; 20];
        for (bytes, unit) in bytes.chunks_exact_mut(4).zip(units) {
            bytes.copy_from_slice(&unit.to_le_bytes());
        }
        for (bytes, integer) in bytes[8..].chunks_exact_mut(2).zip(integers) {
            bytes.copy_from_slice(&integer.to_le_bytes());
        }
        let view = MatrixView::new(&Matrix::new(3, 2, Encoding::I16, &bytes));
        let expected = [[1.5, -2.0], [-16383.5, 7e-3], [0.0, 1e-3]];
        let mut found = [0.0_f64; 3];
        view.multiply(0, &[2.0, 10.0], &mut found);
        for (row, [a, b]) in expected.into_iter().enumerate() {
            assert_eq!([view.get(row, 0), view.get(row, 1)], [a, b]);
            assert!((found[row] - f64::from(2.0 * a + 10.0 * b)).abs() < 1e-3);
        }
        assert_eq!((view.get(3, 0), view.get(0, 2)), (0.0, 0.0));
    }

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
