//! Byte layout of a quantised matrix: length, packing and unpacking.
//!
//! A blob holds one little-endian binary32 scale a column (or row), then a table of signed bytes in panels. An entry of
//! a narrow column is one byte; an entry of a wide column is 256 times its high byte plus its low byte. The wide
//! columns come first.
//!
//! A panel is eight successive rows of the table, in blocks of 16 bytes: a block holds two columns of the table in four
//! words, one for every two rows. A word is the bytes of the two rows in the first column, then in the second. Zeros
//! fill the last panel and the last block. The table has one of two shapes:
//!
//! - [`ColumnPanels`](Encoding::ColumnPanels) and [`RowPanels`](Encoding::RowPanels): the rows of the matrix; for each
//!   wide column its high bytes and then its low bytes, then the narrow columns.
//! - [`Columns`](Encoding::Columns), the transpose: a row for the low bytes of each column, then one for the high bytes
//!   of each wide column; the rows of the matrix are the columns of the table.

use super::wire::{Encoding, Widths};
use crate::linalg::{Block, slice_or_empty};

pub use crate::linalg::LANES;

/// Weight of the high byte of a wide entry.
pub(super) const HIGH: f32 = 256.0;

/// Greatest absolute value of an entry: both bytes are -128.
pub(super) const MAX_ENTRY: f32 = HIGH * 128.0 + 128.0;

/// Bytes of a scale.
const SCALE: usize = size_of::<f32>();

/// Table of the bytes of a quantised matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    shape: [usize; 2],
    wide_columns: usize,
    scales: usize,
    transposed: bool,
}

impl Layout {
    /// The layout of a matrix `[rows, columns]`; none where its entries are singles.
    pub fn new(encoding: Encoding, [rows, columns]: [usize; 2]) -> Option<Self> {
        let (Widths { wide_columns }, scales, transposed) = match encoding {
            Encoding::F32 => return None,
            Encoding::Columns(widths) => (widths, columns, true),
            Encoding::ColumnPanels(widths) => (widths, columns, false),
            Encoding::RowPanels(widths) => (widths, rows, false),
        };
        Some(Self {
            shape: [rows, columns],
            wide_columns: wide_columns.into(),
            scales,
            transposed,
        })
    }

    /// Number of wide columns.
    pub(super) fn wide_columns(&self) -> usize {
        self.wide_columns
    }

    /// Number of scales before the panels.
    pub fn scales(&self) -> usize {
        self.scales
    }

    /// Length of the blob: scales and panels. Saturates for the dimensions of a damaged file.
    pub fn byte_len(&self) -> usize {
        let [rows, columns] = self.shape;
        let bytes = columns.saturating_add(self.wide_columns);
        let [height, width] = if self.transposed { [bytes, rows] } else { [rows, bytes] };
        let blocks = height.div_ceil(LANES).saturating_mul(width.div_ceil(2));
        let panels = blocks.saturating_mul(size_of::<Block>());
        panels.saturating_add(self.scales.saturating_mul(SCALE))
    }

    /// Packs a matrix of integers with its scales into `bytes`, which has [`byte_len`](Self::byte_len).
    ///
    /// `integer(row, column)` lies in -128..=127 in a narrow column, in -32896..=32639 in a wide one.
    #[cfg(feature = "write")]
    pub fn pack(&self, scales: &[f32], integer: impl Fn(usize, usize) -> i32, bytes: &mut [u8]) {
        bytes.fill(0);
        let Some((stored, table)) = bytes.split_at_mut_checked(SCALE * self.scales) else {
            return;
        };
        for (bytes, scale) in stored.as_chunks_mut().0.iter_mut().zip(scales) {
            *bytes = scale.to_le_bytes();
        }
        let mut set = |place: usize, byte: i8| {
            if let Some(stored) = table.get_mut(place) {
                *stored = byte.cast_unsigned();
            }
        };
        let [rows, columns] = self.shape;
        for row in 0..rows {
            for column in 0..columns {
                let value = integer(row, column);
                let low = value as i8;
                let [low_place, high_place] = self.places(row, column);
                set(low_place, low);
                if column < self.wide_columns {
                    set(high_place, ((value - i32::from(low)) / 256) as i8);
                }
            }
        }
    }

    /// Unpacks entry (row, column) of a blob, without its scale; none outside.
    #[cfg(feature = "write")]
    pub fn unpack(&self, bytes: &[u8], row: usize, column: usize) -> Option<i32> {
        let [rows, columns] = self.shape;
        if row >= rows || column >= columns {
            return None;
        }
        let panels = Panels {
            wide_columns: self.wide_columns,
            table: bytes.get(SCALE * self.scales..)?,
        };
        if self.transposed {
            panels.transposed_entry(row, column, self.shape)
        } else {
            panels.entry(row, column, columns)
        }
    }

    /// Places in the table of the low byte of an entry and of the high byte, which a wide one has.
    #[cfg(feature = "write")]
    fn places(&self, row: usize, column: usize) -> [usize; 2] {
        if self.transposed {
            transposed_places(row, column, self.shape)
        } else {
            places(row, column, self.shape[1], self.wide_columns)
        }
    }
}

/// Places in the table of the low byte of an entry and of the high byte, which a wide one has.
fn places(row: usize, column: usize, columns: usize, wide_columns: usize) -> [usize; 2] {
    let [low, high] = if column < wide_columns {
        [2 * column + 1, 2 * column]
    } else {
        [wide_columns + column; 2]
    };
    [low, high].map(|column| place(row, column, columns + wide_columns))
}

/// As [`places`], in the table of the transpose.
fn transposed_places(row: usize, column: usize, [rows, columns]: [usize; 2]) -> [usize; 2] {
    [column, columns + column].map(|place_of_column| place(place_of_column, row, rows))
}

/// Place of a byte in the panels of a table of so many columns.
fn place(row: usize, column: usize, columns: usize) -> usize {
    let block = row / LANES * columns.div_ceil(2) + column / 2;
    size_of::<Block>() * block + 4 * (row % LANES / 2) + 2 * (column % 2) + row % 2
}

/// The panels of a stored table.
#[derive(Clone, Copy, Debug)]
pub(super) struct Panels<'a> {
    pub(super) wide_columns: usize,
    pub(super) table: &'a [u8],
}

impl<'a> Panels<'a> {
    /// Panel number `panel` of a matrix of `columns`.
    pub(super) fn panel(&self, panel: usize, columns: usize) -> &'a [Block] {
        self.blocks(panel, self.blocks_of(columns))
    }

    /// Panel number `panel` of the transpose of a matrix of `rows`.
    pub(super) fn transposed_panel(&self, panel: usize, rows: usize) -> &'a [Block] {
        self.blocks(panel, rows.div_ceil(2))
    }

    /// Entry (row, column) of a matrix of `columns`, without its scale; none where the table does not hold it.
    pub(super) fn entry(&self, row: usize, column: usize, columns: usize) -> Option<i32> {
        self.value(column, places(row, column, columns, self.wide_columns))
    }

    /// As [`entry`](Self::entry), of a matrix `[rows, columns]` whose transpose is stored.
    pub(super) fn transposed_entry(&self, row: usize, column: usize, shape: [usize; 2]) -> Option<i32> {
        self.value(column, transposed_places(row, column, shape))
    }

    fn value(&self, column: usize, [low, high]: [usize; 2]) -> Option<i32> {
        let byte = |place: usize| self.table.get(place).map(|byte| i32::from(byte.cast_signed()));
        let low = byte(low)?;
        if column < self.wide_columns {
            Some(256 * byte(high)? + low)
        } else {
            Some(low)
        }
    }

    /// Blocks that hold so many leading columns: a wide column is one, and so are two narrow ones.
    pub(super) fn blocks_of(&self, columns: usize) -> usize {
        let wide = columns.min(self.wide_columns);
        wide + (columns - wide).div_ceil(2)
    }

    /// Panel number `panel` of panels of `count` blocks.
    fn blocks(&self, panel: usize, count: usize) -> &'a [Block] {
        let length = size_of::<Block>() * count;
        let bytes = slice_or_empty(self.table, panel * length..(panel + 1) * length);
        bytes.as_chunks().0.as_chunks().0
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec;
    use std::vec::Vec;

    const ENCODINGS: [fn(Widths) -> Encoding; 3] = [Encoding::Columns, Encoding::ColumnPanels, Encoding::RowPanels];

    fn layout(encoding: fn(Widths) -> Encoding, shape: [usize; 2], wide_columns: u16) -> Layout {
        Layout::new(encoding(Widths { wide_columns }), shape).unwrap()
    }

    /// An integer in the whole range of its column.
    fn integer(row: usize, column: usize, wide: usize) -> i32 {
        let any = (row * 7919 + column * 104_729 + 13) as i32;
        if column < wide {
            any % 65_536 - 32_896
        } else {
            any % 256 - 128
        }
    }

    #[test]
    fn packed_matrices_unpack_to_the_same_integers_and_scales() {
        for encoding in ENCODINGS {
            for (rows, columns) in [(1, 1), (7, 2), (8, 5), (11, 5), (17, 8), (0, 3), (3, 0)] {
                for wide in 0..=columns {
                    let layout = layout(encoding, [rows, columns], wide as u16);
                    let scales: Vec<f32> = (0..layout.scales()).map(|i| 0.5 + i as f32).collect();
                    let mut bytes = vec![0xaa; layout.byte_len()];
                    layout.pack(&scales, |row, column| integer(row, column, wide), &mut bytes);
                    for (bytes, scale) in bytes.as_chunks().0.iter().zip(&scales) {
                        assert_eq!(f32::from_le_bytes(*bytes), *scale);
                    }
                    for row in 0..rows + 9 {
                        for column in 0..columns + 3 {
                            let expected = (row < rows && column < columns).then(|| integer(row, column, wide));
                            assert_eq!(layout.unpack(&bytes, row, column), expected, "{row} {column} {wide}");
                        }
                    }
                }
            }
        }
    }

    /// The layout of format version 10, byte by byte: 3 rows, one wide and two narrow columns.
    #[test]
    fn bytes_stand_where_the_format_says() {
        let rows = [[0x0102, 0x11, 0x21], [0x0304, 0x12, 0x22], [0x0506, 0x13, 0x23]];
        let packed = |encoding| {
            let layout = layout(encoding, [3, 3], 1);
            let mut bytes = vec![0; layout.byte_len()];
            layout.pack(&[1.0; 3], |row, column| rows[row][column], &mut bytes);
            bytes.split_off(12)
        };
        let words = |words: &[[u8; 4]]| -> Vec<u8> { words.concat() };
        for encoding in [Encoding::ColumnPanels, Encoding::RowPanels] {
            let expected = words(&[
                [1, 3, 2, 4],
                [5, 0, 6, 0],
                [0; 4],
                [0; 4],
                [0x11, 0x12, 0x21, 0x22],
                [0x13, 0, 0x23, 0],
                [0; 4],
                [0; 4],
            ]);
            assert_eq!(packed(encoding), expected);
        }
        // Rows of the table: the low bytes of the three columns, the high bytes of the first.
        let expected = words(&[
            [2, 0x11, 4, 0x12],
            [0x21, 1, 0x22, 3],
            [0; 4],
            [0; 4],
            [6, 0x13, 0, 0],
            [0x23, 5, 0, 0],
            [0; 4],
            [0; 4],
        ]);
        assert_eq!(packed(Encoding::Columns), expected);
    }

    #[test]
    fn the_length_of_a_damaged_file_saturates() {
        for encoding in ENCODINGS {
            let most = u32::MAX as usize;
            assert!(layout(encoding, [most, most], u16::MAX).byte_len() > most);
        }
        assert_eq!(Layout::new(Encoding::F32, [2, 2]), None);
    }
}
