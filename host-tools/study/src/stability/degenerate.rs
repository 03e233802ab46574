//! Samples that lie on a line or a curve, on each other, or that are very few.

use capsule_core::interpolate::{Coordinates, Weights};
use capsule_core::model::Curve;
use capsule_core::model::wire::{Kernel, Matrix, Paper};
use capsule_core::{EvaluateError, Parameters, Real};
use capsule_offline::PlacedSamples;

use super::Check;
use super::places::NEIGHBOURS;

/// Weights whose absolute values add up to more are useless. Off an oblique line of samples they reach 1e4: there the
/// deviation, and with it the expected error, is large.
const USELESS: f64 = 1e5;

/// Sets of samples around (0.05, 0.9), with their names.
fn sets() -> Vec<(&'static str, Vec<[f64; 2]>)> {
    let row = |n: i32, at: fn(f64) -> [f64; 2]| (0..n).map(|i| at(f64::from(i) / f64::from(n))).collect::<Vec<_>>();
    let grid: Vec<[f64; 2]> = (0..40)
        .map(|i| [0.01 * f64::from(i % 8 + 1), 0.8 + 0.05 * f64::from(i / 8)])
        .collect();
    let twice = |shift: f64| {
        let moved = grid.iter().map(|[ca, a]| [ca * (1.0 + shift), *a]);
        grid.iter().copied().chain(moved).collect::<Vec<_>>()
    };
    vec![
        ("on a line of equal a/l", row(30, |s| [0.01 + 0.1 * s, 0.9])),
        ("on a line of equal Ca", row(30, |s| [0.05, 0.7 + 0.5 * s])),
        ("on an oblique line", row(30, |s| [0.01 + 0.1 * s, 0.7 + 0.5 * s])),
        (
            "on a circle",
            row(30, |s| [0.05 + 0.02 * (6.3 * s).sin(), 0.9 + 0.1 * (6.3 * s).cos()]),
        ),
        (
            "on two rows",
            row(30, |s| {
                [0.01 + 0.1 * s, if (30.0 * s) as i32 % 2 == 0 { 0.85 } else { 0.95 }]
            }),
        ),
        ("all in one place", vec![[0.03, 0.85]; 30]),
        ("each twice", twice(0.0)),
        ("each twice, 1e-7 apart", twice(1e-7)),
        ("each twice, 1e-4 apart", twice(1e-4)),
        ("one", vec![[0.03, 0.85]]),
        ("two", vec![[0.03, 0.85], [0.06, 0.95]]),
        ("three", vec![[0.03, 0.85], [0.06, 0.95], [0.07, 0.8]]),
        ("none", vec![]),
    ]
}

/// Both interpolations in both precisions, at queries between the samples, on them and far away.
pub(super) fn checks() -> Vec<Check> {
    let mut checks = Vec::new();
    for (set, samples) in sets() {
        let mut check = Check::new(&format!("samples: {set}"));
        for query in [[0.05, 0.9], [0.03, 0.85], [0.0512, 0.913], [0.01, 0.8], [0.2, 1.2]] {
            count::<f32>(&mut check, &samples, query);
            count::<f64>(&mut check, &samples, query);
        }
        checks.push(check);
    }
    checks
}

fn count<T: Real>(check: &mut Check, samples: &[[f64; 2]], query: [f64; 2]) {
    let nothing = Matrix::f32(0, 2, &[]);
    let kernel = Kernel {
        neighbours: 24,
        scales: [2.0, 1.0, 1.0, 1.0],
    };
    let coordinates = Coordinates {
        scales: kernel.scales,
        limit: Some(Curve::new(&nothing)),
        jump_curve: Curve::new(&nothing),
    };
    let paper = Paper {
        neighbours: 12,
        scales: [1.9, 1.0, 1.0, 1.0],
        radius: 1.2,
        displacement_rank: 10,
        velocity_rank: 10,
        window: 2.0,
    };
    let samples: Vec<[f32; 2]> = samples.iter().map(|sample| sample.map(|value| value as f32)).collect();
    let placed = PlacedSamples::new(samples.iter().map(|sample| &sample[..]), &coordinates);
    let samples = placed.samples();
    let place = Parameters::from(query.map(T::from_f64));
    let mut scratch = vec![T::ZERO; Weights::<T, NEIGHBOURS>::SCRATCH];
    let (mut direct, mut diffuse) = (Weights::<T, NEIGHBOURS>::EMPTY, Weights::EMPTY);
    let by_kernel = direct.kernel(&kernel, &coordinates, &samples, &place, None, &mut scratch);
    let by_diffuse = diffuse.diffuse(&paper, &coordinates, &samples, &place, None, &mut scratch);
    for (by, outcome, weights) in [("kernel", by_kernel, direct), ("diffuse", by_diffuse, diffuse)] {
        let right = match &outcome {
            Ok(()) => {
                let sum = weights.iter().map(|(_, weight)| weight.to_f64()).sum::<f64>();
                let lebesgue = weights.lebesgue().to_f64();
                (sum - 1.0).abs() < 1e-6 * (1.0 + lebesgue) && lebesgue < USELESS && weights.deviation().is_finite()
            }
            Err(error) => matches!(
                error,
                EvaluateError::Weights { .. } | EvaluateError::BeyondExtrapolation { .. }
            ),
        };
        check.count(outcome.is_ok(), right, || match &outcome {
            Ok(()) => format!("{by}, {query:?}: sum |L| = {}", weights.lebesgue()),
            Err(error) => format!("{by}, {query:?}: {error}"),
        });
    }
}
