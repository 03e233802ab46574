//! A capsule's run through the duct: time loop, snapshots, steady state.

use std::ops::ControlFlow;
use std::time::Instant;

use crate::flow::{Duct, DuctSettings, FlowError};
use crate::integrator::{Integration, State, StepError, Stepper};
use crate::measures::Outlines;
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

/// Where a run stands, after each accepted step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Time reached (l/V).
    pub t: f64,
    /// Time asked for (l/V); a steady run ends earlier.
    pub end_time: f64,
    /// Accepted steps.
    pub steps: usize,
    /// Velocity evaluations.
    pub velocity_evaluations: usize,
    /// Greatest normal velocity in the frame of the centroid (V).
    pub residual: f64,
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Status {
    /// Steady from this snapshot on ([`crate::SteadyCriteria`]).
    Steady {
        /// When (l/V).
        time: f64,
    },
    /// Not steady at the end time.
    Unsteady,
    /// Ended early: the solver could not go on, or the observer interrupted it.
    Stopped {
        /// When (l/V).
        time: f64,
        /// Why.
        reason: String,
    },
}

/// Observed quantities, one entry a snapshot.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct History {
    /// Time (l/V).
    pub t: Vec<f64>,
    /// Velocity of the volume centroid (V).
    pub centroid_velocity: Vec<f64>,
    /// See [`crate::measures::Dimensions`] (l).
    pub axial_length: Vec<f64>,
    /// Greatest |y| in the plane z = 0 (l).
    pub half_width: Vec<f64>,
    /// Greatest distance from the axis in the plane y = z (l).
    pub half_diagonal: Vec<f64>,
    /// Depth of the hollow at the rear (l).
    pub rear_depth: Vec<f64>,
    /// Additional pressure drop (mu V/l).
    pub pressure_drop: Vec<f64>,
}

/// A run's result. Vectors over time have one entry a snapshot; fields have one entry a node of the full mesh.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Outcome {
    /// The parameters.
    pub configuration: Configuration,
    /// How the run ended.
    pub status: Status,
    /// Times of the snapshots (l/V): multiples of the snapshot interval from 0, and the end time.
    pub times: Vec<f64>,
    /// Node positions in the laboratory frame (l).
    pub positions: Vec<Vec<[f64; 3]>>,
    /// Node velocities in the laboratory frame (V): exactly those that move the nodes.
    pub velocities: Vec<Vec<[f64; 3]>>,
    /// Axial position of the volume centroid (l).
    pub centroid: Vec<f64>,
    /// Additional pressure drop (mu V/l).
    pub pressure_drop: Vec<f64>,
    /// Observed quantities.
    pub history: History,
    /// Last outline in the plane z = 0 as `[x, r]` points from front to rear, in the frame of the centroid (l).
    pub profile_midplane: Vec<[f64; 2]>,
    /// The same in the plane y = z.
    pub profile_diagonal: Vec<[f64; 2]>,
    /// Accepted steps.
    pub steps: usize,
    /// Velocity evaluations, with those of rejected steps and of the stability estimates.
    pub velocity_evaluations: usize,
    /// Duration of the run (s).
    pub wall_time_s: f64,
    /// Greatest relative change of the enclosed volume.
    pub volume_drift: f64,
    /// The thinnest film between the membrane and the walls.
    pub thinnest_film: Film,
}

/// The film between the membrane and the walls at an instant.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Film {
    /// When (l/V).
    pub time: f64,
    /// Its least thickness (l).
    pub thickness: f64,
}

impl Solver {
    /// Builds mesh and duct operator.
    ///
    /// # Errors
    /// [`FomError`] with the setting that is out of range.
    pub fn new(settings: Settings) -> Result<Self, FomError> {
        settings.validate()?;
        let discretisation = Discretisation::new(settings.mesh_frequency, settings.symmetric, settings.membrane)?;
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

    /// Mesh, symmetry and membrane, for the mechanics of what was run.
    pub fn discretisation(&self) -> &Discretisation {
        &self.discretisation
    }

    /// The settings it was built with.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// A film that is too thin for the walls' panels to resolve, if the run had one ([`Duct::resolved_film`]).
    pub fn unresolved_film(&self, outcome: &Outcome) -> Option<Film> {
        Some(outcome.thinnest_film).filter(|film| film.thickness < self.duct.resolved_film())
    }

    /// The film that the walls' panels resolve (l), see [`Duct::resolved_film`].
    pub fn resolved_film(&self) -> f64 {
        self.duct.resolved_film()
    }

    /// Runs one configuration to its steady state or to the end time. `observer` is called after each step and may
    /// interrupt the run.
    ///
    /// A run that cannot go on is not an error: it keeps its snapshots, with [`Status::Stopped`].
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
        record.snapshot(self, &capsule, &state);
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
                // A snapshot reads the last evaluation of the capsule, so it comes before the observer may interrupt the run.
                if state.time >= until {
                    record.snapshot(self, &capsule, state);
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

/// How far a velocity, known at equal intervals, still is from its end: its differences fall off geometrically.
fn velocity_to_come(history: &[f64]) -> f64 {
    let [.., a, b, c] = history else { return f64::INFINITY };
    sum_to_come([(b - a).abs(), (c - b).abs()])
}

/// The sum of the numbers that follow two, if they fall off geometrically.
fn sum_to_come([before, last]: [f64; 2]) -> f64 {
    /// The slowest decay that is told from none.
    const SLOWEST: f64 = 0.99;
    let ratio = if last < SLOWEST * before {
        last / before
    } else {
        SLOWEST
    };
    last * ratio / (1.0 - ratio)
}

/// The greatest of what the last instants foretell: a velocity that turns seems at rest for a moment.
fn foretold(history: &[f64], to_come: impl Fn(&[f64]) -> f64) -> f64 {
    const INSTANTS: usize = 5;
    let ends = history.len().saturating_sub(INSTANTS - 1)..=history.len();
    ends.map(|end| to_come(&history[..end])).fold(0.0, f64::max)
}

/// Collects snapshots and watches for the steady state.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
struct Record {
    initial_volume: f64,
    steady_since: Option<f64>,
    /// The residual at each snapshot.
    residuals: Vec<f64>,
    outcome: Outcome,
}

impl Record {
    fn new(configuration: Configuration, initial_volume: f64) -> Self {
        Self {
            initial_volume,
            steady_since: None,
            residuals: Vec::new(),
            outcome: Outcome {
                configuration,
                status: Status::Unsteady,
                times: Vec::new(),
                positions: Vec::new(),
                velocities: Vec::new(),
                centroid: Vec::new(),
                pressure_drop: Vec::new(),
                history: History::default(),
                profile_midplane: Vec::new(),
                profile_diagonal: Vec::new(),
                steps: 0,
                velocity_evaluations: 0,
                wall_time_s: 0.0,
                volume_drift: 0.0,
                thinnest_film: Film {
                    time: 0.0,
                    thickness: f64::INFINITY,
                },
            },
        }
    }

    fn snapshot(&mut self, solver: &Solver, capsule: &Capsule, state: &State) {
        let (outlines, criteria) = (&solver.outlines, solver.settings.steady);
        let fields = capsule.fields(&state.value, &state.rate);
        let residual = capsule.residual(&state.rate);
        let length_rate = outlines.axial_length_rate(&fields.positions, &fields.velocities);
        self.residuals.push(residual);
        let steady = residual < criteria.normal_velocity && length_rate.abs() < criteria.length_rate;
        self.steady_since = if steady {
            self.steady_since.or(Some(state.time))
        } else {
            None
        };

        let dimensions = outlines.dimensions(&fields.positions);
        let Outcome {
            history,
            times,
            positions,
            velocities,
            centroid,
            pressure_drop,
            volume_drift,
            thinnest_film,
            ..
        } = &mut self.outcome;
        let film = Film {
            time: state.time,
            thickness: Duct::thinnest_film(&fields.positions),
        };
        if film.thickness < thinnest_film.thickness {
            *thinnest_film = film;
        }
        history.t.push(state.time);
        history.centroid_velocity.push(fields.centroid_velocity);
        history.axial_length.push(dimensions.axial_length);
        history.half_width.push(dimensions.half_width);
        history.half_diagonal.push(dimensions.half_diagonal);
        history.rear_depth.push(dimensions.rear_depth);
        history.pressure_drop.push(capsule.pressure_drop());
        times.push(state.time);
        positions.push(fields.positions);
        velocities.push(fields.velocities);
        centroid.push(fields.centroid);
        pressure_drop.push(capsule.pressure_drop());
        *volume_drift = volume_drift.max((capsule.volume() / self.initial_volume - 1.0).abs());
    }

    fn is_finished(&self, settings: &Settings) -> bool {
        let time = self.outcome.times.last().copied().unwrap_or_default();
        let left = settings.end_time - time;
        let place = left * foretold(&self.outcome.history.centroid_velocity, velocity_to_come);
        let shape = foretold(&self.residuals, |residuals| match residuals {
            [.., before, last] => (settings.snapshot_interval * sum_to_come([*before, *last])).min(left * last),
            _ => f64::INFINITY,
        });
        time >= settings.steady.earliest_end
            && self.steady_since.is_some()
            && place.max(shape) < settings.steady.motion * self.outcome.configuration.confinement
    }

    fn finish(mut self, outlines: &Outlines) -> Outcome {
        if let Some(time) = self.steady_since {
            self.outcome.status = Status::Steady { time };
        }
        if let (Some(positions), Some(&centroid)) = (self.outcome.positions.last(), self.outcome.centroid.last()) {
            let centred = |profile: Vec<[f64; 2]>| profile.into_iter().map(|[x, r]| [x - centroid, r]).collect();
            self.outcome.profile_midplane = centred(outlines.profile_midplane(positions));
            self.outcome.profile_diagonal = centred(outlines.profile_diagonal(positions));
        }
        self.outcome
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_velocity_to_come_is_that_of_a_geometric_decay() {
        let history: Vec<f64> = (0..4).map(|i| 1.3 - 0.01 * 0.85_f64.powi(i)).collect();
        assert!((velocity_to_come(&history) - 0.01 * 0.85_f64.powi(3)).abs() < 1e-12);
        // Two values say nothing; growing differences are taken as hardly decaying ones.
        assert_eq!(velocity_to_come(&history[..2]), f64::INFINITY);
        assert!(velocity_to_come(&[1.0, 1.1, 1.3]) > 10.0);
    }

    #[test]
    fn a_velocity_that_turns_is_not_at_rest() {
        // 1 + exp(-t) - 2 exp(-2 t) rises to its greatest value at t = ln 4 and falls from there.
        let velocity = |i: i32| 1.0 + (-0.2 * f64::from(i)).exp() - 2.0 * (-0.4 * f64::from(i)).exp();
        let history: Vec<f64> = (0..60).map(velocity).collect();
        // At the turn alone it seems at rest; what it has foretold for a while is of the size of what is to come.
        let turn = &history[..8];
        assert!(velocity_to_come(turn) < 0.1 * (history[7] - 1.0));
        assert!(foretold(turn, velocity_to_come) > 0.5 * (history[7] - 1.0));
        assert!(foretold(&history, velocity_to_come) < 1e-4);
    }
}
