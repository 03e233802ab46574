//! A database as plain arrays at common instants, for NumPy, HDF5 readers and ParaView, and for
//! [`Collection::read`](crate::Collection::read).
//!
//! Trajectories end at different times: a run ends soon after its shape is steady. All are exported at the same
//! instants, as a model is built: a steady capsule goes on in rigid translation ([`Trajectory::extended`]), and one
//! that is not steady at its end is left out if that lies before the last instant.

mod hdf5;
mod npz;
mod series;

use std::ops::ControlFlow;
use std::path::Path;

use crate::trajectory::SAME_TIME;
use crate::{Database, DatabaseError, Entry, Trajectory, collection};

/// Is called with the configurations that are written, and their number; may ask to end the work.
pub type Progress<'p> = &'p mut dyn FnMut(usize, usize) -> ControlFlow<()>;

/// The exported part of a database.
#[derive(Debug)]
pub struct Export<'d> {
    database: &'d Database,
    times: Vec<f64>,
    entries: Vec<Entry>,
    left_out: Vec<Entry>,
}

impl<'d> Export<'d> {
    /// The configurations that reach the last of the `times`, which rise from 0 and are instants of the database.
    ///
    /// # Errors
    /// [`DatabaseError::NoInstant`], [`DatabaseError::NothingToExport`], [`DatabaseError::BadCollection`] for instants
    /// that do not rise from 0, or an error of a file.
    pub fn new(database: &'d Database, times: Vec<f64>) -> Result<Self, DatabaseError> {
        collection::check_times(&times)?;
        let stored = database.times();
        for &time in &times {
            let next = stored.partition_point(|t| *t < time - SAME_TIME);
            if stored.get(next).is_none_or(|t| *t > time + SAME_TIME) {
                let around = stored[next.saturating_sub(1)..stored.len().min(next + 1)].to_vec();
                return Err(DatabaseError::NoInstant { time, around });
            }
        }
        let end = times.last().copied().unwrap_or_default();
        // The snapshots of a configuration are those at the first instants of the database.
        let reaches = |entry: &Entry| match entry.snapshots.checked_sub(1) {
            None => false,
            Some(last) => entry.status.is_steady() || stored.get(last).is_some_and(|t| *t > end - SAME_TIME),
        };
        let (entries, left_out): (Vec<_>, Vec<_>) = database.entries()?.into_iter().partition(reaches);
        if entries.is_empty() {
            return Err(DatabaseError::NothingToExport {
                path: database.directory().to_path_buf(),
                end,
            });
        }
        Ok(Self {
            database,
            times,
            entries,
            left_out,
        })
    }

    /// The instants.
    #[must_use]
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The configurations, in the order of the arrays.
    #[must_use]
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// The configurations that have no snapshots, or that are not steady and end too early.
    #[must_use]
    pub fn left_out(&self) -> &[Entry] {
        &self.left_out
    }

    /// Writes an archive as `numpy.savez_compressed` makes it, one configuration in memory at a time.
    ///
    /// # Errors
    /// [`DatabaseError::Interrupted`], [`DatabaseError::Io`], or an error of a file that is read.
    pub fn write_npz(&self, path: &Path, progress: Progress) -> Result<(), DatabaseError> {
        npz::write(self, path, progress)
    }

    /// Writes an HDF5 file with the arrays as datasets of the root group, one configuration in memory at a time.
    ///
    /// # Errors
    /// As [`Export::write_npz`].
    pub fn write_hdf5(&self, path: &Path, progress: Progress) -> Result<(), DatabaseError> {
        hdf5::write(self, path, progress)
    }

    /// Writes a ParaView series for each configuration and `parameters.csv` into `folder`, which is there.
    ///
    /// # Errors
    /// As [`Export::write_npz`].
    pub fn write_series(&self, folder: &Path, progress: Progress) -> Result<(), DatabaseError> {
        series::write(self, folder, progress)
    }

    /// The parameters' names.
    fn names(&self) -> Vec<&str> {
        let parameters = &self.database.description().parameters;
        parameters.iter().map(|parameter| parameter.name.as_str()).collect()
    }

    /// Lengths of the arrays' axes: configurations, instants, nodes.
    fn lengths(&self) -> [usize; 3] {
        [self.entries.len(), self.times.len(), self.database.mesh().nodes.len()]
    }

    /// Reads the configurations one by one, with their indices.
    fn each(
        &self,
        mut write: impl FnMut(usize, Trajectory) -> Result<(), DatabaseError>,
        mut progress: impl FnMut(usize) -> ControlFlow<()>,
    ) -> Result<(), DatabaseError> {
        for (index, entry) in self.entries.iter().enumerate() {
            let trajectory = self.database.read(&entry.parameters)?;
            write(index, trajectory.extended(self.database.mesh(), &self.times)?)?;
            if progress(index + 1).is_break() {
                return Err(DatabaseError::Interrupted);
            }
        }
        Ok(())
    }
}

/// The units of lengths and times in a database, by the arrays' names.
const UNITS: [(&str, &str); 2] = [("length_unit", "l"), ("time_unit", "l/V")];

/// The numbers of a field, without its axes.
fn flat(field: &[Vec<[f64; 3]>]) -> Vec<f64> {
    field.iter().flatten().flatten().copied().collect()
}

#[cfg(test)]
mod tests;
