//! The paper's fixed-step schemes.

use super::{Rate, SpectralRadius, State, StepError, Stepper};

/// A fixed-step scheme.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Scheme {
    /// `u(t + h) = u + h v(u)`.
    ForwardEuler,
    /// Ralston's second-order Runge-Kutta scheme: `u' = u + (2/3) h v(u)`, `u(t + h) = u + (h/4) (v(u) + 3 v(u'))`.
    Ralston,
}

/// Integration with a fixed step, shortened only to land on the requested instant.
///
/// Both schemes are stable for `h rho <= 2` on a real negative spectrum of radius `rho`. As a membrane can also
/// saturate an instability into a jagged surface without failing, the radius is estimated at the start, every few
/// hundred steps and when an evaluation fails.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FixedStep {
    scheme: Scheme,
    step: f64,
    steps: usize,
    spectral_radius: SpectralRadius,
    #[serde(skip)]
    value: Vec<f64>,
    #[serde(skip)]
    stage_rate: Vec<f64>,
}

/// The number of steps from one check of the stability to the next.
const CHECK_INTERVAL: usize = 500;

impl FixedStep {
    /// A scheme with a step `> 0`.
    pub fn new(scheme: Scheme, step: f64) -> Self {
        Self {
            scheme,
            step,
            steps: 0,
            spectral_radius: SpectralRadius::default(),
            value: Vec::new(),
            stage_rate: Vec::new(),
        }
    }

    fn check_stability<E>(&mut self, rate: &mut Rate<E>, state: &State) -> Result<(), StepError<E>> {
        let radius = self
            .spectral_radius
            .estimate(rate, state)
            .map_err(|source| StepError::Evaluation {
                time: state.time,
                source,
            })?;
        let limit = 2.0 / radius;
        if self.step > limit {
            return Err(StepError::Unstable {
                step: self.step,
                limit,
                time: state.time,
            });
        }
        Ok(())
    }

    /// Writes the new value to `self.value` and its rate to `self.stage_rate`.
    fn attempt<E>(&mut self, rate: &mut Rate<E>, state: &State, step: f64) -> Result<(), E> {
        self.value.clone_from(&state.value);
        self.stage_rate.resize(state.rate.len(), 0.0);
        let first = if self.scheme == Scheme::ForwardEuler {
            step
        } else {
            2.0 / 3.0 * step
        };
        for (u, v) in self.value.iter_mut().zip(&state.rate) {
            *u += first * v;
        }
        rate(&self.value, &mut self.stage_rate)?;
        if self.scheme == Scheme::Ralston {
            for i in 0..self.value.len() {
                self.value[i] = state.value[i] + 0.25 * step * (state.rate[i] + 3.0 * self.stage_rate[i]);
            }
            rate(&self.value, &mut self.stage_rate)?;
        }
        Ok(())
    }
}

impl<E> Stepper<E> for FixedStep {
    fn step(&mut self, rate: &mut Rate<E>, state: &mut State, until: f64) -> Result<(), StepError<E>> {
        if self.steps.is_multiple_of(CHECK_INTERVAL) {
            self.check_stability(rate, state)?;
        }
        // A remainder of rounding errors is not a step of its own.
        let lands = state.time + self.step * (1.0 + 1e-9) >= until;
        let step = if lands { until - state.time } else { self.step };
        if let Err(source) = self.attempt(rate, state, step) {
            self.check_stability(rate, state)?;
            return Err(StepError::Evaluation {
                time: state.time,
                source,
            });
        }
        std::mem::swap(&mut state.value, &mut self.value);
        std::mem::swap(&mut state.rate, &mut self.stage_rate);
        state.time = if lands { until } else { state.time + step };
        self.steps += 1;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::test_problems::orders;

    #[test]
    fn orders_of_convergence() {
        for order in orders(|step| FixedStep::new(Scheme::ForwardEuler, step)) {
            assert!((order - 1.0).abs() < 0.1, "{order}");
        }
        for order in orders(|step| FixedStep::new(Scheme::Ralston, step)) {
            assert!((order - 2.0).abs() < 0.15, "{order}");
        }
    }

    #[test]
    fn an_unstable_step_is_named_with_the_limit() {
        let mut rate = |value: &[f64], rate: &mut [f64]| -> Result<(), std::convert::Infallible> {
            for (i, (r, v)) in rate.iter_mut().zip(value).enumerate() {
                *r = -(1.0 + 10.0 * i as f64) * v;
            }
            Ok(())
        };
        let mut state = State::new(0.0, vec![1.0; 11], &mut rate).unwrap();
        let error = FixedStep::new(Scheme::Ralston, 0.03)
            .step(&mut rate, &mut state, 1.0)
            .unwrap_err();
        let StepError::Unstable { step, limit, .. } = error else {
            panic!("{error}")
        };
        assert_eq!(step, 0.03);
        assert!((limit / (2.0 / 101.0) - 1.0).abs() < 0.05, "{limit}");
        assert_eq!(state.value, vec![1.0; 11]);
        assert!(
            FixedStep::new(Scheme::Ralston, 0.018)
                .step(&mut rate, &mut state, 1.0)
                .is_ok()
        );
    }

    #[test]
    fn steps_land_on_the_asked_instant() {
        let mut count = 0;
        let mut rate = |_: &[f64], rate: &mut [f64]| -> Result<(), std::convert::Infallible> {
            rate[0] = 1.0;
            Ok(())
        };
        let mut state = State::new(0.0, vec![0.0], &mut rate).unwrap();
        let mut scheme = FixedStep::new(Scheme::ForwardEuler, 0.01);
        for instant in [0.2, 0.4, 0.6000000000000001] {
            while state.time < instant {
                scheme.step(&mut rate, &mut state, instant).unwrap();
                count += 1;
            }
            assert_eq!(state.time, instant);
        }
        assert_eq!(count, 60);
        assert!((state.value[0] - 0.6).abs() < 1e-14);
    }
}
