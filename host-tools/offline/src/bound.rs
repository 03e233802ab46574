//! How far the error may exceed the one that is expected.
//!
//! Leaving out one sample of a row asks along the row, where the samples are dense. New configurations lie between the
//! rows, some near a sample and some in the middle. So the bound is calibrated with every sample twice: predicted from the
//! other rows alone, and from all samples, where truncation alone errs. The bound is the multiple of the expected error that
//! 95 % of these errors stay below, each counted with the part of the domain that lies nearest to its sample: samples are
//! dense where the solution varies fast, and new configurations are not.

use rayon::prelude::*;

use crate::OfflineError;
use crate::compare::{METHODS, distances, predictions};
use crate::plan::{Assembled, Plan, Reduced};
use crate::samples::{SAME_ROW, Sample, Truth};
use crate::writer::ClusterParts;
use capsule_core::{Domain, Model, Parameters};

/// The share of errors below the bound.
const SHARE: f64 = 0.95;

/// The fewest errors that tell a quantile of 95 %; with fewer the bound is the greatest ratio found.
const FEWEST: usize = 20;

/// About as many places of the domain are asked which sample is nearest.
const PLACES: f64 = 1e4;

/// The bound over the expected error, at each of the instants, for each method. 1 where no row can be left out.
///
/// Of other people's data a model of every other instant is asked too, at the instants that were left out of it: they lie as far from
/// those that it knows as any query.
pub(crate) fn bound_factors(model: &Assembled, coarser: Option<&Assembled>) -> Result<[Vec<f64>; 2], OfflineError> {
    let stored = weighted_ratios(model, |sample| &sample.truth)?;
    let held_out = coarser.map(|coarser| weighted_ratios(coarser, |sample| &sample.held_out));
    let held_out = held_out.transpose()?.unwrap_or_default();
    let held_out_times: Vec<f64> = match coarser {
        Some(coarser) => coarser.plan.samples[0].held_out.iter().map(|truth| truth.time).collect(),
        None => Vec::new(),
    };
    let factor = |method: usize, instant: usize, time: f64| {
        let apart = |i: &usize| (held_out_times[*i] - time).abs();
        let nearest = (0..held_out_times.len()).min_by(|a, b| apart(a).total_cmp(&apart(b)));
        let of = |instant: usize| move |(part, ratios): &(f64, Ratios)| (ratios[method][instant], *part);
        let beside = nearest.into_iter().flat_map(|nearest| held_out.iter().map(of(nearest)));
        quantile(stored.iter().map(of(instant)).chain(beside).collect()).unwrap_or(1.0)
    };
    let times = model.plan.error_times();
    let of_method = |method| times.iter().enumerate().map(|(i, time)| factor(method, i, *time)).collect();
    Ok([0, 1].map(of_method))
}

/// True over expected errors at instants of the truth, with the part of the domain that each sample stands for: of each sample from
/// the other rows alone, and from all.
fn weighted_ratios(model: &Assembled, truth: fn(&Sample) -> &[Truth]) -> Result<Vec<(f64, Ratios)>, OfflineError> {
    let Assembled { plan, reduced, built } = model;
    let tasks: Vec<(usize, usize)> = reduced
        .iter()
        .enumerate()
        .flat_map(|(c, r)| (0..r.part.members.len()).map(move |j| (c, j)))
        .filter(|(c, j)| {
            let sample = &plan.samples[reduced[*c].part.members[*j]];
            plan.inside(sample) && plan.answering(&sample.parameters) == *c
        })
        .collect();
    let files: Result<Vec<Vec<u8>>, OfflineError> = built.iter().map(|b| plan.write(&[&b.parts])).collect();
    let files = files?;
    let models: Result<Vec<Model<'_>>, OfflineError> = files
        .iter()
        .map(|file| Model::open(file).map_err(OfflineError::Invalid))
        .collect();
    let models = models?;
    let sample = |(c, j): &(usize, usize)| &plan.samples[reduced[*c].part.members[*j]];
    let parameters: Vec<&[f64]> = tasks.iter().map(|task| &sample(task).parameters[..]).collect();
    let parts = parts_of_domain(plan, &models, &parameters);
    let both: Result<Vec<Option<[Ratios; 2]>>, OfflineError> = tasks
        .par_iter()
        .map(|(c, j)| {
            let left_out = row_left_out(plan, &reduced[*c], *j, &built[*c].parts, truth)?;
            let Some(left_out) = left_out else { return Ok(None) };
            Ok(Some([left_out, ratios(plan, &models[*c], sample(&(*c, *j)), truth)?]))
        })
        .collect();
    let weighted = parts.into_iter().zip(both?);
    Ok(weighted
        .filter_map(|(part, both)| Some(both?.map(|ratios| (part, ratios))))
        .flatten()
        .collect())
}

/// The value that values with [`SHARE`] of the weight do not exceed; the greatest of few.
fn quantile(mut weighted: Vec<(f64, f64)>) -> Option<f64> {
    weighted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let whole: f64 = weighted.iter().map(|(_, weight)| weight).sum();
    let wanted = if weighted.len() < FEWEST { whole } else { SHARE * whole };
    let mut sum = 0.0;
    let reached = weighted.iter().find(|(_, weight)| {
        sum += weight;
        sum >= wanted
    });
    reached.or(weighted.last()).map(|(value, _)| *value)
}

/// How many places of the domain, evenly spread, lie nearest to each of some parameters, with the domain's ranges as units.
fn parts_of_domain(plan: &Plan, models: &[Model<'_>], parameters: &[&[f64]]) -> Vec<f64> {
    let ranges = plan.ranges();
    let along = PLACES.powf(1.0 / ranges.len() as f64).round() as usize;
    let mut parts = vec![0.0; parameters.len()];
    for number in 0..along.pow(ranges.len() as u32) {
        let share = |d: usize| ((number / along.pow(d as u32)) % along) as f64 + 0.5;
        let place: Vec<f64> = ranges
            .iter()
            .enumerate()
            .map(|(d, [low, high])| low + (high - low) * share(d) / along as f64)
            .collect();
        let inside = Parameters::new(&place).is_some_and(|place| models[0].domain(place) == Ok(Domain::Inside));
        let square = |of: &[f64]| -> f64 {
            let offsets = of.iter().zip(&place).zip(ranges);
            offsets
                .map(|((a, b), [low, high])| ((a - b) / (high - low).max(f64::MIN_POSITIVE)).powi(2))
                .sum()
        };
        let nearest = (0..parameters.len()).min_by(|a, b| square(parameters[*a]).total_cmp(&square(parameters[*b])));
        if let Some(nearest) = nearest.filter(|_| inside) {
            parts[nearest] += 1.0;
        }
    }
    parts
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
    truth: fn(&Sample) -> &[Truth],
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
    Ok(Some(ratios(plan, &model, sample, truth)?))
}

/// Those of a sample as a model predicts it.
fn ratios(
    plan: &Plan,
    model: &Model<'_>,
    sample: &Sample,
    truth: fn(&Sample) -> &[Truth],
) -> Result<Ratios, OfflineError> {
    let truth = truth(sample);
    let ratios = METHODS.map(|method| {
        let predictions =
            predictions(model, &sample.parameters, method, truth).map_err(|source| OfflineError::Evaluate {
                parameters: sample.given.clone(),
                source,
            })?;
        let [laboratory, _] = distances(model, &sample.parameters, &predictions, truth, &plan.distance);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quantile_counts_weights() {
        let values = |weight: fn(usize) -> f64| (0..200).map(|i| ((199 - i) as f64, weight(199 - i))).collect();
        // 0, 1, ... 189 are 95 % of the values; with nineteen times the weight 0, 1, ... 99 are.
        assert_eq!(quantile(values(|_| 1.0)), Some(189.0));
        assert_eq!(quantile(values(|i| if i < 100 { 19.0 } else { 1.0 })), Some(99.0));
        assert_eq!(quantile(vec![(3.0, 1.0), (7.0, 0.1), (5.0, 1.0)]), Some(7.0));
        assert_eq!(quantile(Vec::new()), None);
    }
}
