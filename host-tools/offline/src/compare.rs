//! Comparison of a model with the full-order solution.

use std::sync::atomic::{AtomicUsize, Ordering};

use capsule_core::Method;
use capsule_core::{Domain, EvaluateError, Evaluator, Frame, Model, Nodes, Parameters, Query, Scene, Workspace};
use capsule_database::{Database, Entry};
use rayon::prelude::*;

use crate::distance::Distance;
use crate::hausdorff::Sector;
use crate::samples::Truth;
use crate::tolerances::SAME_TIME;
use crate::{OfflineError, Progress};

/// The methods, in the order of the file's error tables.
pub(crate) const METHODS: [Method; 2] = [Method::Direct, Method::Paper];

/// Error, as a fraction of a, that stands for a prediction that diverged or that too few samples do not allow, so that
/// the model is built nevertheless.
const DIVERGED: f64 = 1e3;

/// Errors of a method at one configuration, at some instants.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// The parameters.
    pub parameters: Vec<f64>,
    /// The method.
    pub method: Method,
    /// Modified Hausdorff distance in the laboratory frame at each instant, as a fraction of a.
    pub laboratory: Vec<f64>,
    /// Distance in the frame of the volume centroid: of the shape alone.
    pub shape: Vec<f64>,
    /// The error that the model expects: laboratory frame, fraction of a.
    pub expected: Vec<f64>,
    /// The bound that the model gives for it; 1000 where it gives none.
    pub bound: Vec<f64>,
    /// Greatest relative error of the volume.
    pub volume: f64,
    /// How far the outermost node is beyond the walls, in l; negative within.
    pub beyond_walls: f64,
}

/// Compares a model by all methods with the configurations of a database that lie in its domain, at those of the
/// `times` at which there are snapshots; these come first. A configuration that was steady before is extended.
///
/// # Errors
/// The database's errors; [`OfflineError::Evaluate`] where the model does not answer.
pub fn compare(
    model: &Model,
    database: &Database,
    times: &[f64],
    progress: Progress,
) -> Result<(Vec<f64>, Vec<Comparison>), OfflineError> {
    let times = stored(database, times);
    let distance = Distance::ModifiedHausdorff(Sector::of(database.symmetry()));
    let inside = inside(model, database)?;
    let done = AtomicUsize::new(0);
    let compared = inside.par_iter().map(|parameters| {
        let truth = Truth::read(database, parameters, &times)?;
        let compared = METHODS.map(|method| one(model, database, parameters, method, &truth, &distance));
        progress("compare", 1 + done.fetch_add(1, Ordering::Relaxed), inside.len());
        let [direct, paper] = compared;
        Ok([direct?, paper?])
    });
    let compared: Result<Vec<[Comparison; 2]>, OfflineError> = compared.collect();
    Ok((times, compared?.into_iter().flatten().collect()))
}

/// The instants at which a database has snapshots.
pub(crate) fn stored(database: &Database, times: &[f64]) -> Vec<f64> {
    let known = |time: &f64| {
        let mut stored = database.times().iter();
        stored.any(|t| (t - time).abs() < SAME_TIME)
    };
    times.iter().copied().filter(known).collect()
}

/// The configurations of a database that lie in a model's domain and that it can be compared with up to the end.
pub(crate) fn inside(model: &Model, database: &Database) -> Result<Vec<Vec<f64>>, OfflineError> {
    let inside = |entry: &Entry| {
        let complete = entry.status.is_steady() || entry.snapshots == database.times().len();
        let parameters = Parameters::new(&entry.parameters);
        complete && parameters.is_some_and(|parameters| model.domain(parameters) == Ok(Domain::Inside))
    };
    let entries = database.entries()?.into_iter();
    Ok(entries.filter(inside).map(|entry| entry.parameters).collect())
}

fn one(
    model: &Model,
    database: &Database,
    parameters: &[f64],
    method: Method,
    truth: &[Truth],
    distance: &Distance,
) -> Result<Comparison, OfflineError> {
    let predictions = predictions(model, parameters, method, truth).map_err(|source| OfflineError::Evaluate {
        parameters: parameters.to_vec(),
        source,
    })?;
    let [laboratory, shape] = distances(model, parameters, &predictions, truth, distance);
    let (mut volume, mut beyond_walls) = (0.0, f64::NEG_INFINITY);
    for (prediction, truth) in predictions.iter().zip(truth) {
        let Some(positions) = &prediction.positions else {
            (volume, beyond_walls) = (f64::INFINITY, f64::INFINITY);
            continue;
        };
        let (found, _) = database.mesh().volume_and_centroid(positions)?;
        let (expected, _) = database.mesh().volume_and_centroid(&truth.positions)?;
        volume = f64::max(volume, (found / expected - 1.0).abs());
        let reach = positions.iter().map(|[_, y, z]| y.abs().max(z.abs()) - 1.0);
        beyond_walls = reach.fold(beyond_walls, f64::max);
    }
    Ok(Comparison {
        parameters: parameters.to_vec(),
        method,
        laboratory,
        shape,
        expected: predictions.iter().map(|p| p.expected).collect(),
        bound: predictions.iter().map(|p| p.bound).collect(),
        volume,
        beyond_walls,
    })
}

/// Answer of a model at an instant.
pub(crate) struct Prediction {
    /// Laboratory frame, `[N_x]`; none if the prediction diverged.
    pub(crate) positions: Option<Vec<[f64; 3]>>,
    pub(crate) centroid: f64,
    pub(crate) expected: f64,
    pub(crate) bound: f64,
    /// Of the weights, the same at all instants.
    pub(crate) deviation: f64,
}

/// A model's answers at the instants of the truth, also outside of its domain.
pub(crate) fn predictions(
    model: &Model,
    parameters: &[f64],
    method: Method,
    truth: &[Truth],
) -> Result<Vec<Prediction>, EvaluateError> {
    let mut workspace = Box::new(Workspace::<f64>::new());
    let mut evaluator = Evaluator::new(model, &mut workspace)?;
    let query = Query {
        extrapolate: true,
        ..Query::new(given(parameters, model)?, method)
    };
    match evaluator.prepare(&query) {
        // The query has no samples on its side of the jump, none that differ, or none within reach.
        Err(EvaluateError::Weights { .. } | EvaluateError::BeyondExtrapolation { .. }) => {
            let none = || Prediction {
                positions: None,
                centroid: 0.0,
                expected: DIVERGED,
                bound: DIVERGED,
                deviation: 1.0,
            };
            return Ok(truth.iter().map(|_| none()).collect());
        }
        other => other?,
    };
    let scene = Scene {
        nodes: Nodes::All,
        frame: Frame::Laboratory,
    };
    let mut at = |truth: &Truth| {
        let mut instant = evaluator.at(truth.time)?;
        instant.unchecked();
        let mut positions = vec![[0.0; 3]; truth.positions.len()];
        let positions = match instant.positions(&scene, &mut positions) {
            Err(EvaluateError::NotFinite) => None,
            other => other.map(|_| Some(positions))?,
        };
        Ok(Prediction {
            positions,
            centroid: instant.centroid().unwrap_or(0.0),
            expected: instant.expected_error()?.min(DIVERGED),
            bound: instant.error_bound().map_or(DIVERGED, |bound| bound.min(DIVERGED)),
            deviation: instant.deviation()?,
        })
    };
    truth.iter().map(&mut at).collect()
}

/// The distances of predictions from the truth as fractions of a: laboratory frame, centroid frame.
pub(crate) fn distances(
    model: &Model,
    parameters: &[f64],
    predictions: &[Prediction],
    truth: &[Truth],
    measure: &Distance,
) -> [Vec<f64>; 2] {
    let radius = Parameters::new(parameters).map_or(1.0, |parameters| model.radius(parameters));
    let distance = |prediction: &Prediction, truth: &Truth, offset: f64| match &prediction.positions {
        None => DIVERGED,
        Some(positions) => {
            let moved: Vec<[f64; 3]> = positions.iter().map(|[x, y, z]| [x - offset, *y, *z]).collect();
            (measure.between(&moved, &truth.positions) / radius).min(DIVERGED)
        }
    };
    let both = || predictions.iter().zip(truth);
    [
        both().map(|(p, truth)| distance(p, truth, 0.0)).collect(),
        both()
            .map(|(p, truth)| distance(p, truth, p.centroid - truth.centroid))
            .collect(),
    ]
}

/// Parameters as the core takes them.
pub(crate) fn given(parameters: &[f64], model: &Model) -> Result<Parameters<f64>, EvaluateError> {
    Parameters::new(parameters).ok_or(EvaluateError::ParameterCount {
        expected: model.parameters().len(),
        found: parameters.len(),
    })
}
