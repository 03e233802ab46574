//! The effect of the bending stiffness, where it has been computed: `bending.csv` beside the snapshots.
//!
//! The full-order model resists bending so that its solutions converge; the membrane that it stands for does not. The file says by
//! how much the solution with the database's stiffness differs from that without.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::{Database, DatabaseError, atomic};

/// One configuration.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BendingEffect {
    /// Ca.
    pub capillary_number: f64,
    /// a/l.
    pub confinement: f64,
    /// Modified Hausdorff distance between the shapes with and without bending stiffness at the end, in the frame of the
    /// centroid, as a fraction of a.
    pub distance: f64,
}

impl Database {
    fn bending_file(&self) -> PathBuf {
        self.directory().join("bending.csv")
    }

    /// The effect of the bending stiffness at some configurations; empty where it has not been computed.
    ///
    /// # Errors
    /// [`DatabaseError::Io`]; [`DatabaseError::BadRow`] for a row that is not three positive numbers.
    pub fn bending_effect(&self) -> Result<Vec<BendingEffect>, DatabaseError> {
        let path = self.bending_file();
        if !path.exists() {
            return Ok(Vec::new());
        }
        let text = std::fs::read(&path).map_err(DatabaseError::io("read", &path))?;
        let mut reader = csv::Reader::from_reader(&text[..]);
        let rows = reader.deserialize().enumerate().map(|(row, found)| match found {
            Ok(BendingEffect {
                capillary_number,
                confinement,
                distance,
            }) if [capillary_number, confinement, distance]
                .iter()
                .all(|x| x.is_finite() && *x > 0.0) =>
            {
                Ok(BendingEffect {
                    capillary_number,
                    confinement,
                    distance,
                })
            }
            _ => Err(DatabaseError::BadRow {
                path: path.clone(),
                row: row + 1,
                expected: "three positive numbers under `capillary_number,confinement,distance`",
            }),
        });
        rows.collect()
    }

    /// Writes the effect of the bending stiffness beside the snapshots.
    ///
    /// # Errors
    /// [`DatabaseError::Io`].
    pub fn write_bending_effect(&self, rows: &[BendingEffect]) -> Result<(), DatabaseError> {
        let path = self.bending_file();
        let mut writer = csv::Writer::from_writer(Vec::new());
        for row in rows {
            writer
                .serialize(row)
                .map_err(|error| DatabaseError::io("write", &path)(error.into()))?;
        }
        let bytes = writer
            .into_inner()
            .map_err(|error| DatabaseError::io("write", &path)(error.into_error()))?;
        atomic::write(&path, &bytes)
    }
}
