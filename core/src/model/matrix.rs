//! Views that read numbers in place, from wherever the file lies.

use super::wire::{Blob, Encoding, Matrix};
use crate::Real;
use crate::linalg::{LANES, add_products, part, sum};

/// A stored matrix, row-major, read byte by byte: it need not be aligned.
#[derive(Clone, Copy, Debug)]
pub struct MatrixView<'a> {
    rows: usize,
    columns: usize,
    /// The units of the columns of integers; none of singles.
    units: &'a [[u8; 4]],
    entries: Entries<'a>,
}

#[derive(Clone, Copy, Debug)]
enum Entries<'a> {
    Singles(&'a [[u8; 4]]),
    Integers(&'a [[u8; 2]]),
}

impl<'a> MatrixView<'a> {
    /// A view of a matrix; entries that its bytes do not hold read as 0.
    pub fn new(matrix: &Matrix<'a>) -> Self {
        let data = matrix.blob.data;
        let (units, entries) = match matrix.encoding {
            Encoding::F32 => (Default::default(), Entries::Singles(data.as_chunks().0)),
            Encoding::I16 => {
                let (units, integers) = data.split_at_checked(4 * matrix.columns as usize).unwrap_or_default();
                (units.as_chunks().0, Entries::Integers(integers.as_chunks().0))
            }
        };
        Self {
            rows: matrix.rows as usize,
            columns: matrix.columns as usize,
            units,
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
            Entries::Singles(entries) => entries.get(index).map_or(0.0, |bytes| single(*bytes)),
            Entries::Integers(entries) => match (self.units.get(column), entries.get(index)) {
                (Some(unit), Some(bytes)) => single(*unit) * integer(*bytes),
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

    /// `R` rows from `first` on times a vector as long as they are. They share each product of a unit and an entry of the
    /// vector.
    pub(crate) fn dots<T: Real, const R: usize>(&self, first: usize, x: &[T]) -> [T; R] {
        let starts = core::array::from_fn(|row| (first + row) * self.columns);
        let ranges = starts.map(|start| start..start + self.columns);
        match self.entries {
            Entries::Singles(entries) => {
                let rows = ranges.map(|range| part(entries, range));
                self.products(rows, x, |bytes| T::from_f32(single(bytes)))
            }
            Entries::Integers(entries) => {
                let rows = ranges.map(|range| part(entries, range));
                self.products(rows, x, |bytes| T::from_f32(integer(bytes)))
            }
        }
    }

    fn products<E: Copy, T: Real, const R: usize>(
        &self,
        rows: [&[E]; R],
        x: &[T],
        value: impl Fn(E) -> T + Copy,
    ) -> [T; R] {
        let mut lanes = [[T::ZERO; LANES]; R];
        let rows = rows.map(|row| row.as_chunks::<LANES>());
        let (units, units_rest) = self.units.as_chunks::<LANES>();
        let (x, x_rest) = x.as_chunks::<LANES>();
        for (chunk, x) in x.iter().enumerate() {
            let x = units.get(chunk).map_or(*x, |units| scaled(units, x));
            for (lanes, (chunks, _)) in lanes.iter_mut().zip(rows) {
                if let Some(entries) = chunks.get(chunk) {
                    *lanes = add_products(*lanes, entries.map(value), x);
                }
            }
        }
        for (lane, x) in x_rest.iter().enumerate() {
            let x = units_rest.get(lane).map_or(*x, |unit| T::from_f32(single(*unit)) * *x);
            for (lanes, (_, rest)) in lanes.iter_mut().zip(rows) {
                if let (Some(sum), Some(entry)) = (lanes.get_mut(lane), rest.get(lane)) {
                    *sum += value(*entry) * x;
                }
            }
        }
        lanes.map(total)
    }

    /// Row times vector, over the row's columns.
    pub(crate) fn dot<T: Real>(&self, row: usize, x: &[T]) -> T {
        let [product] = self.dots(row, x);
        product
    }

    /// out <- the rows from `first` on times a vector, as many as `out` holds.
    pub(crate) fn multiply<T: Real>(&self, first: usize, x: &[T], out: &mut [T]) {
        let (triples, rest) = out.as_chunks_mut::<3>();
        let done = 3 * triples.len();
        for (triple, out) in triples.iter_mut().enumerate() {
            *out = self.dots(first + 3 * triple, x);
        }
        for (row, out) in rest.iter_mut().enumerate() {
            *out = self.dot(first + done + row, x);
        }
    }

    /// out <- out + factor times a row.
    pub(crate) fn add_row<T: Real>(&self, row: usize, factor: T, out: &mut [T]) {
        let range = row * self.columns..(row + 1) * self.columns;
        match self.entries {
            Entries::Singles(entries) => {
                for (entry, out) in part(entries, range).iter().zip(out) {
                    *out += factor * T::from_f32(single(*entry));
                }
            }
            Entries::Integers(entries) => {
                for ((entry, unit), out) in part(entries, range).iter().zip(self.units).zip(out) {
                    *out += factor * T::from_f32(single(*unit) * integer(*entry));
                }
            }
        }
    }
}

fn single(bytes: [u8; 4]) -> f32 {
    f32::from_le_bytes(bytes)
}

fn integer(bytes: [u8; 2]) -> f32 {
    i16::from_le_bytes(bytes).into()
}

/// The sum of the lanes, apart from the loop: with it in view, compilers vectorise the loop in halves of a vector.
#[inline(never)]
fn total<T: Real>(lanes: [T; LANES]) -> T {
    sum(lanes)
}

/// x times units, lane by lane.
fn scaled<T: Real>(units: &[[u8; 4]; LANES], x: &[T; LANES]) -> [T; LANES] {
    core::array::from_fn(|lane| T::from_f32(single(units[lane])) * x[lane])
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
            assert_eq!(view.get(1, 2), -0.5);
            view.multiply(0, &x, found);
        }
        assert_eq!(found[0], found[1]);
        assert!((found[0][0] - (0.15 - 1.4 - 4.225)).abs() < 1e-6);
    }
}
