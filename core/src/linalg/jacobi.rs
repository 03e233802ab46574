//! Singular values and vectors by one-sided Jacobi rotations (Hestenes 1958; de Rijk 1989).

use super::{add_scaled, dot, slice_or_empty, slice_or_empty_mut};
use crate::Real;

/// Graded matrices in single precision needed at most 12.
const MAX_SWEEPS: usize = 20;

/// Rotations of rows (their first `columns` entries) until they are orthogonal: row i becomes sigma_i v_i^T with the
/// right singular vectors v_i, unordered. Every rotation reduces the sum of the squared products of rows, so a matrix
/// that needs more than the last sweep is still closer to orthogonal. One row at a time, so that the caller can pause.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rotations<T> {
    /// Rows with a smaller squared norm are rounding errors of the longest.
    floor: T,
    /// Square of the distance; rotations that move no row farther are skipped.
    negligible: T,
    sweep: usize,
    row: usize,
    rotated: bool,
}

impl<T: Real> Rotations<T> {
    /// Starts the first sweep. Rotations that move rows by no more than `negligible` times the longest norm are
    /// skipped.
    pub(crate) fn new<const K: usize>(rows: &[[T; K]], columns: usize, negligible: T) -> Self {
        let largest = rows.iter().map(|row| square(row, columns)).fold(T::ZERO, T::max);
        Self {
            floor: largest * T::EPSILON * T::EPSILON * T::from_index(columns),
            negligible: largest * negligible * negligible,
            sweep: 0,
            row: 1,
            rotated: false,
        }
    }

    /// Rotates the next row against all above it. Returns false when all rows are orthogonal.
    #[inline(never)]
    pub(crate) fn advance<const K: usize>(&mut self, rows: &mut [[T; K]], columns: usize) -> bool {
        if self.row >= rows.len() {
            let more = self.rotated && self.sweep + 1 < MAX_SWEEPS;
            (self.sweep, self.row, self.rotated) = (self.sweep + 1, 1, false);
            if !more {
                return false;
            }
        }
        let Some((above, [y, ..])) = rows.split_at_mut_checked(self.row) else {
            return false;
        };
        let mut square_of_row = square(y, columns);
        for x in above {
            self.rotated |= self.rotate(x, y, &mut square_of_row, columns);
        }
        self.row += 1;
        true
    }

    /// Makes two rows orthogonal and updates the squared norm of the second; returns false if they already were.
    fn rotate<const K: usize>(&self, x: &mut [T; K], y: &mut [T; K], square: &mut T, columns: usize) -> bool {
        let (x, y) = (slice_or_empty_mut(x, 0..columns), slice_or_empty_mut(y, 0..columns));
        let (a, b) = (dot(x, x), *square);
        if a.min(b) <= self.floor {
            return false;
        }
        let product = dot(x, y);
        // The longer row moves by |product| / length. The division comes before the second product, because squares
        // of products could underflow.
        let (rounding, larger) = (T::EPSILON * T::from_f32(4.0), a.max(b));
        let negligible = (rounding * rounding * a.min(b)).max(self.negligible);
        if product * (product / larger) <= negligible {
            return false;
        }
        let zeta = (b - a) / (product + product);
        let tangent = T::ONE / (zeta.abs() + (T::ONE + zeta * zeta).sqrt());
        let tangent = if zeta < T::ZERO { -tangent } else { tangent };
        let cosine = T::ONE / (T::ONE + tangent * tangent).sqrt();
        let sine = cosine * tangent;
        *square += tangent * product;
        for (x, y) in x.iter_mut().zip(y) {
            (*x, *y) = (cosine * *x - sine * *y, sine * *x + cosine * *y);
        }
        true
    }
}

/// Moves the direction of the longest of nearly orthogonal rows to `out` (a unit vector) and projects it out of all
/// rows, which removes what the skipped rotations left. Returns the length.
#[inline(never)]
pub(crate) fn deflate<T: Real, const K: usize>(rows: &mut [[T; K]], out: &mut [T]) -> Option<T> {
    let mut longest = None;
    let mut greatest = T::ZERO;
    for row in rows.iter() {
        let row = slice_or_empty(row, 0..out.len());
        let square = dot(row, row);
        if square > greatest {
            (longest, greatest) = (Some(row), square);
        }
    }
    let length = greatest.sqrt();
    for (out, entry) in out.iter_mut().zip(longest?) {
        *out = *entry / length;
    }
    for row in rows {
        let row = slice_or_empty_mut(row, 0..out.len());
        let component = dot(row, out);
        add_scaled(row, -component, out);
    }
    Some(length)
}

fn square<T: Real, const K: usize>(row: &[T; K], columns: usize) -> T {
    dot(slice_or_empty(row, 0..columns), slice_or_empty(row, 0..columns))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn orthogonalise<T: Real, const K: usize>(rows: &mut [[T; K]], columns: usize) {
        let mut rotations = Rotations::new(rows, columns, T::ZERO);
        while rotations.advance(rows, columns) {}
    }

    /// Number of eigenvalues of a symmetric matrix below a shift, by the signs of its LDL^T (Sylvester's law of
    /// inertia): an independent way to the squared singular values.
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
    #[cfg_attr(miri, ignore = "too many rotations")]
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
