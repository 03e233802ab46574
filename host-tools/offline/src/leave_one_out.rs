//! What a model errs at a sample that it does not contain.

use std::sync::atomic::{AtomicUsize, Ordering};

use capsule_core::interpolate::{Coordinates, Weights};
use capsule_core::model::wire::Method;
use capsule_core::{EvaluateError, Evaluator, Frame, Model, Nodes, Parameters, Query, Scene, Workspace};
use rayon::prelude::*;
use serde::Serialize;

use crate::build::{Plan, Reduced};
use crate::hausdorff::{Sector, symmetric_modified_hausdorff};
use crate::samples::Truth;
use crate::{OfflineError, Progress, Settings, Source};

/// The methods, in the order of the file's error tables.
pub(crate) const METHODS: [Method; 2] = [Method::Direct, Method::Paper];

/// The most samples that take part in an interpolation: the default capacity of the core's workspace.
const NEIGHBOURS: usize = 32;

/// The error, as a fraction of a, of a prediction that ran away. Forward Euler may: a model says so, rather than not be
/// built.
const DIVERGED: f64 = 1e3;

/// The errors of one method at one sample, predicted without it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LeftOut {
    /// The sample's parameters: (Ca, a/l), or those of other people's data.
    pub parameters: Vec<f64>,
    /// The cluster that was built without it, counted from 0. A sample of the shared row occurs once for each cluster.
    pub cluster: usize,
    /// Whether this is the cluster that answers a query at the sample.
    pub answers: bool,
    /// Whether the sample lies in the domain that the model answers for.
    pub inside: bool,
    /// The method.
    pub method: Method,
    /// Modified Hausdorff distance in the laboratory frame at each instant of the errors, as a fraction of a.
    pub laboratory: Vec<f64>,
    /// The same in the frame of the volume centroid: of the shape alone.
    pub shape: Vec<f64>,
    /// Deviation of the weights of that prediction, see [`Weights::deviation`].
    pub deviation: f64,
}

/// Leaves out every sample in turn: builds its cluster again without it, POD and all, predicts
/// it through capsule-core by both methods, and compares with the full-order solution.
///
/// The instants are those of the settings' `error_times` at which the database has snapshots; they come first. Results are in
/// the order of the clusters, samples and methods.
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
    let errors = plan_leave_one_out(&plan, &reduced, progress)?;
    Ok((plan.error_times().to_vec(), errors))
}

pub(crate) fn plan_leave_one_out(
    plan: &Plan,
    reduced: &[Reduced],
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
            let errors = leave_out(plan, *c, &reduced[*c], *j)?;
            progress("leave one out", 1 + done.fetch_add(1, Ordering::Relaxed), tasks.len());
            Ok(errors)
        })
        .collect();
    Ok(results?.into_iter().flatten().collect())
}

fn leave_out(plan: &Plan, index: usize, cluster: &Reduced, out: usize) -> Result<[LeftOut; 2], OfflineError> {
    let keep: Vec<usize> = (0..cluster.part.members.len()).filter(|j| *j != out).collect();
    let parts = plan.cluster(cluster, &keep)?.parts;
    let bytes = plan.write(&[&parts])?;
    let model = Model::open(&bytes).map_err(OfflineError::Invalid)?;
    let sample = &plan.samples[cluster.part.members[out]];
    let all: Vec<&[f64]> = cluster
        .part
        .members
        .iter()
        .map(|j| &plan.samples[*j].parameters[..])
        .collect();
    let predicted = |method| {
        let failed = |source| OfflineError::Evaluate {
            parameters: sample.parameters.clone(),
            source,
        };
        let (laboratory, shape) =
            errors(&model, &sample.parameters, method, &sample.truth, &plan.sector).map_err(failed)?;
        Ok::<LeftOut, OfflineError>(LeftOut {
            parameters: sample.parameters.clone(),
            cluster: index,
            answers: plan.answering(&sample.parameters) == index,
            inside: plan.inside(sample),
            method,
            laboratory,
            shape,
            deviation: deviation(&model, &all, out, method).map_err(failed)?,
        })
    };
    Ok([predicted(METHODS[0])?, predicted(METHODS[1])?])
}

/// The distances of a prediction from the truth at its instants, as fractions of a: laboratory frame, centroid frame.
pub(crate) fn errors(
    model: &Model,
    parameters: &[f64],
    method: Method,
    truth: &[Truth],
    sector: &Sector,
) -> Result<(Vec<f64>, Vec<f64>), EvaluateError> {
    let mut workspace = Box::new(Workspace::<f64>::new());
    let mut evaluator = Evaluator::new(model, &mut workspace)?;
    let parameters = given(parameters, model)?;
    let radius = model.radius(parameters);
    evaluator.prepare(&Query {
        extrapolate: true,
        ..Query::new(parameters, method)
    })?;
    let (mut laboratory, mut shape) = (Vec::new(), Vec::new());
    for truth in truth {
        let mut instant = evaluator.at(truth.time)?;
        let mut predicted = vec![[0.0; 3]; truth.positions.len()];
        let scene = Scene {
            nodes: Nodes::All,
            frame: Frame::Laboratory,
        };
        match instant.positions(&scene, &mut predicted) {
            Err(EvaluateError::NotFinite) => {
                laboratory.push(DIVERGED);
                shape.push(DIVERGED);
                continue;
            }
            other => other?,
        };
        let centroid = instant.centroid();
        laboratory.push((symmetric_modified_hausdorff(&predicted, &truth.positions, sector) / radius).min(DIVERGED));
        for p in &mut predicted {
            p[0] -= centroid - truth.centroid;
        }
        shape.push((symmetric_modified_hausdorff(&predicted, &truth.positions, sector) / radius).min(DIVERGED));
    }
    Ok((laboratory, shape))
}

/// The deviation of the weights with which sample `out` is predicted from the others.
fn deviation(model: &Model, samples: &[&[f64]], out: usize, method: Method) -> Result<f64, EvaluateError> {
    let samples = samples.iter().map(|sample| given(sample, model));
    let samples: Vec<Parameters<f64>> = samples.collect::<Result<_, _>>()?;
    let (all, query, contents) = (samples.iter().copied(), &samples[out], model.contents());
    let coordinates = Coordinates::new(contents);
    let weights = match method {
        Method::Direct => {
            let mut scratch = vec![0.0; NEIGHBOURS * NEIGHBOURS];
            Weights::<f64, NEIGHBOURS>::kernel(&contents.kernel, &coordinates, all, query, Some(out), &mut scratch)?
        }
        Method::Paper => Weights::diffuse(&contents.paper, &coordinates, all, query, Some(out))?,
    };
    Ok(weights.deviation())
}

/// Parameters as the core takes them.
fn given(parameters: &[f64], model: &Model) -> Result<Parameters<f64>, EvaluateError> {
    Parameters::new(parameters).ok_or(EvaluateError::ParameterCount {
        expected: model.contents().metadata.parameters.len(),
        found: parameters.len(),
    })
}
