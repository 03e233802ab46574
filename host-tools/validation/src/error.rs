//! Errors of the validation and of the studies of the solver.

use std::path::PathBuf;

use capsule_database::DatabaseError;
use capsule_fom::flow::FlowError;
use capsule_fom::{EvaluationError, FomError};

/// An error of a validation or a study of the solver.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ValidationError {
    /// A run could not be set up or carried on.
    #[error(transparent)]
    Fom(#[from] FomError),
    /// A velocity could not be found.
    #[error(transparent)]
    Evaluation(#[from] EvaluationError),
    /// The fluid's velocity could not be found.
    #[error(transparent)]
    Flow(#[from] FlowError),
    /// The database could not be read.
    #[error(transparent)]
    Database(#[from] DatabaseError),
    /// A run that a comparison needs ended early.
    #[error("the run at Ca = {capillary_number}, a/l = {confinement} stopped at t = {time:.3}: {reason}")]
    Stopped {
        /// Its capillary number.
        capillary_number: f64,
        /// Its confinement.
        confinement: f64,
        /// When.
        time: f64,
        /// Why.
        reason: String,
    },
    /// A file of finished runs could not be read or written.
    #[error("could not {action} {path}: {source}")]
    File {
        /// "read" or "write".
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A worker thread could not be started, or it failed.
    #[error("a worker failed: {reason}")]
    Worker {
        /// Why.
        reason: String,
    },
}
