//! Errors of the offline stage.

use capsule_core::{EncodeError, EvaluateError, OpenError};
use capsule_database::DatabaseError;

/// An error of the offline stage: what was wrong, where, and what would be right.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OfflineError {
    /// The database cannot be read.
    #[error(transparent)]
    Database(#[from] DatabaseError),
    /// The database is not over capillary number and confinement.
    #[error("the database is over {}; a model is built over capillary_number, confinement", found.join(", "))]
    WrongParameters {
        /// The parameters' names.
        found: Vec<String>,
    },
    /// The database is of another law than the settings state.
    #[error("the settings state a membrane of the law \"{expected}\", the database is of \"{found}\"")]
    WrongLaw {
        /// The settings' law.
        expected: String,
        /// The database's law.
        found: String,
    },
    /// No sample lies in the domain, or no snapshot at an instant of the errors.
    #[error(
        "no sample in the domain {}, or no snapshot at any of t = {}",
        ranges(domain),
        list(error_times)
    )]
    Unsampled {
        /// The domain that was asked for.
        domain: Vec<[f64; 2]>,
        /// The instants of the errors that were asked for.
        error_times: Vec<f64>,
    },
    /// A number is too large or too small for a model file, in whatever unit it is.
    #[error("{what} is {value:e}; it must be in [{least:e}, {greatest:e}]: give it in another unit")]
    OutOfScale {
        /// Of what.
        what: String,
        /// The number.
        value: f64,
        /// The least that can be.
        least: f64,
        /// The greatest that can be.
        greatest: f64,
    },
    /// There are too few configurations.
    #[error("{found} configurations with {parameter} in [{}, {}]; at least {needed} are needed", range[0], range[1])]
    TooFewSamples {
        /// The parameter along which the clusters follow each other.
        parameter: String,
        /// Its range in the cluster.
        range: [f64; 2],
        /// How many there are.
        found: usize,
        /// How many there must be.
        needed: usize,
    },
    /// Snapshots do not have the symmetry of the mesh.
    #[error(
        "the configuration ({}) deviates by {deviation:e} from the symmetry of its mesh; at most {limit:e} is rounding",
        list(parameters)
    )]
    NotSymmetric {
        /// The configuration.
        parameters: Vec<f64>,
        /// The largest deviation of a component.
        deviation: f64,
        /// The right value.
        limit: f64,
    },
    /// The mesh has no nodes along a section outline, pole to pole.
    #[error("the mesh has {found} nodes on the outline `{outline}`; at least 3, with both poles, are needed")]
    NoOutline {
        /// The outline's name.
        outline: &'static str,
        /// How many nodes lie on it.
        found: usize,
    },
    /// The mesh has more nodes than the model file can index.
    #[error(
        "the mesh has {nodes} nodes, counting each as often as an operation of its symmetry takes one there; a model \
         file \
         indexes at most {limit}"
    )]
    TooManyNodes {
        /// Images of the sector's nodes: the nodes of the mesh, those on planes of symmetry more than once.
        nodes: usize,
        /// The most that can be.
        limit: usize,
    },
    /// A setting has no meaning.
    #[error("setting `{name}` is {value}; expected {expected}")]
    BadSetting {
        /// The setting.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The right value.
        expected: &'static str,
    },
    /// A split separates no samples.
    #[error(
        "the split {name} = {value} separates no samples: `{name}` runs from {} to {}, and the split must lie between",
        range[0],
        range[1]
    )]
    SeparatesNothing {
        /// The parameter.
        name: String,
        /// Where it is split.
        value: f64,
        /// Its range.
        range: [f64; 2],
    },
    /// A singular value decomposition did not converge.
    #[error("the singular value decomposition of a {rows} x {columns} matrix did not converge")]
    NoConvergence {
        /// Rows of the matrix.
        rows: usize,
        /// Columns of the matrix.
        columns: usize,
    },
    /// The model file cannot be written.
    #[error("the model cannot be written: {0}")]
    Encode(EncodeError),
    /// The core refuses the model that was just written.
    #[error("the new model is not valid: {0}")]
    Invalid(OpenError),
    /// The core refuses to evaluate the model at one of its samples.
    #[error("the new model cannot be evaluated at ({}): {source}", list(parameters))]
    Evaluate {
        /// The configuration.
        parameters: Vec<f64>,
        /// The core's answer.
        source: EvaluateError,
    },
}

fn list(numbers: &[f64]) -> String {
    let texts: Vec<String> = numbers.iter().map(f64::to_string).collect();
    texts.join(", ")
}

fn ranges(ranges: &[[f64; 2]]) -> String {
    let texts: Vec<String> = ranges.iter().map(|[low, high]| format!("[{low}, {high}]")).collect();
    texts.join(" x ")
}
