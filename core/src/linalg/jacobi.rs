//! Singular values and vectors by one-sided Jacobi rotations (Hestenes 1958; de Rijk 1989).

use super::{dot, part};
use crate::Real;

/// Graded matrices in single precision needed at most 12.
const MOST_SWEEPS: usize = 20;

/// Rotates the rows (their first `columns` entries) until they are orthogonal: row i becomes sigma_i v_i^T with the
/// right singular vectors v_i, unordered. What still couples after the last sweep stays below what was there before.
pub(crate) fn orthogonalise<T: Real, const K: usize>(rows: &mut [[T; K]], columns: usize) {
    let square = |row: &[T; K]| dot(part(row, 0..columns), part(row, 0..columns));
    let largest = rows.iter().map(square).fold(T::ZERO, T::max);
    // Rows below this are rounding of the largest.
    let floor = largest * T::EPSILON * T::EPSILON * T::from_index(columns);
    for _ in 0..MOST_SWEEPS {
        let mut rotated = false;
        for second in 1..rows.len() {
            let Some((above, [y, ..])) = rows.split_at_mut_checked(second) else {
                return;
            };
            for x in above {
                let (a, b) = (square(x), square(y));
                if a.min(b) <= floor {
                    continue;
                }
                let product = dot(part(x, 0..columns), part(y, 0..columns));
                // Two roots: the product of the squares could underflow.
                if product.abs() <= T::EPSILON * T::from_f32(4.0) * a.sqrt() * b.sqrt() {
                    continue;
                }
                rotated = true;
                let zeta = (b - a) / (product + product);
                let tangent = T::ONE / (zeta.abs() + (T::ONE + zeta * zeta).sqrt());
                let tangent = if zeta < T::ZERO { -tangent } else { tangent };
                let cosine = T::ONE / (T::ONE + tangent * tangent).sqrt();
                let sine = cosine * tangent;
                for (x, y) in x.iter_mut().zip(&mut *y).take(columns) {
                    (*x, *y) = (cosine * *x - sine * *y, sine * *x + cosine * *y);
                }
            }
        }
        if !rotated {
            break;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eigenvalues of a symmetric matrix as roots of Sturm counts of its LDL^T: an independent way to the squares of
    /// the singular values.
    fn count_below(gram: &[[f64; 6]; 6], shift: f64) -> usize {
        let mut m = *gram;
        (0..6).for_each(|i| m[i][i] -= shift);
        let mut negative = 0;
        for k in 0..6 {
            negative += usize::from(m[k][k] < 0.0);
            for i in k + 1..6 {
                let factor = m[i][k] / m[k][k];
                for j in k..6 {
                    m[i][j] -= factor * m[k][j];
                }
            }
        }
        negative
    }

    #[test]
    fn singular_values_agree_with_eigenvalues_of_the_gram_matrix() {
        let matrix: [[f64; 6]; 6] = core::array::from_fn(|i| {
            core::array::from_fn(|j| ((3 * i + 5 * j * j) % 7) as f64 * 10_f64.powi(-(i as i32)))
        });
        let gram =
            core::array::from_fn(|i| core::array::from_fn(|j| (0..6).map(|k| matrix[k][i] * matrix[k][j]).sum()));
        let mut rows = matrix;
        orthogonalise(&mut rows, 6);
        for i in 0..6 {
            for j in 0..i {
                let [a, b] = [rows[i], rows[j]].map(|row| dot(&row, &row).sqrt());
                assert!(dot(&rows[i], &rows[j]).abs() <= 1e-14 * a * b + 1e-13);
            }
            let square = dot(&rows[i], &rows[i]);
            if square > 1e-6 {
                let below = |share: f64| count_below(&gram, square * share);
                assert_eq!(below(1.0 + 1e-6), below(1.0 - 1e-6) + 1, "{square}");
            }
        }
    }

    #[test]
    fn graded_single_precision_rows_become_orthogonal() {
        let mut rows: [[f32; 40]; 40] = core::array::from_fn(|i| {
            core::array::from_fn(|j| {
                let noise = ((i * 7919 + j * 104_729 + i * j * 31) % 1009) as f32 / 1009.0 - 0.5;
                noise * 10_f32.powf(-(i as f32) / 5.0)
            })
        });
        orthogonalise(&mut rows, 40);
        for i in 0..40 {
            for j in 0..i {
                let [a, b] = [rows[i], rows[j]].map(|row| dot(&row, &row).sqrt());
                let floor = 3e-6; // 2 eps sqrt(40), of rows of length up to 2.
                if a > floor && b > floor {
                    assert!(dot(&rows[i], &rows[j]).abs() < 2e-6 * a * b, "{i} {j}");
                }
            }
        }
    }
}
