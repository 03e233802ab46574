//! Poiseuille flow in the square duct `|y|, |z| <= 1` (eq. 3 of the paper, which is written for a duct of full side l;
//! here the side is 2 l).

use std::f64::consts::PI;

/// The undisturbed flow, of mean velocity 1.
#[derive(Debug, Clone)]
pub struct Poiseuille {
    gradient: f64,
    /// Per term: `4 (-1)^n / (k^3 (1 + exp(-2 k)))`, `k = (n + 1/2) pi`.
    coefficients: Vec<f64>,
}

/// Enough for 1e-11 up to 0.05 from the corners; fewer are used elsewhere.
const TERMS: usize = 64;

impl Poiseuille {
    /// Tabulates the series and scales the flow to mean velocity 1.
    pub fn new() -> Self {
        let wave_number = |n: usize| (n as f64 + 0.5) * PI;
        // The mean of the series below, term by term.
        let sum: f64 = (0..10 * TERMS)
            .map(|n| wave_number(n).tanh() / wave_number(n).powi(5))
            .sum();
        let sign = |n: usize| if n.is_multiple_of(2) { 4.0 } else { -4.0 };
        Self {
            gradient: 1.0 / (1.0 / 3.0 - 2.0 * sum),
            coefficients: (0..TERMS)
                .map(|n| sign(n) / (wave_number(n).powi(3) * (1.0 + (-2.0 * wave_number(n)).exp())))
                .collect(),
        }
    }

    /// The pressure gradient `-dp/dx` (mu V/l^2), 7.1135.
    pub fn pressure_gradient(&self) -> f64 {
        self.gradient
    }

    /// The axial velocity (V) at `(y, z)` in the duct.
    ///
    /// `u = G/2 [1 - y^2 - sum_n 4 (-1)^n cosh(k z) cos(k y) / (k^3 cosh k)]`, with y and z exchanged where |y| < |z|:
    /// the hyperbolic cosine takes the smaller, so that the terms fall off like `exp(-k (1 - |z|))` as fast as they
    /// can.
    pub fn velocity(&self, y: f64, z: f64) -> f64 {
        let (small, large) = if y.abs() < z.abs() {
            (y.abs(), z.abs())
        } else {
            (z.abs(), y.abs())
        };
        // exp(-k (1 - z)), exp(-k (1 + z)) and cos(k y) from term to term.
        let (mut rising, mut falling) = ((-0.5 * PI * (1.0 - small)).exp(), (-0.5 * PI * (1.0 + small)).exp());
        let (rising_factor, falling_factor) = (rising * rising, falling * falling);
        let mut cosine = (0.5 * PI * large).cos();
        let mut previous = cosine;
        let twice = 2.0 * (2.0 * cosine * cosine - 1.0);
        let mut sum = 0.0;
        for &coefficient in &self.coefficients {
            let bound = coefficient * (rising + falling);
            sum += bound * cosine;
            if bound.abs() < 1e-14 {
                break;
            }
            rising *= rising_factor;
            falling *= falling_factor;
            (previous, cosine) = (cosine, twice * cosine - previous);
        }
        0.5 * self.gradient * (1.0 - large * large - sum)
    }
}

impl Default for Poiseuille {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_double_sine_series() {
        let flow = Poiseuille::new();
        assert!((flow.pressure_gradient() - 7.113_538_44).abs() < 5e-9);
        assert!((flow.velocity(0.0, 0.0) - 2.096_256_0).abs() < 3e-8);
        for (y, z) in [
            (0.0, 0.0),
            (0.5, 0.0),
            (0.9, 0.0),
            (0.25, 0.25),
            (0.75, 0.75),
            (0.9, 0.9),
        ] {
            let mut sum = 0.0;
            for m in 0..300 {
                for n in 0..300 {
                    let (a, b) = ((f64::from(m) + 0.5) * PI, (f64::from(n) + 0.5) * PI);
                    let sign = if (m + n) % 2 == 0 { 4.0 } else { -4.0 };
                    sum += sign / (a * b * (a * a + b * b)) * (a * y).cos() * (b * z).cos();
                }
            }
            for (y, z) in [(y, z), (-z, y), (z, -y)] {
                let error = flow.velocity(y, z) - flow.pressure_gradient() * sum;
                assert!(error.abs() < 2e-7, "({y}, {z}): {error:.1e}");
            }
        }
    }

    #[test]
    fn momentum_balance_and_no_slip() {
        let flow = Poiseuille::new();
        let h = 1e-3;
        for (y, z) in [(0.1, 0.2), (0.4, -0.6), (-0.7, 0.7), (0.3, 0.95)] {
            let u = |dy: f64, dz: f64| flow.velocity(y + dy, z + dz);
            let laplacian = (u(h, 0.0) + u(-h, 0.0) + u(0.0, h) + u(0.0, -h) - 4.0 * u(0.0, 0.0)) / (h * h);
            assert!((laplacian + flow.pressure_gradient()).abs() < 1e-4, "{laplacian}");
            assert!(flow.velocity(1.0, z).abs() < 1e-10 && flow.velocity(y, -1.0).abs() < 1e-10);
        }
    }
}
