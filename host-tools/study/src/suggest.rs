//! The configurations to compute next: those where a model expects its largest errors.

use capsule_core::interpolate::{Coordinates, Weights};
use capsule_core::model::MatrixView;
use capsule_core::{Domain, EvaluateError, Model, Parameters};
use capsule_database::Database;
use capsule_offline::{PlacedSamples, Progress, Settings, Subsets};
use serde::Serialize;

use crate::{StudyError, TestSetErrors, test_set};

/// Candidates along each parameter.
const CANDIDATES: usize = 32;

/// The expected error where no sample is near, as a fraction of a.
const UNKNOWN: f64 = 1.0;

/// The largest number of samples in an interpolation: the default capacity of the core's workspace.
const NEIGHBOURS: usize = 32;

/// A suggested configuration.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Suggestion {
    /// Its parameters.
    pub parameters: Vec<f64>,
    /// The error expected there before it is computed: laboratory frame, per cent of a.
    pub expected_percent: f64,
}

/// The `count` configurations of the model's domain with the largest expected errors; each counts the ones before it as
/// computed.
/// The error is the greatest over the instants up to `until`.
///
/// A new sample reduces the deviation around it, and its error ratio is taken from its neighbours: so the suggestions
/// spread, and no solution needs to be known.
///
/// # Errors
/// [`StudyError::Evaluate`] where samples are too close to each other.
pub fn suggest(model: &Model, count: usize, until: f64) -> Result<Vec<Suggestion>, StudyError> {
    let mut estimator = Estimator::new(model, until);
    let candidates = candidates(model);
    (0..count).map(|_| estimator.add_worst(&candidates)).collect()
}

/// A lattice over the domain. The channel's Ca is spaced by its root, as the solution varies fast at small Ca.
fn candidates(model: &Model) -> Vec<Parameters<f64>> {
    let ranges = model.parameters();
    let root = |index: usize| index == 0 && !model.steady_limit_curve().is_empty();
    let value = |index: usize, place: usize| {
        let share = place as f64 / (CANDIDATES - 1) as f64;
        let (low, high) = (ranges[index].min, ranges[index].max);
        let value = if root(index) {
            (low.sqrt() + share * (high.sqrt() - low.sqrt())).powi(2)
        } else {
            low + share * (high - low)
        };
        // The precision of file names.
        (value * 1e5).round() / 1e5
    };
    let all = 0..CANDIDATES.pow(ranges.len() as u32);
    let point = |number: usize| {
        let places = (0..ranges.len()).map(|index| value(index, number / CANDIDATES.pow(index as u32) % CANDIDATES));
        Parameters::new(&places.collect::<Vec<_>>())
    };
    all.filter_map(point)
        .filter(|parameters| model.domain(*parameters) == Ok(Domain::Inside))
        .collect()
}

/// The expected error of a model's direct method, as samples are added whose solution is not known.
struct Estimator<'m> {
    model: &'m Model<'m>,
    clusters: Vec<Cluster>,
}

struct Cluster {
    range: [f64; 2],
    /// Parameters of the samples, by rising last parameter.
    samples: Vec<Vec<f32>>,
    placed: PlacedSamples,
    /// The error of each sample, predicted by the others, over the deviation of that prediction.
    ratios: Vec<f64>,
}

impl Cluster {
    fn new(range: [f64; 2], samples: Vec<Vec<f32>>, ratios: Vec<f64>, coordinates: &Coordinates<'_>) -> Self {
        let placed = PlacedSamples::new(samples.iter().map(Vec::as_slice), coordinates);
        Self {
            range,
            samples,
            placed,
            ratios,
        }
    }

    /// Adds a sample in its place: they lie by rising last parameter.
    fn add(&mut self, parameters: &Parameters<f64>, ratio: f64, coordinates: &Coordinates<'_>) {
        let new: Vec<f32> = parameters.as_slice().iter().map(|value| *value as f32).collect();
        let before = self.samples.partition_point(|sample| sample.last() <= new.last());
        self.samples.insert(before, new);
        self.ratios.insert(before, ratio);
        self.placed = PlacedSamples::new(self.samples.iter().map(Vec::as_slice), coordinates);
    }
}

impl<'m> Estimator<'m> {
    fn new(model: &'m Model<'m>, until: f64) -> Self {
        let instants = model.error_times();
        let coordinates = Coordinates::new(model.contents());
        let clusters = model.contents().clusters.iter().map(|cluster| {
            let samples = MatrixView::new(&cluster.samples.parameters);
            let errors = &cluster.direct_errors;
            let (left_out, deviations) = (MatrixView::new(&errors.left_out), MatrixView::new(&errors.deviation));
            let ratio = |j: usize| {
                let early = (0..instants.rows()).filter(|i| f64::from(instants.get(*i, 0)) <= until);
                let worst = early.map(|i| f64::from(left_out.get(j, i))).fold(0.0, f64::max);
                worst / f64::from(deviations.get(j, 0))
            };
            let mut ratios: Vec<f64> = (0..samples.rows()).map(ratio).collect();
            // A sample that the others cannot predict carries no information on the variation of the solution.
            let predicted = |j: &usize| (0..instants.rows()).all(|i| f64::from(left_out.get(*j, i)) < UNKNOWN);
            let known: Vec<f64> = (0..ratios.len()).filter(predicted).map(|j| ratios[j]).collect();
            let mean = known.iter().sum::<f64>() / known.len().max(1) as f64;
            for j in (0..ratios.len()).filter(|j| !predicted(j)) {
                ratios[j] = mean;
            }
            let row = |j: usize| (0..samples.columns()).map(|d| samples.get(j, d)).collect();
            let samples = (0..samples.rows()).map(row).collect();
            Cluster::new([cluster.min, cluster.max], samples, ratios, &coordinates)
        });
        Self {
            clusters: clusters.collect(),
            model,
        }
    }

    /// The parameter that the clusters divide.
    fn place(&self, parameters: &Parameters<f64>) -> f64 {
        parameters.get(self.model.contents().split.into())
    }

    /// Adds the candidate with the greatest expected error.
    fn add_worst(&mut self, candidates: &[Parameters<f64>]) -> Result<Suggestion, StudyError> {
        let mut worst: Option<(f64, f64, Parameters<f64>)> = None;
        for candidate in candidates {
            let (error, ratio) = self.expected(candidate)?;
            if worst.is_none_or(|(greatest, ..)| error > greatest) {
                worst = Some((error, ratio, *candidate));
            }
        }
        let (error, ratio, parameters) = worst.ok_or(StudyError::NothingToCompare)?;
        let place = self.place(&parameters);
        let coordinates = Coordinates::new(self.model.contents());
        for cluster in &mut self.clusters {
            if cluster.range[0] <= place && place <= cluster.range[1] {
                cluster.add(&parameters, ratio, &coordinates);
            }
        }
        Ok(Suggestion {
            parameters: parameters.as_slice().to_vec(),
            expected_percent: 100.0 * error,
        })
    }

    /// The expected error, as a fraction of a, and its share that is not the deviation.
    fn expected(&self, query: &Parameters<f64>) -> Result<(f64, f64), StudyError> {
        let place = self.place(query);
        let answers = self.clusters.iter().find(|cluster| place <= cluster.range[1]);
        let Some(cluster) = answers.or(self.clusters.last()) else {
            return Err(StudyError::NothingToCompare);
        };
        let contents = self.model.contents();
        let samples = cluster.placed.samples();
        let mut weights = Weights::<f64, NEIGHBOURS>::EMPTY;
        let mut scratch = [0.0; Weights::<f64, NEIGHBOURS>::SCRATCH];
        let coordinates = Coordinates::new(contents);
        match weights.kernel(&contents.kernel, &coordinates, &samples, query, None, &mut scratch) {
            // Nothing is known on the query's side of the border or within its reach: nowhere is a sample worth more.
            Err(EvaluateError::Weights { .. } | EvaluateError::BeyondExtrapolation { .. }) => {
                return Ok((UNKNOWN, UNKNOWN));
            }
            other => other?,
        }
        let sum: f64 = weights.iter().map(|(j, weight)| weight.abs() * cluster.ratios[j]).sum();
        let ratio = sum / weights.lebesgue();
        Ok((weights.deviation() * ratio, ratio))
    }
}

/// Errors of a model that was built from a design of some size.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Replayed {
    /// How the samples were chosen: `grid` or `chosen`.
    pub design: &'static str,
    /// How many samples there are.
    pub samples: usize,
    /// Errors of the direct method on the test set.
    pub errors: TestSetErrors,
}

/// Chooses a design from the samples of a database: starts with every `start`-th sample, adds `batch` at a time
/// where the model so far expects to err most in its domain, up to `most` samples, and compares each with a test set;
/// and the paper's grid for comparison.
///
/// Modes, steady limit and border are those of the whole database for all designs.
///
/// # Errors
/// Those of the database and the model.
pub fn replay(
    database: &Database,
    tests: &Database,
    [start, batch, most]: [usize; 3],
    until: f64,
    progress: Progress,
) -> Result<Vec<Replayed>, StudyError> {
    let settings = Settings::of_database(database);
    let subsets = Subsets::new(database, &settings, progress)?;
    let samples = subsets.samples();
    let compared = |design, chosen: &[usize], bytes: &[u8]| {
        let model = Model::open(bytes).map_err(capsule_offline::OfflineError::Invalid)?;
        Ok::<Replayed, StudyError>(Replayed {
            design,
            samples: chosen.len(),
            errors: test_set(&model, tests, None, &crate::TEST_TIMES, &|_, _, _| {})?,
        })
    };
    let grid: Vec<usize> = (0..samples.len()).filter(|j| on_grid(samples[*j])).collect();
    let mut replayed = vec![compared("grid", &grid, &subsets.model(&grid)?)?];
    let mut chosen: Vec<usize> = grid.iter().copied().step_by(start.max(1)).collect();
    while chosen.len() < most {
        progress("choose samples", chosen.len(), most);
        let bytes = subsets.model(&chosen)?;
        replayed.push(compared("chosen", &chosen, &bytes)?);
        let model = Model::open(&bytes).map_err(capsule_offline::OfflineError::Invalid)?;
        let mut estimator = Estimator::new(&model, until);
        for _ in 0..batch.min(most - chosen.len()) {
            let left = (0..samples.len()).filter(|j| !chosen.contains(j));
            // Only the domain counts; around it an estimate is an extrapolation, and always greater.
            let left: Vec<(usize, Parameters<f64>)> = left
                .filter_map(|j| Some((j, Parameters::new(samples[j])?)))
                .filter(|(_, parameters)| model.domain(*parameters) == Ok(Domain::Inside))
                .collect();
            let candidates: Vec<Parameters<f64>> = left.iter().map(|(_, parameters)| *parameters).collect();
            let suggestion = estimator.add_worst(&candidates)?;
            chosen.extend(
                left.iter()
                    .find(|(_, p)| p.as_slice() == suggestion.parameters)
                    .map(|(j, _)| *j),
            );
        }
    }
    let bytes = subsets.model(&chosen)?;
    replayed.push(compared("chosen", &chosen, &bytes)?);
    Ok(replayed)
}

/// Whether a sample is on the paper's grid.
fn on_grid(parameters: &[f64]) -> bool {
    let multiple = |value: f64, step: f64| (value / step - (value / step).round()).abs() < 1e-6;
    match parameters {
        [ca, confinement] => {
            let inside = (0.005 - 1e-9..=0.2 + 1e-9).contains(ca) && (0.75 - 1e-9..=1.2 + 1e-9).contains(confinement);
            inside && multiple(*confinement, 0.05) && (multiple(*ca, 0.01) || (ca - 0.005).abs() < 1e-9)
        }
        _ => false,
    }
}
