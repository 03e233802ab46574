//! The error of each numerical cause alone: runs that differ from the production settings in one thing, compared with
//! the finest of their kind.

mod cases;
mod runs;

pub use cases::{CONFIGURATIONS, Case, cases};

use std::collections::VecDeque;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use capsule_fom::Settings;
use serde::Serialize;

use crate::ValidationError;
use cases::{BENDING, ELEMENTS, HARMONICS};
use runs::{Run, file};

/// A case at one configuration against the finest case of its cause.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Capillary number.
    pub ca: f64,
    /// Confinement a/l.
    pub confinement: f64,
    /// The setting that is varied.
    pub cause: &'static str,
    /// Its value.
    pub value: String,
    /// Whether this is the production setting.
    pub production: bool,
    /// How the run ended.
    pub status: String,
    /// When (l/V).
    pub t: f64,
    /// Velocity (V).
    pub velocity: f64,
    /// Additional pressure drop (mu V/l).
    pub pressure_drop: f64,
    /// Depth of the hollow at the rear (l).
    pub rear_depth: f64,
    /// Distance to the finest; none for the finest itself.
    pub error: Option<Error>,
    /// Velocity evaluations.
    pub velocity_evaluations: usize,
    /// Duration of the run (s).
    pub wall_time_s: f64,
}

/// How far a run is from the finest of its cause; signed but for the profile.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Error {
    /// Modified Hausdorff distance of the outlines, in per cent of a.
    pub profile_percent: f64,
    /// Velocity, in per cent.
    pub velocity_percent: f64,
    /// Additional pressure drop, in per cent.
    pub pressure_drop_percent: f64,
    /// Depth of the hollow at the rear, in per cent of a.
    pub rear_depth_percent: f64,
}

/// The errors of all causes at the production settings, added up without regard to sign; the bending stiffness, which
/// is a property of the membrane, is not among them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Total {
    /// Capillary number.
    pub ca: f64,
    /// Confinement a/l.
    pub confinement: f64,
    /// Which discretisation of the membrane.
    pub membrane: &'static str,
    /// The sum; none if a run that it needs stopped early.
    pub error: Option<Error>,
}

/// The study's outcome.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// All runs.
    pub rows: Vec<Row>,
    /// Their sums at the production settings.
    pub totals: Vec<Total>,
}

/// Runs all `cases` at all `configurations`, `workers` at a time, and compares. Each finished run is kept in `folder`,
/// and a run that is there with the same settings is not repeated. `progress` receives the numbers of finished and of
/// all cases.
///
/// # Errors
/// [`ValidationError`] when a case cannot be set up, a file not read or written, or a thread not started. A run that
/// stops early is no error.
pub fn study(
    cases: &[Case],
    configurations: &[(f64, f64)],
    folder: &Path,
    workers: usize,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<Report, ValidationError> {
    std::fs::create_dir_all(folder).map_err(file("create", folder))?;
    let mut distinct: Vec<&Settings> = Vec::new();
    for case in cases {
        if !distinct.contains(&&case.settings) {
            distinct.push(&case.settings);
        }
    }
    let total = distinct.len() * configurations.len();
    let queue = Mutex::new(VecDeque::from(distinct));
    let done = AtomicUsize::new(0);
    let work = || -> Result<(), ValidationError> {
        let alone = rayon::ThreadPoolBuilder::new()
            .num_threads(1)
            .build()
            .map_err(|error| ValidationError::Worker {
                reason: error.to_string(),
            })?;
        loop {
            let Some(settings) = queue.lock().ok().and_then(|mut queue| queue.pop_front()) else {
                return Ok(());
            };
            let mut solver = None;
            for &configuration in configurations {
                if Run::find(folder, settings, configuration)?.is_none() {
                    alone
                        .install(|| Run::new(&mut solver, settings, configuration))?
                        .keep(folder)?;
                }
                progress(done.fetch_add(1, Ordering::Relaxed) + 1, total);
            }
        }
    };
    progress(0, total);
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        threads.into_iter().try_for_each(|thread| {
            let panicked = |_| ValidationError::Worker {
                reason: "it panicked".to_owned(),
            };
            thread.join().map_err(panicked)?
        })
    })?;
    compare(cases, configurations, folder)
}

/// Every finished run against the finest of its cause.
fn compare(cases: &[Case], configurations: &[(f64, f64)], folder: &Path) -> Result<Report, ValidationError> {
    let mut report = Report {
        rows: Vec::new(),
        totals: Vec::new(),
    };
    for &configuration in configurations {
        let mut rows = Vec::new();
        for (i, case) in cases.iter().enumerate() {
            let finest = cases.iter().rposition(|other| other.cause == case.cause).unwrap_or(i);
            let find = |case: &Case| Run::find(folder, &case.settings, configuration);
            let (Some(run), Some(reference)) = (find(case)?, find(&cases[finest])?) else {
                continue;
            };
            rows.push(Row {
                ca: run.capillary_number,
                confinement: run.confinement,
                cause: case.cause,
                value: case.value.clone(),
                production: case.production,
                error: (i != finest).then(|| run.error(&reference)).flatten(),
                status: run.status,
                t: run.t,
                velocity: run.velocity,
                pressure_drop: run.pressure_drop,
                rear_depth: run.rear_depth,
                velocity_evaluations: run.velocity_evaluations,
                wall_time_s: run.wall_time_s,
            });
        }
        for (membrane, other) in [("harmonics", ELEMENTS), ("elements", HARMONICS)] {
            let counts = |row: &&Row| row.production && ![other, BENDING].contains(&row.cause);
            // The finest of a cause has no error: that it is not measured is not held against it.
            let is_finest = |row: &&Row| {
                cases
                    .iter()
                    .rfind(|case| case.cause == row.cause)
                    .is_some_and(|case| case.value == row.value)
            };
            let mut errors = rows
                .iter()
                .filter(counts)
                .filter(|row| !is_finest(row))
                .map(|row| row.error);
            report.totals.push(Total {
                ca: configuration.0,
                confinement: configuration.1,
                membrane,
                error: errors.try_fold(Error::default(), |sum, error| Some(sum.plus_magnitude(error?))),
            });
        }
        report.rows.extend(rows);
    }
    Ok(report)
}

impl Error {
    fn plus_magnitude(self, other: Self) -> Self {
        Self {
            profile_percent: self.profile_percent + other.profile_percent,
            velocity_percent: self.velocity_percent + other.velocity_percent.abs(),
            pressure_drop_percent: self.pressure_drop_percent + other.pressure_drop_percent.abs(),
            rear_depth_percent: self.rear_depth_percent + other.rear_depth_percent.abs(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use capsule_fom::flow::DuctSettings;

    /// Coarse cases of one cause.
    fn coarse(frequencies: &[usize]) -> Vec<Case> {
        frequencies
            .iter()
            .map(|&mesh_frequency| Case {
                cause: HARMONICS,
                value: mesh_frequency.to_string(),
                production: mesh_frequency == 3,
                settings: Settings {
                    mesh_frequency,
                    end_time: 0.2,
                    duct: DuctSettings::coarse(),
                    ..Settings::default()
                },
            })
            .collect()
    }

    #[test]
    fn finished_runs_are_kept_and_compared_with_the_finest() {
        let folder = tempfile::tempdir().unwrap();
        let run = |cases: &[Case]| study(cases, &[(0.1, 0.8)], folder.path(), 2, &|_, _| ()).unwrap();
        let files = || std::fs::read_dir(folder.path()).unwrap().count();
        let first = run(&coarse(&[2, 4]));
        assert_eq!((files(), first.rows.len()), (2, 2));
        let second = run(&coarse(&[2, 3, 4]));
        assert_eq!((files(), second.rows.len()), (3, 3));
        // The very run of before: its duration is the same.
        assert_eq!(second.rows[0], first.rows[0]);
        let profile = |i: usize| second.rows[i].error.map(|error| error.profile_percent);
        assert!(
            profile(1) < profile(0) && profile(1) > Some(0.0) && profile(2).is_none(),
            "{second:#?}"
        );
        let [harmonics, elements] = [0, 1].map(|i| &second.totals[i]);
        let total = harmonics.error.map(|error| error.profile_percent);
        assert_eq!((harmonics.membrane, total), ("harmonics", profile(1)));
        assert_eq!(
            (elements.membrane, elements.error),
            ("elements", Some(Error::default()))
        );
    }

    #[test]
    fn the_study_has_one_production_setting_for_each_cause() {
        let cases = cases();
        let causes: std::collections::BTreeSet<&str> = cases.iter().map(|case| case.cause).collect();
        for cause in causes {
            let production = cases
                .iter()
                .filter(|case| case.cause == cause && case.production)
                .count();
            assert_eq!(production, 1, "{cause}");
            let values: Vec<_> = cases.iter().filter(|case| case.cause == cause).collect();
            for pair in values.windows(2) {
                assert_ne!(pair[0].settings, pair[1].settings, "{cause}");
            }
        }
        for case in &cases {
            assert!(case.settings.validate().is_ok());
        }
    }
}
