//! The stabilised second-order Runge-Kutta-Chebyshev scheme with error control: B. P. Sommeijer, L. F. Shampine,
//! J. G. Verwer, RKC: an explicit solver for parabolic PDEs, J. Comput. Appl. Math. 88 (1997) 315-326.
//!
//! A step of `s` stages is stable for `h rho` up to about `0.65 s^2` on a real negative spectrum of radius `rho`, so
//! the work grows with the square root of the stiffness.

use super::{Rate, SpectralRadius, State, StepError, Stepper};
use crate::vectors::greatest_magnitude;

/// RKC2 with its work space.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Rkc2 {
    tolerance: f64,
    greatest_step: f64,
    /// The step to try next; none before the first.
    next: Option<f64>,
    /// The last accepted step and its error, for the predictive step control.
    accepted: Option<(f64, f64)>,
    spectral_radius: SpectralRadius,
    radius: f64,
    /// Accepted steps since the radius was estimated.
    age: usize,
    /// The last three stages.
    #[serde(skip)]
    stages: [Vec<f64>; 3],
    #[serde(skip)]
    stage_rate: Vec<f64>,
}

/// The damping of the stability polynomial.
const DAMPING: f64 = 2.0 / 13.0;
/// The power iteration estimates the radius from below.
const RADIUS_SAFETY: f64 = 1.15;
/// Accepted steps between two estimates of the radius.
const RADIUS_AGE: usize = 25;
/// More stages accumulate round-off and lose more work when a step is rejected.
const STAGE_LIMIT: usize = 300;
/// Below this step (in units of the greatest) the problem is not the step.
const MIN_STEP: f64 = 1e-6;

impl Rkc2 {
    /// Steps up to `greatest_step` whose estimated error, entry by entry, is at most `tolerance`.
    pub fn new(tolerance: f64, greatest_step: f64) -> Self {
        Self {
            tolerance,
            greatest_step,
            next: None,
            accepted: None,
            spectral_radius: SpectralRadius::default(),
            radius: 0.0,
            age: RADIUS_AGE,
            stages: Default::default(),
            stage_rate: Vec::new(),
        }
    }

    /// One step of `stages` stages: the new value in `self.stages[1]`, its rate in `self.stage_rate`.
    fn attempt<E>(&mut self, rate: &mut Rate<E>, state: &State, step: f64, stages: usize) -> Result<(), E> {
        let size = state.value.len();
        let chebyshev = Chebyshev::new(stages);
        for stage in &mut self.stages {
            stage.resize(size, 0.0);
        }
        self.stage_rate.resize(size, 0.0);
        let [before, last, new] = &mut self.stages;
        before.copy_from_slice(&state.value);
        let first = chebyshev.first() * step;
        for i in 0..size {
            last[i] = state.value[i] + first * state.rate[i];
        }
        for j in 2..=stages {
            rate(last, &mut self.stage_rate)?;
            let c = chebyshev.stage(j);
            for i in 0..size {
                new[i] = (1.0 - c.mu - c.nu) * state.value[i]
                    + c.mu * last[i]
                    + c.nu * before[i]
                    + step * (c.mu_rate * self.stage_rate[i] + c.gamma_rate * state.rate[i]);
            }
            std::mem::swap(before, last);
            std::mem::swap(last, new);
        }
        rate(last, &mut self.stage_rate)
    }

    /// The greatest entry of the error estimate over the tolerance; infinite if one is not a number.
    fn error(&self, state: &State, step: f64) -> f64 {
        let value = &self.stages[1];
        let differences = (0..value.len())
            .map(|i| 0.8 * (state.value[i] - value[i]) + 0.4 * step * (state.rate[i] + self.stage_rate[i]));
        let error = greatest_magnitude(differences) / self.tolerance;
        if error.is_nan() { f64::INFINITY } else { error }
    }

    /// The factor to the next step after an accepted one.
    fn growth(&self, step: f64, error: f64) -> f64 {
        let root = error.max(1e-12).cbrt();
        let plain = 0.8 / root;
        let predictive = match self.accepted {
            Some((last_step, last_error)) => 0.8 * last_error.max(1e-12).cbrt() / root * step / last_step / root,
            None => plain,
        };
        plain.min(predictive).clamp(0.1, 10.0)
    }
}

impl<E> Stepper<E> for Rkc2 {
    fn step(&mut self, rate: &mut Rate<E>, state: &mut State, until: f64) -> Result<(), StepError<E>> {
        let mut failure = None;
        loop {
            if self.age >= RADIUS_AGE {
                self.radius = RADIUS_SAFETY
                    * self
                        .spectral_radius
                        .estimate(rate, state)
                        .map_err(|source| StepError::Evaluation {
                            time: state.time,
                            source,
                        })?;
                self.age = 0;
            }
            let wanted = self
                .next
                .unwrap_or(self.greatest_step.min(1.0 / self.radius))
                .min(self.greatest_step);
            if wanted < MIN_STEP * self.greatest_step {
                return Err(match failure {
                    Some(source) => StepError::Evaluation {
                        time: state.time,
                        source,
                    },
                    None => StepError::StepTooSmall {
                        time: state.time,
                        step: MIN_STEP * self.greatest_step,
                    },
                });
            }
            let most_stable = 0.65 * (STAGE_LIMIT * STAGE_LIMIT) as f64 / self.radius;
            let allowed = wanted.min(most_stable);
            // Two equal steps to the requested instant are better than a long one and a remainder.
            let remaining = until - state.time;
            let lands = allowed * 1.01 >= remaining;
            let step = if lands { remaining } else { allowed.min(0.5 * remaining) };
            let stages = 1 + (1.54 * step * self.radius + 1.0).sqrt() as usize;
            match self.attempt(rate, state, step, stages.max(2)) {
                Ok(()) => {}
                Err(source) => {
                    failure = Some(source);
                    self.next = Some(0.5 * step);
                    self.age = RADIUS_AGE;
                    continue;
                }
            }
            let error = self.error(state, step);
            if error > 1.0 {
                self.next = Some(step * (0.8 / error.cbrt()).clamp(0.1, 0.8));
                self.age = RADIUS_AGE;
                continue;
            }
            let grown = step * self.growth(step, error);
            // A step that was shortened to land on the instant does not shorten the next one.
            self.next = Some(if step < allowed { grown.max(wanted) } else { grown });
            self.accepted = Some((step, error));
            self.age += 1;
            std::mem::swap(&mut state.value, &mut self.stages[1]);
            std::mem::swap(&mut state.rate, &mut self.stage_rate);
            state.time = if lands { until } else { state.time + step };
            return Ok(());
        }
    }
}

/// The scheme's coefficients, by recursion over the stages.
struct Chebyshev {
    w0: f64,
    w1: f64,
    /// `b_j` and `a_j = 1 - b_j T_j(w0)` for each stage.
    b: Vec<f64>,
    a: Vec<f64>,
}

struct Coefficients {
    mu: f64,
    nu: f64,
    mu_rate: f64,
    gamma_rate: f64,
}

impl Chebyshev {
    fn new(stages: usize) -> Self {
        let w0 = 1.0 + DAMPING / (stages * stages) as f64;
        // T_j(w0) and its first two derivatives.
        let mut t = vec![[1.0, 0.0, 0.0], [w0, 1.0, 0.0]];
        for j in 2..=stages {
            let ([t1, d1, dd1], [t2, d2, dd2]) = (t[j - 1], t[j - 2]);
            t.push([
                2.0 * w0 * t1 - t2,
                2.0 * (t1 + w0 * d1) - d2,
                2.0 * (2.0 * d1 + w0 * dd1) - dd2,
            ]);
        }
        let [_, d, dd] = t[stages];
        let w1 = d / dd;
        let mut b: Vec<f64> = t.iter().map(|[_, d, dd]| dd / (d * d)).collect();
        b[0] = b[2];
        b[1] = 1.0 / w0;
        let a = b.iter().zip(&t).map(|(b, [t, ..])| 1.0 - b * t).collect();
        Self { w0, w1, b, a }
    }

    fn first(&self) -> f64 {
        self.b[1] * self.w1
    }

    fn stage(&self, j: usize) -> Coefficients {
        let mu_rate = 2.0 * self.b[j] * self.w1 / self.b[j - 1];
        Coefficients {
            mu: 2.0 * self.b[j] * self.w0 / self.b[j - 1],
            nu: -self.b[j] / self.b[j - 2],
            mu_rate,
            gamma_rate: -self.a[j - 1] * mu_rate,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use super::*;
    use crate::integrator::test_problems::{orders, smooth_error};

    #[test]
    fn order_of_convergence() {
        // Without error control, at the greatest step.
        for order in orders(|step| Rkc2::new(f64::INFINITY, step)) {
            assert!((order - 2.0).abs() < 0.15, "{order}");
        }
    }

    #[test]
    fn error_follows_the_tolerance() {
        let errors = [1e-4, 1e-6, 1e-8].map(|tolerance| smooth_error(&mut Rkc2::new(tolerance, 0.5)));
        assert!(
            errors[0] < 2e-3 && errors[1] < errors[0] / 10.0 && errors[2] < errors[1] / 10.0,
            "{errors:?}"
        );
    }

    /// The diffusion of a sine on a fine grid: the slow mode alone must remain, with few evaluations.
    #[test]
    fn stays_stable_and_cheap_on_a_stiff_linear_problem() {
        let size = 200;
        let spacing = 1.0 / (size + 1) as f64;
        let mut evaluations = 0;
        let mut rate = |y: &[f64], rate: &mut [f64]| -> Result<(), Infallible> {
            evaluations += 1;
            for i in 0..size {
                let left = if i == 0 { 0.0 } else { y[i - 1] };
                let right = if i + 1 == size { 0.0 } else { y[i + 1] };
                rate[i] = (left - 2.0 * y[i] + right) / (spacing * spacing);
            }
            Ok(())
        };
        let sine = |i: usize| (std::f64::consts::PI * spacing * (i + 1) as f64).sin();
        let value: Vec<f64> = (0..size)
            .map(|i| sine(i) + if i % 2 == 0 { 0.1 } else { -0.1 })
            .collect();
        let mut state = State::new(0.0, value, &mut rate).unwrap();
        let mut scheme = Rkc2::new(1e-5, 0.2);
        while state.time < 0.2 {
            scheme.step(&mut rate, &mut state, 0.2).unwrap();
        }
        let eigenvalue = 4.0 * (0.5 * std::f64::consts::PI * spacing).sin().powi(2) / (spacing * spacing);
        for i in 0..size {
            assert!((state.value[i] - sine(i) * (-0.2 * eigenvalue).exp()).abs() < 5e-4);
        }
        // Forward Euler would need 0.2 * 4 / h^2 / 2 = 16,000.
        assert!(evaluations < 2000, "{evaluations}");
    }

    #[test]
    fn a_rate_that_fails_rejects_the_step_and_says_why() {
        #[derive(Debug, PartialEq)]
        struct Wall;
        // Moves at speed 1 towards a wall at 1 where the rate fails.
        let mut rate = |y: &[f64], rate: &mut [f64]| {
            rate[0] = 1.0;
            if y[0] < 1.0 { Ok(()) } else { Err(Wall) }
        };
        let mut state = State::new(0.0, vec![0.0], &mut rate).unwrap();
        let mut scheme = Rkc2::new(1e-5, 0.3);
        let error = loop {
            if let Err(error) = scheme.step(&mut rate, &mut state, 2.0) {
                break error;
            }
        };
        assert!(matches!(error, StepError::Evaluation { source: Wall, .. }));
        assert!(state.time > 0.999 && state.time < 1.0);
    }
}
