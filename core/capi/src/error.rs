//! The figures of a failure.

use crate::Status;
use capsule_core::error::Name;
use capsule_core::{EvaluateError, OpenError};
use core::ffi::c_char;
use core::ptr;

/// What a call failed at. A field that the status does not mention is zero. Where the status is that a pointer is null or
/// misaligned, or that two overlap, nothing is written: the pointer to this could be the one at fault.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Error {
    /// The status that the call returned.
    pub status: Status,
    /// Name of what was wrong: `what_length` characters without a terminating zero, or null.
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

    pub(crate) fn what(self, what: &'static str) -> Self {
        Self {
            what: what.as_ptr().cast(),
            what_length: what.len(),
            ..self
        }
    }

    pub(crate) fn found(self, found: f64) -> Self {
        Self { found, ..self }
    }

    pub(crate) fn least(self, least: f64) -> Self {
        Self { least, ..self }
    }

    pub(crate) fn greatest(self, greatest: f64) -> Self {
        Self { greatest, ..self }
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

/// A parameter in words that live as long as the program.
fn parameter(name: &Name) -> &'static str {
    match name.as_str() {
        "capillary_number" => "capillary number",
        "confinement" => "confinement",
        _ => "parameter",
    }
}

impl From<OpenError> for Error {
    fn from(error: OpenError) -> Self {
        let inconsistent = |what| Self::from(Status::Inconsistent).what(what);
        match error {
            OpenError::Truncated { expected, found } => Self::from(Status::Truncated)
                .found(figure(found))
                .least(figure(expected)),
            OpenError::Magic { .. } => Status::Magic.into(),
            OpenError::Version { found, supported } => Self::from(Status::Version)
                .found(found.into())
                .greatest(supported.into()),
            OpenError::Checksum { expected, found } => {
                Self::from(Status::Checksum).found(found.into()).least(expected.into())
            }
            OpenError::Undecodable => Status::Undecodable.into(),
            OpenError::TrailingBytes { found } => Self::from(Status::TrailingBytes).found(figure(found)),
            OpenError::Rows { what, expected, found }
            | OpenError::Columns { what, expected, found }
            | OpenError::Dimension { what, expected, found }
            | OpenError::Length { what, expected, found } => {
                inconsistent(what).found(figure(found)).least(figure(expected))
            }
            OpenError::Index { what, value, bound, .. } => {
                inconsistent(what).found(figure(value)).greatest(figure(bound))
            }
            OpenError::Number { what, value, .. } => inconsistent(what).found(value.into()),
            OpenError::Setting { what, value, min, max } => inconsistent(what).found(value).least(min).greatest(max),
            OpenError::SectorNode { node, .. } => inconsistent("sector nodes").found(figure(node)),
            OpenError::ShortOutline { name } => inconsistent(name),
            OpenError::DuplicateSample { second, .. } => inconsistent("samples").found(figure(second)),
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
            } => Self::from(Status::Capacity)
                .what(limit)
                .found(figure(required))
                .greatest(figure(capacity)),
            EvaluateError::Value { what, value, min, max } => Self::from(Status::Value)
                .what(what)
                .found(value)
                .least(min)
                .greatest(max),
            EvaluateError::ParameterCount { expected, found } => Self::from(Status::ParameterCount)
                .found(figure(found))
                .least(figure(expected)),
            EvaluateError::Parameter { name, value, min, max } => Self::from(Status::Value)
                .what(parameter(&name))
                .found(value)
                .least(min)
                .greatest(max),
            EvaluateError::OutsideDomain { name, value, range } => {
                let [least, greatest] = range;
                Self::from(Status::OutsideDomain)
                    .what(parameter(&name))
                    .found(value)
                    .least(least)
                    .greatest(greatest)
            }
            EvaluateError::FarFromSamples { ratio } => Self::from(Status::OutsideDomain)
                .what("distance from the samples")
                .found(ratio)
                .greatest(1.0),
            EvaluateError::FarOutside { distance, limit } => Self::from(Status::OutsideDomain)
                .what("distance from the samples in their spread")
                .found(distance)
                .greatest(limit),
            EvaluateError::BeyondSteadyLimit {
                capillary_number,
                limit,
                ..
            } => Self::from(Status::BeyondSteadyLimit)
                .what("capillary number")
                .found(capillary_number)
                .greatest(limit),
            EvaluateError::Weights { sum } => Self::from(Status::Weights).found(sum),
            EvaluateError::NotPrepared => Status::NotPrepared.into(),
            EvaluateError::UnknownNode { node, nodes } => Self::from(Status::UnknownNode)
                .found(figure(node))
                .greatest(figure(nodes)),
            EvaluateError::BufferTooShort { required, found } => {
                Self::from(Status::Short).found(figure(found)).least(figure(required))
            }
            EvaluateError::NotFinite => Status::NotFinite.into(),
            EvaluateError::NoSphere => Status::NoSphere.into(),
            EvaluateError::UnknownNodeSet => Status::NoOutline.into(),
            _ => Status::Other.into(),
        }
    }
}
