//! From samples to a query in the parameter plane: f(theta) = sum_j L_j(theta) f(theta_j), linear in the data.

mod coordinates;
mod diffuse;
mod kernel;
pub(crate) mod neighbours;
mod plane;

use crate::Real;
use crate::error::EvaluateError;
use crate::linalg::part_mut;
use crate::model::wire::MAX_PARAMETERS;
pub use coordinates::Coordinates;
pub(crate) use diffuse::{ridge_rows, weight};
use neighbours::Neighbour;
pub use plane::Plane;

/// Weights L_j of at most `N` samples, and where these lie relative to the query.
#[derive(Clone, Debug)]
pub struct Weights<T, const N: usize> {
    count: usize,
    samples: [u16; N],
    values: [T; N],
    /// Number of parameters.
    dimensions: usize,
    /// Offsets from the query in the interpolation's coordinates, divided by the radius; zeros beyond the dimensions.
    offsets: [[T; MAX_PARAMETERS]; N],
    radius: T,
    /// Degree of the polynomials that the weights are sure to reproduce.
    degree: usize,
}

impl<T: Real, const N: usize> Weights<T, N> {
    /// No weights.
    pub(crate) const EMPTY: Self = Self {
        count: 0,
        degree: 0,
        dimensions: 1,
        samples: [0; N],
        values: [T::ZERO; N],
        offsets: [[T::ZERO; MAX_PARAMETERS]; N],
        radius: T::ZERO,
    };

    fn new<const P: usize>(neighbours: &[Neighbour<T, P>], radius: T, degree: usize) -> Self {
        let mut weights = Self {
            count: neighbours.len(),
            radius,
            degree,
            dimensions: P,
            ..Self::EMPTY
        };
        let scale = if radius > T::ZERO { T::ONE / radius } else { T::ZERO };
        let places = weights.samples.iter_mut().zip(&mut weights.offsets);
        for ((sample, offset), neighbour) in places.zip(neighbours) {
            // Validation bounds the number of samples.
            *sample = neighbour.sample as u16;
            for (offset, value) in offset.iter_mut().zip(neighbour.offset) {
                *offset = value * scale;
            }
        }
        weights
    }

    /// The offsets in their dimensions.
    fn offsets_in<const P: usize>(&self) -> [[T; P]; N] {
        self.offsets.map(|offset| core::array::from_fn(|d| offset[d]))
    }

    /// The `C` monomials up to degree two in `P` dimensions at the samples, one column each: 1, x, y, x^2, x y, y^2 for
    /// P = 2.
    fn monomials<const P: usize, const C: usize>(&self) -> [[T; N]; C] {
        let mut columns = [[T::ZERO; N]; C];
        for (j, offset) in self.offsets.iter().enumerate().take(self.count) {
            let linear = offset.iter().take(P);
            let products = linear
                .clone()
                .enumerate()
                .flat_map(|(d, x)| offset.iter().take(P).skip(d).map(move |y| *x * *y));
            let row = core::iter::once(T::ONE).chain(linear.copied()).chain(products);
            for (column, value) in columns.iter_mut().zip(row) {
                if let Some(entry) = column.get_mut(j) {
                    *entry = value;
                }
            }
        }
        columns
    }

    /// Checks that the weights sum to 1 but for rounding, and takes the rounding away.
    fn normalised(mut self) -> Result<Self, EvaluateError> {
        let values = part_mut(&mut self.values, 0..self.count);
        let sum = values.iter().copied().sum::<T>();
        if (sum - T::ONE).abs() > T::EPSILON.sqrt() || !sum.is_finite() {
            return Err(EvaluateError::Weights { sum: sum.to_f64() });
        }
        for value in values {
            *value = *value / sum;
        }
        Ok(self)
    }

    /// The samples that take part and their weights.
    pub fn iter(&self) -> impl Iterator<Item = (usize, T)> + '_ {
        self.samples
            .iter()
            .map(|&sample| usize::from(sample))
            .zip(self.values)
            .take(self.count)
    }

    /// sum |L_j|: how much noise in the data may grow.
    pub fn lebesgue(&self) -> T {
        self.iter().map(|(_, value)| value.abs()).sum()
    }

    /// Standard deviation of the interpolation error for data with a generalised covariance: -r^5 for weights that
    /// reproduce quadratics, r^3 for those that are sure to reproduce linear functions only. It is the power function
    /// of that kernel (Wendland, Scattered Data Approximation, 2005, chapter 11): 0 where the query is a sample that
    /// the weights return, and growing with the distance from the samples to the power 5/2 or 3/2.
    pub fn deviation(&self) -> T {
        match self.dimensions {
            1 => self.deviation_in::<1>(),
            2 => self.deviation_in::<2>(),
            3 => self.deviation_in::<3>(),
            _ => self.deviation_in::<MAX_PARAMETERS>(),
        }
    }

    fn deviation_in<const P: usize>(&self) -> T {
        let two = T::from_f32(2.0);
        let offsets: [[T; P]; N] = self.offsets_in();
        let placed = || self.values.iter().zip(&offsets).take(self.count);
        let mut square = T::ZERO;
        for (i, (value, offset)) in placed().enumerate() {
            let mut row = -two * covariance(self.degree, *offset, [T::ZERO; P]);
            for (other, place) in placed().take(i) {
                row += two * *other * covariance(self.degree, *offset, *place);
            }
            square += *value * row;
        }
        let powers = 2 * self.degree + 1;
        (0..powers)
            .fold(square.max(T::ZERO), |square, _| square * self.radius)
            .sqrt()
    }
}

/// Polyharmonic kernel that is positive definite, in any dimension, on weights that annihilate polynomials of a degree:
/// -r, r^3, -r^5 (Wendland 2005, theorem 8.16).
fn covariance<T: Real, const P: usize>(degree: usize, a: [T; P], b: [T; P]) -> T {
    let offset = minus(a, b);
    let square = square(offset);
    (0..degree).fold(-square.sqrt(), |value, _| -(value * square))
}

/// First unit vector: the monomials at the query.
fn at_query<T: Real, const C: usize>() -> [T; C] {
    core::array::from_fn(|k| if k == 0 { T::ONE } else { T::ZERO })
}

/// Square of the length of a vector of parameters, which are too few for lanes.
pub(crate) fn square<T: Real, const P: usize>(vector: [T; P]) -> T {
    vector.iter().fold(T::ZERO, |sum, x| sum + *x * *x)
}

/// a - b.
fn minus<T: Real, const P: usize>(a: [T; P], b: [T; P]) -> [T; P] {
    core::array::from_fn(|d| a[d] - b[d])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Parameters;
    use crate::model::Curve;
    use crate::model::wire::{Kernel, Matrix, Paper};

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

    /// The bytes of rows (a/l, Ca).
    fn points(points: [[f32; 2]; 2]) -> [u8; 16] {
        let mut bytes = [0; 16];
        for (bytes, value) in bytes.chunks_exact_mut(4).zip(points.as_flattened()) {
            bytes.copy_from_slice(&value.to_le_bytes());
        }
        bytes
    }

    /// A grid of samples, 20 x `rows`.
    fn grid<T: Real>(rows: usize) -> impl Iterator<Item = [T; 2]> + Clone {
        (0..20 * rows).map(|i| {
            let [column, row] = [i % 20, i / 20].map(|i| i as f64);
            [0.01 + 0.01 * column, 0.75 + 0.05 * row].map(T::from_f64)
        })
    }

    fn weights<T: Real>(kernel: bool, rows: usize, query: [f64; 2], left_out: Option<usize>) -> Weights<T, N> {
        weights_beside(&Matrix::f32(0, 2, &[]), kernel, rows, query, left_out)
    }

    /// The same in a plane that is cut.
    fn weights_beside<T: Real>(
        border: &Matrix<'_>,
        kernel: bool,
        rows: usize,
        query: [f64; 2],
        left_out: Option<usize>,
    ) -> Weights<T, N> {
        let limit = points([[0.5, 0.2], [1.25, 0.05]]);
        let coordinates = Coordinates::Channel(Plane {
            capillary_scale: KERNEL.scales[0],
            limit: Curve::new(&Matrix::f32(2, 2, &limit)),
            border: Curve::new(border),
        });
        let query = Parameters::from(query.map(T::from_f64));
        let samples = grid(rows).map(Parameters::from);
        let mut scratch = [T::ZERO; N * N];
        let weights = if kernel {
            Weights::kernel(&KERNEL, &coordinates, samples, &query, left_out, &mut scratch)
        } else {
            Weights::diffuse(&PAPER, &coordinates, samples, &query, left_out)
        };
        weights.unwrap()
    }

    /// sum_j L_j f(theta_j).
    fn interpolate<T: Real>(weights: &Weights<T, N>, rows: usize, f: impl Fn([f64; 2]) -> f64) -> f64 {
        let value = |sample| f(grid::<f64>(rows).nth(sample).unwrap());
        weights
            .iter()
            .map(|(sample, weight)| weight.to_f64() * value(sample))
            .sum()
    }

    const QUERIES: [[f64; 2]; 5] = [[0.105, 0.925], [0.012, 0.751], [0.2, 1.2], [0.111, 1.013], [0.03, 0.95]];

    #[test]
    fn both_reproduce_quadratics_in_their_coordinates() {
        for query in QUERIES {
            let root = |[ca, y]: [f64; 2]| {
                let x = (ca / limit(y).sqrt().sqrt()).sqrt();
                1.0 + 3.0 * x - 2.0 * y + 0.5 * x * x - 4.0 * x * y + y * y
            };
            let found = interpolate(&weights::<f64>(true, 10, query, None), 10, root);
            assert!((found - root(query)).abs() < 1e-12, "{query:?}");
            let found = interpolate(&weights::<f32>(true, 10, query, None), 10, root);
            assert!((found - root(query)).abs() < 5e-6, "{query:?} {found}");
            // Five rows of a/l are within reach at the finer spacing of the first query only.
            let plain = |[x, y]: [f64; 2]| 1.0 + 3.0 * x - 2.0 * y + 50.0 * x * x - 4.0 * x * y;
            let found = interpolate(&weights::<f64>(false, 10, query, None), 10, plain);
            assert!((found - plain(query)).abs() < 1e-5, "{query:?} {found}");
            let found = interpolate(&weights::<f32>(false, 10, query, None), 10, plain);
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
        // As beside the steady limit: a grid, and every sample a second and third time a little beside it.
        let limit = points([[0.5, 0.2], [1.25, 0.05]]);
        let nothing = Matrix::f32(0, 2, &[]);
        let plane = Coordinates::Channel(Plane {
            capillary_scale: KERNEL.scales[0],
            limit: Curve::new(&Matrix::f32(2, 2, &limit)),
            border: Curve::new(&nothing),
        });
        fn dense<T: Real>() -> impl Iterator<Item = [T; 2]> {
            let near = |[ca, a]: [f64; 2]| [0.0, 0.00125, 0.0025].map(|step| [ca + step, a].map(T::from_f64));
            grid::<f64>(10).flat_map(near)
        }
        fn weights<T: Real>(plane: &Coordinates<'_>, query: [f64; 2]) -> Weights<T, N> {
            let (samples, query) = (dense().map(Parameters::from), Parameters::from(query.map(T::from_f64)));
            Weights::kernel(&KERNEL, plane, samples, &query, None, &mut [T::ZERO; N * N]).unwrap()
        }
        let f = |[ca, a]: [f64; 2]| (30.0 * ca).sin() * (2.0 * a).exp();
        let sum = |weights: &mut dyn Iterator<Item = (usize, f64)>| -> f64 {
            weights
                .map(|(j, weight)| weight * f(dense::<f64>().nth(j).unwrap()))
                .sum()
        };
        for query in [[0.105, 0.925], [0.1512, 0.81], [0.062, 1.02], [0.0905, 0.88]] {
            let single = weights::<f32>(&plane, query);
            let double = weights::<f64>(&plane, query);
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
    fn a_sample_left_out_takes_no_part() {
        for kernel in [true, false] {
            let weights = weights::<f64>(kernel, 10, [0.03, 0.8], Some(22));
            assert!(weights.iter().all(|(sample, _)| sample != 22));
            assert!(weights.deviation() > 0.0);
        }
    }

    #[test]
    fn weights_do_not_cross_the_border() {
        let bytes = points([[0.7, 0.035], [1.0, 0.035]]);
        let border = Matrix::f32(2, 2, &bytes);
        let place = |sample: usize| grid::<f64>(10).nth(sample).unwrap();
        for kernel in [true, false] {
            for (query, below) in [([0.033, 0.92], true), ([0.037, 0.92], false)] {
                let weights = weights_beside::<f64>(&border, kernel, 10, query, None);
                for (sample, _) in weights.iter() {
                    let [ca, confinement] = place(sample);
                    assert!((ca < 0.035) == below || confinement > 1.0, "{ca} {confinement}");
                }
            }
            // Beyond its ends it parts nothing.
            let beyond = weights_beside::<f64>(&border, kernel, 10, [0.035, 1.03], None);
            let both = [true, false].map(|below| beyond.iter().any(|(j, _)| (place(j)[0] < 0.035) == below));
            assert_eq!(both, [true, true]);
        }
    }

    #[test]
    fn too_few_rows_for_the_tail_still_answer() {
        for kernel in [true, false] {
            for rows in [1, 2] {
                let weights = weights::<f32>(kernel, rows, [0.105, 0.775], None);
                let found = interpolate(&weights, rows, |[ca, _]| ca);
                assert!((found - 0.105).abs() < 1e-3, "{rows} {found}");
            }
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
        let columns = weights.monomials::<2, MONOMIALS>();
        let mut system = [[0.0; SIZE + 1]; SIZE];
        for i in 0..n {
            for j in 0..n {
                let scatter = if i == j { f64::from(3e-5_f32) } else { 0.0 };
                system[i][j] = covariance(2, offsets[i], offsets[j]) + scatter;
            }
            for k in 0..MONOMIALS {
                (system[i][n + k], system[n + k][i]) = (columns[k][i], columns[k][i]);
            }
            system[i][SIZE] = covariance(2, offsets[i], [0.0; 4]);
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
        let columns = weights.monomials::<2, MONOMIALS>();
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
}
