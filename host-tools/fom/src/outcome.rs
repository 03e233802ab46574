//! The result of a run: its snapshots and observables, and the steady state found in them.

use crate::flow::Duct;
use crate::integrator::State;
use crate::measures::Outlines;
use crate::system::Capsule;
use crate::{Configuration, Settings, SteadyCriteria};

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
    /// Ended early: the solver could not continue, or the observer interrupted it.
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

/// The distance of a velocity from its limit, estimated from its last values at equal intervals: its differences decay
/// geometrically.
fn remaining_change(history: &[f64]) -> f64 {
    let [.., a, b, c] = history else { return f64::INFINITY };
    remaining_sum([(b - a).abs(), (c - b).abs()])
}

/// The sum of the terms of a geometric series after two of them.
fn remaining_sum([before, last]: [f64; 2]) -> f64 {
    /// The largest ratio that counts as a decay.
    const SLOWEST: f64 = 0.99;
    let ratio = if last < SLOWEST * before {
        last / before
    } else {
        SLOWEST
    };
    last * ratio / (1.0 - ratio)
}

/// The largest estimate at the last instants: a velocity at its turning point seems at rest for a moment.
fn largest_estimate(history: &[f64], estimate: impl Fn(&[f64]) -> f64) -> f64 {
    const INSTANTS: usize = 5;
    let ends = history.len().saturating_sub(INSTANTS - 1)..=history.len();
    ends.map(|end| estimate(&history[..end])).fold(0.0, f64::max)
}

/// Collects snapshots and detects the steady state.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Record {
    initial_volume: f64,
    steady_since: Option<f64>,
    /// The residual at each snapshot.
    residuals: Vec<f64>,
    pub(crate) outcome: Outcome,
}

impl Record {
    pub(crate) fn new(configuration: Configuration, initial_volume: f64) -> Self {
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

    pub(crate) fn snapshot(&mut self, outlines: &Outlines, criteria: SteadyCriteria, capsule: &Capsule, state: &State) {
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

    pub(crate) fn is_finished(&self, settings: &Settings) -> bool {
        let time = self.outcome.times.last().copied().unwrap_or_default();
        let left = settings.end_time - time;
        let place = left * largest_estimate(&self.outcome.history.centroid_velocity, remaining_change);
        let shape = largest_estimate(&self.residuals, |residuals| match residuals {
            [.., before, last] => (settings.snapshot_interval * remaining_sum([*before, *last])).min(left * last),
            _ => f64::INFINITY,
        });
        time >= settings.steady.earliest_end
            && self.steady_since.is_some()
            && place.max(shape) < settings.steady.motion * self.outcome.configuration.confinement
    }

    pub(crate) fn finish(mut self, outlines: &Outlines) -> Outcome {
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
    fn the_remaining_change_is_that_of_a_geometric_decay() {
        let history: Vec<f64> = (0..4).map(|i| 1.3 - 0.01 * 0.85_f64.powi(i)).collect();
        assert!((remaining_change(&history) - 0.01 * 0.85_f64.powi(3)).abs() < 1e-12);
        // Two values give no estimate; growing differences count as slowly decaying ones.
        assert_eq!(remaining_change(&history[..2]), f64::INFINITY);
        assert!(remaining_change(&[1.0, 1.1, 1.3]) > 10.0);
    }

    #[test]
    fn a_velocity_that_turns_is_not_at_rest() {
        // 1 + exp(-t) - 2 exp(-2 t) rises to its greatest value at t = ln 4 and falls from there.
        let velocity = |i: i32| 1.0 + (-0.2 * f64::from(i)).exp() - 2.0 * (-0.4 * f64::from(i)).exp();
        let history: Vec<f64> = (0..60).map(velocity).collect();
        // At the turn alone it seems at rest; the estimates before it are of the size of the remaining change.
        let turn = &history[..8];
        assert!(remaining_change(turn) < 0.1 * (history[7] - 1.0));
        assert!(largest_estimate(turn, remaining_change) > 0.5 * (history[7] - 1.0));
        assert!(largest_estimate(&history, remaining_change) < 1e-4);
    }
}
