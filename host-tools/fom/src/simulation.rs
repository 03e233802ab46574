//! A capsule's run through the duct: the time loop, which can be interrupted and resumed.

use std::ops::ControlFlow;
use std::time::Instant;

use crate::flow::{Duct, DuctSettings, FlowError};
use crate::integrator::{Integration, State, StepError, Stepper};
use crate::measures::Outlines;
use crate::outcome::{Outcome, Record, Status};
use crate::system::{Capsule, Discretisation};
use crate::{Configuration, EvaluationError, FomError, Mesh, Settings, initial};

/// Mesh and duct operator, built once and shared by all configurations (and threads).
#[derive(Debug, Clone)]
pub struct Solver {
    settings: Settings,
    discretisation: Discretisation,
    outlines: Outlines,
    duct: Duct,
}

/// Progress of a run, after each accepted step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Time reached (l/V).
    pub t: f64,
    /// End time of the settings (l/V); a steady run ends earlier.
    pub end_time: f64,
    /// Accepted steps.
    pub steps: usize,
    /// Velocity evaluations.
    pub velocity_evaluations: usize,
    /// Greatest normal velocity in the frame of the centroid (V).
    pub residual: f64,
}

impl Solver {
    /// Builds mesh and duct operator.
    ///
    /// # Errors
    /// [`FomError`] with the setting that is out of range.
    pub fn new(settings: Settings) -> Result<Self, FomError> {
        settings.validate()?;
        let discretisation = Discretisation::new(
            settings.mesh_frequency,
            settings.symmetric,
            settings.membrane,
            settings.law,
        )?;
        let duct_settings = DuctSettings {
            symmetric: settings.symmetric,
            ..settings.duct.clone()
        };
        let duct = Duct::new(&duct_settings).map_err(FomError::Duct)?;
        Ok(Self {
            outlines: Outlines::new(&discretisation.mesh),
            settings,
            discretisation,
            duct,
        })
    }

    /// The reference mesh (unit sphere).
    pub fn mesh(&self) -> &Mesh {
        &self.discretisation.mesh
    }

    /// Mesh, symmetry and membrane, for the mechanics of the runs.
    pub fn discretisation(&self) -> &Discretisation {
        &self.discretisation
    }

    /// The settings it was built with.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// A warning, if the run had a film that is too thin for the walls' panels to resolve ([`Duct::resolved_film`]).
    pub fn film_warning(&self, outcome: &Outcome) -> Option<String> {
        let (film, resolved) = (outcome.thinnest_film, self.duct.resolved_film());
        let warning = || {
            format!(
                "a film of {:.3} l at t = {:.2}, where the walls' panels resolve {resolved:.3} l: velocities of nodes \
                 in the film may be wrong by 0.01 V, that of the capsule by 0.0003 V",
                film.thickness, film.time
            )
        };
        (film.thickness < resolved).then(warning)
    }

    /// Runs one configuration to its steady state or to the end time. `observer` is called after each step and may
    /// interrupt the run.
    ///
    /// A run that cannot continue is not an error: it keeps its snapshots, with [`Status::Stopped`].
    ///
    /// # Errors
    /// As [`Solver::start`] and [`Solver::resume`].
    pub fn run(
        &self,
        configuration: &Configuration,
        observer: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Outcome, FomError> {
        match self.resume(self.start(configuration)?, observer)? {
            RunState::Finished(outcome) => Ok(*outcome),
            RunState::Interrupted(run) => {
                let (time, reason) = (run.state.time, "interrupted by the caller".to_owned());
                let mut outcome = run.record.finish(&self.outlines);
                outcome.status = Status::Stopped { time, reason };
                Ok(outcome)
            }
        }
    }

    /// The run of one configuration at its first instant.
    ///
    /// # Errors
    /// [`FomError::NotPositive`] for the parameters, [`FomError::TooLong`] or [`FomError::Start`] if the initial shape
    /// does not fit in the duct.
    pub fn start(&self, configuration: &Configuration) -> Result<Run, FomError> {
        configuration.validate()?;
        let clock = Instant::now();
        let mut capsule = self.capsule(configuration);
        let confinement = configuration.confinement;
        let state =
            State::new(0.0, capsule.initial_value(), &mut |x, rate| capsule.rate(x, rate)).map_err(|source| {
                match source {
                    EvaluationError::Flow(FlowError::NearDuctEnd { limit, .. }) => FomError::TooLong {
                        confinement,
                        limit: initial::greatest_confinement(limit),
                    },
                    source => FomError::Start { confinement, source },
                }
            })?;
        let mut record = Record::new(*configuration, capsule.volume());
        record.snapshot(&self.outlines, self.settings.steady, &capsule, &state);
        record.outcome.velocity_evaluations = capsule.evaluations();
        record.outcome.wall_time_s = clock.elapsed().as_secs_f64();
        Ok(Run {
            state,
            integrator: Integration::new(&self.settings.integrator),
            record,
        })
    }

    /// Continues a run to its end, or until `observer` interrupts it. A run that was interrupted, saved and read again
    /// gives the same outcome as an undisturbed one, but for its duration.
    ///
    /// # Errors
    /// [`FomError::UnstableStep`] if a fixed step is too long, [`FomError::AnotherRun`] if the run is one of another
    /// mesh.
    pub fn resume(
        &self,
        mut run: Run,
        observer: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<RunState, FomError> {
        let Run {
            state,
            integrator,
            record,
        } = &mut run;
        let clock = Instant::now();
        let mut capsule = self.capsule(&record.outcome.configuration);
        let size = 3 * self.discretisation.symmetry.sector.len() + 1;
        for found in [state.value.len(), state.rate.len()] {
            if found != size {
                return Err(FomError::AnotherRun { found, expected: size });
            }
        }
        let before = (record.outcome.velocity_evaluations, record.outcome.wall_time_s);
        let end_time = self.settings.end_time;
        let mut stopped = None;
        'run: for until in self.settings.snapshot_times() {
            while state.time < until {
                match integrator.step(&mut |x, rate| capsule.rate(x, rate), state, until) {
                    Ok(()) => {}
                    Err(StepError::Unstable { step, limit, time }) => {
                        return Err(FomError::UnstableStep { step, limit, time });
                    }
                    Err(error) => {
                        stopped = Some(error.to_string());
                        break 'run;
                    }
                }
                capsule.recentre(&mut state.value);
                let residual = capsule.residual(&state.rate);
                // A snapshot reads the last evaluation, so it is taken before the observer may interrupt the run.
                if state.time >= until {
                    record.snapshot(&self.outlines, self.settings.steady, &capsule, state);
                }
                let outcome = &mut record.outcome;
                outcome.steps += 1;
                outcome.velocity_evaluations = before.0 + capsule.evaluations();
                outcome.wall_time_s = before.1 + clock.elapsed().as_secs_f64();
                let progress = Progress {
                    t: state.time,
                    end_time,
                    steps: outcome.steps,
                    velocity_evaluations: outcome.velocity_evaluations,
                    residual,
                };
                if observer(&progress).is_break() {
                    return Ok(RunState::Interrupted(Box::new(run)));
                }
            }
            if record.is_finished(&self.settings) {
                break;
            }
        }
        let time = state.time;
        record.outcome.velocity_evaluations = before.0 + capsule.evaluations();
        record.outcome.wall_time_s = before.1 + clock.elapsed().as_secs_f64();
        let mut outcome = run.record.finish(&self.outlines);
        if let Some(reason) = stopped {
            outcome.status = Status::Stopped { time, reason };
        }
        Ok(RunState::Finished(Box::new(outcome)))
    }

    fn capsule(&self, configuration: &Configuration) -> Capsule<'_> {
        let &Configuration {
            capillary_number,
            confinement,
        } = configuration;
        Capsule::new(&self.discretisation, &self.duct, capillary_number, confinement)
    }
}

/// A run under way: the complete state of the time loop, which can be saved and read again.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Run {
    state: State,
    integrator: Integration,
    record: Record,
}

impl Run {
    /// The configuration of the run.
    pub fn configuration(&self) -> &Configuration {
        &self.record.outcome.configuration
    }

    /// The time reached (l/V).
    pub fn time(&self) -> f64 {
        self.state.time
    }
}

/// The state in which [`Solver::resume`] leaves a run.
#[derive(Debug, Clone, PartialEq)]
pub enum RunState {
    /// At its end time, steady, or stopped.
    Finished(Box<Outcome>),
    /// Interrupted by the observer; [`Solver::resume`] continues it.
    Interrupted(Box<Run>),
}
