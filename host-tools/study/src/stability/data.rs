//! Defective databases: noise, gaps, too few samples for the requested ranks; and one that goes
//! on to t = 200.

use std::path::Path;

use capsule_core::{Evaluator, Method, Model, Query, Workspace};
use capsule_database::{Database, Description, Mesh, Symmetry, Trajectory};
use capsule_offline::{BuildReport, OfflineError, Ranks, Settings, Truncation, build};

use super::truth::{Errors, INSTANTS, Truth, errors, read};
use super::{Check, Row, Subject};
use crate::random::Random;
use crate::{StudyError, name};

const METHODS: [Method; 2] = [Method::Direct, Method::Paper];

/// A small part of a database around a/l = 0.9, at few instants, from which models are built in seconds.
pub(crate) struct Small {
    mesh: Mesh,
    symmetry: Symmetry,
    samples: Vec<Trajectory>,
    truths: Vec<Truth>,
}

/// The part of the parameters that is kept.
fn inside([ca, confinement]: [f64; 2]) -> bool {
    (0.0199..0.0801).contains(&ca) && (0.849..0.951).contains(&confinement)
}

fn on_grid([ca, confinement]: [f64; 2]) -> bool {
    let multiple = |value: f64, step: f64| (value / step - (value / step).round()).abs() < 1e-6;
    multiple(ca, 0.01) && multiple(confinement, 0.05)
}

impl Small {
    pub(crate) fn new(subject: &Subject) -> Result<Self, StudyError> {
        let database = subject.database;
        let all = database.times();
        // Every third instant, and those of the errors.
        let last = INSTANTS[INSTANTS.len() - 1];
        let wanted = |time: f64| INSTANTS.iter().any(|instant| (instant - time).abs() < 1e-9);
        let kept = all
            .iter()
            .enumerate()
            .filter(|(i, time)| **time <= last + 1e-9 && (i % 3 == 0 || wanted(**time)));
        let times: Vec<f64> = kept.map(|(_, time)| *time).collect();
        let mut samples = Vec::new();
        for entry in database.entries()? {
            let parameters = [entry.parameters[0], entry.parameters[1]];
            if entry.status.is_steady() && inside(parameters) && on_grid(parameters) {
                samples.push(database.read(&entry.parameters)?.extended(database.mesh(), &times)?);
            }
        }
        let most = if subject.quick { 3 } else { 8 };
        let off_grid = |parameters| inside(parameters) && !on_grid(parameters);
        let truths = read(subject.tests, most, off_grid).or_else(|_| read(database, most, off_grid))?;
        Ok(Small {
            mesh: database.mesh().clone(),
            symmetry: database.symmetry().clone(),
            samples,
            truths,
        })
    }

    pub(crate) fn times(&self) -> &[f64] {
        self.samples.first().map_or(&[], |sample| &sample.times)
    }

    /// A model of all samples.
    pub(crate) fn whole(&self, folder: &Path) -> Result<(Vec<u8>, BuildReport), StudyError> {
        self.build(folder, self.times(), None, self.samples.clone())
    }

    /// A model of some samples at some instants, built in `folder`.
    fn build(
        &self,
        folder: &Path,
        times: &[f64],
        truncation: Option<Truncation>,
        samples: impl IntoIterator<Item = Trajectory>,
    ) -> Result<(Vec<u8>, BuildReport), StudyError> {
        let written = |source| StudyError::Write {
            path: folder.to_owned(),
            source,
        };
        let directory = tempfile::tempdir_in(folder).map_err(written)?;
        let description = Description::new(times.to_vec(), serde_json::Value::Null);
        let database = Database::create(directory.path(), description, self.mesh.clone())?;
        for sample in samples {
            database.write(&sample)?;
        }
        let default = Settings::default();
        let settings = Settings {
            truncation: truncation.unwrap_or(default.truncation),
            error_times: INSTANTS.to_vec(),
            ..default
        };
        Ok(build(&database, &settings, &|_, _, _| ())?)
    }

    /// A random field with the symmetry of the mesh, of a given standard deviation of the components.
    fn noise(&self, random: &mut Random, size: f64) -> Result<Vec<[f64; 3]>, StudyError> {
        const ON_PLANE: f64 = 1e-9;
        // Uniform on an interval of this width.
        let width = size * 12.0f64.sqrt();
        let sector = self.symmetry.sector.iter().map(|node| {
            let [_, y, z] = self.mesh.nodes[*node as usize];
            let [along, mut across, mut up] = [0; 3].map(|_| random.between(-0.5 * width, 0.5 * width));
            if z.abs() < ON_PLANE {
                up = 0.0;
            }
            if (y - z).abs() < ON_PLANE {
                across = 0.5 * (across + up);
                up = across;
            }
            if y.abs() < ON_PLANE {
                (across, up) = (0.0, 0.0);
            }
            [along, across, up]
        });
        Ok(self.symmetry.expand(&sector.collect::<Vec<_>>())?)
    }
}

/// Errors of models that are built from defective data, and checks of the offline stage.
pub(super) fn rows(subject: &Subject, folder: &Path) -> Result<(Vec<Row>, Check), StudyError> {
    let small = Small::new(subject)?;
    let mut rows = Vec::new();
    let add = |rows: &mut Vec<Row>, setting: &str, value: f64, bytes: &[u8]| -> Result<(), StudyError> {
        let model = Model::open(bytes)?;
        for method in METHODS {
            let errors = errors::<f64>(&model, &small.truths, |place| Query::new(place, method))?;
            rows.push(Row::new(setting, value, name(method), &errors));
        }
        Ok(())
    };
    let levels: &[f64] = if subject.quick {
        &[0.0, 1e-2]
    } else {
        &[0.0, 1e-8, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2]
    };
    for level in levels {
        let mut random = Random(3);
        let mut samples = small.samples.clone();
        for sample in &mut samples {
            for fields in [&mut sample.positions, &mut sample.velocities] {
                for field in fields.iter_mut() {
                    let noise = small.noise(&mut random, *level)?;
                    for (vector, noise) in field.iter_mut().zip(noise) {
                        (0..3).for_each(|d| vector[d] += noise[d]);
                    }
                }
            }
        }
        add(
            &mut rows,
            "noise in the data / l",
            *level,
            &small.build(folder, small.times(), None, samples)?.0,
        )?;
    }
    for rank in [8, 64] {
        let truncation = Truncation::Ranks(Ranks {
            space: rank,
            parameter: rank,
        });
        let (bytes, _) = small.build(folder, small.times(), Some(truncation), small.samples.clone())?;
        add(&mut rows, "ranks asked for", rank as f64, &bytes)?;
    }
    // Steady samples that end early go on rigidly: at t = 4 shapes still change a little.
    for end in [4.0, 6.0] {
        let early = small.samples.iter().enumerate().map(|(j, sample)| match j % 2 {
            0 => until(sample, end),
            _ => sample.clone(),
        });
        let (bytes, _) = small.build(folder, small.times(), None, early.collect::<Vec<_>>())?;
        add(&mut rows, "every other sample ends at t / (l/V)", end, &bytes)?;
    }
    rows.extend(long(&small, folder)?);
    Ok((rows, refusals(&small, folder)?))
}

/// A trajectory that stops early.
fn until(sample: &Trajectory, end: f64) -> Trajectory {
    let mut sample = sample.clone();
    let count = sample.times.partition_point(|time| *time <= end);
    sample.times.truncate(count);
    sample.positions.truncate(count);
    sample.velocities.truncate(count);
    sample.centroid.truncate(count);
    sample.pressure_drop.truncate(count);
    sample
}

/// A model whose snapshots reach to t = 200, stepped all the way: the error of the place that has grown between the
/// last instant with a truth and the end is that of the speed.
fn long(small: &Small, folder: &Path) -> Result<Vec<Row>, StudyError> {
    let last = INSTANTS[INSTANTS.len() - 1];
    let mut times = small.times().to_vec();
    times.extend((1..=24).map(|i| last + 8.0 * f64::from(i)));
    let extended = small.samples.iter().map(|sample| sample.extended(&small.mesh, &times));
    let (bytes, _) = small.build(folder, &times, None, extended.collect::<Result<Vec<_>, _>>()?)?;
    let model = Model::open(&bytes)?;
    let mut workspace = Box::new(Workspace::<f64>::new());
    let mut evaluator = Evaluator::new(&model, &mut workspace)?;
    let mut rows = Vec::new();
    for method in METHODS {
        for t in [20.0, 50.0, 100.0, 200.0] {
            let mut errors = Errors::default();
            for truth in &small.truths {
                let [ca, confinement] = truth.parameters;
                let mut lengths = |t: f64| -> Option<[f64; 2]> {
                    evaluator.prepare(&Query::new([ca, confinement], method)).ok()?;
                    let observables = evaluator.at(t).ok()?.observables().ok()?;
                    Some([observables.axial_length, observables.velocity])
                };
                // A capsule at rest in its own frame: its length and speed stay.
                let change = lengths(last)
                    .zip(lengths(t))
                    .map(|(before, after)| [0, 1].map(|i| (after[i] - before[i]).abs() / confinement).to_vec());
                errors.count(change);
            }
            rows.push(Row::new(
                "change of length and speed since t = 8, at t / (l/V)",
                t,
                name(method),
                &errors,
            ));
        }
    }
    Ok(rows)
}

/// Checks of the offline stage on sample data.
type Built = Result<(Vec<u8>, BuildReport), StudyError>;

/// Data that no model can be built from, and data that one can.
fn refusals(small: &Small, folder: &Path) -> Result<Check, StudyError> {
    let mut check = Check::new("spoilt data: answered with a model where one can be, else with the reason");
    let mut ask = |what: &str, right: fn(&Built) -> bool, samples: Vec<Trajectory>| {
        let built = small.build(folder, small.times(), None, samples);
        check.count(built.is_ok(), right(&built), || match &built {
            Ok(_) => format!("{what}: a model"),
            Err(error) => format!("{what}: {error}"),
        });
    };
    let spoilt = |spoil: &dyn Fn(&mut Trajectory)| {
        let mut samples = small.samples.clone();
        spoil(&mut samples[3]);
        samples
    };
    ask(
        "noise without the symmetry",
        |built| matches!(built, Err(StudyError::Offline(OfflineError::NotSymmetric { .. }))),
        spoilt(&|sample| {
            sample.positions[1][5][1] += 1e-3;
        }),
    );
    ask(
        "a value that is not a number",
        |built| matches!(built, Err(StudyError::Database(_))),
        spoilt(&|sample| {
            sample.velocities[1][5][1] = f64::NAN;
        }),
    );
    ask(
        "an instant missing in the middle",
        |built| built.is_err(),
        spoilt(&|sample| {
            sample.times.remove(2);
            sample.positions.remove(2);
            sample.velocities.remove(2);
            sample.centroid.remove(2);
            sample.pressure_drop.remove(2);
        }),
    );
    ask(
        "instants that do not rise",
        |built| matches!(built, Err(StudyError::Database(_))),
        spoilt(&|sample| sample.times.swap(1, 2)),
    );
    ask(
        "an unsteady sample that ends early is left out",
        |built| built.is_ok(),
        spoilt(&|sample| {
            *sample = until(sample, 4.0);
            sample.status = capsule_database::Status::Unsteady;
        }),
    );
    ask(
        "three samples",
        |built| matches!(built, Err(StudyError::Offline(OfflineError::TooFewSamples { .. }))),
        small.samples[..3].to_vec(),
    );
    ask(
        "one row of a/l",
        |built| built.is_ok(),
        small
            .samples
            .iter()
            .filter(|sample| (sample.parameters[1] - 0.85).abs() < 1e-9)
            .cloned()
            .collect(),
    );
    Ok(check)
}
