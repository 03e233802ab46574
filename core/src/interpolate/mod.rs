//! From samples to a query in the parameter plane: f(theta) = sum_j L_j(theta) f(theta_j), linear in the data.

mod diffuse;
mod kernel;
mod neighbours;

use crate::Real;
use crate::error::EvaluateError;
use crate::linalg::dot;
use crate::model::MatrixView;
pub(crate) use diffuse::{RIDGE_ROWS, weight};
use neighbours::Neighbour;

/// Monomials of the quadratic tail: 1, x, y, x^2, x y, y^2.
const MONOMIALS: usize = 6;

/// Weights L_j of at most `N` samples, and where these lie relative to the query.
#[derive(Clone, Debug)]
pub struct Weights<T, const N: usize> {
    count: usize,
    samples: [u16; N],
    values: [T; N],
    /// Offsets from the query in the interpolation's coordinates, divided by the radius.
    offsets: [[T; 2]; N],
    radius: T,
    /// Degree of the polynomials that the weights are sure to reproduce.
    degree: usize,
}

impl<T: Real, const N: usize> Weights<T, N> {
    /// No weights.
    pub(crate) const EMPTY: Self = Self {
        count: 0,
        degree: 0,
        samples: [0; N],
        values: [T::ZERO; N],
        offsets: [[T::ZERO; 2]; N],
        radius: T::ZERO,
    };

    fn new(neighbours: &[Neighbour<T>], radius: T, degree: usize) -> Self {
        let mut weights = Self {
            count: neighbours.len(),
            radius,
            ..Self::EMPTY
        };
        let scale = if radius > T::ZERO { T::ONE / radius } else { T::ZERO };
        for (j, neighbour) in neighbours.iter().enumerate() {
            // Validation bounds the number of samples.
            weights.samples[j] = neighbour.sample as u16;
            weights.offsets[j] = neighbour.offset.map(|offset| offset * scale);
        }
        weights
    }

    /// The monomials at the samples, one column each.
    fn monomials(&self) -> [[T; N]; MONOMIALS] {
        let mut columns = [[T::ZERO; N]; MONOMIALS];
        for (j, [x, y]) in self.offsets[..self.count].iter().copied().enumerate() {
            for (column, value) in columns.iter_mut().zip([T::ONE, x, y, x * x, x * y, y * y]) {
                column[j] = value;
            }
        }
        columns
    }

    /// Checks that the weights sum to 1 but for rounding, and takes the rounding away.
    fn normalised(mut self) -> Result<Self, EvaluateError> {
        let values = &mut self.values[..self.count];
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

    /// out <- sum_j L_j row j.
    pub(crate) fn combine(&self, rows: &MatrixView<'_>, out: &mut [T]) {
        out.fill(T::ZERO);
        for (sample, value) in self.iter() {
            rows.add_row(sample, value, out);
        }
    }

    /// Standard deviation of the interpolation error for data with a generalised covariance: -r^5 for weights that
    /// reproduce quadratics, r^3 for those that are sure to reproduce linear functions only. It is the power function
    /// of that kernel (Wendland, Scattered Data Approximation, 2005, chapter 11): 0 where the query is a sample that
    /// the weights return, and growing with the distance from the samples to the power 5/2 or 3/2.
    pub fn deviation(&self) -> T {
        let (values, offsets) = (&self.values[..self.count], &self.offsets[..self.count]);
        let two = T::from_f32(2.0);
        let mut square = T::ZERO;
        for i in 0..self.count {
            let mut row = -two * covariance(self.degree, offsets[i], [T::ZERO; 2]);
            for j in 0..i {
                row += two * values[j] * covariance(self.degree, offsets[i], offsets[j]);
            }
            square += values[i] * row;
        }
        let powers = 2 * self.degree + 1;
        (0..powers)
            .fold(square.max(T::ZERO), |square, _| square * self.radius)
            .sqrt()
    }
}

/// Polyharmonic kernel of the plane that is positive definite on weights that annihilate polynomials of a degree:
/// -r, r^3, -r^5.
fn covariance<T: Real>(degree: usize, a: [T; 2], b: [T; 2]) -> T {
    let r = norm([a[0] - b[0], a[1] - b[1]]);
    (0..degree).fold(-r, |value, _| -(value * r * r))
}

/// First unit vector: the monomials at the query.
fn at_query<T: Real>() -> [T; MONOMIALS] {
    core::array::from_fn(|k| if k == 0 { T::ONE } else { T::ZERO })
}

/// Length of a vector of the parameter plane.
fn norm<T: Real>(vector: [T; 2]) -> T {
    dot(&vector, &vector).sqrt()
}
