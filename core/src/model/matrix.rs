//! Views that read numbers in place, from wherever the file lies.

use super::wire::{Blob, Digits, Encoding, Matrix};
use crate::Real;
use crate::linalg::{Block, IN_PAIRS, LANES, add_by, slice_or_empty, slice_or_empty_mut};
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
    Panels(Integers<'a>),
    Transposed(Integers<'a>),
}

/// Panels of `coarse` columns of two digits and then of columns of one, or of their transpose.
#[derive(Clone, Copy, Debug)]
struct Integers<'a> {
    coarse: usize,
    bytes: &'a [u8],
}

/// What the first of two digits counts.
const BASE: f32 = 256.0;

impl<'a> Integers<'a> {
    /// Panel number `number` of the transpose, which has as many columns as the matrix has `rows`.
    fn across(&self, number: usize, rows: usize) -> &'a [Block] {
        self.blocks(number, rows.div_ceil(2))
    }

    /// Panel number `panel` of `columns`.
    fn panel(&self, panel: usize, columns: usize) -> &'a [Block] {
        self.blocks(panel, self.pairs(columns))
    }

    /// Panel number `number` of panels of `count` blocks.
    fn blocks(&self, number: usize, count: usize) -> &'a [Block] {
        let length = size_of::<Block>() * count;
        let bytes = slice_or_empty(self.bytes, number * length..(number + 1) * length);
        bytes.as_chunks().0.as_chunks().0
    }

    /// How many pairs so many leading columns are: one of two digits is one.
    fn pairs(&self, columns: usize) -> usize {
        let coarse = columns.min(self.coarse);
        coarse + (columns - coarse).div_ceil(2)
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
    /// What they are in units without a fraction: a pair for every two columns of one digit, or for one column of two.
    pairs: [[T::Pair; B]; K],
    units: [T; B],
    /// How many values and how many pairs are ready.
    counts: [usize; 2],
}

/// Vectors that are ready for products.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Factors<'s, T: Real, const B: usize = 1> {
    values: &'s [[T; B]],
    pairs: &'s [[T::Pair; B]],
    units: [T; B],
}

impl<T: Real, const K: usize, const B: usize> Vectors<T, K, B> {
    pub(crate) const ZERO: Self = Self {
        values: [[T::ZERO; B]; K],
        pairs: [[T::NO_PAIR; B]; K],
        units: [T::ZERO; B],
        counts: [0; 2],
    };

    /// Makes the leading entries ready for products with a matrix: takes the units of its columns into them, and says
    /// them in wholes. Where one is not finite, no product will be a number.
    pub(crate) fn ready(&mut self, matrix: &MatrixView<'_>, count: usize) {
        let values = slice_or_empty_mut(&mut self.values, 0..count);
        self.counts = [values.len(), 0];
        if let Units::OfColumns(units) = matrix.units {
            for (values, unit) in values.iter_mut().zip(units) {
                let unit = T::from_f32(f32::from_le_bytes(*unit));
                values.iter_mut().for_each(|value| *value *= unit);
            }
        }
        let Entries::Panels(integers) = matrix.entries else {
            return;
        };
        let base = T::from_f32(BASE);
        let (coarse, fine) = values.split_at(integers.coarse.min(values.len()));
        for (b, unit) in self.units.iter_mut().enumerate() {
            let mut factors = FactorsOf::NONE;
            coarse.iter().for_each(|x| factors.include(base * x[b]));
            fine.iter().for_each(|x| factors.include(x[b]));
            *unit = factors.unit();
            let scale = factors.scale();
            let (of_coarse, of_fine) = self.pairs.split_at_mut(coarse.len());
            for (pair, x) in of_coarse.iter_mut().zip(coarse) {
                let x = scale * x[b];
                pair[b] = T::pair(base * x, x);
            }
            let (twos, last) = fine.as_chunks::<2>();
            for (pair, [x, y]) in of_fine.iter_mut().zip(twos) {
                pair[b] = T::pair(scale * x[b], scale * y[b]);
            }
            for (pair, x) in of_fine.iter_mut().skip(twos.len()).zip(last) {
                pair[b] = T::pair(scale * x[b], T::ZERO);
            }
        }
        self.counts[1] = integers.pairs(count);
    }

    /// The entries that are ready.
    pub(crate) fn factors(&self) -> Factors<'_, T, B> {
        let [values, pairs] = self.counts;
        Factors {
            values: slice_or_empty(&self.values, 0..values),
            pairs: slice_or_empty(&self.pairs, 0..pairs),
            units: self.units,
        }
    }
}

/// What makes numbers factors of products with digits: multiples of a unit, to the nearest.
#[derive(Clone, Copy, Debug)]
struct FactorsOf<T> {
    greatest: T,
    sum: T,
}

impl<T: Real> FactorsOf<T> {
    const NONE: Self = Self {
        greatest: T::ZERO,
        sum: T::ZERO,
    };

    fn include(&mut self, number: T) {
        self.greatest = self.greatest.max(number.abs());
        self.sum += number;
    }

    /// Not a number if one of the numbers is not finite.
    fn unit(&self) -> T {
        self.greatest / T::MAX_FACTOR + T::ZERO * self.sum
    }

    /// What a number is multiplied by.
    fn scale(&self) -> T {
        if self.greatest > T::ZERO {
            T::MAX_FACTOR / self.greatest
        } else {
            T::ZERO
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
            Encoding::Columns(digits) => (Units::OfColumns(units), Entries::Transposed(integers(digits))),
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
        let entry = match self.entries {
            Entries::Singles(entries) => entries
                .get(row * self.columns + column)
                .copied()
                .map(f32::from_le_bytes),
            Entries::Transposed(integers) => {
                let across = |place: usize| digit(integers.across(place / LANES, self.rows), row, place % LANES);
                let last = across(column).map(value);
                if column < integers.coarse {
                    last.zip(across(self.columns + column))
                        .map(|(last, first)| BASE * value(first) + last)
                } else {
                    last
                }
            }
            Entries::Panels(integers) => {
                let panel = integers.panel(row / LANES, self.columns);
                let at = |place| digit(panel, place, row % LANES).map(value);
                if column < integers.coarse {
                    let [first, last] = [0, 1].map(|next| at(2 * column + next));
                    first.zip(last).map(|(first, last)| BASE * first + last)
                } else {
                    at(integers.coarse + column)
                }
            }
        };
        entry.unwrap_or(0.0)
    }

    /// The first entry that does not lie within bounds, by its number and value. Where all that can be said in a unit
    /// lies within them, for every unit, no entry is looked at.
    pub(super) fn outside(&self, min: f32, max: f32) -> Option<(usize, f32)> {
        let greatest = BASE * 128.0 + 128.0;
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

    /// Row times a vector. The bits are those of its [panel](Self::panels).
    pub(crate) fn dot<T: Real>(&self, row: usize, x: Factors<'_, T>) -> T {
        if let Entries::Panels(integers) = self.entries {
            let panel = integers.panel(row / LANES, self.columns);
            let lane = row % LANES;
            let [unit] = x.units;
            let sum = panel.iter().zip(x.pairs).fold(T::NO_WHOLE, |sum, (block, [pair])| {
                let word = block.get(lane / 2).copied().unwrap_or_default();
                let [first, second] = T::add_products([sum; 2], word, *pair);
                if lane.is_multiple_of(2) { first } else { second }
            });
            return self.of_row(row, unit * T::from_whole(sum));
        }
        self.plain(row, x.values.as_flattened().iter().copied())
    }

    /// Row times a vector, entry by entry.
    fn plain<T: Real>(&self, row: usize, x: impl ExactSizeIterator<Item = T>) -> T {
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
        self.of_row(row, sum)
    }

    /// A product with a row times its unit, if it has one.
    fn of_row<T: Real>(&self, row: usize, product: T) -> T {
        self.units
            .of_row(row)
            .map_or(product, |unit| product * T::from_f32(unit))
    }

    /// products <- the eight rows of each of some panels times some vectors. A panel's bits do not depend on the
    /// others.
    #[inline(always)]
    pub(crate) fn panels<T: Real, const B: usize, const P: usize>(
        &self,
        panels: [usize; P],
        x: Factors<'_, T, B>,
        products: &mut [[[T; LANES]; B]; P],
    ) {
        if IN_PAIRS {
            self.side_by_side(panels, x, products);
        } else {
            for (panel, products) in panels.iter().zip(products.as_chunks_mut().0) {
                self.side_by_side::<T, B, 1>([*panel], x, products);
            }
        }
    }

    /// products <- the rows of successive panels times some vectors.
    pub(crate) fn successive<T: Real, const B: usize>(
        &self,
        first: usize,
        x: Factors<'_, T, B>,
        products: &mut [[[T; LANES]; B]],
    ) {
        let mut panel = first;
        let mut products = products;
        if IN_PAIRS {
            let (pairs, rest) = products.as_chunks_mut();
            for pair in pairs {
                self.side_by_side::<T, B, 2>([panel, panel + 1], x, pair);
                panel += 2;
            }
            products = rest;
        }
        for single in products.as_chunks_mut().0 {
            self.side_by_side::<T, B, 1>([panel], x, single);
            panel += 1;
        }
    }

    #[inline(never)]
    fn side_by_side<T: Real, const B: usize, const P: usize>(
        &self,
        panels: [usize; P],
        x: Factors<'_, T, B>,
        products: &mut [[[T; LANES]; B]; P],
    ) {
        let Entries::Panels(integers) = self.entries else {
            for (panel, products) in panels.into_iter().zip(products) {
                for (b, products) in products.iter_mut().enumerate() {
                    for (lane, product) in products.iter_mut().enumerate() {
                        *product = self.plain(LANES * panel + lane, x.values.iter().map(|x| x[b]));
                    }
                }
            }
            return;
        };
        let blocks = panels.map(|panel| integers.panel(panel, self.columns));
        T::multiply(blocks, x.pairs, x.units, products);
        if let Units::OfRows(units) = self.units {
            for (panel, products) in panels.into_iter().zip(products) {
                // Rows beyond the last one are zeros.
                let units = slice_or_empty(units, LANES * panel..units.len());
                for products in products {
                    for (product, unit) in products.iter_mut().zip(units) {
                        *product *= T::from_f32(f32::from_le_bytes(*unit));
                    }
                }
            }
        }
    }

    /// out <- the sum of some rows times factors; as long as a row.
    pub(crate) fn combine<T: Real>(&self, rows: &[u16], factors: &[T], out: &mut [T]) {
        out.fill(T::ZERO);
        match self.entries {
            Entries::Transposed(integers) => {
                for (rows, factors) in rows.chunks(SOME).zip(factors.chunks(SOME)) {
                    self.add_rows(&integers, rows, factors, out);
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
                    let factor = self.of_row(row, *factor);
                    for (column, out) in out.iter_mut().enumerate() {
                        *out += factor * T::from_f32(self.entry(row, column));
                    }
                }
            }
        }
        if let Units::OfColumns(units) = self.units {
            for (out, unit) in out.iter_mut().zip(units) {
                *out *= T::from_f32(f32::from_le_bytes(*unit));
            }
        }
    }

    /// out <- out + the sum of at most [`SOME`] rows times factors, in the units of the columns.
    fn add_rows<T: Real>(&self, integers: &Integers<'_>, rows: &[u16], factors: &[T], out: &mut [T]) {
        let mut all = FactorsOf::NONE;
        factors.iter().for_each(|factor| all.include(*factor));
        let (unit, scale) = (all.unit(), all.scale());
        // The blocks of two rows that take part, and the factors of both, whose memory the blocks have afterwards.
        let mut places = [0_u16; SOME];
        let mut pairs = [[T::NO_PAIR]; SOME];
        let mut count = 0;
        {
            let mut of_both = [[T::ZERO; 2]; SOME];
            for (row, factor) in rows.iter().zip(factors) {
                let known = slice_or_empty(&places, 0..count)
                    .iter()
                    .position(|place| *place == row / 2);
                let place = known.unwrap_or(count);
                if let (Some(number), Some(factors)) = (places.get_mut(place), of_both.get_mut(place)) {
                    *number = row / 2;
                    factors[usize::from(row % 2)] = scale * *factor;
                    count += usize::from(known.is_none());
                }
            }
            for (pair, [first, second]) in pairs.iter_mut().zip(slice_or_empty(&of_both, 0..count)) {
                *pair = [T::pair(*first, *second)];
            }
        }
        let places = slice_or_empty(&places, 0..count);
        let mut blocks = [Block::default(); SOME];
        let mut sums = [[[T::ZERO; LANES]; 1]];
        for first in (0..self.columns + integers.coarse).step_by(LANES) {
            let panel = integers.across(first / LANES, self.rows);
            for (block, place) in blocks.iter_mut().zip(places) {
                // Word by word: what moves bytes is called, and takes longer.
                if let Some([a, b, c, d]) = panel.get(usize::from(*place)) {
                    *block = [*a, *b, *c, *d];
                }
            }
            T::multiply([slice_or_empty(&blocks, 0..count)], &pairs, [unit], &mut sums);
            for (place, sum) in (first..).zip(sums.as_flattened().as_flattened()) {
                if let Some(out) = out.get_mut(place) {
                    *out += *sum;
                } else if let Some(out) = out.get_mut(place.wrapping_sub(self.columns)) {
                    *out += T::from_f32(BASE) * *sum;
                }
            }
        }
    }
}

/// Rows that are combined at a time.
const SOME: usize = 16;

fn value(digit: u8) -> f32 {
    digit.cast_signed().into()
}

/// The digit at a place of a panel's row: the even places are the first of a block's two.
fn digit(panel: &[Block], place: usize, lane: usize) -> Option<u8> {
    let word = panel.get(place / 2)?.get(lane / 2)?;
    word.get(2 * (place % 2) + lane % 2).copied()
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
    pub(super) fn slice_or_empty(&self, range: Range<usize>) -> Self {
        Self(slice_or_empty(self.0, range))
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

    /// An integer of two digits in the first two columns, of one in the others.
    fn integer(row: usize, column: usize) -> i32 {
        let any = (row * 7919 + column * 104_729 + 13) as i32;
        if column < 2 {
            any % 65_279 - 32_639
        } else {
            any % 256 - 128
        }
    }

    /// A digit of an integer.
    fn digit_of(row: usize, column: usize, first: bool) -> u8 {
        if row >= ROWS || column >= COLUMNS {
            return 0;
        }
        let last = integer(row, column) as i8;
        if first {
            ((integer(row, column) - i32::from(last)) / 256) as u8
        } else {
            last as u8
        }
    }

    fn unit(i: usize) -> f32 {
        [0.25, 0.125, 0.0625, 0.031_25][i % 4]
    }

    /// The matrix in an encoding, and its entries.
    fn stored(encoding: Encoding) -> (Vec<u8>, [[f64; COLUMNS]; ROWS]) {
        let of_rows = matches!(encoding, Encoding::RowPanels(_));
        let units = 0..if of_rows { ROWS } else { COLUMNS };
        let mut bytes: Vec<u8> = units.flat_map(|i| unit(i).to_le_bytes()).collect();
        // Column and whether it is the first digit of two, as they follow each other.
        let digits = [
            (0, true),
            (0, false),
            (1, true),
            (1, false),
            (2, false),
            (3, false),
            (4, false),
            (5, false),
        ];
        if matches!(encoding, Encoding::Columns(_)) {
            for row in (0..ROWS).step_by(2) {
                // The last digits of all columns, then the first ones.
                let places: Vec<usize> = (0..COLUMNS).chain([COLUMNS, COLUMNS + 1, COLUMNS + 2]).collect();
                for two in places.chunks(2) {
                    for row in [row, row + 1] {
                        let digit = |place: &usize| match place.checked_sub(COLUMNS) {
                            Some(2) => 0,
                            Some(coarse) => digit_of(row, coarse, true),
                            None => digit_of(row, *place, false),
                        };
                        bytes.extend(two.iter().map(digit));
                    }
                }
            }
        } else {
            for first in (0..ROWS).step_by(LANES) {
                for pair in digits.chunks(2) {
                    for row in (first..first + LANES).step_by(2) {
                        for (column, first) in pair {
                            bytes.extend([row, row + 1].map(|row| digit_of(row, *column, *first)));
                        }
                    }
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
                view.panels([0, 1], interleaved.factors(), &mut together);
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
                            view.panels([panel], single.factors(), &mut products);
                            let [[alone]] = products;
                            assert!((together[b][lane] - exact).abs() <= 1e-9, "{encoding:?} {row}");
                            let dot = view.dot(row, single.factors());
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
    fn wholes_lose_half_a_unit_each_at_most_and_no_sum_overflows() {
        // The greatest entries there are, along and against factors that are far apart, as many as fit.
        const MAX: usize = 256;
        for entry in [i8::MIN, i8::MAX] {
            let mut bytes: Vec<u8> = (0..MAX).flat_map(|_| 1.0_f32.to_le_bytes()).collect();
            bytes.extend(core::iter::repeat_n(entry as u8, 2 * MAX * LANES));
            let encoding = Encoding::ColumnPanels(Digits { coarse: MAX as u16 });
            let entry = 257.0 * f64::from(entry);
            let view = MatrixView::new(&Matrix::new(LANES as u32, MAX as u32, encoding, &bytes));
            for sign in [1.0_f32, -1.0] {
                let mut x = Vectors::<f32, MAX>::ZERO;
                let factor = |k: usize| sign.powi(k as i32) * 3.0 * 0.999_f32.powi(k as i32);
                (0..MAX).for_each(|k| x.values[k][0] = factor(k));
                x.ready(&view, MAX);
                let sum = |size: &dyn Fn(f64) -> f64| (0..MAX).map(|k| size(factor(k).into())).sum::<f64>();
                let exact = entry * sum(&|x| x);
                let found = f64::from(view.dot(0, x.factors()));
                // Of either digit's factor, times the digit.
                let unit = 256.0 * 3.0 / f64::from(f32::MAX_FACTOR);
                let rounding = 4.0 * f64::from(f32::EPSILON) * entry.abs() * sum(&f64::abs);
                let error = (found - exact).abs();
                assert!(
                    error < 0.5 * 2.0 * MAX as f64 * 128.0 * unit + rounding,
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
                assert!(!view.dot(1, x.factors()).is_finite(), "{value} {column}");
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
