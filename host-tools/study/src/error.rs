//! Errors of the studies.

use std::path::PathBuf;

use capsule_core::{EncodeError, EvaluateError, OpenError};
use capsule_database::DatabaseError;
use capsule_identify::IdentifyError;
use capsule_offline::OfflineError;
use capsule_plot::PlotError;

/// An error of a study.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// No model could be built from the database.
    #[error(transparent)]
    Offline(#[from] OfflineError),
    /// The database cannot be read.
    #[error(transparent)]
    Database(#[from] DatabaseError),
    /// The model did not answer.
    #[error("the model cannot be evaluated: {0}")]
    Evaluate(EvaluateError),
    /// A capsule was not identified.
    #[error("a capsule cannot be identified: {0}")]
    Identify(IdentifyError),
    /// A drawn picture could not be encoded.
    #[error("a picture cannot be drawn: {0}")]
    Draw(#[from] image::ImageError),
    /// No capsule was found in a drawn picture.
    #[error("no capsule is found in a picture: {0}")]
    Picture(#[from] capsule_contour::PictureError),
    /// No series of the study has this name.
    #[error("no series is named \"{name}\": there are \"{known}\"")]
    UnknownSeries {
        /// The name.
        name: String,
        /// The names that there are.
        known: String,
    },
    /// The test set and the model have nothing in common.
    #[error("no configuration of the test set lies in the model's domain, with snapshots at the instants compared")]
    NothingToCompare,
    /// The model file cannot be opened.
    #[error("the model cannot be opened: {0}")]
    Open(OpenError),
    /// A model file could not be written.
    #[error("the model cannot be written: {0}")]
    Encode(EncodeError),
    /// A file or folder of the study could not be written.
    #[error("could not write {}: {source}", path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// A figure could not be drawn.
    #[error(transparent)]
    Plot(#[from] PlotError),
    /// A singular value decomposition did not converge.
    #[error("a singular value decomposition did not converge")]
    NoConvergence,
    /// Nothing to compare with.
    #[error("{} holds no steady configuration to compare with", database.display())]
    NoTruth {
        /// The database.
        database: PathBuf,
    },
    /// Nothing was to be measured.
    #[error("{queries} queries and {repetitions} repetitions; at least 2 and 1 are needed")]
    NothingToMeasure {
        /// Queries given.
        queries: usize,
        /// The number of repetitions.
        repetitions: usize,
    },
}

impl From<EvaluateError> for StudyError {
    fn from(error: EvaluateError) -> Self {
        StudyError::Evaluate(error)
    }
}

impl From<IdentifyError> for StudyError {
    fn from(error: IdentifyError) -> Self {
        StudyError::Identify(error)
    }
}

impl From<OpenError> for StudyError {
    fn from(error: OpenError) -> Self {
        StudyError::Open(error)
    }
}

impl From<EncodeError> for StudyError {
    fn from(error: EncodeError) -> Self {
        StudyError::Encode(error)
    }
}
