//! The effect of the bending stiffness, where it has been computed: `bending.csv` in the folder of the snapshots.
//!
//! The full-order model resists bending so that its solutions converge; the modelled membrane does not. The file holds
//! the difference between the solutions with the database's stiffness and without.

use std::path::PathBuf;

use serde::Deserialize;

use crate::{Database, DatabaseError, atomic, table};

/// One configuration.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct BendingEffect {
    /// Ca.
    pub capillary_number: f64,
    /// a/l.
    pub confinement: f64,
    /// Modified Hausdorff distance between the shapes with and without bending stiffness at the end, in the frame of
    /// the centroid, as a fraction of a.
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

    /// Writes the effect of the bending stiffness into the folder of the snapshots.
    ///
    /// # Errors
    /// [`DatabaseError::Io`].
    pub fn write_bending_effect(&self, rows: &[BendingEffect]) -> Result<(), DatabaseError> {
        let row = |row: &BendingEffect| {
            let numbers = [row.capillary_number, row.confinement, row.distance];
            numbers.map(|number| format!("{number:.6}"))
        };
        let heading = ["capillary_number", "confinement", "distance"];
        atomic::write(&self.bending_file(), &table::csv(None, heading, rows.iter().map(row))?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Description, Mesh};

    #[test]
    fn the_effect_is_read_as_it_was_written_and_a_bad_row_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let nodes = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
            .map(|node| node.map(f64::from))
            .to_vec();
        let elements = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
            .map(|[a, b, c]| [a, b, c, a, b, c])
            .to_vec();
        let description = Description::new(vec![0.0, 1.0], serde_json::Value::Null);
        let database = Database::create(folder.path(), description, Mesh { nodes, elements }).unwrap();
        assert_eq!(database.bending_effect().unwrap(), []);
        let row = |capillary_number, distance| BendingEffect {
            capillary_number,
            confinement: 0.9,
            distance,
        };
        let rows = [row(0.005, 0.015), row(0.1, 0.001)];
        database.write_bending_effect(&rows).unwrap();
        assert_eq!(database.bending_effect().unwrap(), rows);
        let file = folder.path().join("bending.csv");
        for bad in ["0.1,0.9", "0.1,0.9,x", "0.1,0.9,-1", "0.1,0.9,nan"] {
            std::fs::write(
                &file,
                format!("capillary_number,confinement,distance\n0.1,0.9,0.01\n{bad}\n"),
            )
            .unwrap();
            let error = database.bending_effect().unwrap_err();
            assert!(matches!(error, DatabaseError::BadRow { row: 2, .. }), "{bad}: {error}");
        }
    }
}
