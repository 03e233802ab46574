//! By how much the bending stiffness of the full-order model changes its solution.

use capsule_database::{BendingEffect, Database, Entry};
use rayon::prelude::*;

use crate::OfflineError;
use crate::distance::Distance;
use crate::hausdorff::Sector;
use crate::samples::Truth;

/// The modified Hausdorff distance at the end, in the frame of the centroid and as a fraction of a, between the
/// solutions of two databases at the configurations that are steady in both: `without` holds those without bending
/// stiffness.
///
/// # Errors
/// The databases' errors; [`OfflineError::WrongParameters`] where they are not over (Ca, a/l); another mesh.
pub fn bending_effect(database: &Database, without: &Database) -> Result<Vec<BendingEffect>, OfflineError> {
    let nodes = |database: &Database| database.mesh().nodes.len();
    if nodes(database) != nodes(without) {
        let what = "nodes of the mesh without bending stiffness".to_owned();
        let (expected, found) = (nodes(database), nodes(without));
        return Err(capsule_database::DatabaseError::WrongLength { what, expected, found }.into());
    }
    let end = database.times().last().copied().unwrap_or_default();
    let distance = Distance::ModifiedHausdorff(Sector::of(database.symmetry()));
    let steady = |database: &Database| -> Result<Vec<Entry>, OfflineError> {
        let entries = database.entries()?.into_iter();
        Ok(entries
            .filter(|entry| entry.status.is_steady() && entry.snapshots > 0)
            .collect())
    };
    let known = steady(database)?;
    let both = |entry: &Entry| known.iter().any(|other| other.parameters == entry.parameters);
    let found = steady(without)?.into_par_iter().filter(both).map(|entry| {
        let shape = |database: &Database| -> Result<Vec<[f64; 3]>, OfflineError> {
            let truth = Truth::read(database, &entry.parameters, &[end])?;
            let centred = |truth: &Truth| {
                let nodes = truth.positions.iter();
                nodes.map(|[x, y, z]| [x - truth.centroid, *y, *z]).collect()
            };
            Ok(truth.iter().map(centred).next().unwrap_or_default())
        };
        let [capillary_number, confinement] = *entry.parameters.first_chunk().ok_or(OfflineError::WrongParameters {
            found: without
                .description()
                .parameters
                .iter()
                .map(|p| p.name.clone())
                .collect(),
        })?;
        Ok(BendingEffect {
            capillary_number,
            confinement,
            distance: distance.between(&shape(database)?, &shape(without)?) / confinement,
        })
    });
    found.collect()
}
