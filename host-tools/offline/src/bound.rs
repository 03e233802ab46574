//! Bound of the error as a multiple of the expected error.
//!
//! Leaving out one sample tests the interpolation along its row, where samples are dense. New configurations lie
//! between rows, some near a sample and some in the middle. So the bound is calibrated with every sample twice:
//! predicted from the other rows alone, and from all samples, where only the truncation error remains. The bound is the
//! multiple of the expected error that 95 % of these errors stay below, each counted with the part of the domain that
//! lies nearest to its sample: samples are dense where the solution varies fast, and new configurations are not.

use rayon::prelude::*;

use crate::OfflineError;
use crate::assembled::Assembled;
use crate::compare::{METHODS, distances, predictions};
use crate::plan::{Plan, Reduced};
use crate::samples::Sample;
use crate::tolerances::SAME_ROW;
use crate::writer::OwnedCluster;
use capsule_core::Method;
use capsule_core::{Domain, Model, Parameters};

/// The share of errors below the bound.
const SHARE: f64 = 0.95;

/// The fewest errors that tell a quantile of 95 %; with fewer the bound is the greatest ratio found.
const FEWEST: usize = 20;

/// Approximate number of points of the domain whose nearest sample is looked up.
const PLACES: f64 = 1e4;

/// Ratio of the bound to the expected error at each instant, for each method. 1 where no row can be left out.
pub(crate) fn bound_factors(model: &Assembled) -> Result<[Vec<f64>; 2], OfflineError> {
    let weighted = weighted_ratios(model)?;
    let factor = |method: usize, instant: usize| {
        let values = weighted.iter().map(|(part, ratios)| (ratios[method][instant], *part));
        quantile(values.collect()).unwrap_or(1.0)
    };
    let instants = 0..model.plan.error_times().len();
    Ok([0, 1].map(|method| instants.clone().map(|instant| factor(method, instant)).collect()))
}

/// Ratio of the bound to the expected error of the interpolation in time, in the middle of each interval of a coarser
/// model, whose samples hold out the instants there. All samples count alike.
pub(crate) fn interval_bound_factors(coarser: &Assembled, cluster: usize) -> Result<Vec<f64>, OfflineError> {
    let parts = &coarser.built[cluster].parts;
    let truth = coarser.own_errors(cluster, Method::Direct, |sample| &sample.held_out)?;
    let floor = parts.errors[0].floor;
    let expected = |sample: usize, interval: usize| parts.interval_errors.get(sample, interval);
    let ratio = |(sample, errors): (usize, &Vec<f64>), interval: usize| {
        let above_floor = (errors[interval] - floor).max(0.0);
        (above_floor / expected(sample, interval).max(floor), 1.0)
    };
    let intervals = 0..truth.first().map_or(0, Vec::len);
    let factor = |interval| quantile(truth.iter().enumerate().map(|row| ratio(row, interval)).collect());
    // A ratio below 1 would rely on the coarser model to correct the finer one.
    Ok(intervals
        .map(|interval| factor(interval).unwrap_or(1.0).max(1.0))
        .collect())
}

/// True over expected errors at the instants, with the part of the domain that each sample stands for: of each sample
/// from the other rows alone, and from all.
fn weighted_ratios(model: &Assembled) -> Result<Vec<(f64, Ratios)>, OfflineError> {
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
    let found: Result<Vec<Vec<Ratios>>, OfflineError> = tasks
        .par_iter()
        .map(|(c, j)| {
            let left_out = rows_left_out(plan, &reduced[*c], *j, &built[*c].parts)?;
            if left_out.is_empty() {
                return Ok(left_out);
            }
            // As often as a model without its row.
            let known = ratios(plan, &models[*c], sample(&(*c, *j)))?;
            let known = vec![known; left_out.len()];
            Ok([left_out, known].concat())
        })
        .collect();
    let weighted = parts.into_iter().zip(found?);
    Ok(weighted
        .flat_map(|(part, found)| found.into_iter().map(move |ratios| (part, ratios)))
        .collect())
}

/// The value that values with [`SHARE`] of the weight do not exceed; the greatest of few.
fn quantile(mut weighted: Vec<(f64, f64)>) -> Option<f64> {
    weighted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = weighted.iter().map(|(_, weight)| weight).sum();
    let wanted = if weighted.len() < FEWEST { total } else { SHARE * total };
    let mut sum = 0.0;
    let reached = weighted.iter().find(|(_, weight)| {
        sum += weight;
        sum >= wanted
    });
    reached.or(weighted.last()).map(|(value, _)| *value)
}

/// How many places of the domain, evenly spread, lie nearest to each of some parameters, with the domain's ranges as
/// units.
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

/// Ratios of a sample predicted without each of its rows (samples with the same value of a parameter): rows of equal
/// confinement for a capsule in the channel, rows of every parameter for imported data.
fn rows_left_out(
    plan: &Plan,
    cluster: &Reduced,
    place: usize,
    parts: &OwnedCluster,
) -> Result<Vec<Ratios>, OfflineError> {
    let parameters = plan.ranges().len();
    let last = parameters - 1;
    let without = |out: &[usize]| {
        let bytes = plan.write(&[&parts.without(out)])?;
        let model = Model::open(&bytes).map_err(OfflineError::Invalid)?;
        ratios(plan, &model, &plan.samples[cluster.part.members[place]])
    };
    let mut found = Vec::new();
    for parameter in if plan.of_channel() {
        last..parameters
    } else {
        0..parameters
    } {
        let Some(row) = row(plan, cluster, place, parameter) else {
            continue;
        };
        // A sample by itself is left out once.
        if row.len() > 1 || parameter == last {
            found.push(without(&row)?);
        }
    }
    if !plan.of_channel() && !found.is_empty() {
        found.push(without(&[place])?);
    }
    Ok(found)
}

/// The row of a sample along a parameter; none where it is the first or last of its cluster, or what is left without it
/// cannot carry an interpolation.
fn row(plan: &Plan, cluster: &Reduced, place: usize, parameter: usize) -> Option<Vec<usize>> {
    let members = &cluster.part.members;
    let value = |j: &usize| plan.samples[*j].parameters[parameter];
    let own = value(&members[place]);
    let row: Vec<usize> = (0..members.len())
        .filter(|k| (value(&members[*k]) - own).abs() <= SAME_ROW)
        .collect();
    let below = members.iter().any(|j| value(j) < own - SAME_ROW);
    let above = members.iter().any(|j| value(j) > own + SAME_ROW);
    // As many as a linear function has coefficients, and one more: the kernel leaves out what they cannot tell apart.
    let enough = members.len() >= row.len() + plan.ranges().len() + 2;
    (below && above && enough).then_some(row)
}

/// Ratios of a sample as a model predicts it.
fn ratios(plan: &Plan, model: &Model<'_>, sample: &Sample) -> Result<Ratios, OfflineError> {
    let truth = &sample.truth;
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
