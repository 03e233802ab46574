//! Everything that is the same for all models built from some snapshots.

use capsule_core::model::wire::Reference;
use capsule_database::{Collection, Database};
use rayon::prelude::*;
use std::f64::consts::PI;

use crate::border::{Jump, border, is_late, jumps, places};
use crate::build::Source;
use crate::distance::Distance;
use crate::hausdorff::Sector;
use crate::limit::{SteadyLimit, curve, steady_limits};
use crate::pod::{DoublePod, Snapshots};
use crate::samples::{Part, SAME_ROW, Sample, Truth, clusters, common_symmetry, instants, of_collection, read};
use crate::scaling::Scaling;
use crate::surfaces::Surfaces;
use crate::writer::{Domain, OwnedCluster, OwnedMesh, Units, write};
use crate::{OfflineError, Progress, Settings};

/// Instants closer than this (l/V) are the same.
pub(crate) const SAME_TIME: f64 = 1e-9;

fn check_parameters(database: &Database) -> Result<(), OfflineError> {
    let parameters = &database.description().parameters;
    let found: Vec<String> = parameters.iter().map(|p| p.name.clone()).collect();
    if found == ["capillary_number", "confinement"] {
        Ok(())
    } else {
        Err(OfflineError::WrongParameters { found })
    }
}

/// Everything that is the same for all models built from a database: with all its samples, or without one.
///
/// Other people's data are in the working units of their [`Scaling`].
pub(crate) struct Plan<'a> {
    /// As they were given.
    given: &'a Settings,
    /// In the working units.
    pub(crate) settings: Settings,
    scaling: Scaling,
    pub(crate) samples: Vec<Sample>,
    pub(crate) distance: Distance,
    /// Other people's data, from which models of fewer instants can be built.
    surfaces: Option<Surfaces>,
    /// Of how many instants of the data one is used.
    pub(crate) stride: usize,
    /// The order of the symmetry.
    pub(crate) symmetry: usize,
    pub(crate) mesh: OwnedMesh,
    pub(crate) domain: Domain,
    pub(crate) brackets: Vec<SteadyLimit>,
    pub(crate) jumps: Vec<Jump>,
    /// Configurations without the samples' smoothness in time.
    pub(crate) late: Vec<Vec<f64>>,
    parts: Vec<Part>,
    pub(crate) nodes: usize,
}

/// The snapshots of a cluster in a common basis.
pub(crate) struct Reduced {
    pub(crate) part: Part,
    pub(crate) snapshots: Snapshots,
}

/// A cluster built from some of its samples.
pub(crate) struct Built {
    pub(crate) parts: OwnedCluster,
    pub(crate) pod: DoublePod,
}

impl<'a> Plan<'a> {
    pub(crate) fn new(source: Source, settings: &'a Settings, progress: Progress) -> Result<Self, OfflineError> {
        settings.validate()?;
        match source {
            Source::Database(database) => Self::of_database(database, settings, progress),
            Source::Collection(collection) => Self::of_collection(collection, settings, progress),
        }
    }

    fn of_database(database: &Database, settings: &'a Settings, progress: Progress) -> Result<Self, OfflineError> {
        check_parameters(database)?;
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

    fn of_collection(
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

    /// The instants of the errors at which there are snapshots.
    pub(crate) fn error_times(&self) -> &[f64] {
        &self.domain.error_times
    }

    /// Whether the samples are capsules in the channel.
    pub(crate) fn of_channel(&self) -> bool {
        self.surfaces.is_none()
    }

    /// The radius of a sample, in the working unit.
    pub(crate) fn radius(&self, sample: &Sample) -> f64 {
        if self.of_channel() { sample.parameters[1] } else { 1.0 }
    }

    /// The working unit of length in the data's.
    pub(crate) fn length(&self) -> f64 {
        self.scaling.length
    }

    /// The last instant, in the data's unit.
    pub(crate) fn end_time(&self) -> f64 {
        self.scaling.time * self.domain.times.last().copied().unwrap_or_default()
    }

    /// The instants of the errors in the data's unit.
    pub(crate) fn given_error_times(&self) -> Vec<f64> {
        self.error_times().iter().map(|t| self.scaling.time * t).collect()
    }

    /// A range of the clusters' parameter in the data's unit.
    pub(crate) fn given_range(&self, range: [f64; 2]) -> [f64; 2] {
        let parameter = self.settings.split.map_or(0, |split| split.parameter);
        self.scaling.given_range(parameter, range)
    }

    /// The stored instants.
    pub(crate) fn times(&self) -> &[f64] {
        &self.domain.times
    }

    /// The range of each parameter that the model answers for.
    pub(crate) fn ranges(&self) -> &[[f64; 2]] {
        &self.domain.ranges
    }

    /// Whether a sample lies in the domain that the model answers for.
    pub(crate) fn inside(&self, sample: &Sample) -> bool {
        let below_limit = || {
            let [capillary_number, confinement] = [sample.parameters[0], sample.parameters[1]];
            let in_row = |row: &&SteadyLimit| (row.confinement - confinement).abs() <= SAME_ROW;
            let row = self.brackets.iter().find(in_row);
            capillary_number <= row.and_then(|row| row.largest_steady_ca).unwrap_or(0.0) + SAME_ROW
        };
        let ranges = sample.parameters.iter().zip(&self.domain.ranges);
        let mut within = ranges.map(|(v, [low, high])| *v > low - SAME_ROW && *v < high + SAME_ROW);
        within.all(|within| within) && (self.brackets.is_empty() || below_limit())
    }

    /// The snapshots of each cluster.
    pub(crate) fn reduce(&self) -> Result<Vec<Reduced>, OfflineError> {
        let reduce = |part: &Part| {
            let samples = part.members.iter().map(|j| &self.samples[*j]);
            let states: Vec<_> = samples.map(|s| [&s.displacement, &s.velocity]).collect();
            Ok(Reduced {
                part: part.clone(),
                snapshots: Snapshots::new(&states, &self.domain.times, self.nodes, self.settings.truncation)?,
            })
        };
        self.parts.par_iter().map(reduce).collect()
    }

    /// Builds a cluster from those of its samples whose places are in `keep`.
    pub(crate) fn cluster(&self, cluster: &Reduced, keep: &[usize]) -> Result<Built, OfflineError> {
        let pod = cluster.snapshots.reduce(keep)?;
        let parameters: Vec<&[f64]> = keep
            .iter()
            .map(|j| &self.samples[cluster.part.members[*j]].parameters[..])
            .collect();
        let parts = OwnedCluster::new(
            cluster.part.range,
            &parameters,
            &cluster.snapshots,
            &pod,
            &self.mesh,
            self.error_times().len(),
            self.settings.storage,
        );
        Ok(Built { parts, pod })
    }

    /// A model in the working units.
    pub(crate) fn write(&self, clusters: &[&OwnedCluster]) -> Result<Vec<u8>, OfflineError> {
        let scaling = Scaling::none(&self.domain.ranges);
        write(
            [self.given, &self.settings],
            &self.domain,
            &self.mesh,
            clusters,
            &scaling,
        )
    }

    /// A model in the units of its data.
    pub(crate) fn write_in_given_units(&self, clusters: &[&OwnedCluster]) -> Result<Vec<u8>, OfflineError> {
        write(
            [self.given, &self.settings],
            &self.domain,
            &self.mesh,
            clusters,
            &self.scaling,
        )
    }

    /// A quarter of the way of the nodes from each snapshot to the next, for each sample of a cluster: what
    /// interpolation may err by at most where too few instants say more.
    pub(crate) fn quarter_steps(&self, cluster: usize) -> Result<Vec<Vec<f64>>, OfflineError> {
        let Some(surfaces) = &self.surfaces else {
            return Ok(Vec::new());
        };
        let steps = |sample: &usize| {
            let snapshots = surfaces.collection.positions[*sample].windows(2);
            snapshots
                .map(|pair| 0.25 * self.distance.between(&pair[0], &pair[1]))
                .collect()
        };
        Ok(self.parts[cluster].members.iter().map(steps).collect())
    }

    /// The cluster that answers a query: the first that reaches up to it.
    pub(crate) fn answering(&self, parameters: &[f64]) -> usize {
        let value = parameters[self.settings.split.map_or(0, |split| split.parameter)];
        self.parts
            .iter()
            .position(|part| value <= part.range[1] + SAME_ROW)
            .unwrap_or(0)
    }
}
