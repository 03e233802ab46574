//! From a database to a model file.

use capsule_core::Model;
use serde::Serialize;

use crate::assembled::Assembled;
use crate::border::Jump;
use crate::bound::{bound_factors, interval_bound_factors};
use crate::changes::changes;
use crate::compare::METHODS;
use crate::intervals::interval_errors;
use crate::leave_one_out::each_left_out;
use crate::limit::SteadyLimit;
use crate::plan::Plan;
use crate::pod::{DoublePod, Snapshots};
use crate::spectra::laboratory;
use crate::writer::{OwnedErrors, StoredMatrix};
use crate::{LeftOut, OfflineError, Progress, Settings, Source, Spectrum};

/// Report of a build.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BuildReport {
    /// Configurations in the model.
    pub samples: usize,
    /// Samples that never became steady.
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
    /// Root-mean-square error that the parameter modes leave.
    pub parameter_error: f64,
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
    // The errors of models of every other, every fourth and every eighth instant give the error of the interpolation in
    // time.
    let every = |stride| plan.thinned(stride, progress)?.map(Assembled::new).transpose();
    let (mut two, four, eight) = (every(2)?, every(4)?, every(8)?);
    let [four, eight] = [four.as_ref(), eight.as_ref()];
    let mut model = Assembled::new(plan)?;
    progress("singular values", 2, 2);
    let left_out = {
        let Assembled { plan, reduced, built } = &model;
        each_left_out(plan, reduced, &|c, j| Ok(built[c].parts.without(&[j])), progress)?
    };
    measure(&mut model, &left_out, [two.as_ref(), four, eight])?;
    if let Some(two) = &mut two {
        measure(two, &[], [four, eight, None])?;
    }
    progress("error bounds", 0, 1);
    let factors = bound_factors(&model)?;
    for cluster in 0..model.built.len() {
        let changes = changes(&model, cluster)?;
        for (errors, changes) in model.built[cluster].parts.errors.iter_mut().zip(&changes) {
            errors.changes = StoredMatrix::column(changes);
        }
    }
    bound_intervals(&mut model, two.as_ref())?;
    progress("error bounds", 1, 1);

    let Assembled { plan, reduced, built } = model;
    let mut parts = Vec::new();
    let mut reports = Vec::new();
    for (cluster, mut built) in reduced.iter().zip(built) {
        for (errors, factors) in built.parts.errors.iter_mut().zip(&factors) {
            errors.bound_factors = StoredMatrix::column(factors);
        }
        let floors = built.parts.errors.each_ref().map(|errors| errors.floor);
        for (matrix, values) in [("S", &built.pod.parameter_values), ("T", &built.pod.space_values)] {
            spectra.push(Spectrum {
                matrix,
                cluster: Some(plan.given_range(cluster.part.range)),
                singular_values: values.clone(),
            });
        }
        reports.push(ClusterReport {
            range: plan.given_range(cluster.part.range),
            samples: cluster.part.members.len(),
            field: field_report(&cluster.snapshots, &built.pod, plan.length()),
            floor: floors,
        });
        parts.push(built.parts);
    }
    let bytes = plan.write_in_given_units(&parts.iter().collect::<Vec<_>>())?;
    let digest = Model::open(&bytes).map_err(OfflineError::Invalid)?.digest();
    let report = BuildReport {
        samples: plan.samples.len(),
        unsteady_samples: plan.samples.iter().filter(|s| !s.steady).count(),
        instants: plan.domain.times.len(),
        end_time: plan.end_time(),
        symmetry: plan.symmetry,
        error_times: plan.given_error_times(),
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

/// Stores the errors of a model: at its samples, with and without each, and between its instants. Models of every other
/// and every fourth instant give the last.
fn measure(model: &mut Assembled, left_out: &[LeftOut], coarser: [Option<&Assembled>; 3]) -> Result<(), OfflineError> {
    for cluster in 0..model.reduced.len() {
        for (m, method) in METHODS.into_iter().enumerate() {
            let own = model.own_errors(cluster, method, |sample| &sample.truth)?;
            // All samples have as many instants.
            let floor = own.iter().map(|errors| mean(errors)).sum::<f64>() / own.len() as f64;
            let of_method = left_out.iter().filter(|e| e.cluster == cluster && e.method == method);
            let errors = &mut model.built[cluster].parts.errors[m];
            *errors = if left_out.is_empty() {
                OwnedErrors {
                    floor,
                    ..errors.clone()
                }
            } else {
                OwnedErrors::new(of_method, model.plan.error_times().len(), floor)
            };
        }
        let floor = model.built[cluster].parts.errors[0].floor;
        let between = interval_errors(&model.plan, cluster, floor, coarser)?;
        let parts = &mut model.built[cluster].parts;
        let intervals = between.first().map_or(0, Vec::len);
        parts.interval_errors = StoredMatrix::new(between.len(), intervals, |j, i| between[j][i]);
        parts.interval_bound_factors = StoredMatrix::new(intervals, usize::from(intervals > 0), |_, _| 1.0);
    }
    Ok(())
}

/// Stores the bounds of the errors between instants: the same multiples of the expected error as in the model of every
/// other instant.
fn bound_intervals(model: &mut Assembled, coarser: Option<&Assembled>) -> Result<(), OfflineError> {
    let Some(coarser) = coarser else { return Ok(()) };
    let intervals = model.plan.times().len() - 1;
    for (cluster, built) in model.built.iter_mut().enumerate() {
        let factors = interval_bound_factors(coarser, cluster)?;
        let factor = |interval: usize| factors[(interval / 2).min(factors.len() - 1)];
        built.parts.interval_bound_factors = StoredMatrix::new(intervals, 1, |interval, _| factor(interval));
    }
    Ok(())
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn field_report(snapshots: &Snapshots, pod: &DoublePod, length: f64) -> FieldReport {
    let spans = pod.spans.iter();
    FieldReport {
        space_rank: pod.modes.ncols() + 1,
        parameter_ranks: spans.clone().map(|span| span.parameter_modes.ncols()).collect(),
        controls: spans.clone().map(|span| span.slices.len()).sum(),
        rows: spans.flat_map(|span| &span.slices).map(|slice| slice.nrows()).sum(),
        axial_rank: pod.axial_modes.ncols(),
        space_error: length * pod.space_error,
        parameter_error: length * snapshots.parameter_error(pod),
    }
}
