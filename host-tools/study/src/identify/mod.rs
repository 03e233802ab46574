//! How well a capsule is identified: on outlines of the full-order model that no sample shares, with and without noise,
//! and on the model's own outlines, whose truth is exact.

mod laws;
mod plan;
mod raster;
mod trials;
mod truth;

use std::path::Path;

use capsule_core::Model;
use capsule_database::{Database, table};
use capsule_identify::{Grid, Observable};
use capsule_measurement::Bench;
use serde::Serialize;

use crate::StudyError;
pub use laws::{LawSeries, identify_laws};
use plan::{Plan, plans};
use trials::Trial;
use truth::Truth;

/// Room for the points of a contour.
const MOST_POINTS: usize = 4096;
/// Share by which Ca may be off the border of buckling for a configuration to count as beside it.
const BESIDE: f64 = 0.3;

/// Errors and intervals of a series of trials.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Series {
    /// "midplane" or "silhouette".
    pub observable: &'static str,
    /// The series of trials.
    pub name: &'static str,
    /// Pixels per l.
    pub pixels: f64,
    /// Number of trials that were answered.
    pub trials: usize,
    /// Trials that were refused with an error, such as a contour that is wider than the channel.
    pub refused: usize,
    /// Errors of Ca, per cent: median, 90 % quantile, greatest.
    pub ca_percent: [f64; 3],
    /// Errors of a.
    pub radius_percent: [f64; 3],
    /// The same away from the border of buckling.
    pub away_ca_percent: [f64; 3],
    /// The same away from the border of buckling.
    pub away_radius_percent: [f64; 3],
    /// Share of the 68 % intervals of Ca and of a that hold the truth, per cent.
    pub held_68_percent: [f64; 2],
    /// Share of the 95 % intervals.
    pub held_95_percent: [f64; 2],
    /// Root mean square of the errors of ln Ca and a/l in their standard deviations, without those beyond five, which
    /// are counted: with the model's own outlines and known noise, the spread in that of the bound of Cramer and Rao.
    pub spread: [f64; 2],
    /// Trials that err by more than five standard deviations.
    pub lost: usize,
    /// Median standard deviations, per cent of Ca and of a.
    pub deviation_percent: [f64; 2],
    /// Median time of a fit, in milliseconds.
    pub time_ms: f64,
    /// Tenth percentile of the time: on a busy machine nearer to what one fit takes.
    pub fast_ms: f64,
    /// Median number of outlines that the model computed.
    pub evaluations: f64,
    /// How often each verdict was given.
    pub verdicts: std::collections::BTreeMap<&'static str, usize>,
}

/// Heading of the table of all trials.
const HEADING: [&str; 13] = [
    "observable",
    "series",
    "pixels",
    "capillary_number",
    "confinement",
    "found_capillary_number",
    "found_confinement",
    "ca_95_low",
    "ca_95_high",
    "confinement_95_low",
    "confinement_95_high",
    "structure",
    "verdict",
];

/// Runs the study: `repeats` noisy trials of each configuration, of all series or of those with a name. Writes all
/// trials as `trials.csv` and the series as `series.json` into the folder.
///
/// # Errors
/// Those of the database and of the model; a name that no series has; a folder that cannot be written.
pub fn identify(
    model: &Model<'_>,
    tests: &Database,
    (repeats, name): (usize, Option<&str>),
    out: &Path,
    progress: capsule_offline::Progress,
) -> Result<Vec<Series>, StudyError> {
    let mut plans = plans();
    if let Some(name) = name {
        let known: Vec<&str> = plans.iter().map(|plan| plan.name).collect();
        if !known.contains(&name) {
            return Err(StudyError::UnknownSeries {
                name: name.to_owned(),
                known: known.join("\", \""),
            });
        }
        plans.retain(|plan| plan.name == name);
    }
    let mut all = Vec::new();
    let mut rows = Vec::new();
    let steps = 2 * plans.len();
    for observable in [Observable::Midplane, Observable::Silhouette] {
        let truths = Truth::all(model, tests, observable)?;
        if truths.is_empty() {
            return Err(StudyError::NothingToCompare);
        }
        let mut bench = Bench::new(model);
        bench.make_room(MOST_POINTS);
        let (mut shapes, points) = bench.shapes(model, observable);
        let grid = Grid::new(&mut shapes)?;
        for plan in plans.iter().filter(|plan| plan.shows(observable)) {
            progress("identify", all.len(), steps);
            let (trials, refused) = plan.run(model, &truths, repeats, (&mut shapes, &grid, points))?;
            let observable = shown(observable);
            rows.extend(trials.iter().map(|trial| trial.row(observable, plan.name, plan.pixels)));
            all.push(Series {
                refused,
                ..Series::new(model, observable, plan, &trials)
            });
        }
    }
    progress("identify", steps, steps);
    write(out, &all, rows)?;
    Ok(all)
}

/// The name of an observable in tables.
fn shown(observable: Observable) -> &'static str {
    match observable {
        Observable::Midplane => "midplane",
        Observable::Silhouette => "silhouette",
    }
}

/// Writes all trials as `trials.csv` and the series as `series.json` into the folder.
fn write(out: &Path, series: &impl Serialize, rows: Vec<Vec<String>>) -> Result<(), StudyError> {
    let write = |name: &str, bytes: Vec<u8>| {
        let path = out.join(name);
        std::fs::write(&path, bytes).map_err(|source| StudyError::Write { path, source })
    };
    write("trials.csv", table::csv(None, HEADING, rows)?)?;
    write("series.json", serde_json::to_vec_pretty(series).unwrap_or_default())
}

impl Series {
    fn new(model: &Model<'_>, observable: &'static str, plan: &Plan, trials: &[Trial]) -> Self {
        let border = model.jump_curve();
        let away = |trial: &&Trial| {
            let [ca, confinement] = trial.truth;
            border
                .at(confinement)
                .is_none_or(|border| (ca / border - 1.0).abs() > BESIDE && ca > border)
        };
        let errors = |trials: &mut dyn Iterator<Item = &Trial>, d: usize| {
            let values: Vec<f64> = trials.map(|trial| 100.0 * trial.errors()[d].abs()).collect();
            [0.5, 0.9, 1.0].map(|share| quantile(&values, share))
        };
        let count = trials.len() as f64;
        let held = |level: usize| {
            [0, 1].map(|d| 100.0 * trials.iter().filter(|trial| trial.holds()[d][level]).count() as f64 / count)
        };
        let scores: Vec<[f64; 2]> = trials
            .iter()
            .map(|trial| {
                let found = &trial.found;
                [
                    (found.capillary_number.value / trial.truth[0]).ln() / found.deviations[0],
                    (found.confinement.value - trial.truth[1]) / found.deviations[1],
                ]
            })
            .collect();
        let lost = |score: &&[f64; 2]| score.iter().any(|score| score.is_nan() || score.abs() > 5.0);
        let kept: Vec<&[f64; 2]> = scores.iter().filter(|score| !lost(score)).collect();
        let median = |value: &dyn Fn(&Trial) -> f64, share: f64| {
            let values: Vec<f64> = trials.iter().map(value).collect();
            quantile(&values, share)
        };
        let mut verdicts = std::collections::BTreeMap::new();
        for trial in trials {
            *verdicts.entry(trial.found.verdict.name()).or_insert(0) += 1;
        }
        Self {
            observable,
            name: plan.name,
            pixels: plan.pixels,
            trials: trials.len(),
            refused: 0,
            ca_percent: errors(&mut trials.iter(), 0),
            radius_percent: errors(&mut trials.iter(), 1),
            away_ca_percent: errors(&mut trials.iter().filter(away), 0),
            away_radius_percent: errors(&mut trials.iter().filter(away), 1),
            held_68_percent: held(0),
            held_95_percent: held(1),
            spread: [0, 1].map(|d| {
                let squares: f64 = kept.iter().map(|score| score[d] * score[d]).sum();
                (squares / kept.len().max(1) as f64).sqrt()
            }),
            lost: scores.len() - kept.len(),
            deviation_percent: [
                median(&|trial| 100.0 * trial.found.deviations[0], 0.5),
                median(&|trial| 100.0 * trial.found.deviations[1] / trial.truth[1], 0.5),
            ],
            time_ms: median(&|trial| 1e3 * trial.seconds, 0.5),
            fast_ms: median(&|trial| 1e3 * trial.seconds, 0.1),
            evaluations: median(&|trial| f64::from(trial.found.evaluations), 0.5),
            verdicts,
        }
    }
}

/// A quantile of some values, 0 of none.
fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let place = (sorted.len().saturating_sub(1) as f64 * share).round() as usize;
    sorted.get(place).copied().unwrap_or(0.0)
}
