//! The figures of a failure.

use crate::Status;
use capsule_core::{EvaluateError, Model, OpenError};
use core::ffi::c_char;

/// The cause of a failure, with its figures. A field that the status does not mention is zero.
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
    /// The figure that was found.
    pub found: f64,
    /// The least that would be right.
    pub least: f64,
    /// The greatest that would be right.
    pub greatest: f64,
}

/// Marks that a call failed; its [`Error`] holds the cause.
pub(crate) struct Failed;

/// The cause of a failure.
pub(crate) trait Cause {
    /// Writes the cause into an error that holds zeros.
    fn write_to(self, failure: &mut Error) -> Failed;
}

impl Error {
    /// Records the cause of a failed outcome here, so that calls return one bit and not the forty bytes of a cause.
    pub(crate) fn record<A, C: Cause>(&mut self, outcome: Result<A, C>) -> Result<A, Failed> {
        outcome.map_err(|cause| cause.write_to(self))
    }

    /// A failure with counts: what was found, the least and the greatest that would be right. They are exact below
    /// 2^32.
    #[inline(never)]
    pub(crate) fn counts(
        &mut self,
        status: Status,
        what: &'static str,
        found: usize,
        least: usize,
        greatest: usize,
    ) -> Failed {
        let figure = |count| f64::from(u32::try_from(count).unwrap_or(u32::MAX));
        self.figures(status, what, figure(found), figure(least), figure(greatest))
    }

    /// A failure with numbers in place of counts.
    #[inline(never)]
    fn numbers(&mut self, status: Status, what: &'static str, found: f32, least: f32, greatest: f32) -> Failed {
        self.figures(status, what, found.into(), least.into(), greatest.into())
    }

    #[inline(never)]
    fn figures(&mut self, status: Status, what: &'static str, found: f64, least: f64, greatest: f64) -> Failed {
        (self.status, self.found, self.least, self.greatest) = (status, found, least, greatest);
        self.about(what);
        Failed
    }

    /// A choice that does not exist.
    #[inline(never)]
    pub(crate) fn choice(&mut self, what: &'static str, found: usize, greatest: usize) -> Failed {
        self.counts(Status::Choice, what, found, 0, greatest)
    }

    /// Why a query was refused; a parameter bears the name that the model gives it.
    pub(crate) fn query(&mut self, error: EvaluateError, model: &Model<'static>) -> Failed {
        let failed = error.write_to(self);
        let index = match error {
            EvaluateError::Parameter { index, .. } | EvaluateError::OutsideDomain { index, .. } => index,
            // The limit is one of Ca, the first.
            EvaluateError::BeyondSteadyLimit { .. } => 0,
            _ => return failed,
        };
        if let Some(parameter) = model.parameters().get(index) {
            self.about(parameter.name);
        }
        failed
    }

    fn about(&mut self, what: &'static str) {
        if !what.is_empty() {
            (self.what, self.what_length) = (what.as_ptr().cast(), what.len());
        }
    }
}

impl Cause for Status {
    fn write_to(self, failure: &mut Error) -> Failed {
        failure.status = self;
        Failed
    }
}

impl Cause for OpenError {
    fn write_to(self, failure: &mut Error) -> Failed {
        match self {
            Self::Truncated { expected, found } => failure.counts(Status::Truncated, "", found, expected, 0),
            Self::Magic { .. } => Status::Magic.write_to(failure),
            Self::Version { found, supported } => {
                failure.counts(Status::Version, "", found as usize, 0, supported as usize)
            }
            Self::Checksum { expected, found } => {
                failure.counts(Status::Checksum, "", found as usize, expected as usize, 0)
            }
            Self::Undecodable => Status::Undecodable.write_to(failure),
            Self::TrailingBytes { found } => failure.counts(Status::TrailingBytes, "", found, 0, 0),
            Self::Rows { what, expected, found }
            | Self::Columns { what, expected, found }
            | Self::Dimension { what, expected, found }
            | Self::Length { what, expected, found } => failure.counts(Status::Inconsistent, what, found, expected, 0),
            Self::Index { what, value, bound, .. } => failure.counts(Status::Inconsistent, what, value, 0, bound),
            Self::Number { what, value, .. } => failure.numbers(Status::Inconsistent, what, value, 0.0, 0.0),
            Self::Setting { what, value, min, max } => failure.figures(Status::Inconsistent, what, value, min, max),
            Self::NoImage { node } => failure.counts(Status::Inconsistent, "images", node, 0, 0),
            Self::ShortOutline { name } => failure.counts(Status::Inconsistent, name, 0, 0, 0),
            Self::DuplicateSample { second, .. } => failure.counts(Status::Inconsistent, "samples", second, 0, 0),
            _ => Status::Other.write_to(failure),
        }
    }
}

impl Cause for EvaluateError {
    #[inline(never)]
    fn write_to(self, failure: &mut Error) -> Failed {
        match self {
            Self::Capacity {
                limit,
                required,
                capacity,
            } => failure.counts(Status::Capacity, limit, required, 0, capacity),
            Self::Value { what, value, min, max } => failure.numbers(Status::Value, what, value, min, max),
            Self::Parameter { value, min, max, .. } => failure.numbers(Status::Value, "", value, min, max),
            Self::ParameterCount { expected, found } => failure.counts(Status::ParameterCount, "", found, expected, 0),
            Self::OutsideDomain {
                value,
                range: [min, max],
                ..
            } => failure.numbers(Status::OutsideDomain, "", value, min, max),
            Self::FarFromSamples { ratio } => {
                failure.numbers(Status::OutsideDomain, "distance from the samples", ratio, 0.0, 1.0)
            }
            Self::BeyondExtrapolation { distance, limit } => failure.numbers(
                Status::OutsideDomain,
                "distance from the samples in their spread",
                distance,
                0.0,
                limit,
            ),
            Self::BeyondSteadyLimit {
                capillary_number,
                limit,
                ..
            } => failure.numbers(Status::BeyondSteadyLimit, "", capillary_number, 0.0, limit),
            Self::Weights { sum } => failure.numbers(Status::Weights, "", sum, 0.0, 0.0),
            Self::NotPrepared => Status::NotPrepared.write_to(failure),
            Self::UnknownNode { node, nodes } => failure.counts(Status::UnknownNode, "", node, 0, nodes),
            Self::BufferTooShort { required, found } => failure.counts(Status::Short, "", found, required, 0),
            Self::NotFinite => Status::NotFinite.write_to(failure),
            Self::UnsupportedReference => Status::UnsupportedReference.write_to(failure),
            Self::UnknownNodeSet => Status::NoOutline.write_to(failure),
            Self::NoBound => Status::NoBound.write_to(failure),
            Self::WrongVolume { volume, min, max } => {
                failure.numbers(Status::ImpossibleShape, "volume", volume, min, max)
            }
            Self::BeyondWall { reach } => {
                failure.numbers(Status::ImpossibleShape, "distance from the axis", reach, 0.0, 1.0)
            }
            _ => Status::Other.write_to(failure),
        }
    }
}
