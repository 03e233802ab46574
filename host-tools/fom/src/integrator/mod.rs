//! Explicit integrators of `d value / dt = rate(value)` on a flat state.
//!
//! [`FixedStep`] holds the paper's two schemes, forward Euler and Ralston's; [`Rkc2`] is a stabilised scheme with
//! error control for the membrane's stiff, real and negative spectrum. A step only counts if every evaluation of the
//! rate in it succeeds.

mod fixed_step;
mod rkc2;
mod spectral_radius;

pub use fixed_step::{FixedStep, Scheme};
pub use rkc2::Rkc2;
pub use spectral_radius::SpectralRadius;

use crate::Integrator;

/// The right-hand side: writes the rate of a value, or returns an error.
pub type Rate<'a, E> = dyn FnMut(&[f64], &mut [f64]) -> Result<(), E> + 'a;

/// A point of the solution with its rate.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct State {
    /// The time.
    pub time: f64,
    /// The value.
    pub value: Vec<f64>,
    /// `rate(value)`.
    pub rate: Vec<f64>,
}

impl State {
    /// The initial state: evaluates the rate once.
    ///
    /// # Errors
    /// That of the rate.
    pub fn new<E>(time: f64, value: Vec<f64>, rate: &mut Rate<E>) -> Result<Self, E> {
        let mut state = Self {
            time,
            rate: vec![0.0; value.len()],
            value,
        };
        rate(&state.value, &mut state.rate)?;
        Ok(state)
    }
}

/// One scheme with its work space.
pub trait Stepper<E> {
    /// Advances `state` by one step that does not pass `until`.
    ///
    /// On success the last evaluation of `rate` was that of the new state; on failure `state` is unchanged.
    ///
    /// # Errors
    /// [`StepError`].
    fn step(&mut self, rate: &mut Rate<E>, state: &mut State, until: f64) -> Result<(), StepError<E>>;
}

/// The scheme of the settings with its state from the previous steps.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Integration {
    /// One of the paper's.
    FixedStep(FixedStep),
    /// The stabilised one.
    Rkc2(Rkc2),
}

/// Longest step of the stabilised integrator (l/V).
const MAX_STEP: f64 = 0.2;

impl Integration {
    /// A scheme that has made no step yet.
    pub fn new(integrator: &Integrator) -> Self {
        match *integrator {
            Integrator::ForwardEuler { step } => Self::FixedStep(FixedStep::new(Scheme::ForwardEuler, step)),
            Integrator::Ralston { step } => Self::FixedStep(FixedStep::new(Scheme::Ralston, step)),
            Integrator::Rkc2 { tolerance } => Self::Rkc2(Rkc2::new(tolerance, MAX_STEP)),
        }
    }
}

impl<E> Stepper<E> for Integration {
    fn step(&mut self, rate: &mut Rate<E>, state: &mut State, until: f64) -> Result<(), StepError<E>> {
        match self {
            Self::FixedStep(scheme) => scheme.step(rate, state, until),
            Self::Rkc2(scheme) => scheme.step(rate, state, until),
        }
    }
}

/// Errors of an integrator.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StepError<E> {
    /// A fixed step is beyond the scheme's stability.
    #[error("a fixed step of {step:e} is unstable at t = {time:.4}: the limit is about {limit:.3e}")]
    Unstable {
        /// The step.
        step: f64,
        /// An estimate of the greatest stable step at this state.
        limit: f64,
        /// The time.
        time: f64,
    },
    /// The rate could not be evaluated, however small the step.
    #[error("no further than t = {time:.4}: {source}")]
    Evaluation {
        /// The time of the last state.
        time: f64,
        /// Why.
        source: E,
    },
    /// The error control asks for steps below the smallest.
    #[error("no further than t = {time:.4}: the tolerance would need a step below {step:e}")]
    StepTooSmall {
        /// The time of the last state.
        time: f64,
        /// The smallest step.
        step: f64,
    },
}

#[cfg(test)]
pub(crate) mod test_problems {
    //! Problems with known solutions for the tests of each scheme.

    use std::convert::Infallible;

    use super::*;

    /// Logistic growth and hyperbolic decay.
    pub fn smooth(value: &[f64], rate: &mut [f64]) -> Result<(), Infallible> {
        rate[0] = value[0] * (1.0 - value[0]);
        rate[1] = -value[1] * value[1];
        Ok(())
    }

    pub fn smooth_exact(t: f64) -> [f64; 2] {
        [1.0 / (1.0 + 3.0 * (-t).exp()), 1.0 / (0.5 + t)]
    }

    /// The error at t = 2 of a scheme on the smooth problem.
    pub fn smooth_error(integrator: &mut dyn Stepper<Infallible>) -> f64 {
        let mut state = State::new(0.0, smooth_exact(0.0).to_vec(), &mut smooth).unwrap();
        while state.time < 2.0 {
            integrator.step(&mut smooth, &mut state, 2.0).unwrap();
        }
        let exact = smooth_exact(2.0);
        (0..2).map(|i| (state.value[i] - exact[i]).abs()).fold(0.0, f64::max)
    }

    /// The observed orders between the steps 0.1, 0.05, 0.025.
    pub fn orders<S: Stepper<Infallible>>(scheme: impl Fn(f64) -> S) -> [f64; 2] {
        let errors = [0.1, 0.05, 0.025].map(|step| smooth_error(&mut scheme(step)));
        [(errors[0] / errors[1]).log2(), (errors[1] / errors[2]).log2()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::test_problems::smooth;

    #[test]
    fn an_integration_saved_after_each_step_is_the_same() {
        for integrator in [
            Integrator::Rkc2 { tolerance: 1e-9 },
            Integrator::ForwardEuler { step: 1e-3 },
        ] {
            let run = |save: bool| {
                let mut integration = Integration::new(&integrator);
                let mut state = State::new(0.0, vec![0.25, 2.0], &mut smooth).unwrap();
                let mut steps = 0;
                while state.time < 2.0 {
                    integration.step(&mut smooth, &mut state, 2.0).unwrap();
                    steps += 1;
                    if save {
                        let bytes = postcard::to_stdvec(&(&integration, &state)).unwrap();
                        (integration, state) = postcard::from_bytes(&bytes).unwrap();
                    }
                }
                (state, steps)
            };
            let (undisturbed, steps) = run(false);
            assert!(steps > 50, "more than one estimate of the spectral radius");
            assert_eq!(run(true), (undisturbed, steps));
        }
    }
}
