//! Givens rotations: a triangular factor that takes in one row at a time (Golub and Van Loan, Matrix Computations,
//! 2013, sections 5.1.8 and 6.5.3).

use super::slice_or_empty_mut;
use crate::Real;

/// Rotates a row into the upper triangular factor of the rows before it: factor^T factor grows by row^T row. What the
/// rotations leave of the row, in place, belongs to columns beyond those of the factor's rows.
pub(crate) fn givens_update<T: Real, const W: usize>(factor: &mut [[T; W]], row: &mut [T]) {
    let end = row.len();
    for (k, factor) in factor.iter_mut().enumerate() {
        let (factor, row) = (slice_or_empty_mut(factor, k..end), slice_or_empty_mut(row, k..end));
        let (Some(&a), Some(&b)) = (factor.first(), row.first()) else {
            return;
        };
        if b == T::ZERO {
            continue;
        }
        let largest = a.abs().max(b.abs());
        let (p, q) = (a / largest, b / largest);
        let scale = T::ONE / (p * p + q * q).sqrt();
        let (cosine, sine) = (p * scale, q * scale);
        for (r, x) in factor.iter_mut().zip(row) {
            (*r, *x) = (cosine * *r + sine * *x, cosine * *x - sine * *r);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_factor_has_the_gram_matrix_of_the_rows() {
        let rows: [[f64; 4]; 9] = core::array::from_fn(|i| {
            core::array::from_fn(|k| ((i * i + 3 * k * i + 1) % 11) as f64 - 5.0 + 0.1 * k as f64)
        });
        let mut factor = [[0.0; 6]; 4];
        for mut row in rows {
            givens_update(&mut factor, &mut row);
        }
        for i in 0..4 {
            for j in 0..4 {
                let direct: f64 = rows.iter().map(|x| x[i] * x[j]).sum();
                let factored: f64 = factor.iter().map(|row| row[i] * row[j]).sum();
                assert!((direct - factored).abs() < 1e-12 * direct.abs().max(1.0));
                assert!(i <= j || factor[i][j].abs() < 1e-12);
            }
        }
    }
}
