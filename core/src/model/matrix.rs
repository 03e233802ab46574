//! A matrix, read in place from wherever the file lies.

use super::panels::{Layout, MAX_ENTRY, Panels};
use super::wire::{Encoding, Matrix};
use crate::Real;

/// A stored matrix; the bytes need not be aligned.
#[derive(Clone, Copy, Debug)]
pub struct MatrixView<'a> {
    pub(super) rows: usize,
    pub(super) columns: usize,
    pub(super) entries: Entries<'a>,
    pub(super) scales: Scales<'a>,
}

/// The entries, without their scales.
#[derive(Clone, Copy, Debug)]
pub(super) enum Entries<'a> {
    Singles(&'a [[u8; 4]]),
    Panels(Panels<'a>),
    Transposed(Panels<'a>),
}

/// Scales of the entries.
#[derive(Clone, Copy, Debug)]
pub(super) enum Scales<'a> {
    One,
    OfColumns(&'a [[u8; 4]]),
    OfRows(&'a [[u8; 4]]),
}

impl Scales<'_> {
    pub(super) fn of_row(&self, row: usize) -> Option<f32> {
        match self {
            Self::OfRows(scales) => scales.get(row).copied().map(f32::from_le_bytes),
            _ => None,
        }
    }

    fn of_column(&self, column: usize) -> Option<f32> {
        match self {
            Self::OfColumns(scales) => scales.get(column).copied().map(f32::from_le_bytes),
            _ => None,
        }
    }
}

impl<'a> MatrixView<'a> {
    /// A view of a matrix; entries that its bytes do not hold read as 0.
    pub fn new(matrix: &Matrix<'a>) -> Self {
        let (rows, columns) = (matrix.rows as usize, matrix.columns as usize);
        let data = matrix.blob.data;
        let (scales, entries) = match Layout::new(matrix.encoding, [rows, columns]) {
            None => (Scales::One, Entries::Singles(data.as_chunks().0)),
            Some(layout) => {
                let (scales, table) = data.split_at_checked(4 * layout.scales()).unwrap_or_default();
                let scales = scales.as_chunks().0;
                let panels = Panels {
                    wide_columns: layout.wide_columns(),
                    table,
                };
                match matrix.encoding {
                    Encoding::Columns(_) => (Scales::OfColumns(scales), Entries::Transposed(panels)),
                    Encoding::RowPanels(_) => (Scales::OfRows(scales), Entries::Panels(panels)),
                    _ => (Scales::OfColumns(scales), Entries::Panels(panels)),
                }
            }
        };
        Self {
            rows,
            columns,
            entries,
            scales,
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
        let scale = match self.scales {
            Scales::One => Some(1.0),
            Scales::OfColumns(_) => self.scales.of_column(column),
            Scales::OfRows(_) => self.scales.of_row(row),
        };
        self.entry(row, column) * scale.unwrap_or(0.0)
    }

    /// Entry (row, column) without its scale; 0 outside.
    pub(super) fn entry(&self, row: usize, column: usize) -> f32 {
        if row >= self.rows || column >= self.columns {
            return 0.0;
        }
        let entry = match self.entries {
            Entries::Singles(entries) => entries
                .get(row * self.columns + column)
                .copied()
                .map(f32::from_le_bytes),
            Entries::Transposed(panels) => panels
                .transposed_entry(row, column, [self.rows, self.columns])
                .map(|x| x as f32),
            Entries::Panels(panels) => panels.entry(row, column, self.columns).map(|x| x as f32),
        };
        entry.unwrap_or(0.0)
    }

    /// The number and value of the first entry outside of bounds. If the greatest multiple of every scale lies within
    /// them, the entries are not read.
    pub(super) fn out_of_range(&self, min: f32, max: f32) -> Option<(usize, f32)> {
        let within = |scale: &[u8; 4]| {
            let reach = f32::from_le_bytes(*scale).abs() * MAX_ENTRY;
            min <= -reach && reach <= max
        };
        if let Scales::OfColumns(scales) | Scales::OfRows(scales) = self.scales
            && scales.iter().all(within)
        {
            return None;
        }
        // A file may announce any number of rows without columns.
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
}
