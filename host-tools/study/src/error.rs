//! Why a study came to nothing.

use capsule_core::EvaluateError;
use capsule_database::DatabaseError;
use capsule_offline::OfflineError;

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
    /// The test set and the model have nothing in common.
    #[error("no configuration of the test set lies in the model's domain, with snapshots at the instants compared")]
    NothingToCompare,
    /// Nothing was to be measured.
    #[error("{queries} queries and {repetitions} repetitions; at least 2 and 1 are needed")]
    NothingToMeasure {
        /// Queries given.
        queries: usize,
        /// Repetitions asked for.
        repetitions: usize,
    },
}

impl From<EvaluateError> for StudyError {
    fn from(error: EvaluateError) -> Self {
        StudyError::Evaluate(error)
    }
}
