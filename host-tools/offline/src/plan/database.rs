//! The plan of a model of capsules in the channel.

use capsule_core::model::Reference;
use capsule_database::Database;

use super::Plan;
use crate::border::{border, is_late, jumps, places};
use crate::distance::Distance;
use crate::hausdorff::Sector;
use crate::limit::{curve, steady_limits};
use crate::samples::{Sample, clusters, instants, read};
use crate::scaling::Scaling;
use crate::source::Source;
use crate::tolerances::SAME_TIME;
use crate::writer::{Domain, OwnedMesh, Units};
use crate::{OfflineError, Progress, Settings};

impl<'a> Plan<'a> {
    pub(super) fn of_database(
        database: &Database,
        settings: &'a Settings,
        progress: Progress,
    ) -> Result<Self, OfflineError> {
        check_parameters(database)?;
        check_law(database, settings)?;
        let symmetry = database.symmetry();
        let mesh = OwnedMesh::new(database.mesh(), symmetry, Reference::Sphere)?;
        let names = Source::Database(database).parameter_names();
        let entries = database.entries()?;
        let brackets = steady_limits(&entries);
        let has = |time: f64| database.times().iter().any(|t| (t - time).abs() < SAME_TIME);
        let error_times: Vec<f64> = settings.error_times.iter().copied().filter(|t| has(*t)).collect();
        let samples = read(database, &entries, &brackets, settings, &error_times, progress)?;
        let places = places(&samples);
        let (late, samples): (Vec<Sample>, Vec<Sample>) = samples.into_iter().partition(|s| is_late(s.dent));
        let parts = clusters(&samples, settings.split, &names)?;
        let range = |d: usize| {
            let values = samples.iter().filter(|s| s.steady).map(|s| s.parameters[d]);
            let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)]);
            [low.max(settings.domain[d][0]), high.min(settings.domain[d][1])]
        };
        let ranges = vec![range(0), range(1)];
        if ranges.iter().any(|[low, high]| low > high) || error_times.is_empty() {
            return Err(OfflineError::Unsampled {
                domain: settings.domain.clone(),
                error_times: settings.error_times.clone(),
            });
        }
        let jumps = jumps(&places);
        let domain = Domain {
            names,
            units: Units::channel(),
            ranges,
            border: border(&jumps, &places),
            steady_limit: curve(&brackets),
            bending_stiffness: database.description().bending_stiffness(),
            bending_effect: database
                .bending_effect()?
                .iter()
                .map(|row| [row.capillary_number, row.confinement, row.distance])
                .collect(),
            times: instants(database.times(), settings.spacing),
            error_times,
            database_digest: format!("{:016x}", database.digest()?),
        };
        Ok(Plan {
            given: settings,
            settings: settings.clone(),
            scaling: Scaling::none(&domain.ranges),
            distance: Distance::ModifiedHausdorff(Sector::of(symmetry)),
            surfaces: None,
            stride: 1,
            symmetry: symmetry.order(),
            mesh,
            domain,
            brackets,
            jumps,
            late: late.into_iter().map(|sample| sample.given).collect(),
            parts,
            nodes: database.mesh().nodes.len(),
            samples,
        })
    }
}

fn check_law(database: &Database, settings: &Settings) -> Result<(), OfflineError> {
    let found = database.description().membrane_law();
    if found == settings.membrane_law {
        Ok(())
    } else {
        Err(OfflineError::WrongLaw {
            expected: settings.membrane_law.clone(),
            found: found.to_owned(),
        })
    }
}

fn check_parameters(database: &Database) -> Result<(), OfflineError> {
    let parameters = &database.description().parameters;
    let found: Vec<String> = parameters.iter().map(|p| p.name.clone()).collect();
    if found == ["capillary_number", "confinement"] {
        Ok(())
    } else {
        Err(OfflineError::WrongParameters { found })
    }
}
