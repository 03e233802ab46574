//! Views that read numbers in place, from wherever the file lies.

use super::wire::{Blob, Digits, Encoding, Matrix};
use crate::Real;
use crate::linalg::{add_by, dots_by, part};

/// A stored matrix, row-major; the bytes need not be aligned.
#[derive(Clone, Copy, Debug)]
pub struct MatrixView<'a> {
    rows: usize,
    columns: usize,
    entries: Entries<'a>,
    units: Units<'a>,
}

#[derive(Clone, Copy, Debug)]
enum Entries<'a> {
    Singles(&'a [[u8; 4]]),
    /// Rows of `coarse` integers of two bytes, then of one.
    Integers {
        coarse: usize,
        bytes: &'a [u8],
    },
}

/// What the entries are multiples of.
#[derive(Clone, Copy, Debug)]
enum Units<'a> {
    One,
    OfColumns(&'a [[u8; 4]]),
    OfRows(&'a [[u8; 4]]),
}

impl Units<'_> {
    fn of_row(&self, row: usize) -> Option<f32> {
        match self {
            Self::OfRows(units) => units.get(row).copied().map(f32::from_le_bytes),
            _ => None,
        }
    }

    fn of_column(&self, column: usize) -> Option<f32> {
        match self {
            Self::OfColumns(units) => units.get(column).copied().map(f32::from_le_bytes),
            _ => None,
        }
    }
}

impl<'a> MatrixView<'a> {
    /// A view of a matrix; entries that its bytes do not hold read as 0.
    pub fn new(matrix: &Matrix<'a>) -> Self {
        let [rows, columns] = [matrix.rows, matrix.columns].map(|count| count as usize);
        let units = match matrix.encoding {
            Encoding::F32 => 0,
            Encoding::Columns(_) => columns,
            Encoding::Rows(_) => rows,
        };
        let (units, data) = matrix.blob.data.split_at_checked(4 * units).unwrap_or_default();
        let units = units.as_chunks().0;
        let integers = |digits: Digits| Entries::Integers {
            coarse: digits.coarse.into(),
            bytes: data,
        };
        let (units, entries) = match matrix.encoding {
            Encoding::F32 => (Units::One, Entries::Singles(data.as_chunks().0)),
            Encoding::Columns(digits) => (Units::OfColumns(units), integers(digits)),
            Encoding::Rows(digits) => (Units::OfRows(units), integers(digits)),
        };
        Self {
            rows,
            columns,
            entries,
            units,
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
        if column >= self.columns {
            return 0.0;
        }
        let entry = match self.entries {
            Entries::Singles(entries) => entries
                .get(row * self.columns + column)
                .copied()
                .map(f32::from_le_bytes),
            Entries::Integers { coarse, bytes } => {
                let (shorts, small) = integers(bytes, row, self.columns, coarse);
                match column.checked_sub(coarse) {
                    None => shorts.get(column).copied().map(short),
                    Some(place) => small.get(place).copied().map(self::small),
                }
            }
        };
        let unit = match self.units {
            Units::One => Some(1.0),
            Units::OfColumns(_) => self.units.of_column(column),
            Units::OfRows(_) => self.units.of_row(row),
        };
        entry.zip(unit).map_or(0.0, |(entry, unit)| entry * unit)
    }

    /// The first entry that does not lie within bounds, by its number and value. Where all that can be said in a unit lies
    /// within them, for every unit, no entry is looked at.
    pub(super) fn outside(&self, min: f32, max: f32) -> Option<(usize, f32)> {
        let greatest = 32768.0;
        let within = |unit: &[u8; 4]| {
            let reach = f32::from_le_bytes(*unit).abs() * greatest;
            min <= -reach && reach <= max
        };
        if let Units::OfColumns(units) | Units::OfRows(units) = self.units
            && units.iter().all(within)
        {
            return None;
        }
        // Rows without columns are as many as a file says.
        let rows = if self.columns > 0 { self.rows } else { 0 };
        for row in 0..rows {
            for column in 0..self.columns {
                let value = self.get(row, column);
                let within = min <= value && value <= max;
                if !within {
                    return Some((row * self.columns + column, value));
                }
            }
        }
        None
    }

    /// The rows of a matrix of two columns.
    pub fn pairs<T: Real>(self) -> impl Iterator<Item = [T; 2]> + use<'a, T> {
        (0..self.rows).map(move |row| [0, 1].map(|column| T::from_f32(self.get(row, column))))
    }

    /// x <- x times the units of the columns, where they have any: [`dot`](Self::dot) takes such vectors.
    pub(crate) fn scale<T: Real>(&self, x: &mut [T]) {
        for (column, x) in x.iter_mut().enumerate() {
            if let Some(unit) = self.units.of_column(column) {
                *x *= T::from_f32(unit);
            }
        }
    }

    /// Row times a [scaled](Self::scale) vector, over as many columns as the vector has.
    pub(crate) fn dot<T: Real>(&self, row: usize, x: &[T]) -> T {
        let [dot] = self.dots(row, [x]);
        dot
    }

    /// Row times some [scaled](Self::scale) vectors of the same length, in one pass over the row.
    pub(crate) fn dots<T: Real, const B: usize>(&self, row: usize, x: [&[T]; B]) -> [T; B] {
        let columns = x.first().map_or(0, |x| x.len());
        let sums = match self.entries {
            Entries::Singles(entries) => {
                let start = row * self.columns;
                let entries = part(entries, start..start + columns);
                dots_by(entries, x, |entry| T::from_f32(f32::from_le_bytes(entry)))
            }
            Entries::Integers { coarse, bytes } => {
                let (shorts, small) = integers(bytes, row, self.columns, coarse);
                let middle = coarse.min(columns);
                let leading = x.map(|x| part(x, 0..middle));
                let mut sums = dots_by(part(shorts, 0..middle), leading, |entry| T::from_f32(short(entry)));
                if middle < columns {
                    let trailing = x.map(|x| part(x, middle..columns));
                    let small = part(small, 0..columns - middle);
                    let rest = dots_by(small, trailing, |entry| T::from_f32(self::small(entry)));
                    for (sum, rest) in sums.iter_mut().zip(rest) {
                        *sum += rest;
                    }
                }
                sums
            }
        };
        match self.units.of_row(row) {
            Some(unit) => sums.map(|sum| sum * T::from_f32(unit)),
            None => sums,
        }
    }

    /// out <- the rows from `first` on times a [scaled](Self::scale) vector, as many as `out` holds.
    pub(crate) fn multiply<T: Real>(&self, first: usize, x: &[T], out: &mut [T]) {
        for (row, out) in out.iter_mut().enumerate() {
            *out = self.dot(first + row, x);
        }
    }

    /// out <- the sum of rows times factors.
    pub(crate) fn combine<T: Real>(&self, factors: impl Iterator<Item = (usize, T)>, out: &mut [T]) {
        out.fill(T::ZERO);
        for (row, factor) in factors {
            let factor = self.units.of_row(row).map_or(factor, |unit| factor * T::from_f32(unit));
            match self.entries {
                Entries::Singles(entries) => {
                    let start = row * self.columns;
                    let entries = part(entries, start..start + out.len());
                    add_by(out, factor, entries, |entry| T::from_f32(f32::from_le_bytes(entry)));
                }
                Entries::Integers { coarse, bytes } => {
                    let (shorts, small) = integers(bytes, row, self.columns, coarse);
                    let (leading, trailing) = out.split_at_mut(coarse.min(out.len()));
                    add_by(leading, factor, shorts, |entry| T::from_f32(short(entry)));
                    add_by(trailing, factor, small, |entry| T::from_f32(self::small(entry)));
                }
            }
        }
        self.scale(out);
    }
}

/// The integers of a row: of two bytes, then of one.
fn integers(bytes: &[u8], row: usize, columns: usize, coarse: usize) -> (&[[u8; 2]], &[u8]) {
    let length = columns + coarse;
    let row = part(bytes, row * length..(row + 1) * length);
    let (shorts, small) = row.split_at_checked(2 * coarse).unwrap_or_default();
    (shorts.as_chunks().0, small)
}

fn short(bytes: [u8; 2]) -> f32 {
    i16::from_le_bytes(bytes).into()
}

fn small(byte: u8) -> f32 {
    byte.cast_signed().into()
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

    /// The indices two by two.
    pub(crate) fn pairs(self) -> impl Iterator<Item = [usize; 2]> + use<'a> {
        let (pairs, _) = self.0.as_chunks::<2>();
        pairs
            .iter()
            .map(|pair| pair.map(|bytes| u16::from_le_bytes(bytes).into()))
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
        let view = MatrixView::new(&Matrix::new(3, 2, Encoding::Columns(Digits { coarse: 2 }), &bytes));
        let expected = [[1.5, -2.0], [-16383.5, 7e-3], [0.0, 1e-3]];
        let (mut x, mut found) = ([2.0, 10.0], [0.0_f64; 3]);
        view.scale(&mut x);
        view.multiply(0, &x, &mut found);
        for (row, [a, b]) in expected.into_iter().enumerate() {
            assert_eq!([view.get(row, 0), view.get(row, 1)], [a, b]);
            assert!((found[row] - f64::from(2.0 * a + 10.0 * b)).abs() < 1e-3);
        }
        assert_eq!((view.get(3, 0), view.get(0, 2)), (0.0, 0.0));
        let mut sum = [0.0_f64; 2];
        view.combine([(0, 2.0), (2, -1.0)].into_iter(), &mut sum);
        assert!((sum[0] - 3.0).abs() < 1e-6 && (sum[1] + 4.001).abs() < 1e-6, "{sum:?}");
    }

    #[test]
    fn a_row_has_integers_of_two_bytes_and_then_of_one() {
        // 300, -2, 100 | -5, 7, -128 in units of 0.5, 1, 2.
        let mut bytes = [0_u8; 20];
        for (bytes, unit) in bytes.chunks_exact_mut(4).zip([0.5_f32, 1.0, 2.0]) {
            bytes.copy_from_slice(&unit.to_le_bytes());
        }
        bytes[12..].copy_from_slice(&[44, 1, 254, 100, 251, 255, 7, 128]);
        let view = MatrixView::new(&Matrix::new(2, 3, Encoding::Columns(Digits { coarse: 1 }), &bytes));
        let rows = [[150.0, -2.0, 200.0], [-2.5, 7.0, -256.0]];
        for (row, entries) in rows.iter().enumerate() {
            assert_eq!([0, 1, 2].map(|column| view.get(row, column)), *entries);
            for columns in 1..=3 {
                let mut x = [3.0_f64, -1.0, 0.5];
                let exact: f64 = (0..columns).map(|k| x[k] * f64::from(entries[k])).sum();
                view.scale(&mut x);
                assert_eq!(view.dots(row, [&x[..columns], &x[..columns]]), [exact; 2]);
            }
        }
        let mut sum = [0.0_f64; 3];
        view.combine([(0, 1.0), (1, 2.0)].into_iter(), &mut sum);
        assert_eq!(sum, [145.0, 12.0, -312.0]);
    }

    #[test]
    fn integers_read_in_the_units_of_their_rows() {
        let mut bytes = [0_u8; 14];
        bytes[..4].copy_from_slice(&0.5_f32.to_le_bytes());
        bytes[4..8].copy_from_slice(&2.0_f32.to_le_bytes());
        let small = [3_i8, -128, 127, -1, 0, 5];
        bytes[8..].copy_from_slice(&small.map(i8::cast_unsigned));
        let view = MatrixView::new(&Matrix::new(2, 3, Encoding::Rows(Digits { coarse: 0 }), &bytes));
        assert_eq!([view.get(0, 1), view.get(1, 2), view.get(2, 0)], [-64.0, 10.0, 0.0]);
        let mut found = [0.0_f32; 2];
        view.multiply(0, &[1.0, 0.0, 2.0], &mut found);
        assert_eq!(found, [1.5 + 127.0, -2.0 + 20.0]);
        view.multiply(0, &[1.0, 1.0], &mut found);
        assert_eq!(found, [1.5 - 64.0, -2.0], "the leading columns");
        let mut sum = [0.0_f32; 3];
        view.combine([(1, 0.5)].into_iter(), &mut sum);
        assert_eq!(sum, [-1.0, 0.0, 5.0]);
    }

    #[test]
    fn an_entry_out_of_bounds_is_found_whatever_its_unit() {
        let first = |encoding, bytes: &[u8]| MatrixView::new(&Matrix::new(2, 2, encoding, bytes)).outside(-10.0, 10.0);
        let file = |units: [f32; 2], integers: &[u8]| {
            let mut bytes = [0; 16];
            bytes[..4].copy_from_slice(&units[0].to_le_bytes());
            bytes[4..8].copy_from_slice(&units[1].to_le_bytes());
            bytes[8..8 + integers.len()].copy_from_slice(integers);
            bytes
        };
        let [two, one] = [2, 0].map(|coarse| Digits { coarse });
        let shorts = [1, 0, 2, 0, 3, 0, 4, 0];
        for encoding in [Encoding::Columns(two), Encoding::Rows(two)] {
            assert_eq!(first(encoding, &file([1e-4, 1e-4], &shorts)), None);
            // The unit could carry more than there is.
            assert_eq!(first(encoding, &file([1.0, 1.0], &shorts)), None);
            assert!(first(encoding, &file([1.0, f32::NAN], &shorts)).is_some());
        }
        assert_eq!(
            first(Encoding::Columns(two), &file([4.0, 1.0], &shorts)),
            Some((2, 12.0))
        );
        assert_eq!(first(Encoding::Rows(two), &file([1.0, 4.0], &shorts)), Some((2, 12.0)));
        assert_eq!(
            first(Encoding::Rows(one), &file([0.01, 4.0], &[127, 1, 2, 253])[..12]),
            Some((3, -12.0))
        );
        assert_eq!(
            first(Encoding::Rows(one), &file([0.01, 4.0], &[127, 1, 2, 2])[..12]),
            None
        );
    }
}
