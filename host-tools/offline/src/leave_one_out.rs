//! Leave-one-out errors: each sample predicted by a model without it.

use std::sync::atomic::{AtomicUsize, Ordering};

use capsule_core::Method;
use capsule_core::Model;
use rayon::prelude::*;
use serde::Serialize;

use crate::compare::{METHODS, distances, predictions};
use crate::plan::{Plan, Reduced};
use crate::writer::OwnedCluster;
use crate::{OfflineError, Progress, Settings, Source};

/// The errors of one method at one sample, predicted without it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LeftOut {
    /// The sample's parameters: (Ca, a/l), or those of imported data.
    pub parameters: Vec<f64>,
    /// The cluster that was built without it, counted from 0. A sample of the shared row occurs once for each cluster.
    pub cluster: usize,
    /// Whether this is the cluster that answers a query at the sample.
    pub answers: bool,
    /// Whether the sample lies in the domain that the model answers for.
    pub inside: bool,
    /// The method.
    pub method: Method,
    /// Distance in the laboratory frame at each instant of the errors, as a fraction of a: modified Hausdorff distance,
    /// or, of imported data, the mean distance of the nodes.
    pub laboratory: Vec<f64>,
    /// Distance in the frame of the volume centroid: of the shape alone.
    pub shape: Vec<f64>,
    /// Deviation of the weights of that prediction, see [`capsule_core::Instant::deviation`].
    pub deviation: f64,
}

/// Leaves out every sample in turn: builds its cluster again without it, POD and all, predicts
/// it through capsule-rom-core by both methods, and compares with the full-order solution.
///
/// The instants are those of the settings' `error_times` at which the database has snapshots; they come first. Results
/// are in the order of the clusters, samples and methods.
///
/// # Errors
/// As [`crate::build`].
pub fn leave_one_out<'a>(
    source: impl Into<Source<'a>>,
    settings: &Settings,
    progress: Progress,
) -> Result<(Vec<f64>, Vec<LeftOut>), OfflineError> {
    let plan = Plan::new(source.into(), settings, progress)?;
    let reduced = plan.reduce()?;
    let anew = |cluster: usize, out: usize| {
        let reduced = &reduced[cluster];
        let keep: Vec<usize> = (0..reduced.part.members.len()).filter(|j| *j != out).collect();
        Ok(plan.cluster(reduced, &keep)?.parts)
    };
    let errors = each_left_out(&plan, &reduced, &anew, progress)?;
    Ok((plan.given_error_times(), errors))
}

/// A cluster, given by its number, without the sample at a place of it.
type Without<'a> = &'a (dyn Fn(usize, usize) -> Result<OwnedCluster, OfflineError> + Sync);

/// The errors at all samples, each predicted by its cluster `without` it.
pub(crate) fn each_left_out(
    plan: &Plan,
    reduced: &[Reduced],
    without: Without,
    progress: Progress,
) -> Result<Vec<LeftOut>, OfflineError> {
    let tasks: Vec<(usize, usize)> = reduced
        .iter()
        .enumerate()
        .flat_map(|(c, r)| (0..r.part.members.len()).map(move |j| (c, j)))
        .collect();
    let done = AtomicUsize::new(0);
    let results: Result<Vec<[LeftOut; 2]>, OfflineError> = tasks
        .par_iter()
        .map(|(c, j)| {
            let parts = without(*c, *j)?;
            let [direct, paper] = METHODS.map(|method| left_out(plan, *c, &reduced[*c], *j, &parts, method));
            progress("leave one out", 1 + done.fetch_add(1, Ordering::Relaxed), tasks.len());
            Ok([direct?, paper?])
        })
        .collect();
    Ok(results?.into_iter().flatten().collect())
}

/// The error at the sample at a place of a cluster, predicted by what is left of it.
pub(crate) fn left_out(
    plan: &Plan,
    index: usize,
    cluster: &Reduced,
    out: usize,
    parts: &OwnedCluster,
    method: Method,
) -> Result<LeftOut, OfflineError> {
    let bytes = plan.write(&[parts])?;
    let model = Model::open(&bytes).map_err(OfflineError::Invalid)?;
    let sample = &plan.samples[cluster.part.members[out]];
    let parameters = &sample.parameters;
    let predictions =
        predictions(&model, parameters, method, &sample.truth).map_err(|source| OfflineError::Evaluate {
            parameters: sample.given.clone(),
            source,
        })?;
    let [laboratory, shape] = distances(&model, parameters, &predictions, &sample.truth, &plan.distance);
    Ok(LeftOut {
        parameters: sample.given.clone(),
        cluster: index,
        answers: plan.answering(parameters) == index,
        inside: plan.inside(sample),
        method,
        laboratory,
        shape,
        deviation: predictions.first().map_or(0.0, |p| p.deviation),
    })
}
