//! Checks of single numbers, lists and matrices.

use crate::model::error::OpenError;
use crate::model::indices::Indices;
use crate::model::matrix::MatrixView;
use crate::model::panels::Layout;
use crate::model::wire::{Blob, Encoding, Matrix};

/// Larger numbers have no meaning in any array of a model of a capsule in the channel, and could overflow what is
/// computed from them.
pub(super) const MAX: f32 = 1e6;
/// Times in units of any kind.
pub(super) const TIME: [f32; 2] = [0.0, 1e18];
/// The range of numbers that may have either sign.
pub(super) const ANY: [f32; 2] = [-MAX, MAX];
/// The range of numbers that may not be negative.
pub(super) const POSITIVE: [f32; 2] = [0.0, MAX];

/// Range of a setting.
pub(super) struct Range {
    pub(super) what: &'static str,
    pub(super) min: f64,
    pub(super) max: f64,
}

/// Keeps the first fault. After it no array is read: checks return empty views.
pub(super) struct Validator {
    pub(super) found: Result<(), OpenError>,
    /// The range of lengths.
    pub(super) length: [f32; 2],
}

impl Validator {
    #[inline(never)]
    pub(super) fn refuse(&mut self, error: OpenError) {
        if self.found.is_ok() {
            self.found = Err(error);
        }
    }

    #[inline(never)]
    pub(super) fn number(&mut self, what: &'static str, index: usize, value: f32, expected: &'static str) {
        self.refuse(OpenError::Number {
            what,
            index,
            value,
            expected,
        });
    }

    #[inline(never)]
    pub(super) fn count(&mut self, what: &'static str, expected: usize, found: usize) {
        if found != expected {
            self.refuse(OpenError::Dimension { what, expected, found });
        }
    }

    #[inline(never)]
    pub(super) fn length(&mut self, what: &'static str, blob: &Blob<'_>, expected: usize) {
        let found = blob.data.len();
        if found != expected {
            self.refuse(OpenError::Length { what, expected, found });
        }
    }

    #[inline(never)]
    pub(super) fn setting(&mut self, what: &'static str, value: f64, min: f64, max: f64) {
        let within = min <= value && value <= max;
        if !within {
            self.refuse(OpenError::Setting { what, value, min, max });
        }
    }

    /// A setting whose range is the same in every model.
    #[inline(never)]
    pub(super) fn fixed(&mut self, value: f64, range: &Range) {
        let Range { what, min, max } = *range;
        self.setting(what, value, min, max);
    }

    #[inline(never)]
    pub(super) fn at_least_one(&mut self, what: &'static str, value: u32) {
        self.setting(what, value.into(), 1.0, 1e4);
    }

    #[inline(never)]
    pub(super) fn index(&mut self, what: &'static str, index: usize, value: usize, bound: usize) {
        if value >= bound {
            self.refuse(OpenError::Index {
                what,
                index,
                value,
                bound,
            });
        }
    }

    /// A list of `count` u16, every one below the bound.
    #[inline(never)]
    pub(super) fn indices<'a>(
        &mut self,
        what: &'static str,
        blob: &Blob<'a>,
        count: usize,
        bound: usize,
    ) -> Indices<'a> {
        self.length(what, blob, 2 * count);
        if self.found.is_err() {
            return Indices::new(&Blob::new(&[]));
        }
        let indices = Indices::new(blob);
        for (index, value) in indices.iter().enumerate() {
            self.index(what, index, value, bound);
        }
        indices
    }

    /// A matrix of these dimensions with every entry within bounds.
    #[inline(never)]
    pub(super) fn matrix<'a>(
        &mut self,
        what: &'static str,
        matrix: &Matrix<'a>,
        [rows, columns]: [usize; 2],
        [min, max]: [f32; 2],
    ) -> MatrixView<'a> {
        let found = matrix.rows as usize;
        if found != rows {
            let expected = rows;
            self.refuse(OpenError::Rows { what, expected, found });
        }
        let found = matrix.columns as usize;
        if found != columns {
            let expected = columns;
            self.refuse(OpenError::Columns { what, expected, found });
        }
        let bytes = match Layout::new(matrix.encoding, [rows, columns]) {
            None => columns.saturating_mul(4).saturating_mul(rows),
            Some(layout) => {
                self.index(what, 0, layout.wide_columns(), columns.saturating_add(1));
                layout.byte_len()
            }
        };
        self.length(what, &matrix.blob, bytes);
        if self.found.is_err() {
            return MatrixView::new(&Matrix::f32(0, columns as u32, &[]));
        }
        let view = MatrixView::new(matrix);
        if let Some((index, value)) = view.out_of_range(min, max) {
            self.number(what, index, value, "a finite number in the array's range");
        }
        view
    }

    /// Not of integers: it is read again and again.
    pub(super) fn singles(&mut self, what: &'static str, matrix: &Matrix<'_>) {
        if matrix.encoding != Encoding::F32 {
            let expected = (matrix.columns as usize)
                .saturating_mul(matrix.rows as usize)
                .saturating_mul(4);
            let found = matrix.blob.data.len();
            self.refuse(OpenError::Length { what, expected, found });
        }
    }

    /// A matrix of so many columns and at least so many rows, whose first entries rise.
    #[inline(never)]
    pub(super) fn rising<'a>(
        &mut self,
        what: &'static str,
        stored: &Matrix<'a>,
        [columns, least]: [usize; 2],
        range: [f32; 2],
    ) -> MatrixView<'a> {
        let rows = stored.rows as usize;
        self.count(what, rows.max(least), rows);
        let view = self.matrix(what, stored, [rows, columns], range);
        for index in 1..view.rows() {
            let value = view.get(index, 0);
            if value <= view.get(index - 1, 0) {
                self.number(what, index, value, "more than the one before");
            }
        }
        view
    }
}
