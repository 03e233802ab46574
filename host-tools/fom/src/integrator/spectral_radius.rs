//! The spectral radius of the rate's Jacobian, by nonlinear power iteration.

use super::{Rate, State};

/// The dominant direction, kept from one estimate to the next.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct SpectralRadius {
    direction: Vec<f64>,
    #[serde(skip)]
    perturbed: Vec<f64>,
    #[serde(skip)]
    rate: Vec<f64>,
}

/// Root mean square of the perturbation. The rate is accurate to about 1e-6 (its quadrature switches with distance),
/// so a much smaller one would measure noise.
const PERTURBATION: f64 = 1e-5;
/// The iteration stops when the estimate changes by less than this fraction.
const CHANGE: f64 = 0.01;
const ITERATION_LIMIT: usize = 50;

impl SpectralRadius {
    /// An estimate from below, good to a few percent.
    ///
    /// # Errors
    /// That of the rate.
    pub fn estimate<E>(&mut self, rate: &mut Rate<E>, state: &State) -> Result<f64, E> {
        let size = state.value.len();
        if self.direction.len() != size {
            // No direction is known: a quasi-random one has a part in every mode.
            self.direction = (1..=size)
                .map(|i| (i as f64 * 0.618_033_988_749_895).fract() - 0.5)
                .collect();
        }
        self.perturbed.resize(size, 0.0);
        self.rate.resize(size, 0.0);
        let mut radius = 0.0;
        for _ in 0..ITERATION_LIMIT {
            let norm = self.direction.iter().map(|d| d * d).sum::<f64>().sqrt();
            if norm == 0.0 || !norm.is_finite() {
                self.direction.clear();
                break;
            }
            let length = PERTURBATION * (size as f64).sqrt();
            for i in 0..size {
                self.perturbed[i] = state.value[i] + self.direction[i] * (length / norm);
            }
            rate(&self.perturbed, &mut self.rate)?;
            for i in 0..size {
                self.direction[i] = self.rate[i] - state.rate[i];
            }
            let previous = radius;
            radius = self.direction.iter().map(|d| d * d).sum::<f64>().sqrt() / length;
            if (radius - previous).abs() <= CHANGE * radius {
                break;
            }
        }
        Ok(radius)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radius_of_a_nonlinear_system_with_real_spectrum() {
        let mut rate = |y: &[f64], rate: &mut [f64]| -> Result<(), std::convert::Infallible> {
            rate[0] = -y[0].powi(3);
            for i in 1..y.len() {
                rate[i] = -(i as f64) * y[i] + 0.1 * y[i - 1];
            }
            Ok(())
        };
        // The first entry's eigenvalue is -3 y^2, the others' -1 to -20.
        for (first, exact) in [(1.0, 20.0), (5.0, 75.0)] {
            let mut value = vec![0.5; 21];
            value[0] = first;
            let state = State::new(0.0, value, &mut rate).unwrap();
            let mut radius = SpectralRadius::default();
            let estimate = radius.estimate(&mut rate, &state).unwrap();
            assert!((0.85..1.02).contains(&(estimate / exact)), "{estimate} {exact}");
        }
    }

    #[test]
    fn a_constant_rate_has_radius_zero() {
        let mut rate = |_: &[f64], rate: &mut [f64]| -> Result<(), std::convert::Infallible> {
            rate.fill(2.0);
            Ok(())
        };
        let state = State::new(0.0, vec![1.0; 4], &mut rate).unwrap();
        assert_eq!(SpectralRadius::default().estimate(&mut rate, &state).unwrap(), 0.0);
    }
}
