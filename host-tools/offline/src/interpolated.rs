//! Error of the interpolation alone: its weights times the snapshots of the samples, without modes, splines and
//! quantisation.

use std::sync::atomic::{AtomicUsize, Ordering};

use capsule_core::interpolate::{Coordinates, Weights};
use capsule_core::model::MatrixView;
use capsule_core::{EvaluateError, Model};
use capsule_database::{Database, DatabaseError};
use rayon::prelude::*;

use crate::compare::{Prediction, distances, given, inside, stored};
use crate::distance::Distance;
use crate::hausdorff::Sector;
use crate::samples::Truth;
use crate::{OfflineError, Progress};

/// The most samples that take part in a query, as in the core's workspace.
const NEIGHBOURS: usize = 32;

/// Errors of the interpolation of the direct method at one configuration, at some instants.
#[derive(Debug, Clone, PartialEq)]
pub struct Interpolated {
    /// The parameters.
    pub parameters: Vec<f64>,
    /// Modified Hausdorff distance in the laboratory frame at each instant, as a fraction of a.
    pub laboratory: Vec<f64>,
    /// Distance in the frame of the volume centroid: of the shape alone.
    pub shape: Vec<f64>,
}

/// Interpolates the snapshots of `samples`, the database that a model was built from, by the model's weights, and
/// compares with the configurations of `tests` that lie in its domain, at those of the `times` at which there are
/// snapshots.
///
/// # Errors
/// The databases' errors, or that their meshes differ; [`OfflineError::Evaluate`] where the weights cannot be computed.
pub fn interpolated(
    model: &Model,
    samples: &Database,
    tests: &Database,
    times: &[f64],
    progress: Progress,
) -> Result<Vec<Interpolated>, OfflineError> {
    let [expected, found] = [tests, samples].map(|database| database.mesh().nodes.len());
    if found != expected {
        let what = "nodes of the samples' mesh".to_owned();
        return Err(DatabaseError::WrongLength { what, expected, found }.into());
    }
    let times = stored(tests, times);
    let distance = Distance::ModifiedHausdorff(Sector::of(tests.symmetry()));
    let inside = inside(model, tests)?;
    let done = AtomicUsize::new(0);
    let one = |parameters: &Vec<f64>| {
        let weights = weights(model, parameters).map_err(|source| OfflineError::Evaluate {
            parameters: parameters.clone(),
            source,
        })?;
        let mut sums: Vec<Prediction> = Vec::new();
        for (sample, weight) in weights {
            add(&mut sums, weight, Truth::read(samples, &sample, &times)?);
        }
        let truth = Truth::read(tests, parameters, &times)?;
        let [laboratory, shape] = distances(model, parameters, &sums, &truth, &distance);
        progress("interpolate", 1 + done.fetch_add(1, Ordering::Relaxed), inside.len());
        Ok(Interpolated {
            parameters: parameters.clone(),
            laboratory,
            shape,
        })
    };
    inside.par_iter().map(one).collect()
}

/// The samples that take part in a query by the direct method, by their parameters, and their weights.
fn weights(model: &Model, parameters: &[f64]) -> Result<Vec<(Vec<f64>, f64)>, EvaluateError> {
    let parameters = given(parameters, model)?;
    let contents = model.contents();
    let cluster = model.cluster(&parameters).ok_or(EvaluateError::NotPrepared)?;
    let mut weights = Weights::<f64, NEIGHBOURS>::EMPTY;
    let mut scratch = vec![0.0; Weights::<f64, NEIGHBOURS>::SCRATCH];
    let coordinates = Coordinates::new(contents);
    weights.kernel(
        &contents.kernel,
        &coordinates,
        &cluster.samples,
        &model.scaled(&parameters),
        None,
        &mut scratch,
    )?;
    let samples = MatrixView::new(&cluster.samples.parameters);
    let sample = |j| (0..samples.columns()).map(|d| samples.get(j, d).into()).collect();
    Ok(weights.iter().map(|(j, weight)| (sample(j), weight)).collect())
}

/// sums <- sums + weight times a sample's snapshots. As the weights reproduce linear functions, what is interpolated
/// may be the positions themselves in place of the displacements.
fn add(sums: &mut Vec<Prediction>, weight: f64, snapshots: Vec<Truth>) {
    if sums.is_empty() {
        sums.extend(snapshots.iter().map(|snapshot| Prediction {
            positions: Some(vec![[0.0; 3]; snapshot.positions.len()]),
            centroid: 0.0,
            expected: 0.0,
            bound: 0.0,
            deviation: 0.0,
        }));
    }
    for (sum, snapshot) in sums.iter_mut().zip(snapshots) {
        sum.centroid += weight * snapshot.centroid;
        let positions = sum.positions.iter_mut().flatten().zip(&snapshot.positions);
        for (sum, position) in positions {
            for d in 0..3 {
                sum[d] += weight * position[d];
            }
        }
    }
}
