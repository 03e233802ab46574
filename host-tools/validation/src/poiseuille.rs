//! The undisturbed flow of the square duct against finite differences.

use std::f64::consts::PI;

use capsule_fom::flow::Poiseuille;

use crate::Check;

/// Grid intervals over the half side, so that y = 0.25, 0.5, 0.75 and 0.9 are on the grid.
const INTERVALS: usize = 160;

/// Pressure gradient and velocities of the solver's series.
pub fn checks() -> Vec<Check> {
    let flow = Poiseuille::new();
    let reference = FiniteDifferences::extrapolated(INTERVALS);
    let source = "compact finite differences, here";
    let mut checks = vec![Check::new(
        "-dp/dx l^2/(mu V)",
        flow.pressure_gradient(),
        reference.pressure_gradient,
        2e-8,
        source,
    )];
    for ((y, z), exact) in POINTS.into_iter().zip(reference.velocities) {
        let quantity = format!("u({y}, {z})/V");
        checks.push(Check::new(quantity, flow.velocity(y, z), exact, 2e-8, source));
    }
    checks
}

const POINTS: [(f64, f64); 9] = [
    (0.0, 0.0),
    (0.25, 0.0),
    (0.5, 0.0),
    (0.75, 0.0),
    (0.9, 0.0),
    (0.25, 0.25),
    (0.5, 0.5),
    (0.75, 0.75),
    (0.9, 0.9),
];

/// The flow by a method that shares nothing with the series: the fourth-order nine-point stencil
/// (Mehrstellenverfahren), solved exactly in the grid's sines.
#[derive(Debug, Clone, Copy)]
pub struct FiniteDifferences {
    /// `-dp/dx` at mean velocity 1.
    pub pressure_gradient: f64,
    /// Velocities at the points of the comparison; the first is the greatest.
    pub velocities: [f64; 9],
}

impl FiniteDifferences {
    /// The fourth-order error removed by a second grid of half as many intervals; right to about 1e-9.
    pub fn extrapolated(intervals: usize) -> Self {
        let (fine, coarse) = (unit_gradient(intervals), unit_gradient(intervals / 2));
        let [mean, velocities @ ..]: [f64; 10] = std::array::from_fn(|i| (16.0 * fine[i] - coarse[i]) / 15.0);
        Self {
            pressure_gradient: 1.0 / mean,
            velocities: velocities.map(|u| u / mean),
        }
    }
}

/// Mean velocity and the velocities at those points for a pressure gradient of 1, with `n` intervals of `h = 1/n` over
/// the half side.
fn unit_gradient(n: usize) -> [f64; 10] {
    let (size, h) = (2 * n, 1.0 / n as f64);
    let sine = |j: usize, p: usize| (PI * ((j * p) % (2 * size)) as f64 / size as f64).sin();
    // Odd modes alone: the flow is even. Each mode's part of a field of ones, and of the stencil.
    let modes: Vec<(usize, f64, f64)> = (1..size)
        .step_by(2)
        .map(|j| {
            let ones = (1..size).map(|p| sine(j, p)).sum::<f64>();
            (j, ones / n as f64, 2.0 * (PI * j as f64 / size as f64).cos() - 2.0)
        })
        .collect();
    let amplitude = |a: &(usize, f64, f64), b: &(usize, f64, f64)| -h * h * a.1 * b.1 / (a.2 + b.2 + a.2 * b.2 / 6.0);
    let at = |p: usize, q: usize| -> f64 {
        let row = |a| modes.iter().map(|b| amplitude(a, b) * sine(b.0, q)).sum::<f64>();
        modes.iter().map(|a| row(a) * sine(a.0, p)).sum()
    };
    // Trapezoidal rule with its first correction (Euler and Maclaurin); the walls' total shear is the pressure's 4.
    let sum = |a| modes.iter().map(|b| amplitude(a, b) * b.1).sum::<f64>();
    let mean = 0.25 * modes.iter().map(|a| sum(a) * a.1).sum::<f64>() + h * h / 12.0;
    let grid = |y: f64| n + (y * n as f64).round() as usize;
    std::array::from_fn(|i| match i.checked_sub(1) {
        None => mean,
        Some(point) => at(grid(POINTS[point].0), grid(POINTS[point].1)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stencil_is_of_fourth_order() {
        let exact = FiniteDifferences::extrapolated(160);
        let errors = [20, 40, 80].map(|n| {
            let [mean, greatest, ..] = unit_gradient(n);
            (greatest / mean - exact.velocities[0]).abs()
        });
        for pair in errors.windows(2) {
            assert!((3.5..4.5).contains(&(pair[0] / pair[1]).log2()), "{errors:?}");
        }
    }

    #[test]
    fn the_series_passes() {
        assert!(checks().iter().all(|check| check.passed), "{:#?}", checks());
    }
}
