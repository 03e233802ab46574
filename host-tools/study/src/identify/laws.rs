//! Capsules of other membrane laws, identified as if they were the model's: whether the verdict notices, and how wrong
//! the answers are where it does not.

use std::collections::BTreeMap;
use std::path::Path;

use capsule_core::Model;
use capsule_database::Database;
use capsule_identify::{Grid, Observable, Verdict};
use capsule_measurement::Bench;
use serde::Serialize;

use super::plan::{From, Plan};
use super::trials::Trial;
use super::truth::Truth;
use super::{MOST_POINTS, quantile, shown, write};
use crate::StudyError;

/// The ranges of Ca that are told apart: laws differ the more, the more the membrane is strained.
const RANGES: [[f64; 2]; 3] = [[0.0, 0.03], [0.03, 0.075], [0.075, 1.0]];

/// The answers for the capsules of one law in a range of Ca.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LawSeries {
    /// "midplane" or "silhouette".
    pub observable: &'static str,
    /// The series of trials.
    pub name: &'static str,
    /// The law of the membrane.
    pub law: String,
    /// The range of the true Ca.
    pub ca: [f64; 2],
    /// Configurations in it.
    pub configurations: usize,
    /// Number of trials that were answered.
    pub trials: usize,
    /// Trials that were refused with an error.
    pub refused: usize,
    /// How often each verdict was given.
    pub verdicts: BTreeMap<&'static str, usize>,
    /// Trials that are said to be of no such capsule.
    pub noticed: usize,
    /// Trials with the verdict "identified".
    pub identified: usize,
    /// Identified trials whose 95 % interval of Ca does not hold the truth.
    pub identified_wrong_ca: usize,
    /// Identified trials whose 95 % interval of a does not hold the truth.
    pub identified_wrong_radius: usize,
    /// Errors of Ca of the identified trials, per cent: median with its sign, and the greatest without. That of G_s is
    /// the opposite.
    pub identified_ca_percent: [f64; 2],
    /// The same of a.
    pub identified_radius_percent: [f64; 2],
}

/// Identifies the steady capsules of databases of any law from contours with 0.1 px of noise, `repeats` times each.
/// Writes all trials as `trials.csv` and the series as `series.json` into the folder.
///
/// # Errors
/// As [`identify`](super::identify).
pub fn identify_laws(
    model: &Model<'_>,
    databases: &[Database],
    repeats: usize,
    out: &Path,
    progress: capsule_offline::Progress,
) -> Result<Vec<LawSeries>, StudyError> {
    let contour = Plan::new("0.1 px", From::FullOrder, 0.1, true);
    let with_line = Plan::new("0.1 px, with dent line", From::DentLine, 0.1, true);
    let (mut all, mut rows) = (Vec::new(), Vec::new());
    let (mut done, steps) = (0, 2 * databases.len());
    for observable in [Observable::Midplane, Observable::Silhouette] {
        let mut bench = Bench::new(model);
        bench.make_room(MOST_POINTS);
        let (mut shapes, points) = bench.shapes(model, observable);
        let grid = Grid::new(&mut shapes)?;
        for database in databases {
            progress("identify", done, steps);
            done += 1;
            let law = database.description().membrane_law();
            let truths = Truth::all(model, database, observable)?;
            if truths.is_empty() {
                return Err(StudyError::NothingToCompare);
            }
            for plan in [&contour, &with_line].into_iter().filter(|plan| plan.shows(observable)) {
                for range in RANGES {
                    let within = |truth: &&Truth| range[0] < truth.parameters[0] && truth.parameters[0] <= range[1];
                    let some: Vec<Truth> = truths.iter().filter(within).cloned().collect();
                    let (trials, refused) = plan.run(model, &some, repeats, (&mut shapes, &grid, points))?;
                    let texts = trials
                        .iter()
                        .map(|trial| trial.row(shown(observable), law, plan.pixels));
                    rows.extend(texts);
                    all.push(LawSeries {
                        configurations: some.len(),
                        refused,
                        ..LawSeries::new((shown(observable), plan.name), law, range, &trials)
                    });
                }
            }
        }
    }
    progress("identify", steps, steps);
    write(out, &all, rows)?;
    Ok(all)
}

impl LawSeries {
    fn new((observable, name): (&'static str, &'static str), law: &str, ca: [f64; 2], trials: &[Trial]) -> Self {
        let mut verdicts = BTreeMap::new();
        for trial in trials {
            *verdicts.entry(trial.found.verdict.name()).or_insert(0) += 1;
        }
        let of = |verdict: Verdict| trials.iter().filter(move |trial| trial.found.verdict == verdict);
        let wrong = |d: usize| of(Verdict::Identified).filter(|trial| !trial.holds()[d][1]).count();
        let errors = |d: usize| {
            let errors: Vec<f64> = of(Verdict::Identified).map(|trial| 100.0 * trial.errors()[d]).collect();
            let greatest = errors
                .iter()
                .fold(0.0, |greatest: f64, error| greatest.max(error.abs()));
            [quantile(&errors, 0.5), greatest]
        };
        Self {
            observable,
            name,
            law: law.to_owned(),
            ca,
            configurations: 0,
            trials: trials.len(),
            refused: 0,
            verdicts,
            noticed: of(Verdict::NotSuchACapsule).count(),
            identified: of(Verdict::Identified).count(),
            identified_wrong_ca: wrong(0),
            identified_wrong_radius: wrong(1),
            identified_ca_percent: errors(0),
            identified_radius_percent: errors(1),
        }
    }
}
