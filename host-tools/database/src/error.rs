//! Errors of a database, with the file, the array and the figures.

use std::path::{Path, PathBuf};

/// An error of a database, with its place and the expected value.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DatabaseError {
    /// The operating system refused a file operation.
    #[error("cannot {operation} {}: {source}", path.display())]
    Io {
        /// The operation that failed: "read", "write", "create", ...
        operation: &'static str,
        /// The file or directory.
        path: PathBuf,
        /// The system's answer.
        source: std::io::Error,
    },
    /// The directory holds no `database.json`.
    #[error("{} is not a database: it holds no database.json", path.display())]
    NotADatabase {
        /// The directory.
        path: PathBuf,
    },
    /// A malformed row of a table.
    #[error("{}: row {row} below the heading: expected {expected}", path.display())]
    BadRow {
        /// The table.
        path: PathBuf,
        /// The row, counted from 1.
        row: usize,
        /// The right value.
        expected: &'static str,
    },
    /// Databases that should be of the same settings and mesh are not.
    #[error("{} holds a database of another kind: they differ in {difference}", path.display())]
    Different {
        /// The directory of the one that is there.
        path: PathBuf,
        /// The setting or array that differs.
        difference: String,
    },
    /// There are no databases to merge.
    #[error("nothing to merge: no database was given")]
    NothingToMerge,
    /// Two databases disagree about a configuration.
    #[error("{} and {} are of the same configuration but differ", first.display(), second.display())]
    Conflict {
        /// One of the files.
        first: PathBuf,
        /// The other.
        second: PathBuf,
    },
    /// A directory for something new is not empty.
    #[error("{} exists and is not empty: name a new directory", path.display())]
    Occupied {
        /// The directory.
        path: PathBuf,
    },
    /// The database was written in a format that this program does not read.
    #[error("{}: format version {found}; this program reads version {supported}", path.display())]
    WrongVersion {
        /// The `database.json`.
        path: PathBuf,
        /// The version it names.
        found: u64,
        /// The version that is read.
        supported: u64,
    },
    /// A JSON text cannot be understood.
    #[error("{}: {source}", path.display())]
    Json {
        /// The file.
        path: PathBuf,
        /// The reason, with its line and column.
        source: serde_json::Error,
    },
    /// A file is cut short or damaged.
    #[error("{} is damaged or cut short: {reason}", path.display())]
    Corrupt {
        /// The file.
        path: PathBuf,
        /// The reason.
        reason: String,
    },
    /// A required array is missing in the file.
    #[error("{}: array `{name}` of shape {expected} is missing", path.display())]
    MissingArray {
        /// The file.
        path: PathBuf,
        /// The array's name.
        name: String,
        /// The shape it should have.
        expected: String,
    },
    /// An array has the wrong shape.
    #[error("{}: array `{name}` has shape {}, expected {expected}", path.display(), tuple(found))]
    WrongShape {
        /// The file.
        path: PathBuf,
        /// The array's name.
        name: String,
        /// The shape it should have.
        expected: String,
        /// The shape it has.
        found: Vec<usize>,
    },
    /// A path is neither a folder nor a file of a known kind.
    #[error("{}: expected a .npz, .h5 or .hdf5 file, or a folder with parameters.csv", path.display())]
    UnknownKind {
        /// The path.
        path: PathBuf,
    },
    /// A malformed text file.
    #[error("{}: {reason}", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// The element types found and expected.
        reason: String,
    },
    /// A malformed collection.
    #[error("{reason}")]
    BadCollection {
        /// The array, the index in it, the value found and the value expected.
        reason: String,
    },
    /// An array has the wrong element type.
    #[error("{}: array `{name}` has elements of type {found}, expected {expected}", path.display())]
    WrongType {
        /// The file.
        path: PathBuf,
        /// The array's name.
        name: String,
        /// The element type it should have.
        expected: &'static str,
        /// The NumPy descriptor it has.
        found: String,
    },
    /// A number is infinite or not a number.
    #[error("{what}: value {index} is {value}, expected finite numbers only")]
    NotFinite {
        /// Which data.
        what: String,
        /// The index of the first such number, counted through the whole array.
        index: usize,
        /// The number.
        value: f64,
    },
    /// Two lengths that must agree do not.
    #[error("{what}: {found} given, expected {expected}")]
    WrongLength {
        /// The items that were counted.
        what: String,
        /// How many there should be.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// The instants do not increase.
    #[error("times must increase from 0: value {index} is {value} after {previous}")]
    TimesNotIncreasing {
        /// The index of the offending instant.
        index: usize,
        /// That instant.
        value: f64,
        /// The one before it (0 for the first).
        previous: f64,
    },
    /// A coordinate is too large for the fixed-point storage.
    #[error("{what}: {value} is beyond the largest storable magnitude {limit}")]
    TooLarge {
        /// Which data.
        what: String,
        /// The number.
        value: f64,
        /// The largest magnitude.
        limit: f64,
    },
    /// A mesh element names a node that does not exist, or the mesh is empty.
    #[error("mesh: {reason}")]
    BadMesh {
        /// The reason.
        reason: String,
    },
    /// The database holds no such configuration.
    #[error("{}: no snapshots of configuration {}", path.display(), tuple(parameters))]
    UnknownConfiguration {
        /// The directory.
        path: PathBuf,
        /// The requested configuration.
        parameters: Vec<f64>,
    },
    /// A requested instant is not stored.
    #[error("no snapshot at t = {time}; the trajectory ends at t = {end} and its state there is {status}")]
    NoSnapshot {
        /// The requested instant.
        time: f64,
        /// The last stored instant.
        end: f64,
        /// "steady", "unsteady" or "stopped".
        status: &'static str,
    },
    /// No configuration of a database has snapshots at a requested instant.
    #[error("the database has no snapshots at t = {time}; those around it are {}", tuple(around))]
    NoInstant {
        /// The requested instant.
        time: f64,
        /// The instants of the database before and after it.
        around: Vec<f64>,
    },
    /// No configuration of a database can be exported.
    #[error("{}: no configuration is steady or has snapshots to t = {end}: there is nothing to export", path.display())]
    NothingToExport {
        /// The directory.
        path: PathBuf,
        /// The last of the requested instants.
        end: f64,
    },
    /// The caller asked to end the work.
    #[error("interrupted, nothing is written")]
    Interrupted,
}

impl DatabaseError {
    pub(crate) fn io(operation: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_path_buf();
        move |source| DatabaseError::Io {
            operation,
            path,
            source,
        }
    }

    /// A fault of a collection.
    pub(crate) fn collection(reason: impl Into<String>) -> Self {
        DatabaseError::BadCollection { reason: reason.into() }
    }

    /// The same of a collection that was read from a file or folder.
    pub(crate) fn read_from(self, path: &Path) -> Self {
        match self {
            DatabaseError::BadCollection { reason } => DatabaseError::Malformed {
                path: path.to_path_buf(),
                reason,
            },
            other => other,
        }
    }

    pub(crate) fn json(path: &Path) -> impl FnOnce(serde_json::Error) -> Self {
        let path = path.to_path_buf();
        move |source| DatabaseError::Json { path, source }
    }
}

/// Numbers as Python writes a tuple of them: a shape, a configuration.
pub(crate) fn tuple(numbers: &[impl ToString]) -> String {
    let numbers: Vec<String> = numbers.iter().map(ToString::to_string).collect();
    let comma = if numbers.len() == 1 { "," } else { "" };
    format!("({}{comma})", numbers.join(", "))
}

/// Refuses the first number of `values` that is not finite.
pub(crate) fn finite<'a>(what: &str, values: impl IntoIterator<Item = &'a f64>) -> Result<(), DatabaseError> {
    match values.into_iter().enumerate().find(|(_, v)| !v.is_finite()) {
        None => Ok(()),
        Some((index, &value)) => Err(DatabaseError::NotFinite {
            what: what.to_owned(),
            index,
            value,
        }),
    }
}

/// Refuses a length that is not the expected one.
pub(crate) fn length(what: &str, expected: usize, found: usize) -> Result<(), DatabaseError> {
    if expected == found {
        Ok(())
    } else {
        Err(DatabaseError::WrongLength {
            what: what.to_owned(),
            expected,
            found,
        })
    }
}
