//! Collections in HDF5 files: the arrays are datasets of the root group.

use hdf5_pure::File;
use ndarray::{ArrayD, IxDyn};
use std::path::{Path, PathBuf};

use super::arrays::Arrays;
use crate::DatabaseError;

/// An HDF5 file.
pub(crate) struct Archive {
    path: PathBuf,
    file: File,
    names: Vec<String>,
}

impl Archive {
    pub(crate) fn open(path: &Path) -> Result<Self, DatabaseError> {
        let corrupt = |error: hdf5_pure::Error| match error {
            hdf5_pure::Error::Io(source) => DatabaseError::io("read", path)(source),
            other => DatabaseError::Corrupt {
                path: path.to_path_buf(),
                reason: other.to_string(),
            },
        };
        let file = File::open(path).map_err(corrupt)?;
        let names = file.root().datasets().map_err(corrupt)?;
        Ok(Self {
            path: path.to_path_buf(),
            file,
            names,
        })
    }

    fn wrong(&self, name: &str, expected: &'static str, error: &hdf5_pure::Error) -> DatabaseError {
        DatabaseError::WrongType {
            path: self.path.clone(),
            name: name.to_owned(),
            expected,
            found: error.to_string(),
        }
    }
}

impl Arrays for Archive {
    fn path(&self) -> &Path {
        &self.path
    }

    fn has(&self, name: &str) -> bool {
        self.names.iter().any(|known| known == name)
    }

    fn numbers(&mut self, name: &str) -> Result<ArrayD<f64>, DatabaseError> {
        let wrong = |error| self.wrong(name, "real numbers", &error);
        let dataset = self.file.dataset(name).map_err(wrong)?;
        let shape: Vec<usize> = dataset.shape().map_err(wrong)?.iter().map(|n| *n as usize).collect();
        let values = dataset.read_f64().map_err(wrong)?;
        let (found, counted) = (values.len(), shape.iter().product::<usize>());
        ArrayD::from_shape_vec(IxDyn(&shape), values).map_err(|_| DatabaseError::Corrupt {
            path: self.path.clone(),
            reason: format!("array `{name}` holds {found} numbers, its shape {counted}"),
        })
    }

    fn texts(&mut self, name: &str) -> Result<Vec<String>, DatabaseError> {
        let wrong = |error| self.wrong(name, "text", &error);
        let texts = self
            .file
            .dataset(name)
            .and_then(|dataset| dataset.read_string())
            .map_err(wrong)?;
        Ok(texts
            .into_iter()
            .map(|text| text.trim_end_matches('\0').to_owned())
            .collect())
    }
}
