//! Cholesky solution of a small positive definite system.

use super::dot;
use crate::Real;

/// Solves the trailing block, from row and column `first` on, of a symmetric row-major `n x n` matrix for `b`, in
/// place. Directions in which the block is not positive beyond rounding get no part in the solution.
pub(crate) fn solve<T: Real>(matrix: &mut [T], n: usize, first: usize, b: &mut [T]) {
    let largest = (first..n).fold(T::ZERO, |largest, i| largest.max(matrix[i * n + i]));
    let floor = largest * T::EPSILON * T::from_index(n);
    for i in first..n {
        let (above, row) = matrix.split_at_mut(i * n);
        for j in first..i {
            let pivot = above[j * n + j];
            let sum = dot(&row[first..j], &above[j * n + first..j * n + j]);
            row[j] = if pivot > T::ZERO {
                (row[j] - sum) / pivot
            } else {
                T::ZERO
            };
        }
        let square = row[i] - dot(&row[first..i], &row[first..i]);
        row[i] = if square > floor { square.sqrt() } else { T::ZERO };
        let sum = dot(&row[first..i], &b[..i - first]);
        b[i - first] = if row[i] > T::ZERO {
            (b[i - first] - sum) / row[i]
        } else {
            T::ZERO
        };
    }
    for i in (first..n).rev() {
        let mut sum = b[i - first];
        for j in i + 1..n {
            sum -= matrix[j * n + i] * b[j - first];
        }
        let pivot = matrix[i * n + i];
        b[i - first] = if pivot > T::ZERO { sum / pivot } else { T::ZERO };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_the_trailing_block() {
        let mut matrix = [9.0, 9.0, 9.0, 9.0, 4.0_f64, 1.0, 9.0, 1.0, 3.0];
        let mut b = [1.0, 2.0];
        solve(&mut matrix, 3, 1, &mut b);
        assert!((b[0] - 1.0 / 11.0).abs() < 1e-15 && (b[1] - 7.0 / 11.0).abs() < 1e-15);
    }

    #[test]
    fn a_singular_direction_gets_no_part() {
        let mut matrix = [1.0_f32, 1.0, 1.0, 1.0];
        let mut b = [2.0, 2.0];
        solve(&mut matrix, 2, 0, &mut b);
        assert_eq!(b, [2.0, 0.0]);
    }
}
