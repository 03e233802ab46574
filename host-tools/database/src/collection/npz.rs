//! Collections in NPZ archives.

use std::path::Path;

use ndarray::ArrayD;
use ndarray_npy::{ReadNpyError, ReadNpzError, ReadableElement};

use super::arrays::Arrays;
use super::dtype::{NUMBERS, Real, TEXTS, Text, refused};
use crate::DatabaseError;
use crate::npz::Reader;

/// An archive that NumPy's `savez` or `savez_compressed` wrote.
pub(crate) struct Archive {
    reader: Reader,
    names: Vec<String>,
}

impl Archive {
    pub(crate) fn open(path: &Path) -> Result<Self, DatabaseError> {
        let mut reader = Reader::open(path)?;
        let mut names = reader.names()?;
        names.sort_unstable();
        Ok(Self { reader, names })
    }

    /// The array, whose elements must be of a type that `T` takes; `expected` says which, with the remedy for others.
    fn array<T: ReadableElement>(
        &mut self,
        name: &str,
        (expected, remedy): (&str, Option<&str>),
    ) -> Result<ArrayD<T>, DatabaseError> {
        let result = self.reader.by_name::<T>(name);
        result.map_err(|error| match error {
            ReadNpzError::Npy(ReadNpyError::WrongDescriptor(kind)) => refused(name, &kind, expected, remedy),
            ReadNpzError::Npy(ReadNpyError::ParseData(error)) => {
                DatabaseError::collection(format!("array `{name}`: {error}"))
            }
            other => DatabaseError::Corrupt {
                path: self.reader.path().to_path_buf(),
                reason: format!("array `{name}`: {other}"),
            },
        })
    }
}

impl Arrays for Archive {
    fn names(&self) -> &[String] {
        &self.names
    }

    fn numbers(&mut self, name: &str) -> Result<ArrayD<f64>, DatabaseError> {
        Ok(self.array::<Real>(name, NUMBERS)?.map(|Real(x)| *x))
    }

    fn texts(&mut self, name: &str) -> Result<Vec<String>, DatabaseError> {
        let texts = self.array::<Text>(name, TEXTS)?;
        Ok(texts.into_iter().map(|Text(text)| text).collect())
    }
}
