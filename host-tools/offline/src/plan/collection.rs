//! The plan of a model of other data, in working units.

use capsule_core::model::Reference;
use capsule_database::Collection;
use std::f64::consts::PI;

use super::Plan;
use crate::distance::Distance;
use crate::samples::{Truth, clusters, common_symmetry, of_collection};
use crate::scaling::Scaling;
use crate::surfaces::Surfaces;
use crate::writer::{Domain, OwnedMesh, Units};
use crate::{OfflineError, Progress, Settings};

impl<'a> Plan<'a> {
    pub(super) fn of_collection(
        collection: &Collection,
        settings: &'a Settings,
        progress: Progress,
    ) -> Result<Self, OfflineError> {
        let scaling = Scaling::of(collection)?;
        let working = scaling.collection(collection);
        let (reference, radius) = working.reference()?;
        let symmetry = common_symmetry(&working, &reference, radius);
        let volume = 4.0 / 3.0 * PI * radius.powi(3);
        let mut volumes = [f64::INFINITY, f64::NEG_INFINITY];
        for positions in working.positions.iter().flatten() {
            let (found, _) = reference.volume_and_centroid(positions)?;
            volumes = [volumes[0].min(found / volume), volumes[1].max(found / volume)];
        }
        let shape = Reference::Shape {
            radius,
            origin: 0.0,
            volumes,
        };
        let mesh = OwnedMesh::new(&reference, &symmetry, shape)?;
        let surfaces = Surfaces {
            derived: collection.velocities_are_derived(),
            collection: working,
            given: collection.parameters.clone(),
            reference,
            symmetry,
        };
        let units = Units::new(collection.length_unit.as_deref(), collection.time_unit.as_deref());
        let digest = format!("{:016x}", collection.digest());
        Self::of_surfaces(surfaces, mesh, scaling, settings, (units, digest), progress)
    }

    /// The plan of a model of every `stride`-th instant, whose samples hold out those between; none where there are too
    /// few, and for a database.
    pub(crate) fn thinned(&self, stride: usize, progress: Progress) -> Result<Option<Self>, OfflineError> {
        let Some(all) = &self.surfaces else { return Ok(None) };
        let Some((surfaces, held_out)) = all.thinned(stride)? else {
            return Ok(None);
        };
        let (units, digest) = (self.domain.units.clone(), self.domain.database_digest.clone());
        let (mesh, scaling) = (self.mesh.clone(), self.scaling.clone());
        let plan = Self::of_surfaces(surfaces, mesh, scaling, self.given, (units, digest), progress)?;
        let mut plan = Plan { stride, ..plan };
        for (sample, positions) in plan.samples.iter_mut().zip(&all.collection.positions) {
            for instant in &held_out {
                let (_, centroid) = all.reference.volume_and_centroid(&positions[*instant])?;
                sample.held_out.push(Truth {
                    time: all.collection.times[*instant],
                    positions: positions[*instant].clone(),
                    centroid,
                });
            }
        }
        Ok(Some(plan))
    }

    fn of_surfaces(
        surfaces: Surfaces,
        mesh: OwnedMesh,
        scaling: Scaling,
        given: &'a Settings,
        (units, database_digest): (Units, String),
        progress: Progress,
    ) -> Result<Self, OfflineError> {
        let settings = scaling.settings(given);
        let Surfaces {
            collection,
            given: given_parameters,
            reference,
            symmetry,
            ..
        } = &surfaces;
        let known = |t: &f64| collection.times.contains(t);
        let mut error_times: Vec<f64> = settings.error_times.iter().copied().filter(known).collect();
        if error_times.is_empty() {
            error_times.extend(collection.times.last());
        }
        let samples = of_collection(
            collection,
            reference,
            symmetry,
            &error_times,
            given_parameters,
            progress,
        )?;
        let names = collection.parameter_names.clone();
        let parts = clusters(&samples, settings.split, &names).map_err(|error| match error {
            OfflineError::TooFewSamples {
                parameter,
                range,
                found,
                needed,
            } => OfflineError::TooFewSamples {
                range: scaling.given_range(settings.split.map_or(0, |split| split.parameter), range),
                parameter,
                found,
                needed,
            },
            other => other,
        })?;
        let domain = Domain {
            names,
            units,
            ranges: collection.ranges(),
            border: Vec::new(),
            steady_limit: Vec::new(),
            bending_stiffness: None,
            bending_effect: Vec::new(),
            times: collection.times.clone(),
            error_times,
            database_digest,
        };
        Ok(Plan {
            given,
            settings,
            scaling,
            distance: Distance::Nodes,
            symmetry: symmetry.order(),
            mesh,
            domain,
            brackets: Vec::new(),
            jumps: Vec::new(),
            late: Vec::new(),
            parts,
            nodes: reference.nodes.len(),
            samples,
            surfaces: Some(surfaces),
            stride: 1,
        })
    }
}
