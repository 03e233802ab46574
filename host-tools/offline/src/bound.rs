//! How far the error may exceed the one that is expected.
//!
//! Leaving out one sample of a row asks along the row, where the samples are dense. New configurations lie between the
//! rows, some near a sample and some in the middle. So the bound is calibrated with every sample twice: predicted from the
//! other rows alone, and from all samples, where truncation alone errs. The bound is the multiple of the expected error that
//! 95 % of these errors stay below.

use rayon::prelude::*;

use crate::OfflineError;
use crate::build::{Plan, Reduced};
use crate::compare::{METHODS, distances, predictions};
use crate::samples::{SAME_ROW, Sample};
use crate::writer::ClusterParts;
use capsule_core::Model;

/// The share of errors below the bound.
const SHARE: f64 = 0.95;

/// The fewest errors that tell a quantile of 95 %; with fewer the bound is the greatest ratio found.
const FEWEST: usize = 20;

/// The bound over the expected error, at each of the instants, for each method. 1 where no row can be left out.
pub(crate) fn bound_factors(
    plan: &Plan,
    reduced: &[Reduced],
    clusters: &[&ClusterParts],
) -> Result<[Vec<f64>; 2], OfflineError> {
    let tasks: Vec<(usize, usize)> = reduced
        .iter()
        .enumerate()
        .flat_map(|(c, r)| (0..r.part.members.len()).map(move |j| (c, j)))
        .filter(|(c, j)| {
            let sample = &plan.samples[reduced[*c].part.members[*j]];
            plan.inside(sample) && plan.answering(&sample.parameters) == *c
        })
        .collect();
    let files: Result<Vec<Vec<u8>>, OfflineError> = clusters.iter().map(|parts| plan.write(&[parts])).collect();
    let files = files?;
    let models: Result<Vec<Model<'_>>, OfflineError> = files
        .iter()
        .map(|file| Model::open(file).map_err(OfflineError::Invalid))
        .collect();
    let models = models?;
    let both: Result<Vec<Option<[Ratios; 2]>>, OfflineError> = tasks
        .par_iter()
        .map(|(c, j)| {
            let left_out = row_left_out(plan, &reduced[*c], *j, clusters[*c])?;
            let sample = &plan.samples[reduced[*c].part.members[*j]];
            let Some(left_out) = left_out else { return Ok(None) };
            Ok(Some([left_out, ratios(plan, &models[*c], sample)?]))
        })
        .collect();
    let ratios: Vec<Ratios> = both?.into_iter().flatten().flatten().collect();
    let factor = |method: usize, instant: usize| {
        let mut values: Vec<f64> = ratios.iter().map(|ratio| ratio[method][instant]).collect();
        values.sort_by(f64::total_cmp);
        let place = if values.len() < FEWEST {
            values.len()
        } else {
            (SHARE * values.len() as f64).ceil() as usize
        };
        place.checked_sub(1).map_or(1.0, |place| values[place])
    };
    let instants = 0..plan.error_times().len();
    Ok([0, 1].map(|method| instants.clone().map(|instant| factor(method, instant)).collect()))
}

/// True over expected error at each of the instants, of each method.
type Ratios = [Vec<f64>; 2];

/// Those of a sample without its row; none where the row is the first or last of its cluster, or what is
/// left cannot carry an interpolation.
fn row_left_out(
    plan: &Plan,
    cluster: &Reduced,
    place: usize,
    parts: &ClusterParts,
) -> Result<Option<Ratios>, OfflineError> {
    let members = &cluster.part.members;
    let sample = &plan.samples[members[place]];
    let last = |j: &usize| plan.samples[*j].parameters.last().copied().unwrap_or(0.0);
    let value = last(&members[place]);
    let row: Vec<usize> = (0..members.len())
        .filter(|k| (last(&members[*k]) - value).abs() <= SAME_ROW)
        .collect();
    let needed = crate::samples::needed(sample.parameters.len());
    let between =
        members.iter().any(|j| last(j) < value - SAME_ROW) && members.iter().any(|j| last(j) > value + SAME_ROW);
    if !between || members.len() < row.len() + needed {
        return Ok(None);
    }
    let bytes = plan.write(&[&parts.without(&row)])?;
    let model = Model::open(&bytes).map_err(OfflineError::Invalid)?;
    Ok(Some(ratios(plan, &model, sample)?))
}

/// Those of a sample as a model predicts it.
fn ratios(plan: &Plan, model: &Model<'_>, sample: &Sample) -> Result<Ratios, OfflineError> {
    let ratios = METHODS.map(|method| {
        let predictions =
            predictions(model, &sample.parameters, method, &sample.truth).map_err(|source| OfflineError::Evaluate {
                parameters: sample.parameters.clone(),
                source,
            })?;
        let [laboratory, _] = distances(model, &sample.parameters, &predictions, &sample.truth, &plan.sector);
        let expected = predictions.iter().map(|p| p.expected.max(f64::MIN_POSITIVE));
        Ok(laboratory
            .iter()
            .zip(expected)
            .map(|(error, expected)| error / expected)
            .collect())
    });
    let [direct, paper]: [Result<Vec<f64>, OfflineError>; 2] = ratios;
    Ok([direct?, paper?])
}
