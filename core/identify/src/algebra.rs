//! Small symmetric systems.

/// Cholesky factor of a positive definite matrix; none if it is not.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Factor<const N: usize>([[f64; N]; N]);

impl<const N: usize> Factor<N> {
    pub(crate) fn new(matrix: &[[f64; N]; N]) -> Option<Self> {
        Self::leading(matrix, N)
    }

    /// As [`new`](Self::new), of a matrix that is diagonal beyond some leading rows and columns.
    pub(crate) fn leading(matrix: &[[f64; N]; N], count: usize) -> Option<Self> {
        let mut lower = [[0.0; N]; N];
        for i in count..N {
            lower[i][i] = libm::sqrt(matrix[i][i]);
        }
        for i in 0..count {
            for j in 0..=i {
                let sum = (0..j).fold(matrix[i][j], |sum, k| sum - lower[i][k] * lower[j][k]);
                if i == j {
                    if sum <= 0.0 || !sum.is_finite() {
                        return None;
                    }
                    lower[i][i] = libm::sqrt(sum);
                } else {
                    lower[i][j] = sum / lower[j][j];
                }
            }
        }
        Some(Self(lower))
    }

    pub(crate) fn solve(&self, right: &[f64; N]) -> [f64; N] {
        let lower = &self.0;
        let mut x = *right;
        for i in 0..N {
            x[i] = (0..i).fold(x[i], |sum, k| sum - lower[i][k] * x[k]) / lower[i][i];
        }
        for i in (0..N).rev() {
            x[i] = (i + 1..N).fold(x[i], |sum, k| sum - lower[k][i] * x[k]) / lower[i][i];
        }
        x
    }

    /// The logarithm of the matrix's determinant.
    pub(crate) fn log_determinant(&self) -> f64 {
        (0..N).map(|i| 2.0 * libm::log(self.0[i][i])).sum()
    }

    /// Column `i` of the inverse.
    pub(crate) fn inverse_column(&self, i: usize) -> [f64; N] {
        let mut unit = [0.0; N];
        unit[i] = 1.0;
        self.solve(&unit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_and_inverts() {
        let matrix = [[4.0, 1.0, 0.5], [1.0, 3.0, -0.2], [0.5, -0.2, 2.0]];
        let factor = Factor::new(&matrix).unwrap();
        let x = factor.solve(&[1.0, 2.0, 3.0]);
        for (row, right) in matrix.iter().zip([1.0, 2.0, 3.0]) {
            let product: f64 = row.iter().zip(x).map(|(a, x)| a * x).sum();
            assert!((product - right).abs() < 1e-14);
        }
        assert!(
            (factor.log_determinant() - libm::log(4.0 * (6.0 - 0.04) - (2.0 + 0.1) + 0.5 * (-0.2 - 1.5))).abs() < 1e-14
        );
        let column = factor.inverse_column(1);
        let product: f64 = matrix[1].iter().zip(column).map(|(a, x)| a * x).sum();
        assert!((product - 1.0).abs() < 1e-14);
        assert!(Factor::new(&[[1.0, 2.0], [2.0, 1.0]]).is_none());
    }
}
