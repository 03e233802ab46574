//! The figures of a failure.

use crate::Status;
use capsule_core::{EvaluateError, Model, OpenError};
use core::ffi::c_char;
use core::ptr;

/// What a call failed at. A field that the status does not mention is zero. Where the status is that a pointer is null or
/// misaligned, or that two overlap, nothing is written: the pointer to this could be the one at fault.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Error {
    /// The status that the call returned.
    pub status: Status,
    /// Name of what was wrong: `what_length` characters without a terminating zero, in the library or in the model's
    /// file, or null.
    pub what: *const c_char,
    /// Length of `what`.
    pub what_length: usize,
    /// What was found.
    pub found: f64,
    /// The least that would be right.
    pub least: f64,
    /// The greatest that would be right.
    pub greatest: f64,
}

impl Error {
    pub(crate) const NONE: Self = Self {
        status: Status::Ok,
        what: ptr::null(),
        what_length: 0,
        found: 0.0,
        least: 0.0,
        greatest: 0.0,
    };

    /// A failure with counts: what was found, the least and the greatest that would be right. They are exact below 2^32.
    #[inline(never)]
    pub(crate) fn counts(status: Status, what: &'static str, figures: [usize; 3]) -> Self {
        let figure = |count| f64::from(u32::try_from(count).unwrap_or(u32::MAX));
        Self::new(status, what, figures.map(figure))
    }

    /// A failure with numbers in place of counts.
    #[inline(never)]
    fn numbers(status: Status, what: &'static str, figures: [f32; 3]) -> Self {
        Self::new(status, what, figures.map(f64::from))
    }

    #[inline(never)]
    fn new(status: Status, what: &'static str, [found, least, greatest]: [f64; 3]) -> Self {
        let figures = Self {
            found,
            least,
            greatest,
            ..status.into()
        };
        figures.about(what)
    }

    /// Why a query was refused; a parameter bears the name that the model gives it.
    pub(crate) fn of_query(error: EvaluateError, model: &Model<'static>) -> Self {
        let ranges = &model.contents().metadata.parameters;
        match error {
            EvaluateError::Parameter { index, .. } | EvaluateError::OutsideDomain { index, .. } => {
                Self::from(error).about(ranges.get(index).map_or("", |range| range.name))
            }
            _ => error.into(),
        }
    }

    fn about(self, what: &'static str) -> Self {
        Self {
            what: if what.is_empty() {
                ptr::null()
            } else {
                what.as_ptr().cast()
            },
            what_length: what.len(),
            ..self
        }
    }
}

impl From<Status> for Error {
    #[inline(never)]
    fn from(status: Status) -> Self {
        Self { status, ..Self::NONE }
    }
}

impl From<OpenError> for Error {
    fn from(error: OpenError) -> Self {
        match error {
            OpenError::Truncated { expected, found } => Self::counts(Status::Truncated, "", [found, expected, 0]),
            OpenError::Magic { .. } => Status::Magic.into(),
            OpenError::Version { found, supported } => {
                Self::counts(Status::Version, "", [found as usize, 0, supported as usize])
            }
            OpenError::Checksum { expected, found } => {
                Self::counts(Status::Checksum, "", [found as usize, expected as usize, 0])
            }
            OpenError::Undecodable => Status::Undecodable.into(),
            OpenError::TrailingBytes { found } => Self::counts(Status::TrailingBytes, "", [found, 0, 0]),
            OpenError::Rows { what, expected, found }
            | OpenError::Columns { what, expected, found }
            | OpenError::Dimension { what, expected, found }
            | OpenError::Length { what, expected, found } => {
                Self::counts(Status::Inconsistent, what, [found, expected, 0])
            }
            OpenError::Index { what, value, bound, .. } => Self::counts(Status::Inconsistent, what, [value, 0, bound]),
            OpenError::Number { what, value, .. } => Self::numbers(Status::Inconsistent, what, [value, 0.0, 0.0]),
            OpenError::Setting { what, value, min, max } => Self::new(Status::Inconsistent, what, [value, min, max]),
            OpenError::SectorNode { node, .. } => Self::counts(Status::Inconsistent, "sector nodes", [node, 0, 0]),
            OpenError::ShortOutline { name } => Self::counts(Status::Inconsistent, name, [0; 3]),
            OpenError::DuplicateSample { second, .. } => Self::counts(Status::Inconsistent, "samples", [second, 0, 0]),
            _ => Status::Other.into(),
        }
    }
}

impl From<EvaluateError> for Error {
    fn from(error: EvaluateError) -> Self {
        match error {
            EvaluateError::Capacity {
                limit,
                required,
                capacity,
            } => Self::counts(Status::Capacity, limit, [required, 0, capacity]),
            EvaluateError::Value { what, value, min, max } => Self::numbers(Status::Value, what, [value, min, max]),
            EvaluateError::Parameter { value, min, max, .. } => Self::numbers(Status::Value, "", [value, min, max]),
            EvaluateError::ParameterCount { expected, found } => {
                Self::counts(Status::ParameterCount, "", [found, expected, 0])
            }
            EvaluateError::OutsideDomain {
                value,
                range: [min, max],
                ..
            } => Self::numbers(Status::OutsideDomain, "", [value, min, max]),
            EvaluateError::FarFromSamples { ratio } => {
                Self::numbers(Status::OutsideDomain, "distance from the samples", [ratio, 0.0, 1.0])
            }
            EvaluateError::FarOutside { distance, limit } => Self::numbers(
                Status::OutsideDomain,
                "distance from the samples in their spread",
                [distance, 0.0, limit],
            ),
            EvaluateError::BeyondSteadyLimit {
                capillary_number,
                limit,
                ..
            } => Self::numbers(
                Status::BeyondSteadyLimit,
                "capillary number",
                [capillary_number, 0.0, limit],
            ),
            EvaluateError::Weights { sum } => Self::numbers(Status::Weights, "", [sum, 0.0, 0.0]),
            EvaluateError::NotPrepared => Status::NotPrepared.into(),
            EvaluateError::UnknownNode { node, nodes } => Self::counts(Status::UnknownNode, "", [node, 0, nodes]),
            EvaluateError::BufferTooShort { required, found } => Self::counts(Status::Short, "", [found, required, 0]),
            EvaluateError::NotFinite => Status::NotFinite.into(),
            EvaluateError::NoSphere => Status::NoSphere.into(),
            EvaluateError::UnknownNodeSet => Status::NoOutline.into(),
            _ => Status::Other.into(),
        }
    }
}
