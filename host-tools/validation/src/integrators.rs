//! The cost of each time integrator against its accuracy.

use std::time::Instant;

use capsule_fom::flow::Duct;
use capsule_fom::integrator::{FixedStep, Rkc2, Scheme, State, StepError, Stepper};
use capsule_fom::system::{Capsule, Discretisation};
use capsule_fom::vectors::{greatest_magnitude, norm};
use capsule_fom::{Configuration, EvaluationError, FomError, Integrator, Settings};
use nalgebra::Vector3;
use serde::Serialize;

use crate::ValidationError;

/// One run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// The integrator.
    pub integrator: Integrator,
    /// Its outcome.
    #[serde(flatten)]
    pub outcome: Outcome,
}

/// The outcome of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Outcome {
    /// It reached its end.
    Finished {
        /// Velocity evaluations.
        velocity_evaluations: usize,
        /// Duration (s).
        wall_time_s: f64,
        /// Greatest distance of a node from where the reference has it at the end, over a.
        error: f64,
    },
    /// The fixed step is too long.
    Unstable {
        /// The greatest stable one, about (l/V).
        stability_limit: f64,
    },
}

/// The reference's error of a position allowed a step (l).
const REFERENCE: f64 = 1e-9;
/// Longest step of the stabilised scheme (l/V).
const MAX_STEP: f64 = 0.2;

/// Runs one configuration to the end time of `settings` with each of `integrators`. `progress` receives the number of
/// finished runs and of all.
///
/// # Errors
/// [`ValidationError`] when settings or configuration are refused, or a run stops for another reason than its step.
pub fn study(
    settings: &Settings,
    configuration: &Configuration,
    integrators: &[Integrator],
    progress: &dyn Fn(usize, usize),
) -> Result<Vec<Row>, ValidationError> {
    settings.validate()?;
    configuration.validate()?;
    integrators.iter().try_for_each(Integrator::validate)?;
    let problem = Problem {
        discretisation: Discretisation::new(settings.mesh_frequency, true, settings.membrane, settings.law)?,
        duct: Duct::new(&settings.duct).map_err(FomError::Duct)?,
        configuration,
        end_time: settings.end_time,
    };
    let total = integrators.len() + 1;
    progress(0, total);
    let reference = problem.run(&mut Rkc2::new(REFERENCE, MAX_STEP))?;
    let mut rows = Vec::new();
    for (i, integrator) in integrators.iter().enumerate() {
        progress(i + 1, total);
        let run = match *integrator {
            Integrator::ForwardEuler { step } => problem.run(&mut FixedStep::new(Scheme::ForwardEuler, step)),
            Integrator::Ralston { step } => problem.run(&mut FixedStep::new(Scheme::Ralston, step)),
            Integrator::Rkc2 { tolerance } => problem.run(&mut Rkc2::new(tolerance, MAX_STEP)),
        };
        let outcome = match run {
            Ok(run) => Outcome::Finished {
                velocity_evaluations: run.velocity_evaluations,
                wall_time_s: run.wall_time_s,
                error: run.distance(&reference) / configuration.confinement,
            },
            Err(ValidationError::Fom(FomError::UnstableStep { limit, .. })) => {
                Outcome::Unstable { stability_limit: limit }
            }
            Err(error) => return Err(error),
        };
        rows.push(Row {
            integrator: *integrator,
            outcome,
        });
    }
    Ok(rows)
}

/// All but the integrator.
struct Problem<'a> {
    discretisation: Discretisation,
    duct: Duct,
    configuration: &'a Configuration,
    end_time: f64,
}

/// A run's end.
struct Run {
    positions: Vec<[f64; 3]>,
    velocity_evaluations: usize,
    wall_time_s: f64,
}

impl Problem<'_> {
    fn run(&self, stepper: &mut dyn Stepper<EvaluationError>) -> Result<Run, ValidationError> {
        let &Configuration {
            capillary_number,
            confinement,
        } = self.configuration;
        let clock = Instant::now();
        let mut capsule = Capsule::new(&self.discretisation, &self.duct, capillary_number, confinement);
        let mut state = State::new(0.0, capsule.initial_value(), &mut |x, rate| capsule.rate(x, rate))
            .map_err(|source| FomError::Start { confinement, source })?;
        while state.time < self.end_time {
            stepper
                .step(&mut |x, rate| capsule.rate(x, rate), &mut state, self.end_time)
                .map_err(|error| match error {
                    StepError::Unstable { step, limit, time } => FomError::UnstableStep { step, limit, time }.into(),
                    error => ValidationError::Stopped {
                        capillary_number,
                        confinement,
                        time: state.time,
                        reason: error.to_string(),
                    },
                })?;
            capsule.recentre(&mut state.value);
        }
        Ok(Run {
            positions: capsule.fields(&state.value, &state.rate).positions,
            velocity_evaluations: capsule.evaluations(),
            wall_time_s: clock.elapsed().as_secs_f64(),
        })
    }
}

impl Run {
    /// The greatest distance between two runs' positions of a node.
    fn distance(&self, other: &Self) -> f64 {
        let pairs = self.positions.iter().zip(&other.positions);
        greatest_magnitude(pairs.map(|(a, b)| norm(Vector3::from(*a) - Vector3::from(*b))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use capsule_fom::flow::DuctSettings;

    #[test]
    fn errors_fall_with_the_step_at_each_schemes_order() {
        let settings = Settings {
            mesh_frequency: 2,
            end_time: 0.25,
            duct: DuctSettings::coarse(),
            ..Settings::default()
        };
        let configuration = Configuration {
            capillary_number: 0.2,
            confinement: 0.8,
        };
        let steps = [0.01, 0.005];
        let integrators: Vec<_> = steps
            .map(|step| Integrator::ForwardEuler { step })
            .into_iter()
            .chain(steps.map(|step| Integrator::Ralston { step }))
            .chain([1e-4, 1e-6].map(|tolerance| Integrator::Rkc2 { tolerance }))
            .chain([Integrator::ForwardEuler { step: 0.2 }])
            .collect();
        let rows = study(&settings, &configuration, &integrators, &|_, _| ()).unwrap();
        let error = |i: usize| match rows[i].outcome {
            Outcome::Finished { error, .. } => error,
            Outcome::Unstable { .. } => panic!("{:?}", rows[i]),
        };
        assert!((error(0) / error(1) - 2.0).abs() < 0.4, "{rows:?}");
        assert!((error(2) / error(3) - 4.0).abs() < 1.0, "{rows:?}");
        assert!(error(5) < error(4) && error(5) < 1e-4, "{rows:?}");
        assert!(
            matches!(rows[6].outcome, Outcome::Unstable { stability_limit } if stability_limit < 0.2),
            "{rows:?}"
        );
    }
}
