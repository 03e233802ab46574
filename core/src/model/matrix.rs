//! Views that read numbers in place, from wherever the file lies.

use super::wire::{Blob, Digits, Encoding, Matrix};
use crate::Real;
use crate::linalg::{
    IN_PAIRS, LANES, add_by, add_panel, add_panels, add_whole_panels, in_vectors, part, part_mut, whole_panel,
};
use core::ops::Range;

/// A stored matrix; the bytes need not be aligned.
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
    Rows(Integers<'a>),
    Panels(Integers<'a>),
}

/// Rows, or panels, of `coarse` columns of two bytes and then of one.
#[derive(Clone, Copy, Debug)]
struct Integers<'a> {
    coarse: usize,
    bytes: &'a [u8],
}

impl<'a> Integers<'a> {
    /// Row number `row` of `columns`.
    fn row(&self, row: usize, columns: usize) -> (&'a [[u8; 2]], &'a [u8]) {
        let (shorts, small) = self.split(row, columns + self.coarse, 2 * self.coarse);
        (shorts.as_chunks().0, small)
    }

    /// Panel number `panel` of `columns`.
    fn panel(&self, panel: usize, columns: usize) -> (&'a [[[u8; 2]; LANES]], &'a [[u8; LANES]]) {
        let length = LANES * (columns + self.coarse);
        let (shorts, small) = self.split(panel, length, 2 * LANES * self.coarse);
        (shorts.as_chunks().0.as_chunks().0, small.as_chunks().0)
    }

    /// Part number `number` of the bytes, all of this length, in two.
    fn split(&self, number: usize, length: usize, middle: usize) -> (&'a [u8], &'a [u8]) {
        let part = part(self.bytes, number * length..(number + 1) * length);
        part.split_at_checked(middle).unwrap_or_default()
    }
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

/// At most `K` entries of `B` vectors, the first of each, then the second ones ..., for products with a matrix.
#[derive(Clone, Debug)]
pub(crate) struct Vectors<T: Real, const K: usize, const B: usize = 1> {
    pub(crate) values: [[T; B]; K],
    /// Those that meet entries of one byte, as multiples of a unit without a fraction.
    wholes: [[T::Whole; B]; K],
    units: [T; B],
}

/// The leading entries of vectors that are ready for products.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Factors<'s, T: Real, const B: usize = 1> {
    values: &'s [[T; B]],
    wholes: &'s [[T::Whole; B]],
    units: [T; B],
}

impl<T: Real, const K: usize, const B: usize> Vectors<T, K, B> {
    pub(crate) const ZERO: Self = Self {
        values: [[T::ZERO; B]; K],
        wholes: [[T::NO_WHOLE; B]; K],
        units: [T::ZERO; B],
    };

    /// Makes the leading entries ready for products with a matrix: takes the units of its columns into them, and says those
    /// that meet entries of one byte in wholes. Where one is not finite, no product will be a number.
    pub(crate) fn ready(&mut self, matrix: &MatrixView<'_>, count: usize) {
        let values = part_mut(&mut self.values, 0..count);
        for (column, values) in values.iter_mut().enumerate() {
            if let Some(unit) = matrix.units.of_column(column) {
                values.iter_mut().for_each(|value| *value *= T::from_f32(unit));
            }
        }
        let coarse = matrix.coarse();
        for (b, unit) in self.units.iter_mut().enumerate() {
            let fine = values.iter().zip(&mut self.wholes).skip(coarse);
            let sum = values.iter().skip(coarse).fold(T::ZERO, |sum, x| sum + x[b].abs());
            let inverse = if sum > T::ZERO {
                T::GREATEST_WHOLE / sum
            } else {
                T::ZERO
            };
            for (value, whole) in fine {
                let multiple = value[b] * inverse;
                let half = T::from_f32(if multiple < T::ZERO { -0.5 } else { 0.5 });
                whole[b] = (multiple + half).to_whole();
            }
            *unit = sum / T::GREATEST_WHOLE;
        }
    }

    /// As many leading entries.
    pub(crate) fn factors(&self, count: usize) -> Factors<'_, T, B> {
        Factors {
            values: part(&self.values, 0..count),
            wholes: part(&self.wholes, 0..count),
            units: self.units,
        }
    }
}

impl<'a> MatrixView<'a> {
    /// A view of a matrix; entries that its bytes do not hold read as 0.
    pub fn new(matrix: &Matrix<'a>) -> Self {
        let (rows, columns) = (matrix.rows as usize, matrix.columns as usize);
        let units = match matrix.encoding {
            Encoding::F32 => 0,
            Encoding::Columns(_) | Encoding::ColumnPanels(_) => columns,
            Encoding::RowPanels(_) => rows,
        };
        let (units, data) = matrix.blob.data.split_at_checked(4 * units).unwrap_or_default();
        let units = units.as_chunks().0;
        let integers = |digits: Digits| Integers {
            coarse: digits.coarse.into(),
            bytes: data,
        };
        let (units, entries) = match matrix.encoding {
            Encoding::F32 => (Units::One, Entries::Singles(data.as_chunks().0)),
            Encoding::Columns(digits) => (Units::OfColumns(units), Entries::Rows(integers(digits))),
            Encoding::ColumnPanels(digits) => (Units::OfColumns(units), Entries::Panels(integers(digits))),
            Encoding::RowPanels(digits) => (Units::OfRows(units), Entries::Panels(integers(digits))),
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
        let unit = match self.units {
            Units::One => Some(1.0),
            Units::OfColumns(_) => self.units.of_column(column),
            Units::OfRows(_) => self.units.of_row(row),
        };
        self.entry(row, column) * unit.unwrap_or(0.0)
    }

    /// Entry (row, column) in its unit; 0 outside.
    fn entry(&self, row: usize, column: usize) -> f32 {
        if row >= self.rows || column >= self.columns {
            return 0.0;
        }
        let integer = |shorts: Option<[u8; 2]>, small: Option<u8>| shorts.map(short).or(small.map(self::small));
        let entry = match self.entries {
            Entries::Singles(entries) => entries
                .get(row * self.columns + column)
                .copied()
                .map(f32::from_le_bytes),
            Entries::Rows(integers) => {
                let (shorts, small) = integers.row(row, self.columns);
                let place = column.wrapping_sub(integers.coarse);
                integer(shorts.get(column).copied(), small.get(place).copied())
            }
            Entries::Panels(integers) => {
                let (shorts, small) = integers.panel(row / LANES, self.columns);
                let place = column.wrapping_sub(integers.coarse);
                let lane = row % LANES;
                integer(shorts.get(column).map(|c| c[lane]), small.get(place).map(|c| c[lane]))
            }
        };
        entry.unwrap_or(0.0)
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

    /// x <- x times the units of the columns, where they have any.
    fn scale<T: Real>(&self, x: &mut [T]) {
        for (column, x) in x.iter_mut().enumerate() {
            if let Some(unit) = self.units.of_column(column) {
                *x *= T::from_f32(unit);
            }
        }
    }

    /// How many of the leading columns are multiplied as they are.
    fn coarse(&self) -> usize {
        match self.entries {
            Entries::Panels(integers) => integers.coarse,
            Entries::Singles(_) | Entries::Rows(_) => self.columns,
        }
    }

    /// Row times a vector, over as many columns as the vector has. The bits are those of its [panel](Self::panel).
    pub(crate) fn dot<T: Real>(&self, row: usize, x: Factors<'_, T>) -> T {
        let values = x.values.as_flattened();
        let sum = match self.entries {
            Entries::Panels(integers) => {
                let (shorts, small) = integers.panel(row / LANES, self.columns);
                let lane = row % LANES;
                let shorts = shorts.iter().map(|column| short(column[lane])).zip(values);
                let sum = shorts.fold(T::ZERO, |sum, (entry, x)| sum + T::from_f32(entry) * *x);
                let wholes = x.wholes.as_flattened().iter().skip(integers.coarse);
                let small = small.iter().map(|column| column[lane].cast_signed()).zip(wholes);
                let whole = small.fold(T::NO_WHOLE, |sum, (entry, x)| T::add_product(sum, entry, *x));
                let [unit] = x.units;
                sum + unit * T::from_whole(whole)
            }
            Entries::Singles(entries) => {
                let start = row * self.columns;
                let entries = part(entries, start..start + values.len()).iter().zip(values);
                entries.fold(T::ZERO, |sum, (entry, x)| {
                    sum + T::from_f32(f32::from_le_bytes(*entry)) * *x
                })
            }
            Entries::Rows(_) => {
                let entries = values.iter().enumerate();
                entries.fold(T::ZERO, |sum, (column, x)| {
                    sum + T::from_f32(self.entry(row, column)) * *x
                })
            }
        };
        self.units.of_row(row).map_or(sum, |unit| sum * T::from_f32(unit))
    }

    /// products <- the eight rows of each of some panels times some vectors, over as many columns as these have. A panel's bits
    /// do not depend on the others.
    #[inline(always)]
    pub(crate) fn panels<T: Real, const B: usize, const P: usize>(
        &self,
        panels: [usize; P],
        x: Factors<'_, T, B>,
        products: &mut [[[T; LANES]; B]; P],
    ) {
        if let Entries::Panels(integers) = self.entries
            && IN_PAIRS
        {
            self.side_by_side(&integers, panels, x, products);
        } else {
            for (panel, products) in panels.iter().zip(products) {
                self.panel(*panel, x, products);
            }
        }
    }

    #[inline(never)]
    fn panel<T: Real, const B: usize>(&self, panel: usize, x: Factors<'_, T, B>, products: &mut [[T; LANES]; B]) {
        if let Entries::Panels(integers) = self.entries {
            let (shorts, small) = integers.panel(panel, self.columns);
            let wholes = part(x.wholes, integers.coarse..x.wholes.len());
            let whole_sums: [_; B] = core::array::from_fn(|b| whole_panel::<T, B>(small, wholes, b));
            let mut sums = [[T::ZERO; LANES]; B];
            add_panel(shorts, x.values, |entry| T::from_f32(short(entry)), &mut sums);
            for (b, products) in products.iter_mut().enumerate() {
                *products = add_wholes(sums[b], &whole_sums[b], x.units[b]);
            }
        } else {
            *products = [[T::ZERO; LANES]; B];
            for (column, x) in x.values.iter().enumerate() {
                let entries = core::array::from_fn(|lane| self.entry(LANES * panel + lane, column));
                add_panel(&[entries], &[*x], T::from_f32, products);
            }
        }
        self.scale_rows(panel, products);
    }

    #[inline(never)]
    fn side_by_side<T: Real, const B: usize, const P: usize>(
        &self,
        integers: &Integers<'_>,
        panels: [usize; P],
        x: Factors<'_, T, B>,
        products: &mut [[[T; LANES]; B]; P],
    ) {
        *products = in_vectors(
            #[inline(always)]
            || {
                let mut sums = [[[T::ZERO; LANES]; B]; P];
                let parts = panels.map(|panel| integers.panel(panel, self.columns));
                let (shorts, small) = (parts.map(|(shorts, _)| shorts), parts.map(|(_, small)| small));
                add_panels(shorts, x.values, |entry| T::from_f32(short(entry)), &mut sums);
                let mut whole_sums = [[[T::NO_WHOLE; LANES]; B]; P];
                let wholes = part(x.wholes, integers.coarse..x.wholes.len());
                add_whole_panels::<T, B, P>(small, wholes, &mut whole_sums);
                for (whole_sums, sums) in whole_sums.iter().zip(&mut sums) {
                    for ((whole_sums, unit), sums) in whole_sums.iter().zip(x.units).zip(sums) {
                        *sums = add_wholes(*sums, whole_sums, unit);
                    }
                }
                sums
            },
        );
        for (panel, products) in panels.into_iter().zip(products) {
            self.scale_rows(panel, products);
        }
    }

    /// Products with a panel times the units of its rows, where they have any.
    #[inline(always)]
    fn scale_rows<T: Real, const B: usize>(&self, panel: usize, products: &mut [[T; LANES]; B]) {
        if let Units::OfRows(units) = self.units {
            // Rows beyond the last one are zeros.
            let units = part(units, LANES * panel..units.len());
            for products in products {
                for (product, unit) in products.iter_mut().zip(units) {
                    *product *= T::from_f32(f32::from_le_bytes(*unit));
                }
            }
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
                Entries::Rows(integers) => {
                    let (shorts, small) = integers.row(row, self.columns);
                    let (leading, trailing) = out.split_at_mut(integers.coarse.min(out.len()));
                    add_by(leading, factor, shorts, |entry| T::from_f32(short(entry)));
                    add_by(trailing, factor, small, |entry| T::from_f32(self::small(entry)));
                }
                Entries::Panels(_) => {
                    for (column, out) in out.iter_mut().enumerate() {
                        *out += factor * T::from_f32(self.entry(row, column));
                    }
                }
            }
        }
        self.scale(out);
    }
}

/// lanes + a unit times sums of wholes. Written out, for the reason of the products' columns.
#[inline(always)]
fn add_wholes<T: Real>(
    [l0, l1, l2, l3, l4, l5, l6, l7]: [T; LANES],
    [w0, w1, w2, w3, w4, w5, w6, w7]: &[T::Whole; LANES],
    unit: T,
) -> [T; LANES] {
    let add = |lane: T, whole: &T::Whole| lane + unit * T::from_whole(*whole);
    [
        add(l0, w0),
        add(l1, w1),
        add(l2, w2),
        add(l3, w3),
        add(l4, w4),
        add(l5, w5),
        add(l6, w6),
        add(l7, w7),
    ]
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

    /// Those in a range; none where there are not as many.
    pub(super) fn part(&self, range: Range<usize>) -> Self {
        Self(part(self.0, range))
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
    extern crate std;
    use super::*;
    use std::vec::Vec;

    const ROWS: usize = 11;
    const COLUMNS: usize = 5;
    const DIGITS: Digits = Digits { coarse: 2 };
    const ENCODINGS: [Encoding; 3] = [
        Encoding::Columns(DIGITS),
        Encoding::ColumnPanels(DIGITS),
        Encoding::RowPanels(DIGITS),
    ];

    /// An integer of two bytes in the first two columns, of one in the others.
    fn integer(row: usize, column: usize) -> i16 {
        let any = (row * 7919 + column * 104_729 + 13) % 65_521;
        if column < 2 {
            (any as i32 - 32_760) as i16
        } else {
            (any % 256) as i16 - 128
        }
    }

    fn unit(i: usize) -> f32 {
        [0.25, 0.125, 0.0625, 0.031_25][i % 4]
    }

    /// The matrix in an encoding, and its entries.
    fn stored(encoding: Encoding) -> (Vec<u8>, [[f64; COLUMNS]; ROWS]) {
        let of_rows = matches!(encoding, Encoding::RowPanels(_));
        let height = if matches!(encoding, Encoding::Columns(_)) {
            1
        } else {
            LANES
        };
        let units = 0..if of_rows { ROWS } else { COLUMNS };
        let mut bytes: Vec<u8> = units.flat_map(|i| unit(i).to_le_bytes()).collect();
        for first in (0..ROWS).step_by(height) {
            for column in 0..COLUMNS {
                for row in first..first + height {
                    let entry = if row < ROWS { integer(row, column) } else { 0 };
                    let width = if column < 2 { 2 } else { 1 };
                    bytes.extend(&entry.to_le_bytes()[..width]);
                }
            }
        }
        let entry = |row, column| f64::from(integer(row, column)) * f64::from(unit(if of_rows { row } else { column }));
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
                    let mut ready = Vectors::<f64, COLUMNS, 3>::ZERO;
                    for (b, vector) in vectors.into_iter().enumerate() {
                        vector.iter().enumerate().for_each(|(k, x)| ready.values[k][b] = *x);
                    }
                    ready.ready(&view, columns);
                    ready
                };
                let interleaved = vectors(plain.each_ref().map(Vec::as_slice));
                let mut together = [[[0.0; LANES]; 3]; 2];
                view.panels([0, 1], interleaved.factors(columns), &mut together);
                for (panel, together) in together.iter().enumerate() {
                    for lane in 0..LANES {
                        let row = LANES * panel + lane;
                        for b in 0..3 {
                            let exact: f64 = entries.get(row).map_or(0.0, |entries| {
                                entries.iter().zip(&plain[b]).map(|(entry, x)| entry * x).sum()
                            });
                            let mut single = Vectors::<f64, COLUMNS>::ZERO;
                            single.values.as_flattened_mut()[..columns].copy_from_slice(&plain[b]);
                            single.ready(&view, columns);
                            let mut products = [[[0.0; LANES]; 1]];
                            view.panels([panel], single.factors(columns), &mut products);
                            let [[alone]] = products;
                            assert!((together[b][lane] - exact).abs() <= 1e-9, "{encoding:?} {row}");
                            let dot = view.dot(row, single.factors(columns));
                            assert_eq!([alone[lane], dot], [together[b][lane]; 2]);
                        }
                    }
                }
                let mut sum = std::vec![0.0_f64; columns];
                view.combine([(0, 2.0), (9, -1.0)].into_iter(), &mut sum);
                for (column, sum) in sum.iter().enumerate() {
                    let exact = 2.0 * entries[0][column] - entries[9][column];
                    assert!((sum - exact).abs() < 1e-9, "{encoding:?} {column}");
                }
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
    fn wholes_lose_half_a_unit_each_at_most_and_no_sum_overflows() {
        // The greatest entries there are, along and against factors that are far apart.
        const MOST: usize = 96;
        for entry in [i8::MIN, i8::MAX] {
            let mut bytes: Vec<u8> = (0..MOST).flat_map(|_| 1.0_f32.to_le_bytes()).collect();
            bytes.extend(core::iter::repeat_n(entry as u8, MOST * LANES));
            let encoding = Encoding::ColumnPanels(Digits { coarse: 0 });
            let view = MatrixView::new(&Matrix::new(LANES as u32, MOST as u32, encoding, &bytes));
            for sign in [1.0_f32, -1.0] {
                let mut x = Vectors::<f32, MOST>::ZERO;
                let factor = |k: usize| sign.powi(k as i32) * 3.0 * 0.9_f32.powi(k as i32);
                (0..MOST).for_each(|k| x.values[k][0] = factor(k));
                x.ready(&view, MOST);
                let sum = |size: &dyn Fn(f64) -> f64| (0..MOST).map(|k| size(factor(k).into())).sum::<f64>();
                let exact = f64::from(entry) * sum(&|x| x);
                let found = f64::from(view.dot(0, x.factors(MOST)));
                let greatest = 128.0 * sum(&f64::abs);
                let unit = greatest / f64::from(f32::GREATEST_WHOLE);
                let rounding = 4.0 * f64::from(f32::EPSILON) * greatest;
                let error = (found - exact).abs();
                assert!(
                    error < 0.5 * MOST as f64 * unit + rounding,
                    "{entry} {sign}: {found} {exact}"
                );
            }
        }
    }

    #[test]
    fn what_is_not_finite_gives_no_number() {
        let (bytes, _) = stored(Encoding::ColumnPanels(DIGITS));
        let view = view(Encoding::ColumnPanels(DIGITS), &bytes);
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            for column in 0..COLUMNS {
                let mut x = Vectors::<f32, COLUMNS>::ZERO;
                x.values[column][0] = value;
                x.ready(&view, COLUMNS);
                assert!(!view.dot(1, x.factors(COLUMNS)).is_finite(), "{value} {column}");
            }
        }
    }

    #[test]
    fn an_entry_out_of_bounds_is_found_whatever_its_unit() {
        for encoding in ENCODINGS {
            let (mut bytes, entries) = stored(encoding);
            let greatest = entries.as_flattened().iter().fold(0.0, |a: f64, x| a.max(x.abs())) as f32;
            let outside = |bytes: &[u8], bound: f32| view(encoding, bytes).outside(-bound, bound);
            // The units could carry more than there is.
            assert_eq!(outside(&bytes, greatest), None);
            let (index, value) = outside(&bytes, 0.999 * greatest).unwrap();
            assert_eq!(f64::from(value), entries[index / COLUMNS][index % COLUMNS]);
            bytes[4..8].copy_from_slice(&f32::NAN.to_le_bytes());
            assert!(outside(&bytes, 1e9).is_some());
        }
    }
}
