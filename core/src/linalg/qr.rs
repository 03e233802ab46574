//! Householder QR of a tall matrix with few columns, which leaves out columns that depend on those before.

use super::{add_scaled, dot};
use crate::Real;

/// A column whose part outside the columns before it is less than this share of its length is left out.
const DEPENDENT: f32 = 1e-5;

/// Q and R of up to `N` rows and `C` columns.
#[derive(Debug)]
pub(crate) struct Qr<T, const N: usize, const C: usize> {
    rows: usize,
    rank: usize,
    /// Reflector k: I - v v^T with v in the entries from k on.
    reflectors: [[T; N]; C],
    /// Column k of R belongs to the k-th column kept.
    r: [[T; C]; C],
    kept: [usize; C],
}

impl<T: Real, const N: usize, const C: usize> Qr<T, N, C> {
    /// Factors the first `rows` entries of the given columns.
    pub(crate) fn new(rows: usize, columns: [[T; N]; C]) -> Self {
        let rows = rows.min(N);
        let zero = [T::ZERO; C];
        let mut qr = Self {
            rows,
            rank: 0,
            reflectors: [[T::ZERO; N]; C],
            r: [zero; C],
            kept: [0; C],
        };
        for (index, mut column) in columns.into_iter().enumerate() {
            let column = &mut column[..rows];
            let length = dot(column, column).sqrt();
            qr.transpose_times(column);
            let k = qr.rank;
            let rest = &mut column[k..];
            let norm = dot(rest, rest).sqrt();
            if rest.is_empty() || norm <= length * T::from_f32(DEPENDENT) {
                continue;
            }
            let diagonal = if rest[0] > T::ZERO { -norm } else { norm };
            rest[0] -= diagonal;
            let scale = (T::from_f32(2.0) / dot(rest, rest)).sqrt();
            for (v, rest) in qr.reflectors[k][k..].iter_mut().zip(rest) {
                *v = scale * *rest;
            }
            qr.r[k][..k].copy_from_slice(&column[..k]);
            qr.r[k][k] = diagonal;
            qr.kept[k] = index;
            qr.rank += 1;
        }
        qr
    }

    /// Number of columns kept.
    pub(crate) fn rank(&self) -> usize {
        self.rank
    }

    fn reflect(&self, k: usize, x: &mut [T]) {
        let (v, x) = (&self.reflectors[k][k..self.rows], &mut x[k..]);
        add_scaled(x, -dot(v, x), v);
    }

    /// x <- Q^T x.
    pub(crate) fn transpose_times(&self, x: &mut [T]) {
        for k in 0..self.rank {
            self.reflect(k, x);
        }
    }

    /// x <- Q x.
    pub(crate) fn times(&self, x: &mut [T]) {
        for k in (0..self.rank).rev() {
            self.reflect(k, x);
        }
    }

    /// S <- Q^T S Q of a symmetric matrix, row-major.
    pub(crate) fn conjugate(&self, matrix: &mut [T]) {
        let n = self.rows;
        for row in matrix.chunks_exact_mut(n) {
            self.transpose_times(row);
        }
        for k in 0..self.rank {
            let v = &self.reflectors[k][..n];
            let mut product = [T::ZERO; N];
            for (row, v) in matrix.chunks_exact(n).zip(v).skip(k) {
                add_scaled(&mut product, *v, row);
            }
            for (row, v) in matrix.chunks_exact_mut(n).zip(v).skip(k) {
                add_scaled(row, -*v, &product);
            }
        }
    }

    /// The first `rank` entries of out <- R^-T b, with b given at all columns.
    pub(crate) fn solve_transposed(&self, b: &[T; C], out: &mut [T]) {
        for k in 0..self.rank {
            let sum = dot(&self.r[k][..k], &out[..k]);
            out[k] = (b[self.kept[k]] - sum) / self.r[k][k];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COLUMNS: [[f64; 5]; 4] = [
        [1.0; 5],
        [0.3, -0.2, 0.9, 0.1, -0.7],
        [0.6, -0.4, 1.8, 0.2, -1.4],
        [0.2, 0.5, -0.1, 0.8, 0.4],
    ];

    #[test]
    fn least_norm_solution_meets_the_kept_constraints() {
        // Column 2 is twice column 1: it must be left out.
        let qr = Qr::new(5, COLUMNS);
        assert_eq!(qr.rank(), 3);
        let b = [1.0, -0.4, f64::NAN, 2.0];
        let mut x = [0.0; 5];
        qr.solve_transposed(&b, &mut x);
        qr.times(&mut x);
        for c in [0, 1, 3] {
            assert!((dot(&COLUMNS[c], &x) - b[c]).abs() < 1e-14);
        }
    }

    #[test]
    fn conjugation_is_a_similarity() {
        let qr = Qr::new(5, COLUMNS);
        let mut matrix: [f64; 25] = core::array::from_fn(|i| 1.0 / (1.0 + (i / 5 + i % 5) as f64));
        let before = matrix;
        qr.conjugate(&mut matrix);
        // x^T S y = (Q^T x)^T (Q^T S Q) (Q^T y).
        let (x, y) = ([0.3, -1.0, 0.2, 0.5, 0.9], [1.0, 0.4, -0.6, 0.1, -0.2]);
        let form = |s: &[f64], x: &[f64], y: &[f64]| (0..5).map(|i| x[i] * dot(&s[5 * i..][..5], y)).sum::<f64>();
        let (mut qx, mut qy) = (x, y);
        qr.transpose_times(&mut qx);
        qr.transpose_times(&mut qy);
        assert!((form(&before, &x, &y) - form(&matrix, &qx, &qy)).abs() < 1e-14);
    }
}
