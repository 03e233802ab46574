//! Least squares by modified Gram-Schmidt (Golub and Van Loan, Matrix Computations, 2013, section 5.2.8).

use super::{add_scaled, dot};
use crate::Real;

/// A column whose part outside the columns before it is less than this share of its length is not determined.
const DEPENDENT: f32 = 1e-3;

/// The rows of the pseudo-inverse that give the last `D` of `C` least-squares coefficients of `R` values. The columns
/// become orthonormal in place; the last coefficients need the last block of the triangular factor only. None where
/// the columns are not independent or not finite.
pub(crate) fn last_coefficients<T: Real, const R: usize, const C: usize, const D: usize>(
    columns: &mut [[T; R]; C],
) -> Option<[[T; R]; D]> {
    let first = C - D;
    let mut triangle = [[T::ZERO; C]; C];
    for k in 0..C {
        let (before, rest) = columns.split_at_mut_checked(k)?;
        let column = rest.first_mut()?;
        let length = dot(column, column).sqrt();
        for (earlier, row) in before.iter().zip(&mut triangle) {
            let component = dot(earlier, column);
            add_scaled(column, -component, earlier);
            row[k] = component;
        }
        let norm = dot(column, column).sqrt();
        // In this direction a NaN is refused too.
        let determined = norm > length * T::from_f32(DEPENDENT);
        if !determined {
            return None;
        }
        *column = column.map(|value| value / norm);
        triangle[k][k] = norm;
    }
    let mut solution = [[T::ZERO; R]; D];
    for k in (0..D).rev() {
        let row = triangle[first + k];
        let mut own = columns[first + k];
        for (factor, known) in row.iter().skip(first).zip(&solution).skip(k + 1) {
            add_scaled(&mut own, -*factor, known);
        }
        solution[k] = own.map(|value| value / row[first + k]);
    }
    Some(solution)
}

#[cfg(test)]
mod tests {
    use super::*;

    const COLUMNS: [[f64; 5]; 3] = [[1.0; 5], [-2.0, -1.0, 0.0, 1.0, 2.0], [4.0, 1.0, 0.0, 1.0, 4.0]];

    #[test]
    fn the_last_coefficients_of_a_combination_are_found() {
        let values: [f64; 5] =
            core::array::from_fn(|i| 3.0 * COLUMNS[0][i] - 0.5 * COLUMNS[1][i] + 0.25 * COLUMNS[2][i]);
        let solution: [_; 2] = last_coefficients(&mut COLUMNS.clone()).unwrap();
        for (row, expected) in solution.iter().zip([-0.5, 0.25]) {
            assert!((dot(row, &values) - expected).abs() < 1e-14);
        }
    }

    #[test]
    fn dependent_columns_are_refused() {
        let mut columns = COLUMNS;
        columns[2] = columns[1].map(|x| 2.0 * x);
        assert!(last_coefficients::<_, 5, 3, 1>(&mut columns).is_none());
        columns[2] = [f64::NAN; 5];
        assert!(last_coefficients::<_, 5, 3, 1>(&mut columns).is_none());
    }
}
