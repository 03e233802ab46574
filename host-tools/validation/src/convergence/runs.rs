//! Runs to the instant of comparison, kept in a folder.

use std::io;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use capsule_fom::{Configuration, Settings, Solver, Status};
use serde::{Deserialize, Serialize};

use super::Error;
use crate::{Outline, ValidationError};

/// The state of a run at the instant of comparison.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Run {
    pub settings: serde_json::Value,
    pub capillary_number: f64,
    pub confinement: f64,
    pub status: String,
    pub t: f64,
    pub velocity: f64,
    pub pressure_drop: f64,
    pub rear_depth: f64,
    pub outline: Outline,
    pub velocity_evaluations: usize,
    pub wall_time_s: f64,
}

impl Run {
    /// Runs one configuration, with the solver of `settings` if it was built before.
    pub fn new(
        solver: &mut Option<Solver>,
        settings: &Settings,
        (capillary_number, confinement): (f64, f64),
    ) -> Result<Self, ValidationError> {
        let solver = match solver {
            Some(solver) => solver,
            None => solver.insert(Solver::new(settings.clone())?),
        };
        let configuration = Configuration {
            capillary_number,
            confinement,
        };
        let outcome = solver.run(&configuration, &mut |_| ControlFlow::Continue(()))?;
        let history = &outcome.history;
        let last = |column: &[f64]| column.last().copied().unwrap_or(f64::NAN);
        let positions = outcome.positions.last().map_or(&[][..], Vec::as_slice);
        Ok(Self {
            settings: record(settings)?,
            capillary_number,
            confinement,
            status: match outcome.status {
                Status::Steady { .. } => "steady".to_owned(),
                Status::Unsteady => "unsteady".to_owned(),
                Status::Stopped { time, reason } => format!("stopped at t = {time:.3}: {reason}"),
            },
            t: last(&history.t),
            velocity: last(&history.centroid_velocity),
            pressure_drop: last(&history.pressure_drop),
            rear_depth: last(&history.rear_depth),
            outline: Outline::new(solver.mesh(), positions, last(&outcome.centroid)),
            velocity_evaluations: outcome.velocity_evaluations,
            wall_time_s: outcome.wall_time_s,
        })
    }

    /// The errors relative to `finest`; none if they are not of the same instant, because one stopped early.
    pub fn error(&self, finest: &Self) -> Option<Error> {
        let stopped = |run: &Self| run.status.starts_with("stopped");
        let percent = |value: f64, reference: f64, scale: f64| 100.0 * (value - reference) / scale;
        (!stopped(self) && !stopped(finest)).then(|| Error {
            profile_percent: 100.0 * self.outline.distance(&finest.outline) / self.confinement,
            velocity_percent: percent(self.velocity, finest.velocity, finest.velocity),
            pressure_drop_percent: percent(self.pressure_drop, finest.pressure_drop, finest.pressure_drop),
            rear_depth_percent: percent(self.rear_depth, finest.rear_depth, self.confinement),
        })
    }

    /// The run of these settings and parameters, if it is in `folder`.
    pub fn find(
        folder: &Path,
        settings: &Settings,
        configuration: (f64, f64),
    ) -> Result<Option<Self>, ValidationError> {
        let settings = record(settings)?;
        let path = path(folder, &settings, configuration);
        let text = match std::fs::read(&path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            text => text.map_err(file("read", &path))?,
        };
        let run: Self = serde_json::from_slice(&text).map_err(|error| file("read", &path)(error.into()))?;
        Ok((run.settings == settings).then_some(run))
    }

    /// Keeps the run in `folder`: whole or not at all.
    pub fn keep(&self, folder: &Path) -> Result<(), ValidationError> {
        let path = path(folder, &self.settings, (self.capillary_number, self.confinement));
        let write = || -> io::Result<()> {
            let mut temporary = tempfile::NamedTempFile::new_in(folder)?;
            serde_json::to_writer(&mut temporary, self)?;
            temporary.persist(&path)?;
            Ok(())
        };
        write().map_err(file("write", &path))
    }
}

/// The settings as they are kept.
fn record(settings: &Settings) -> Result<serde_json::Value, ValidationError> {
    serde_json::to_value(settings).map_err(|error| file("write", Path::new("settings"))(error.into()))
}

/// One file for each configuration and all settings.
fn path(folder: &Path, settings: &serde_json::Value, (capillary_number, confinement): (f64, f64)) -> PathBuf {
    // FNV-1a.
    let digest = settings
        .to_string()
        .bytes()
        .fold(0xcbf2_9ce4_8422_2325_u64, |digest, byte| {
            (digest ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
        });
    folder.join(format!("ca{capillary_number:.4}_al{confinement:.4}_{digest:016x}.json"))
}

/// Names the file of an error.
pub fn file(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> ValidationError {
    let path = path.to_owned();
    move |source| ValidationError::File { action, path, source }
}
