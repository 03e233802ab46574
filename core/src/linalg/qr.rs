//! Householder QR of a tall matrix with few columns, which leaves out columns that depend on those before.

use super::{add_scaled, dot, part, part_mut};
use crate::Real;

/// A column whose part outside the columns before it is less than this share of its length is left out.
const DEPENDENT: f32 = 1e-5;

/// Q and R of columns of `N` entries, the last of which may be padding. All vectors have `N` entries too, of
/// which the first `rows` take part.
#[derive(Debug)]
pub(crate) struct Qr<T, const N: usize, const C: usize> {
    rows: usize,
    rank: usize,
    /// Reflector k: I - v v^T, with zeros in the first k entries of v.
    reflectors: [[T; N]; C],
    /// Column k of R, up to its diagonal, belongs to the k-th column kept; then come zeros.
    r: [[T; C]; C],
    diagonals: [T; C],
    kept: [usize; C],
}

impl<T: Real, const N: usize, const C: usize> Qr<T, N, C> {
    /// Factors columns whose entries from `rows` on are zeros.
    pub(crate) fn new(rows: usize, columns: [[T; N]; C]) -> Self {
        const { assert!(C <= N, "a tall matrix") };
        let mut qr = Self {
            rows,
            rank: 0,
            reflectors: [[T::ZERO; N]; C],
            r: [[T::ZERO; C]; C],
            diagonals: [T::ZERO; C],
            kept: [0; C],
        };
        for (index, mut column) in columns.into_iter().enumerate() {
            let length = dot(&column, &column).sqrt();
            qr.transpose_times(&mut column);
            // The first `rank` entries belong to R, the rest is to be reflected onto the next.
            let k = qr.rank;
            for (r, value) in part_mut(&mut qr.r, k..k + 1)
                .as_flattened_mut()
                .iter_mut()
                .zip(&mut column)
                .take(k)
            {
                (*r, *value) = (*value, T::ZERO);
            }
            let norm = dot(&column, &column).sqrt();
            let (Some(head), true) = (column.get_mut(k), k < rows && norm > length * T::from_f32(DEPENDENT)) else {
                continue;
            };
            let diagonal = if *head > T::ZERO { -norm } else { norm };
            *head -= diagonal;
            let scale = (T::from_f32(2.0) / dot(&column, &column)).sqrt();
            if let (Some(reflector), Some(r), Some(kept)) =
                (qr.reflectors.get_mut(k), qr.diagonals.get_mut(k), qr.kept.get_mut(k))
            {
                *reflector = column.map(|value| scale * value);
                (*r, *kept) = (diagonal, index);
                qr.rank += 1;
            }
        }
        qr
    }

    /// Number of columns kept.
    pub(crate) fn rank(&self) -> usize {
        self.rank
    }

    /// x <- Q^T x.
    pub(crate) fn transpose_times(&self, x: &mut [T; N]) {
        for v in self.reflectors.iter().take(self.rank) {
            let (v, x) = (part(v, 0..self.rows), part_mut(x, 0..self.rows));
            let share = dot(v, x);
            add_scaled(x, -share, v);
        }
    }

    /// x <- Q x.
    pub(crate) fn times(&self, x: &mut [T; N]) {
        for v in part(&self.reflectors, 0..self.rank).iter().rev() {
            let (v, x) = (part(v, 0..self.rows), part_mut(x, 0..self.rows));
            let share = dot(v, x);
            add_scaled(x, -share, v);
        }
    }

    /// S <- Q^T S Q of a symmetric matrix of as many rows as the columns have, of which only the lower half is read and
    /// written: with p = S v and w = p - (p^T v / 2) v, (I - v v^T) S (I - v v^T) = S - v w^T - w v^T.
    pub(crate) fn conjugate(&self, matrix: &mut [[T; N]]) {
        for v in self.reflectors.iter().take(self.rank) {
            let mut w = [T::ZERO; N];
            for (i, (row, x)) in matrix.iter().zip(v).enumerate() {
                if let ([before @ .., diagonal], v) = (part(row, 0..i + 1), part(v, 0..i)) {
                    let own = dot(before, v) + *diagonal * *x;
                    add_scaled(&mut w, *x, before);
                    part_mut(&mut w, i..i + 1).iter_mut().for_each(|w| *w += own);
                }
            }
            let half = dot(&w, v) * T::from_f32(0.5);
            add_scaled(&mut w, -half, v);
            for (i, ((row, v_i), w_i)) in matrix.iter_mut().zip(v).zip(&w).enumerate() {
                for ((value, v), w) in row.iter_mut().zip(v).zip(&w).take(i + 1) {
                    *value -= *v_i * *w + *w_i * *v;
                }
            }
        }
    }

    /// R^-T b in the first `rank` entries, then zeros; b is given at all columns.
    pub(crate) fn solve_transposed(&self, b: &[T; C]) -> [T; N] {
        let mut solution = [T::ZERO; C];
        for k in 0..self.rank.min(C) {
            let right = b.get(self.kept[k]).copied().unwrap_or(T::ZERO);
            solution[k] = (right - dot(&self.r[k], &solution)) / self.diagonals[k];
        }
        let mut padded = [T::ZERO; N];
        for (padded, value) in padded.iter_mut().zip(solution) {
            *padded = value;
        }
        padded
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
        let mut x = qr.solve_transposed(&b);
        qr.times(&mut x);
        for c in [0, 1, 3] {
            assert!((dot(&COLUMNS[c], &x) - b[c]).abs() < 1e-14);
        }
    }

    #[test]
    fn conjugation_is_a_similarity() {
        let qr = Qr::new(5, COLUMNS);
        let mut matrix: [[f64; 5]; 5] =
            core::array::from_fn(|i| core::array::from_fn(|j| 1.0 / (1.0 + (i + j) as f64)));
        let before = matrix;
        // Only the lower half counts.
        for i in 0..5 {
            matrix[i][i + 1..].fill(f64::NAN);
        }
        qr.conjugate(&mut matrix);
        for i in 0..5 {
            for j in i + 1..5 {
                matrix[i][j] = matrix[j][i];
            }
        }
        // x^T S y = (Q^T x)^T (Q^T S Q) (Q^T y).
        let (x, y) = ([0.3, -1.0, 0.2, 0.5, 0.9], [1.0, 0.4, -0.6, 0.1, -0.2]);
        let form = |s: &[[f64; 5]], x: &[f64], y: &[f64]| (0..5).map(|i| x[i] * dot(&s[i], y)).sum::<f64>();
        let (mut qx, mut qy) = (x, y);
        qr.transpose_times(&mut qx);
        qr.transpose_times(&mut qy);
        assert!((form(&before, &x, &y) - form(&matrix, &qx, &qy)).abs() < 1e-14);
    }
}
