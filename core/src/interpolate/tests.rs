//! Weights of a grid of samples, against polynomials and the systems solved directly.

use super::weights::covariance;
use super::*;
use crate::Parameters;
use crate::error::EvaluateError;
use crate::model::Curve;
use crate::model::wire::{Blob, Kernel, Matrix, Paper, Samples};

const N: usize = 32;
const KERNEL: Kernel = Kernel {
    neighbours: 24,
    scales: [2.25, 1.0, 1.0, 1.0],
};
const PAPER: Paper = Paper {
    neighbours: 12,
    scales: [1.9, 1.0, 1.0, 1.0],
    radius: 1.2,
    displacement_rank: 10,
    velocity_rank: 10,
    window: 2.0,
};

/// A steady limit, linear in a/l.
fn limit(confinement: f64) -> f64 {
    0.3 - 0.2 * confinement
}

/// The bytes of rows of two numbers: points (a/l, Ca) of a curve or samples (Ca, a/l).
fn bytes<const R: usize>(rows: [[f32; 2]; R]) -> [[[u8; 4]; 2]; R] {
    rows.map(|row| row.map(f32::to_le_bytes))
}

fn matrix<const R: usize>(bytes: &[[[u8; 4]; 2]; R]) -> Matrix<'_> {
    Matrix::f32(R as u32, 2, bytes.as_flattened().as_flattened())
}

/// Sample of a grid of 20 columns.
fn grid(sample: usize) -> [f32; 2] {
    let [column, row] = [sample % 20, sample / 20].map(|i| i as f64);
    [(0.01 + 0.01 * column) as f32, (0.75 + 0.05 * row) as f32]
}

/// The coordinates of the channel, with the limit.
fn channel<'a>(limit: &Matrix<'a>, jump_curve: &Matrix<'a>) -> Coordinates<'a> {
    Coordinates {
        scales: KERNEL.scales,
        limit: Some(Curve::new(limit)),
        jump_curve: Curve::new(jump_curve),
    }
}

/// The transformed samples.
fn transformed_samples<const R: usize>(coordinates: &Coordinates<'_>, samples: [[f32; 2]; R]) -> [[[u8; 4]; 2]; R] {
    bytes(samples.map(|sample| {
        let [x, y, ..] = coordinates.transform(&Parameters::from(sample));
        [x, y]
    }))
}

fn weights<T: Real>(kernel: bool, rows: usize, query: [f64; 2], left_out: Option<usize>) -> Weights<T, N> {
    weights_with_jump(&Matrix::f32(0, 2, &[]), kernel, rows, query, left_out)
}

/// Does something with the samples of the first rows of the grid and their coordinates.
fn with_grid<R>(jump_curve: &Matrix<'_>, rows: usize, work: impl FnOnce(&Coordinates<'_>, &Samples<'_>) -> R) -> R {
    let limit = bytes([[0.5, 0.2], [1.25, 0.05]]);
    let coordinates = channel(&matrix(&limit), jump_curve);
    let grid: [_; 200] = core::array::from_fn(grid);
    let (points, grid) = (transformed_samples(&coordinates, grid), bytes(grid));
    let part = |bytes| Matrix {
        rows: 20 * rows as u32,
        blob: Blob::new(&matrix(bytes).blob.data[..8 * 20 * rows]),
        ..matrix(bytes)
    };
    let samples = Samples {
        parameters: part(&grid),
        places: part(&points),
    };
    work(&coordinates, &samples)
}

/// The same with a jump curve.
fn weights_with_jump<T: Real>(
    jump_curve: &Matrix<'_>,
    kernel: bool,
    rows: usize,
    query: [f64; 2],
    left_out: Option<usize>,
) -> Weights<T, N> {
    let query = Parameters::from(query.map(T::from_f64));
    let (mut weights, mut scratch) = (Weights::EMPTY, [T::ZERO; 64 * 64]);
    let done = with_grid(jump_curve, rows, |coordinates, samples| {
        if kernel {
            weights.kernel(&KERNEL, coordinates, samples, &query, left_out, &mut scratch)
        } else {
            weights.diffuse(&PAPER, coordinates, samples, &query, left_out, &mut scratch)
        }
    });
    done.unwrap();
    weights
}

/// The derivatives of the kernel's weights at a query, those of all samples.
fn derivatives<T: Real>(jump_curve: &Matrix<'_>, rows: usize, query: [f64; 2]) -> [[f64; 200]; 2] {
    let (mut weights, mut scratch) = (Weights::<T, N>::EMPTY, [T::ZERO; 64 * 64]);
    let query = Parameters::from(query.map(T::from_f64));
    let found = with_grid(jump_curve, rows, |coordinates, samples| {
        weights.kernel_derivatives(&KERNEL, coordinates, samples, &query, &mut scratch)
    });
    let [first, second, ..] = found.unwrap();
    [first, second].map(|values| {
        let mut all = [0.0; 200];
        for ((sample, _), value) in weights.iter().zip(values) {
            all[sample] = value.to_f64();
        }
        all
    })
}

#[test]
fn derivatives_of_the_weights_are_limits_of_differences() {
    let bytes = bytes([[0.7, 0.045], [0.93, 0.045]]);
    let (none, jump) = (Matrix::f32(0, 2, &[]), matrix(&bytes));
    // The last one takes samples from beyond the jump curve.
    for (jump, rows, query) in [
        (&none, 10, [0.105, 0.925]),
        (&none, 10, [0.013, 0.762]),
        (&none, 10, [0.111, 1.013]),
        (&jump, 4, [0.04, 0.83]),
    ] {
        let exact = derivatives::<f64>(jump, rows, query);
        let single = derivatives::<f32>(jump, rows, query);
        for d in 0..2 {
            let greatest = exact[d].iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            assert!(exact[d].iter().sum::<f64>().abs() < 1e-11 * greatest);
            // Steps of a share of a spacing, so short that the stencil stays.
            let errors = [4e-3, 2e-3, 1e-3].map(|share: f64| {
                let step = share * [0.01, 0.05][d];
                let all = [-1.0, 1.0].map(|sign| {
                    let mut place = query;
                    place[d] += sign * step;
                    let mut all = [0.0; 200];
                    for (sample, weight) in weights_with_jump::<f64>(jump, true, rows, place, None).iter() {
                        all[sample] = weight;
                    }
                    all
                });
                let [before, after] = all;
                (0..200).fold(0.0_f64, |most, j| {
                    most.max(((after[j] - before[j]) / (2.0 * step) - exact[d][j]).abs())
                }) / greatest
            });
            // Second order: a quarter of the error for half the step.
            for pair in errors.windows(2) {
                let ratio = pair[0] / pair[1];
                assert!((3.9..4.15).contains(&ratio), "{query:?} {d}: {errors:?}");
            }
            assert!(errors[2] < 1e-4, "{query:?} {d}: {errors:?}");
            // Rounding moves single weights, but not what is interpolated with them.
            let of = |weights: &[f64; 200]| -> f64 {
                let value = |j: usize| {
                    let [ca, confinement] = grid(j).map(f64::from);
                    (20.0 * ca).sin() * confinement.exp()
                };
                weights.iter().enumerate().map(|(j, weight)| weight * value(j)).sum()
            };
            let (single, exact) = (of(&single[d]), of(&exact[d]));
            assert!(
                (single - exact).abs() < 1e-3 * exact.abs(),
                "{query:?} {d}: {single} {exact}"
            );
        }
    }
}

/// sum_j L_j f(theta_j).
fn interpolate<T: Real>(weights: &Weights<T, N>, f: impl Fn([f64; 2]) -> f64) -> f64 {
    let value = |sample| f(grid(sample).map(f64::from));
    weights
        .iter()
        .map(|(sample, weight)| weight.to_f64() * value(sample))
        .sum()
}

/// sum_j L_j f(x_j) with the coordinates x_j as they are stored, in singles.
fn interpolate_transformed<T: Real>(weights: &Weights<T, N>, f: impl Fn([f64; 2]) -> f64) -> f64 {
    let limit = bytes([[0.5, 0.2], [1.25, 0.05]]);
    let none = Matrix::f32(0, 2, &[]);
    let points = transformed_samples(
        &channel(&matrix(&limit), &none),
        core::array::from_fn::<_, 200, _>(grid),
    );
    let value = |sample: usize| f(points[sample].map(|bytes| f32::from_le_bytes(bytes).into()));
    weights
        .iter()
        .map(|(sample, weight)| weight.to_f64() * value(sample))
        .sum()
}

/// The coordinates of the channel, with the steady limit as it is stored.
fn transformed([ca, confinement]: [f64; 2]) -> [f64; 2] {
    let stored = bytes([[0.5, 0.2], [1.25, 0.05]]);
    let none = Matrix::f32(0, 2, &[]);
    let [x, y, ..] = channel(&matrix(&stored), &none).transform(&Parameters::from([ca, confinement]));
    let stretched = ca / limit(confinement).sqrt().sqrt();
    assert!((x - KERNEL.scales[0] * stretched.sqrt()).abs() < 1e-7 && y == KERNEL.scales[1] * confinement);
    [x, y]
}

const QUERIES: [[f64; 2]; 5] = [[0.105, 0.925], [0.012, 0.751], [0.2, 1.2], [0.111, 1.013], [0.03, 0.95]];

#[test]
fn both_reproduce_quadratics_in_their_coordinates() {
    for query in QUERIES {
        let root = |[x, y]: [f64; 2]| 1.0 + 3.0 * x - 2.0 * y + 0.5 * x * x - 4.0 * x * y + y * y;
        let found = interpolate_transformed(&weights::<f64>(true, 10, query, None), root);
        assert!((found - root(transformed(query))).abs() < 1e-12, "{query:?}");
        let found = interpolate_transformed(&weights::<f32>(true, 10, query, None), root);
        assert!((found - root(transformed(query))).abs() < 5e-6, "{query:?} {found}");
        // Five rows of a/l are within reach at the finer spacing of the first query only.
        let plain = |[x, y]: [f64; 2]| 1.0 + 3.0 * x - 2.0 * y + 50.0 * x * x - 4.0 * x * y;
        let found = interpolate(&weights::<f64>(false, 10, query, None), plain);
        assert!((found - plain(query)).abs() < 1e-5, "{query:?} {found}");
        let found = interpolate(&weights::<f32>(false, 10, query, None), plain);
        assert!((found - plain(query)).abs() < 2e-5, "{query:?} {found}");
    }
}

#[test]
fn weights_sum_to_one_and_stay_moderate() {
    for query in QUERIES {
        for kernel in [true, false] {
            let weights = weights::<f32>(kernel, 10, query, None);
            let sum: f32 = weights.iter().map(|(_, weight)| weight).sum();
            assert!(
                (sum - 1.0).abs() < 1e-6 && weights.lebesgue() < 4.0,
                "{query:?} {}",
                weights.lebesgue()
            );
        }
    }
}

#[test]
fn a_sum_of_weights_off_by_rounding_is_normalised_and_by_more_refused() {
    fn normalised<T: Real>(values: [f64; 3]) -> Result<f64, EvaluateError> {
        let mut weights = Weights::<T, N>::EMPTY;
        weights.count = 3;
        // Entries beyond the count belong to another query.
        weights.values = [T::ONE; N];
        weights.values[..3].copy_from_slice(&values.map(T::from_f64));
        weights.normalise()?;
        // The ratios stay.
        assert!((weights.values[1].to_f64() / weights.values[0].to_f64() - values[1] / values[0]).abs() < 1e-6);
        Ok(weights.iter().map(|(_, weight)| weight.to_f64()).sum())
    }
    for scale in [1.0 - 2e-4, 1.0 - 1e-6, 1.0, 1.0 + 1e-6, 1.0 + 2e-4] {
        let sum = normalised::<f32>([0.6 * scale, -0.3 * scale, 0.7 * scale]).unwrap();
        assert!((sum - 1.0).abs() < 2e-7, "{scale}: {sum}");
    }
    let sum = normalised::<f64>([0.6 + 1e-9, -0.3, 0.7]).unwrap();
    assert!((sum - 1.0).abs() < 4e-16, "{sum}");
    for far in [0.999, 1.001, -1.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
        let refused = normalised::<f32>([0.6 * far, -0.3, 0.7]);
        assert!(
            matches!(refused, Err(EvaluateError::Weights { .. })),
            "{far}: {refused:?}"
        );
    }
    let Err(EvaluateError::Weights { sum }) = normalised::<f64>([0.6, 0.3, 0.7]) else {
        panic!("weights that sum to 1.6 were taken");
    };
    assert!((sum - 1.6).abs() < 1e-6, "{sum}");
}

#[test]
fn the_kernel_returns_the_sample_itself_but_for_the_scatter() {
    let weights = weights::<f64>(true, 10, [0.03, 0.8], None);
    for (sample, weight) in weights.iter() {
        assert!(
            (weight - if sample == 22 { 1.0 } else { 0.0 }).abs() < 0.05,
            "{sample} {weight}"
        );
    }
    let without = self::weights::<f64>(true, 10, [0.03, 0.8], Some(22));
    assert!(
        weights.deviation() < 0.1 * without.deviation(),
        "{} {}",
        weights.deviation(),
        without.deviation()
    );
}

#[test]
fn samples_close_to_each_other_do_no_harm_in_single_precision() {
    // As near the steady limit: a grid, with two more samples close to each.
    fn dense(sample: usize) -> [f32; 2] {
        let [ca, confinement] = grid(sample / 3);
        [ca + [0.0, 0.00125, 0.0025][sample % 3], confinement]
    }
    fn weights<T: Real>(query: [f64; 2]) -> Weights<T, N> {
        let limit = bytes([[0.5, 0.2], [1.25, 0.05]]);
        let coordinates = channel(&matrix(&limit), &Matrix::f32(0, 2, &[]));
        let samples: [_; 600] = core::array::from_fn(dense);
        let (points, samples) = (transformed_samples(&coordinates, samples), bytes(samples));
        let samples = Samples {
            parameters: matrix(&samples),
            places: matrix(&points),
        };
        let query = Parameters::from(query.map(T::from_f64));
        let (mut weights, mut scratch) = (Weights::EMPTY, [T::ZERO; 64 * 64]);
        let done = weights.kernel(&KERNEL, &coordinates, &samples, &query, None, &mut scratch);
        done.unwrap();
        weights
    }
    let f = |[ca, a]: [f64; 2]| (30.0 * ca).sin() * (2.0 * a).exp();
    let sum = |weights: &mut dyn Iterator<Item = (usize, f64)>| -> f64 {
        weights.map(|(j, weight)| weight * f(dense(j).map(f64::from))).sum()
    };
    for query in [[0.105, 0.925], [0.1512, 0.81], [0.062, 1.02], [0.0905, 0.88]] {
        let single = weights::<f32>(query);
        let double = weights::<f64>(query);
        let found = [
            sum(&mut single.iter().map(|(j, weight)| (j, f64::from(weight)))),
            sum(&mut double.iter()),
        ];
        assert!(
            (found[0] - found[1]).abs() < 1e-3 && (found[1] - f(query)).abs() < 0.02,
            "{query:?} {found:?} {}",
            f(query)
        );
    }
}

#[test]
fn the_covariance_has_the_sign_that_makes_variances_positive() {
    // -r, r^3, -r^5 at r = 2.
    assert_eq!([0, 1, 2].map(|degree| covariance(degree, 4.0_f64)), [-2.0, 8.0, -32.0]);
}

#[test]
fn the_deviation_from_the_solution_is_the_quadratic_form() {
    for query in QUERIES {
        let weights = weights::<f64>(true, 10, query, None);
        assert!(weights.variance > 0.0, "{query:?}: {}", weights.variance);
        let form = weights.quadratic_form();
        assert!((weights.variance - form).abs() < 1e-9, "{} {form}", weights.variance);
        let single = self::weights::<f32>(true, 10, query, None);
        assert!(
            (f64::from(single.variance) - form).abs() < 1e-5,
            "{} {form}",
            single.variance
        );
    }
}

#[test]
fn a_sample_left_out_has_no_weight() {
    for kernel in [true, false] {
        let weights = weights::<f64>(kernel, 10, [0.03, 0.8], Some(22));
        assert!(weights.iter().all(|(sample, _)| sample != 22));
        assert!(weights.deviation() > 0.0);
    }
}

#[test]
fn samples_beyond_the_jump_curve_have_no_weight() {
    let bytes = bytes([[0.7, 0.035], [1.0, 0.035]]);
    let jump_curve = matrix(&bytes);
    for kernel in [true, false] {
        for (query, below) in [([0.033, 0.92], true), ([0.037, 0.92], false)] {
            let weights = weights_with_jump::<f64>(&jump_curve, kernel, 10, query, None);
            for (sample, _) in weights.iter() {
                let [ca, confinement] = grid(sample);
                assert!((ca < 0.035) == below || confinement > 1.0, "{ca} {confinement}");
            }
        }
        // Beyond its ends the curve separates nothing.
        let beyond = weights_with_jump::<f64>(&jump_curve, kernel, 10, [0.035, 1.03], None);
        let both = [true, false].map(|below| beyond.iter().any(|(j, _)| (grid(j)[0] < 0.035) == below));
        assert_eq!(both, [true, true]);
    }
}

#[test]
fn with_few_samples_on_its_side_of_the_jump_curve_the_kernel_reproduces_a_jump() {
    // Four columns of four rows lie below the curve: fewer than the 24 that are wanted.
    let bytes = bytes([[0.7, 0.045], [0.93, 0.045]]);
    let jump_curve = matrix(&bytes);
    for query in [[0.013, 0.76], [0.04, 0.83], [0.043, 0.9]] {
        let value = |[x, y]: [f64; 2]| {
            let [curve, _] = transformed([0.045, y]);
            let jump = if x < curve { 3.0 } else { 0.0 };
            jump + 3.0 * x - 2.0 * y + 0.5 * x * x - 4.0 * x * y + y * y
        };
        let weights = weights_with_jump::<f64>(&jump_curve, true, 4, query, None);
        assert!(
            weights
                .iter()
                .any(|(sample, weight)| grid(sample)[0] > 0.045 && weight.abs() > 1e-3)
        );
        let expected = value(transformed(query));
        assert!(
            (interpolate_transformed(&weights, value) - expected).abs() < 1e-12,
            "{query:?}"
        );
        let single = weights_with_jump::<f32>(&jump_curve, true, 4, query, None);
        assert!(
            (interpolate_transformed(&single, value) - expected).abs() < 1e-5,
            "{query:?}"
        );
        assert!((weights.variance - weights.quadratic_form()).abs() < 1e-9);
    }
}

#[test]
fn too_few_rows_for_the_tail_still_answer() {
    for kernel in [true, false] {
        for rows in [1, 2] {
            let weights = weights::<f32>(kernel, rows, [0.105, 0.775], None);
            let found = interpolate(&weights, |[ca, _]| ca);
            assert!((found - 0.105).abs() < 1e-3, "{rows} {found}");
        }
    }
}

#[test]
#[cfg_attr(miri, ignore = "eight thousand queries")]
fn the_weights_follow_the_query_without_a_jump() {
    // Along lines through the plane, on which samples enter and leave.
    for [from, to] in [[[0.012, 0.76], [0.17, 1.17]], [[0.19, 0.78], [0.02, 1.19]]] {
        const STEPS: usize = 4000;
        let mut before: Option<[f64; 200]> = None;
        let mut greatest = 0.0_f64;
        for step in 0..=STEPS {
            let share = step as f64 / STEPS as f64;
            let query = [0, 1].map(|d| from[d] + share * (to[d] - from[d]));
            let mut all = [0.0; 200];
            for (sample, weight) in weights::<f64>(true, 10, query, None).iter() {
                all[sample] = weight;
            }
            if let Some(before) = before.replace(all) {
                let change: f64 = before.iter().zip(&all).map(|(a, b)| (a - b).abs()).sum();
                greatest = greatest.max(change);
            }
        }
        // Without the scatter of far samples 1.1.
        assert!(greatest < 0.15, "{greatest}");
    }
}

#[test]
fn the_kernel_agrees_with_the_full_saddle_system() {
    // The same weights from [Phi P; P^T 0] [L; mu] = [phi; p] by Gaussian elimination with pivoting.
    let query = [0.105, 0.925];
    let weights = weights::<f64>(true, 10, query, None);
    let (n, offsets) = (weights.count, weights.offsets);
    const MONOMIALS: usize = 6;
    const SIZE: usize = 30;
    assert_eq!(n + MONOMIALS, SIZE);
    let mut columns = [[0.0; N]; MONOMIALS];
    weights.monomials(&mut columns);
    let mut system = [[0.0; SIZE + 1]; SIZE];
    for i in 0..n {
        for j in 0..n {
            system[i][j] = covariance(2, square(minus(offsets[i], offsets[j])));
        }
        // The scatter, which grows from 0.6 to 1 of the greatest squared distance.
        let far = (square(offsets[i]) - f64::from(0.6_f32)).max(0.0) / f64::from(1.0 - 0.6_f32);
        system[i][i] += f64::from(3e-5_f32) + 3.0 * far.powi(3);
        for k in 0..MONOMIALS {
            (system[i][n + k], system[n + k][i]) = (columns[k][i], columns[k][i]);
        }
        system[i][SIZE] = covariance(2, square(offsets[i]));
    }
    system[n][SIZE] = 1.0;
    for k in 0..SIZE {
        let pivot = (k..SIZE)
            .max_by(|&a, &b| system[a][k].abs().total_cmp(&system[b][k].abs()))
            .unwrap();
        system.swap(k, pivot);
        for i in (0..SIZE).filter(|&i| i != k) {
            let factor = system[i][k] / system[k][k];
            for j in k..=SIZE {
                system[i][j] -= factor * system[k][j];
            }
        }
    }
    for (j, (_, weight)) in weights.iter().enumerate() {
        assert!((weight - system[j][SIZE] / system[j][j]).abs() < 1e-9);
    }
}

#[test]
fn diffuse_weights_agree_with_the_normal_equations() {
    // L = W P (P^T W P)^-1 p of eq. (30), where the samples determine all monomials.
    let query = [0.1075, 0.95];
    let weights = weights::<f64>(false, 10, query, None);
    const MONOMIALS: usize = 6;
    let mut columns = [[0.0; N]; MONOMIALS];
    weights.monomials(&mut columns);
    let w: [f64; N] = core::array::from_fn(|j| weight(square(weights.offsets[j]).sqrt()));
    let mut system = [[0.0; MONOMIALS + 1]; MONOMIALS];
    for a in 0..MONOMIALS {
        for b in 0..MONOMIALS {
            system[a][b] = (0..weights.count).map(|j| w[j] * columns[a][j] * columns[b][j]).sum();
        }
    }
    system[0][MONOMIALS] = 1.0;
    for k in 0..MONOMIALS {
        for i in (0..MONOMIALS).filter(|&i| i != k) {
            let factor = system[i][k] / system[k][k];
            for j in k..=MONOMIALS {
                system[i][j] -= factor * system[k][j];
            }
        }
    }
    for (j, (_, found)) in weights.iter().enumerate() {
        let exact: f64 = (0..MONOMIALS)
            .map(|k| w[j] * columns[k][j] * system[k][MONOMIALS] / system[k][k])
            .sum();
        assert!((found - exact).abs() < 1e-4, "{found} {exact}");
    }
}
