//! From a database to a model file.

use capsule_core::Model;
use capsule_core::model::wire::Reference;
use capsule_database::{Collection, Database};
use rayon::prelude::*;
use serde::Serialize;

use crate::border::{Jump, border, is_late, jumps, places};
use crate::bound::bound_factors;
use crate::compare::{METHODS, distances, predictions};
use crate::hausdorff::Sector;
use crate::leave_one_out::each_left_out;
use crate::limit::{SteadyLimit, curve, steady_limits};
use crate::pod::{DoublePod, Snapshots};
use crate::samples::{Part, SAME_ROW, Sample, clusters, common_symmetry, instants, of_collection, read};
use crate::spectra::laboratory;
use crate::writer::{ClusterParts, Domain, ErrorParts, MeshParts, Numbers, Units, write};
use crate::{LeftOut, OfflineError, Progress, Settings, Spectrum};

/// What a build found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BuildReport {
    /// Configurations in the model.
    pub samples: usize,
    /// Those of them that never became steady.
    pub unsteady_samples: usize,
    /// Parameters of the configurations that take no part because they buckle late.
    pub late: Vec<Vec<f64>>,
    /// Instants of the snapshots, and the last of them.
    pub instants: usize,
    /// See [`BuildReport::instants`].
    pub end_time: f64,
    /// Order of the symmetry that mesh and snapshots have: 8 for the whole square, 1 for none.
    pub symmetry: usize,
    /// The instants of the leave-one-out errors.
    pub error_times: Vec<f64>,
    /// The parameter along which the clusters follow each other.
    pub cluster_parameter: String,
    /// The bracket of the steady limit in each row of confinements.
    pub steady_limit: Vec<SteadyLimit>,
    /// Length of the file.
    pub bytes: usize,
    /// The core's digest of the file.
    pub digest: u32,
    /// The database's digest.
    pub database_digest: String,
    /// Each cluster.
    pub clusters: Vec<ClusterReport>,
    /// Where the solution jumps from a smooth rear to a dented one: weights do not cross the border between.
    pub jumps: Vec<Jump>,
    /// Singular values: of the whole database in the laboratory frame as in the paper, then of each cluster.
    pub spectra: Vec<Spectrum>,
    /// The 95 % bound of the error over the expected error at each instant: direct and paper's method.
    pub bound_factors: [Vec<f64>; 2],
    /// Errors at the samples, each predicted without itself.
    pub left_out: Vec<LeftOut>,
}

/// One cluster.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ClusterReport {
    /// Least and greatest value of the parameter along which the clusters follow each other: a/l, or the first.
    pub range: [f64; 2],
    /// Samples.
    pub samples: usize,
    /// The reduction of its motion.
    pub field: FieldReport,
    /// Mean error at the samples themselves, over the error instants, as a fraction of a: direct and paper's method.
    pub floor: [f64; 2],
}

/// The reduction of displacement and velocity.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FieldReport {
    /// K^x, the translation included.
    pub space_rank: usize,
    /// K^c of each span of time.
    pub parameter_ranks: Vec<usize>,
    /// Controls of the splines in time.
    pub controls: usize,
    /// Rows of the core.
    pub rows: usize,
    /// Modes of the translation.
    pub axial_rank: usize,
    /// Root-mean-square error of the displacement over nodes, instants and samples that the space modes leave, in l.
    pub space_error: f64,
    /// That which the parameter modes leave.
    pub parameter_error: f64,
}

/// Where a model's samples come from.
#[derive(Debug, Clone, Copy)]
pub enum Source<'a> {
    /// Capsules in the channel, over (Ca, a/l).
    Database(&'a Database),
    /// Other people's data.
    Collection(&'a Collection),
}

impl Source<'_> {
    /// The parameters' names.
    #[must_use]
    pub fn parameter_names(&self) -> Vec<String> {
        match self {
            Source::Database(database) => database
                .description()
                .parameters
                .iter()
                .map(|p| p.name.clone())
                .collect(),
            Source::Collection(collection) => collection.parameter_names.clone(),
        }
    }
}

impl<'a> From<&'a Database> for Source<'a> {
    fn from(database: &'a Database) -> Self {
        Source::Database(database)
    }
}

impl<'a> From<&'a Collection> for Source<'a> {
    fn from(collection: &'a Collection) -> Self {
        Source::Collection(collection)
    }
}

/// Builds a model from the configurations of a database or a collection: the bytes of the file, and a report.
///
/// Equal data and settings give equal bytes.
///
/// # Errors
/// [`OfflineError`]: too few samples, snapshots without the symmetry of their mesh, settings without meaning, or a
/// damaged database.
pub fn build<'a>(
    source: impl Into<Source<'a>>,
    settings: &Settings,
    progress: Progress,
) -> Result<(Vec<u8>, BuildReport), OfflineError> {
    let plan = Plan::new(source.into(), settings, progress)?;
    progress("singular values", 0, 2);
    let mut spectra = laboratory(&plan.samples, plan.mesh.scales(), plan.nodes)?;
    progress("singular values", 1, 2);
    let reduced = plan.reduce()?;
    progress("singular values", 2, 2);
    let built: Result<Vec<Built>, OfflineError> = reduced
        .iter()
        .map(|cluster| plan.cluster(cluster, &(0..cluster.part.members.len()).collect::<Vec<_>>()))
        .collect();
    let mut built = built?;
    let left_out = each_left_out(&plan, &reduced, &|c, j| Ok(built[c].parts.without(&[j])), progress)?;
    for (index, (cluster, built)) in reduced.iter().zip(&mut built).enumerate() {
        let floors = floors(&plan, cluster, &built.parts)?;
        for (m, method) in METHODS.into_iter().enumerate() {
            let of_method = left_out.iter().filter(|e| e.cluster == index && e.method == method);
            built.parts.errors[m] = ErrorParts::new(of_method, plan.error_times().len(), floors[m]);
        }
    }
    progress("error bounds", 0, 1);
    let factors = bound_factors(&plan, &reduced, &built.iter().map(|b| &b.parts).collect::<Vec<_>>())?;
    progress("error bounds", 1, 1);

    let mut parts = Vec::new();
    let mut reports = Vec::new();
    for (cluster, mut built) in reduced.iter().zip(built) {
        for (errors, factors) in built.parts.errors.iter_mut().zip(&factors) {
            errors.bound_factors = Numbers::column(factors);
        }
        let floors = built.parts.errors.each_ref().map(|errors| errors.floor);
        for (matrix, values) in [("S", &built.pod.parameter_values), ("T", &built.pod.space_values)] {
            spectra.push(Spectrum {
                matrix,
                cluster: Some(cluster.part.range),
                singular_values: values.clone(),
            });
        }
        reports.push(ClusterReport {
            range: cluster.part.range,
            samples: cluster.part.members.len(),
            field: field_report(&cluster.snapshots, &built.pod),
            floor: floors,
        });
        parts.push(built.parts);
    }
    let bytes = plan.write(&parts.iter().collect::<Vec<_>>())?;
    let digest = Model::open(&bytes).map_err(OfflineError::Invalid)?.digest();
    let report = BuildReport {
        samples: plan.samples.len(),
        unsteady_samples: plan.samples.iter().filter(|s| !s.steady).count(),
        instants: plan.domain.times.len(),
        end_time: plan.domain.times.last().copied().unwrap_or(0.0),
        symmetry: plan.symmetry,
        error_times: plan.error_times().to_vec(),
        cluster_parameter: plan.domain.names[settings.split.map_or(0, |split| split.parameter)].clone(),
        steady_limit: plan.brackets,
        jumps: plan.jumps,
        late: plan.late,
        bytes: bytes.len(),
        digest,
        database_digest: plan.domain.database_digest,
        clusters: reports,
        spectra,
        bound_factors: factors,
        left_out,
    };
    Ok((bytes, report))
}

/// Mean error of each method at the samples themselves, over samples and instants.
fn floors(plan: &Plan, cluster: &Reduced, parts: &ClusterParts) -> Result<[f64; 2], OfflineError> {
    let bytes = plan.write(&[parts])?;
    let model = Model::open(&bytes).map_err(OfflineError::Invalid)?;
    let floor = |method| {
        let members = &cluster.part.members;
        let means = members.par_iter().map(|j| {
            let sample = &plan.samples[*j];
            let failed = |source| OfflineError::Evaluate {
                parameters: sample.parameters.clone(),
                source,
            };
            let predictions = predictions(&model, &sample.parameters, method, &sample.truth).map_err(failed)?;
            let [errors, _] = distances(&model, &sample.parameters, &predictions, &sample.truth, &plan.sector);
            Ok(errors.iter().sum::<f64>() / errors.len() as f64)
        });
        let means: Result<Vec<f64>, OfflineError> = means.collect();
        Ok(means?.iter().sum::<f64>() / members.len() as f64)
    };
    let [direct, paper]: [Result<f64, OfflineError>; 2] = METHODS.map(floor);
    Ok([direct?, paper?])
}

fn field_report(snapshots: &Snapshots, pod: &DoublePod) -> FieldReport {
    let spans = pod.spans.iter();
    FieldReport {
        space_rank: pod.modes.ncols() + 1,
        parameter_ranks: spans.clone().map(|span| span.parameter_modes.ncols()).collect(),
        controls: spans.clone().map(|span| span.slices.len()).sum(),
        rows: spans.flat_map(|span| &span.slices).map(|slice| slice.nrows()).sum(),
        axial_rank: pod.axial_modes.ncols(),
        space_error: pod.space_error,
        parameter_error: snapshots.parameter_error(pod),
    }
}

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
pub(crate) struct Plan<'a> {
    pub(crate) settings: &'a Settings,
    pub(crate) samples: Vec<Sample>,
    pub(crate) sector: Sector,
    /// The order of the symmetry.
    symmetry: usize,
    mesh: MeshParts,
    domain: Domain,
    brackets: Vec<SteadyLimit>,
    jumps: Vec<Jump>,
    /// Configurations without the samples' smoothness in time.
    late: Vec<Vec<f64>>,
    parts: Vec<Part>,
    nodes: usize,
}

/// The snapshots of a cluster in a common basis.
pub(crate) struct Reduced {
    pub(crate) part: Part,
    snapshots: Snapshots,
}

/// A cluster built from some of its samples.
pub(crate) struct Built {
    pub(crate) parts: ClusterParts,
    pod: DoublePod,
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
        let mesh = MeshParts::new(database.mesh(), symmetry, Reference::Sphere)?;
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
            times: instants(database.times(), settings.spacing),
            error_times,
            database_digest: format!("{:016x}", database.digest()?),
        };
        Ok(Plan {
            settings,
            sector: Sector::of(symmetry),
            symmetry: symmetry.order(),
            mesh,
            domain,
            brackets,
            jumps,
            late: late.into_iter().map(|sample| sample.parameters).collect(),
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
        let (reference, radius) = collection.reference()?;
        let symmetry = common_symmetry(collection, &reference, radius);
        let mesh = MeshParts::new(&reference, &symmetry, Reference::Shape { radius })?;
        let times = settings.error_times.iter().copied();
        let error_times: Vec<f64> = times.filter(|t| collection.times.contains(t)).collect();
        if error_times.is_empty() {
            return Err(OfflineError::Unsampled {
                domain: settings.domain.clone(),
                error_times: settings.error_times.clone(),
            });
        }
        let samples = of_collection(collection, &reference, &symmetry, &error_times, progress)?;
        let names = collection.parameter_names.clone();
        let parts = clusters(&samples, settings.split, &names)?;
        let domain = Domain {
            names,
            units: Units::new(collection.length_unit.as_deref(), collection.time_unit.as_deref()),
            ranges: collection.ranges(),
            border: Vec::new(),
            steady_limit: Vec::new(),
            times: collection.times.clone(),
            error_times,
            database_digest: format!("{:016x}", collection.digest()),
        };
        Ok(Plan {
            settings,
            sector: Sector::of(&symmetry),
            symmetry: symmetry.order(),
            mesh,
            domain,
            brackets: Vec::new(),
            jumps: Vec::new(),
            late: Vec::new(),
            parts,
            nodes: reference.nodes.len(),
            samples,
        })
    }

    /// The instants of the errors at which there are snapshots.
    pub(crate) fn error_times(&self) -> &[f64] {
        &self.domain.error_times
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
        let parts = ClusterParts::new(
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

    pub(crate) fn write(&self, clusters: &[&ClusterParts]) -> Result<Vec<u8>, OfflineError> {
        write(self.settings, &self.domain, &self.mesh, clusters)
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
