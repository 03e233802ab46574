//! Householder QR of a tall matrix with few columns. Columns that depend on those before them are left out.

use super::{add_scaled, dot_in_order, slice_or_empty, slice_or_empty_mut};
use crate::Real;

/// A column whose part outside the columns before it is less than this share of its length is left out.
const DEPENDENT: f32 = 1e-5;

/// Maximum number of columns.
pub(crate) const MAX_COLUMNS: usize = 15;

/// Q and R of columns, stored in their place. Columns and vectors have `N` entries, of which the first `rows` count.
#[derive(Debug)]
pub(crate) struct Qr<'s, T, const N: usize> {
    rows: usize,
    rank: usize,
    /// Bit j: whether column j is kept.
    kept: u16,
    /// Kept column k holds the entries of R before row k, then the vector v of the reflector I - v v^T.
    columns: &'s mut [[T; N]],
    /// Diagonal of R.
    diagonals: [T; MAX_COLUMNS],
}

impl<'s, T: Real, const N: usize> Qr<'s, T, N> {
    /// QuantizedRef at most [`MAX_COLUMNS`] columns.
    pub(crate) fn new(rows: usize, columns: &'s mut [[T; N]]) -> Self {
        let mut qr = Self {
            rows,
            rank: 0,
            kept: 0,
            columns,
            diagonals: [T::ZERO; MAX_COLUMNS],
        };
        for index in 0..qr.columns.len() {
            let rank = qr.rank;
            let Some((done, open)) = qr.columns.split_at_mut_checked(rank) else {
                break;
            };
            let (Some(column), Some(diagonal)) = (open.get_mut(index - rank), qr.diagonals.get_mut(rank)) else {
                break;
            };
            let column = slice_or_empty_mut(column, 0..rows);
            let length = dot_in_order(column, column).sqrt();
            for (k, reflector) in done.iter().enumerate() {
                reflect(slice_or_empty(reflector, k..rows), slice_or_empty_mut(column, k..rows));
            }
            // The first `rank` entries belong to R; the reflector maps the others onto the next entry.
            let column = slice_or_empty_mut(column, rank..rows);
            let norm = dot_in_order(column, column).sqrt();
            let (true, Some(head)) = (norm > length * T::from_f32(DEPENDENT), column.first_mut()) else {
                continue;
            };
            *diagonal = if *head > T::ZERO { -norm } else { norm };
            let share = T::ONE / (norm * (norm + head.abs())).sqrt();
            *head -= *diagonal;
            for value in column {
                *value *= share;
            }
            // Swapped entry by entry: a copy of the column would link `memmove`, 1.5 kB of code on a Cortex-M.
            if let Some((place, rest)) = open.split_first_mut()
                && let Some(kept) = (index - rank).checked_sub(1).and_then(|gap| rest.get_mut(gap))
            {
                place.swap_with_slice(kept);
            }
            qr.rank += 1;
            qr.kept |= 1 << index;
        }
        qr
    }

    /// Number of columns kept.
    pub(crate) fn rank(&self) -> usize {
        self.rank
    }

    /// The reflectors and the first entry that each acts on.
    fn reflectors(&self) -> impl DoubleEndedIterator<Item = (usize, &[T])> {
        (0..self.rank).map(|k| (k, self.from(k, k)))
    }

    /// x <- Q^T x.
    pub(crate) fn transpose_times(&self, x: &mut [T; N]) {
        for (k, v) in self.reflectors() {
            reflect(v, slice_or_empty_mut(x, k..self.rows));
        }
    }

    /// x <- Q x.
    pub(crate) fn times(&self, x: &mut [T; N]) {
        for (k, v) in self.reflectors().rev() {
            reflect(v, slice_or_empty_mut(x, k..self.rows));
        }
    }

    /// The x of least norm whose product with column 0 is 1 and with the other kept columns 0: Q R^-T e_0.
    pub(crate) fn first(&self) -> [T; N] {
        self.least_norm(|k| if k == 0 { T::ONE } else { T::ZERO })
    }

    /// The x of least norm whose products with the kept columns are given ones, by the numbers that the columns had
    /// before any was left out.
    pub(crate) fn least_norm_of_all(&self, right: impl Fn(usize) -> T) -> [T; N] {
        let number = |k: usize| (0..MAX_COLUMNS).filter(|j| self.kept >> j & 1 == 1).nth(k);
        self.least_norm(|k| number(k).map_or(T::ZERO, &right))
    }

    /// The x of least norm whose product with kept column k is `right(k)`: Q R^-T right.
    #[inline(always)]
    fn least_norm(&self, right: impl Fn(usize) -> T) -> [T; N] {
        let mut x = [T::ZERO; N];
        let columns = slice_or_empty(self.columns, 0..self.rank).iter().zip(&self.diagonals);
        for (k, (column, diagonal)) in columns.enumerate() {
            let right = right(k);
            let value = (right - dot_in_order(slice_or_empty(column, 0..k), slice_or_empty(&x, 0..k))) / *diagonal;
            slice_or_empty_mut(&mut x, k..k + 1).fill(value);
        }
        self.times(&mut x);
        x
    }

    /// S <- Q^T S Q of a symmetric matrix of as many rows as the columns have. Reads its lower half, and computes the
    /// lower half of the block that belongs to the null space of the columns (rows and columns from the rank on); other
    /// entries are left undefined. With p = S v and w = p - (p^T v / 2) v, (I - v v^T) S (I - v v^T) = S - v w^T -
    /// w v^T; the same pass sums p of the next reflector.
    #[inline(never)]
    pub(crate) fn conjugate(&self, matrix: &mut [[T; N]]) {
        let mut entries = [Entry {
            v: T::ZERO,
            w: T::ZERO,
            next: T::ZERO,
            product: T::ZERO,
        }; N];
        let mut product = [T::ZERO; N];
        if let Some(first) = self.columns.first() {
            symmetric_times(matrix, first, &mut product);
        }
        for (entry, product) in entries.iter_mut().zip(&product) {
            entry.product = *product;
        }
        for k in 0..self.rank {
            let entries = slice_or_empty_mut(&mut entries, k..self.rows);
            let mut half = T::ZERO;
            for (entry, v) in entries.iter_mut().zip(self.from(k, k)) {
                half += entry.product * *v;
                entry.v = *v;
            }
            half *= T::from_f32(0.5);
            for entry in &mut *entries {
                entry.w = entry.product - half * entry.v;
                (entry.next, entry.product) = (T::ZERO, T::ZERO);
            }
            let entries = slice_or_empty_mut(entries, 1..self.rows - k);
            for (entry, next) in entries.iter_mut().zip(self.from(k + 1, k + 1)) {
                entry.next = *next;
            }
            for (i, row) in matrix.iter_mut().skip(k + 1).enumerate() {
                let Some((own, before)) = slice_or_empty_mut(entries, 0..i + 1).split_last_mut() else {
                    break;
                };
                let Some((diagonal, row)) = slice_or_empty_mut(row, k + 1..k + 2 + i).split_last_mut() else {
                    break;
                };
                let Entry {
                    v,
                    w,
                    next,
                    mut product,
                } = *own;
                for (value, entry) in row.iter_mut().zip(before) {
                    *value -= v * entry.w + w * entry.v;
                    product += *value * entry.next;
                    entry.product += *value * next;
                }
                let twice = v * w;
                *diagonal -= twice + twice;
                own.product = product + *diagonal * next;
            }
        }
    }

    /// The entries of reflector `k` from `first` on; none beyond the rank.
    fn from(&self, k: usize, first: usize) -> &[T] {
        let column = slice_or_empty(self.columns, 0..self.rank).get(k);
        column.map_or(&[], |column| slice_or_empty(column, first..self.rows))
    }
}

/// Entries of the vectors of one conjugation step, interleaved: a Cortex-M loads them with one instruction.
#[derive(Clone, Copy)]
struct Entry<T> {
    v: T,
    w: T,
    /// Entry of the next reflector, and of its product with the matrix.
    next: T,
    product: T,
}

/// x <- (I - v v^T) x.
fn reflect<T: Real>(v: &[T], x: &mut [T]) {
    let share = dot_in_order(v, x);
    add_scaled(x, -share, v);
}

/// out <- out + S x of a symmetric matrix, of which the lower half is read.
pub(crate) fn symmetric_times<T: Real, const N: usize>(matrix: &[[T; N]], x: &[T; N], out: &mut [T; N]) {
    for (i, (row, x_i)) in matrix.iter().zip(x).enumerate() {
        let mut own = T::ZERO;
        for ((value, x), out) in slice_or_empty(row, 0..i).iter().zip(x).zip(&mut *out) {
            own += *value * *x;
            *out += *value * *x_i;
        }
        if let (Some(out), Some(diagonal)) = (out.get_mut(i), row.get(i)) {
            *out += own + *diagonal * *x_i;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::dot;
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
        let mut columns = COLUMNS;
        let qr = Qr::new(5, &mut columns);
        assert_eq!(qr.rank(), 3);
        let x = qr.first();
        for (column, expected) in [(0, 1.0), (1, 0.0), (2, 0.0), (3, 0.0)] {
            assert!((dot(&COLUMNS[column], &x) - expected).abs() < 1e-14);
        }
        // By the numbers of all columns.
        let other = qr.least_norm_of_all(|j| j as f64);
        for j in [0, 1, 3] {
            assert!((dot(&COLUMNS[j], &other) - j as f64).abs() < 1e-14);
        }
        // The shortest is a combination of the columns: nothing of it is in their null space.
        let mut inside = x;
        qr.transpose_times(&mut inside);
        assert!(inside[3..].iter().all(|value| value.abs() < 1e-15), "{inside:?}");
    }

    #[test]
    fn conjugation_is_a_similarity() {
        let mut columns = COLUMNS;
        let qr = Qr::new(5, &mut columns);
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
        // In the null space, x^T (Q^T S Q) y = (Q x)^T S (Q y).
        let (x, y) = ([0.0, 0.0, 0.0, 0.5, 0.9], [0.0, 0.0, 0.0, 0.1, -0.2]);
        let form = |s: &[[f64; 5]], x: &[f64], y: &[f64]| (3..5).map(|i| x[i] * dot(&s[i][3..], &y[3..])).sum::<f64>();
        let (mut qx, mut qy) = (x, y);
        qr.times(&mut qx);
        qr.times(&mut qy);
        let whole = (0..5).map(|i| qx[i] * dot(&before[i], &qy)).sum::<f64>();
        assert!((whole - form(&matrix, &x, &y)).abs() < 1e-14);
    }

    #[test]
    fn a_symmetric_product_reads_the_lower_half() {
        let matrix = [[2.0, f64::NAN, f64::NAN], [1.0, 3.0, f64::NAN], [-1.0, 0.5, 4.0]];
        let mut out = [1.0, 0.0, 0.0];
        symmetric_times(&matrix, &[1.0, 2.0, 3.0], &mut out);
        assert_eq!(out, [2.0, 8.5, 12.0]);
    }
}
