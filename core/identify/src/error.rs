//! Errors of an identification.

use crate::contour::ContourError;
use crate::measurement::MAX_FRAMES;
use capsule_core::EvaluateError;

/// The fewest points of a dent line.
pub const MIN_LINE_POINTS: usize = 5;

/// The fault of a dent line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum DentLineError {
    /// It does not go with the contour of a silhouette, or the model does not tell the section.
    NoSilhouette,
    /// Fewer than [`MIN_LINE_POINTS`].
    TooFewPoints {
        /// How many.
        found: usize,
    },
    /// A point that is not a finite number or lies outside of the contour.
    Outside {
        /// Which, from 0.
        index: usize,
    },
}

impl core::fmt::Display for DentLineError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match *self {
            Self::NoSilhouette => f.write_str(
                "a dent line goes with the contour of a silhouette: of a section the dent is a part of the contour",
            ),
            Self::TooFewPoints { found } => {
                write!(
                    f,
                    "the dent line has {found} points: at least {MIN_LINE_POINTS} are needed"
                )
            }
            Self::Outside { index } => write!(
                f,
                "point {} of the dent line does not lie within the contour: they must have the same coordinates",
                index + 1
            ),
        }
    }
}

/// The cause of a refused measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum IdentifyError {
    /// The fault of the contour.
    Contour(ContourError),
    /// A number of the measurement that cannot be.
    Number {
        /// Its name.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The fault of a dent line.
    DentLine(DentLineError),
    /// Without a contour at least two lengths are needed.
    TooFewLengths {
        /// How many there are.
        found: usize,
    },
    /// A sequence has no frame, or too many.
    Frames {
        /// How many there are.
        found: usize,
    },
    /// A contour of a sequence without the direction of the flow.
    Direction,
    /// The capsule's velocity in a transient, in which it changes.
    ChangingVelocity,
    /// The model did not answer.
    Model(EvaluateError),
    /// No start led to a minimum.
    NoFit,
}

impl From<EvaluateError> for IdentifyError {
    fn from(error: EvaluateError) -> Self {
        Self::Model(error)
    }
}

impl From<DentLineError> for IdentifyError {
    fn from(error: DentLineError) -> Self {
        Self::DentLine(error)
    }
}

impl From<ContourError> for IdentifyError {
    fn from(error: ContourError) -> Self {
        Self::Contour(error)
    }
}

impl core::fmt::Display for IdentifyError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Contour(error) => error.fmt(f),
            Self::Number { what, value } => write!(f, "{what} is {value}: it must be a positive finite number"),
            Self::DentLine(error) => error.fmt(f),
            Self::TooFewLengths { found } => write!(
                f,
                "{found} of the lengths, the velocity and the radius are given: without a contour at least two are \
                 needed"
            ),
            Self::Frames { found } => write!(f, "{found} frames are given: it must be 1 to {MAX_FRAMES}"),
            Self::Direction => f.write_str("the direction of the flow must be given for the contours of a sequence"),
            Self::ChangingVelocity => f.write_str(
                "the capsule's velocity changes in a transient: give the liquid's mean velocity or flow rate",
            ),
            Self::Model(error) => error.fmt(f),
            Self::NoFit => f.write_str("no capsule of the model comes near the measurement"),
        }
    }
}

impl core::error::Error for IdentifyError {}
