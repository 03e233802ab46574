//! Local POD basis of a query (eqs. 32 to 39), computed in reduced coordinates.
//!
//! The global modes are orthonormal, so the POD of the N_x-sized pseudo-snapshots is the POD of their coefficients: the
//! local modes are Phi W. The translation stays its own coordinate: the first local mode is the translation, the others
//! are the leading left singular vectors of the shape's coefficients. Those come from the triangular factor of the
//! snapshots, which grows snapshot by snapshot, so that no more than a `K x K` matrix is ever held, and whose condition
//! is that of the snapshots and not its square.

use crate::Real;
use crate::linalg::{add_scaled, dot, jacobi};
use crate::motion::Field;

/// A local basis: `rank` orthonormal rows of W^T over the global coefficients.
#[derive(Clone, Debug)]
pub(crate) struct Basis<T, const K: usize, const M: usize> {
    rank: usize,
    rows: [[T; K]; M],
}

impl<T: Real, const K: usize, const M: usize> Basis<T, K, M> {
    pub(crate) const EMPTY: Self = Self {
        rank: 0,
        rows: [[T::ZERO; K]; M],
    };

    /// The basis of a field from its snapshots at all stored instants. `factor` is room for the triangular factor.
    /// The rank is at most `wanted`, and less where the snapshots have no more.
    pub(crate) fn learn(&mut self, field: &Field<'_, '_, T>, instants: usize, wanted: usize, factor: &mut [[T; K]; K]) {
        let shape = 1..field.rank();
        let factor = &mut factor[..shape.len()];
        factor.as_flattened_mut().fill(T::ZERO);
        let mut snapshot = [T::ZERO; K];
        for instant in 0..instants {
            field.at_instant(instant, &mut snapshot[..shape.end]);
            absorb(factor, &mut snapshot[shape.clone()]);
        }
        jacobi::orthogonalise(factor, shape.len());

        self.rows[0].fill(T::ZERO);
        self.rows[0][0] = T::ONE;
        self.rank = 1;
        let norm = |row: &[T; K]| dot(&row[..shape.len()], &row[..shape.len()]).sqrt();
        let largest = factor.iter().map(norm).fold(T::ZERO, T::max);
        let floor = largest * T::EPSILON * T::from_index(shape.len());
        while self.rank < wanted.min(M) {
            // The longest row left; taken rows are cleared.
            let mut longest = (T::ZERO, 0);
            for (index, row) in factor.iter().enumerate() {
                let length = norm(row);
                if length > longest.0 {
                    longest = (length, index);
                }
            }
            let (length, index) = longest;
            if length <= floor {
                break;
            }
            let row = &mut self.rows[self.rank];
            row.fill(T::ZERO);
            for (out, value) in row[shape.clone()].iter_mut().zip(&mut factor[index]) {
                *out = *value / length;
                *value = T::ZERO;
            }
            self.rank += 1;
        }
    }

    /// The rows of W^T.
    pub(crate) fn rows(&self) -> &[[T; K]] {
        &self.rows[..self.rank]
    }

    /// out <- W^T x: local coordinates of global coefficients.
    pub(crate) fn project(&self, x: &[T], out: &mut [T; M]) {
        for (out, row) in out.iter_mut().zip(self.rows()) {
            *out = dot(&row[..x.len()], x);
        }
    }

    /// out <- W x: global coefficients of local coordinates.
    pub(crate) fn lift(&self, x: &[T; M], out: &mut [T]) {
        out.fill(T::ZERO);
        for (x, row) in x.iter().zip(self.rows()) {
            add_scaled(out, *x, row);
        }
    }
}

/// Rotates a snapshot into the triangular factor R of the snapshots absorbed before (Givens rotations).
fn absorb<T: Real, const K: usize>(factor: &mut [[T; K]], snapshot: &mut [T]) {
    let n = snapshot.len();
    for (k, row) in factor.iter_mut().enumerate() {
        let (a, b) = (row[k], snapshot[k]);
        if b == T::ZERO {
            continue;
        }
        let largest = a.abs().max(b.abs());
        let (p, q) = (a / largest, b / largest);
        let scale = T::ONE / (p * p + q * q).sqrt();
        let (cosine, sine) = (p * scale, q * scale);
        for (r, x) in row[k..n].iter_mut().zip(&mut snapshot[k..]) {
            (*r, *x) = (cosine * *r + sine * *x, cosine * *x - sine * *r);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_factor_has_the_gram_matrix_of_the_snapshots() {
        let snapshots: [[f64; 4]; 9] = core::array::from_fn(|i| {
            core::array::from_fn(|k| ((i * i + 3 * k * i + 1) % 11) as f64 - 5.0 + 0.1 * k as f64)
        });
        let mut factor = [[0.0; 6]; 4];
        for mut snapshot in snapshots {
            absorb(&mut factor, &mut snapshot);
        }
        for i in 0..4 {
            for j in 0..4 {
                let direct: f64 = snapshots.iter().map(|x| x[i] * x[j]).sum();
                let factored: f64 = factor.iter().map(|row| row[i] * row[j]).sum();
                assert!((direct - factored).abs() < 1e-12 * direct.abs().max(1.0));
                assert!(j >= i || factor[i][j] == 0.0);
            }
        }
    }
}
