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

    /// A failure with what was found, the least and the greatest that would be right.
    #[inline(never)]
    pub(crate) fn new(status: Status, what: &'static str, [found, least, greatest]: [f64; 3]) -> Self {
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
    fn from(status: Status) -> Self {
        Self { status, ..Self::NONE }
    }
}

/// A count as a figure, exact below 2^32.
#[inline(never)]
pub(crate) fn figure(count: usize) -> f64 {
    f64::from(u32::try_from(count).unwrap_or(u32::MAX))
}

impl From<OpenError> for Error {
    fn from(error: OpenError) -> Self {
        let counts = |found, least, greatest| [found, least, greatest].map(figure);
        let (status, what, figures) = match error {
            OpenError::Truncated { expected, found } => (Status::Truncated, "", counts(found, expected, 0)),
            OpenError::Magic { .. } => return Status::Magic.into(),
            OpenError::Version { found, supported } => (Status::Version, "", [found.into(), 0.0, supported.into()]),
            OpenError::Checksum { expected, found } => (Status::Checksum, "", [found.into(), expected.into(), 0.0]),
            OpenError::Undecodable => return Status::Undecodable.into(),
            OpenError::TrailingBytes { found } => (Status::TrailingBytes, "", counts(found, 0, 0)),
            OpenError::Rows { what, expected, found }
            | OpenError::Columns { what, expected, found }
            | OpenError::Dimension { what, expected, found }
            | OpenError::Length { what, expected, found } => (Status::Inconsistent, what, counts(found, expected, 0)),
            OpenError::Index { what, value, bound, .. } => (Status::Inconsistent, what, counts(value, 0, bound)),
            OpenError::Number { what, value, .. } => (Status::Inconsistent, what, [value.into(), 0.0, 0.0]),
            OpenError::Setting { what, value, min, max } => (Status::Inconsistent, what, [value, min, max]),
            OpenError::SectorNode { node, .. } => (Status::Inconsistent, "sector nodes", counts(node, 0, 0)),
            OpenError::ShortOutline { name } => (Status::Inconsistent, name, [0.0; 3]),
            OpenError::DuplicateSample { second, .. } => (Status::Inconsistent, "samples", counts(second, 0, 0)),
            _ => return Status::Other.into(),
        };
        Self::new(status, what, figures)
    }
}

impl From<EvaluateError> for Error {
    fn from(error: EvaluateError) -> Self {
        let counts = |found, least, greatest| [found, least, greatest].map(figure);
        let numbers = |found: f32, least: f32, greatest: f32| [found, least, greatest].map(f64::from);
        let (status, what, figures) = match error {
            EvaluateError::Capacity {
                limit,
                required,
                capacity,
            } => (Status::Capacity, limit, counts(required, 0, capacity)),
            EvaluateError::Value { what, value, min, max } => (Status::Value, what, numbers(value, min, max)),
            EvaluateError::Parameter { value, min, max, .. } => (Status::Value, "", numbers(value, min, max)),
            EvaluateError::ParameterCount { expected, found } => {
                (Status::ParameterCount, "", counts(found, expected, 0))
            }
            EvaluateError::OutsideDomain {
                value,
                range: [min, max],
                ..
            } => (Status::OutsideDomain, "", numbers(value, min, max)),
            EvaluateError::FarFromSamples { ratio } => (
                Status::OutsideDomain,
                "distance from the samples",
                numbers(ratio, 0.0, 1.0),
            ),
            EvaluateError::FarOutside { distance, limit } => (
                Status::OutsideDomain,
                "distance from the samples in their spread",
                numbers(distance, 0.0, limit),
            ),
            EvaluateError::BeyondSteadyLimit {
                capillary_number,
                limit,
                ..
            } => (
                Status::BeyondSteadyLimit,
                "capillary number",
                numbers(capillary_number, 0.0, limit),
            ),
            EvaluateError::Weights { sum } => (Status::Weights, "", numbers(sum, 0.0, 0.0)),
            EvaluateError::NotPrepared => return Status::NotPrepared.into(),
            EvaluateError::UnknownNode { node, nodes } => (Status::UnknownNode, "", counts(node, 0, nodes)),
            EvaluateError::BufferTooShort { required, found } => (Status::Short, "", counts(found, required, 0)),
            EvaluateError::NotFinite => return Status::NotFinite.into(),
            EvaluateError::NoSphere => return Status::NoSphere.into(),
            EvaluateError::UnknownNodeSet => return Status::NoOutline.into(),
            _ => return Status::Other.into(),
        };
        Self::new(status, what, figures)
    }
}
