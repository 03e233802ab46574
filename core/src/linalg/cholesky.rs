//! Cholesky solution of a small positive definite system.

use super::{add_scaled, dot_in_order, slice_or_empty, slice_or_empty_mut};
use crate::Real;

/// Solves the system of the trailing block (rows and columns from `first` on) of a symmetric matrix for the same
/// entries of `b`, in place. A pivot that is not positive beyond rounding sets its component of the solution to 0.
pub(crate) fn solve<T: Real, const N: usize>(matrix: &mut [[T; N]], first: usize, b: &mut [T; N]) {
    let n = matrix.len().min(N);
    let mut largest = T::ZERO;
    for (i, row) in matrix.iter().enumerate().skip(first) {
        largest = largest.max(entry(row, i));
    }
    let floor = largest * T::EPSILON * T::from_index(n);
    for i in first..n {
        let Some((above, [row, ..])) = matrix.split_at_mut_checked(i) else {
            return;
        };
        for (j, earlier) in above.iter().enumerate().skip(first) {
            let Some((done, [value, ..])) = row.split_at_mut_checked(j) else {
                return;
            };
            let sum = dot_in_order(slice_or_empty(done, first..j), slice_or_empty(earlier, first..j));
            *value = quotient(*value - sum, entry(earlier, j));
        }
        let Some((done, [pivot, ..])) = row.split_at_mut_checked(i) else {
            return;
        };
        let Some((solved, [value, ..])) = b.split_at_mut_checked(i) else {
            return;
        };
        let done = slice_or_empty(done, first..i);
        let square = *pivot - dot_in_order(done, done);
        *pivot = if square > floor { square.sqrt() } else { T::ZERO };
        *value = quotient(*value - dot_in_order(done, slice_or_empty(solved, first..i)), *pivot);
    }
    back_substitute(matrix, first, n, b);
}

/// Solves the system whose factor [`solve`] has left in the matrix for another `b`, in place.
pub(crate) fn solve_again<T: Real, const N: usize>(matrix: &[[T; N]], first: usize, b: &mut [T; N]) {
    let n = matrix.len().min(N);
    for (i, row) in matrix.iter().enumerate().skip(first) {
        let Some((solved, [value, ..])) = b.split_at_mut_checked(i) else {
            return;
        };
        let sum = dot_in_order(slice_or_empty(row, first..i), slice_or_empty(solved, first..i));
        *value = quotient(*value - sum, entry(row, i));
    }
    back_substitute(matrix, first, n, b);
}

/// b <- L^-T b of the trailing block.
#[inline(always)]
fn back_substitute<T: Real, const N: usize>(matrix: &[[T; N]], first: usize, n: usize, b: &mut [T; N]) {
    for i in (first..n).rev() {
        let (Some(row), Some((open, [value, ..]))) = (matrix.get(i), b.split_at_mut_checked(i)) else {
            return;
        };
        *value = quotient(*value, entry(row, i));
        add_scaled(
            slice_or_empty_mut(open, first..i),
            -*value,
            slice_or_empty(row, first..i),
        );
    }
}

/// Entry `i` of a row, 0 beyond its end.
fn entry<T: Real>(row: &[T], i: usize) -> T {
    row.get(i).copied().unwrap_or(T::ZERO)
}

/// a / pivot, or 0 for a pivot of 0.
fn quotient<T: Real>(a: T, pivot: T) -> T {
    if pivot > T::ZERO { a / pivot } else { T::ZERO }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_the_trailing_block() {
        let mut matrix = [[9.0; 3], [9.0, 4.0_f64, 1.0], [9.0, 1.0, 3.0]];
        let mut b = [5.0, 1.0, 2.0];
        solve(&mut matrix, 1, &mut b);
        assert!(b[0] == 5.0 && (b[1] - 1.0 / 11.0).abs() < 1e-15 && (b[2] - 7.0 / 11.0).abs() < 1e-15);
        let mut b = [5.0, 2.0, -1.0];
        solve_again(&matrix, 1, &mut b);
        assert!(b[0] == 5.0 && (b[1] - 7.0 / 11.0).abs() < 1e-15 && (b[2] + 6.0 / 11.0).abs() < 1e-15);
    }

    #[test]
    fn a_singular_direction_gets_the_component_0() {
        let mut matrix = [[1.0_f32; 2]; 2];
        let mut b = [2.0, 2.0];
        solve(&mut matrix, 0, &mut b);
        assert_eq!(b, [2.0, 0.0]);
    }
}
