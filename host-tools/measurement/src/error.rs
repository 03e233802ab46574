//! Errors of a measurement.

use capsule_contour::PictureError;
use capsule_contour::text::TextError;
use capsule_core::EvaluateError;
use capsule_identify::{ContourError, IdentifyError};

/// The reason for which a measurement has no answer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeasurementError {
    /// The fault of a text.
    #[error(transparent)]
    Text(#[from] TextError),
    /// The fault of a picture.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// It is not said which of the capsules in a picture is meant, or one that is not there.
    #[error(
        "the picture shows {count} whole capsule(s), at {} pixels: choose one by its number, 1 to {count}",
        places.join(", ")
    )]
    Capsule {
        /// How many it shows.
        count: usize,
        /// Their middles, in words.
        places: Vec<String>,
    },
    /// A size of a pixel that cannot be.
    #[error("the size of a pixel is {0} um: it must be a positive number")]
    Pixel(f64),
    /// A picture without scale.
    #[error("the walls of the channel are not seen on both sides: give the size of a pixel")]
    NoScale,
    /// More points than are taken.
    #[error("{found} points: at most {most} are taken")]
    TooManyPoints {
        /// How many there are.
        found: usize,
        /// The most.
        most: usize,
    },
    /// The fault of a contour.
    #[error(transparent)]
    Contour(#[from] ContourError),
    /// The identification refuses it.
    #[error(transparent)]
    Identify(#[from] IdentifyError),
    /// The model did not answer.
    #[error(transparent)]
    Model(#[from] EvaluateError),
}

/// An input that would help.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Input {
    /// The unit of a text, or the size of a pixel.
    Unit,
    /// The size of a pixel.
    Pixel,
    /// The number of a capsule.
    Capsule,
}

impl MeasurementError {
    /// The input that the error asks for.
    pub fn asks_for(&self) -> Option<Input> {
        match self {
            Self::Text(TextError::NoUnit) => Some(Input::Unit),
            Self::Text(TextError::NoScale) | Self::Pixel(_) | Self::NoScale => Some(Input::Pixel),
            Self::Capsule { .. } => Some(Input::Capsule),
            _ => None,
        }
    }
}
