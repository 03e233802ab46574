//! Everything that is the same for all models built from some snapshots.

mod collection;
mod database;

use rayon::prelude::*;

use crate::border::Jump;
use crate::distance::Distance;
use crate::limit::SteadyLimit;
use crate::pod::{DoublePod, Snapshots};
use crate::samples::{Part, Sample};
use crate::scaling::Scaling;
use crate::source::Source;
use crate::surfaces::Surfaces;
use crate::tolerances::SAME_ROW;
use crate::writer::{Domain, OwnedCluster, OwnedMesh, write};
use crate::{OfflineError, Progress, Settings};

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
