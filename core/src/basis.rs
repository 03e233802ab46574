//! Local POD basis of a query (eqs. 32 to 39), computed in reduced coordinates.
//!
//! The global modes are orthonormal, so the POD of the N_x-sized pseudo-snapshots is the POD of their coefficients: the
//! local modes are Phi W. The translation stays its own coordinate: the first local mode is the translation, the others
//! are the leading left singular vectors of the shape's coefficients. Those come from the triangular factor of the
//! snapshots, which grows snapshot by snapshot, so that no more than a `K x K` matrix is ever held, and whose condition
//! is that of the snapshots and not its square.

use crate::Real;
use crate::linalg::{add_scaled, dot, jacobi, part, part_mut};
use crate::workspace::PAPER_MODES;

/// A local basis: `rank` orthonormal rows of W^T over the global coefficients.
#[derive(Clone, Debug)]
pub(crate) struct Basis<T, const M: usize> {
    rank: usize,
    rows: [[T; PAPER_MODES]; M],
}

/// How far a basis is learned.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Learning<T> {
    /// The snapshot to absorb next.
    Snapshot(usize),
    /// The rotations of the snapshots' factor.
    Rotations(jacobi::Rotations<T>),
}

impl<T> Learning<T> {
    pub(crate) const START: Self = Self::Snapshot(0);
}

impl<T: Real, const M: usize> Basis<T, M> {
    pub(crate) const EMPTY: Self = Self {
        rank: 0,
        rows: [[T::ZERO; PAPER_MODES]; M],
    };

    /// A piece of the work of finding a field's basis from its snapshots at all stored instants: one snapshot, or one
    /// row of their factor. Returns how far it has come, none at the end. `snapshot` gives the `rank` coefficients at a stored
    /// instant. `factor` is room for the triangular factor, left alone between the pieces. The local rank is at most
    /// `wanted`, and less where the snapshots have no more.
    pub(crate) fn learn(
        &mut self,
        learning: Learning<T>,
        rank: usize,
        mut snapshot: impl FnMut(usize, &mut [T]),
        instants: usize,
        wanted: usize,
        factor: &mut [[T; PAPER_MODES]; PAPER_MODES],
    ) -> Option<Learning<T>> {
        let columns = rank - 1;
        let factor = part_mut(factor, 0..columns);
        match learning {
            Learning::Snapshot(instant) => {
                if instant == 0 {
                    factor.as_flattened_mut().fill(T::ZERO);
                }
                let mut coefficients = [T::ZERO; PAPER_MODES];
                snapshot(instant, part_mut(&mut coefficients, 0..rank));
                absorb(factor, part_mut(&mut coefficients, 1..rank));
                Some(if instant + 1 < instants {
                    Learning::Snapshot(instant + 1)
                } else {
                    Learning::Rotations(jacobi::Rotations::new(factor, columns))
                })
            }
            Learning::Rotations(mut rotations) => {
                if rotations.advance(factor, columns) {
                    return Some(Learning::Rotations(rotations));
                }
                self.choose(factor, columns, wanted);
                None
            }
        }
    }

    /// Takes the longest rows of the factor.
    fn choose(&mut self, factor: &[[T; PAPER_MODES]], columns: usize, wanted: usize) {
        let mut lengths = [T::ZERO; PAPER_MODES];
        for (length, row) in lengths.iter_mut().zip(factor) {
            let row = part(row, 0..columns);
            *length = dot(row, row).sqrt();
        }
        let largest = lengths.iter().copied().fold(T::ZERO, T::max);
        let floor = largest * T::EPSILON * T::from_index(columns);
        self.rows = [[T::ZERO; PAPER_MODES]; M];
        self.rows[0][0] = T::ONE;
        self.rank = 1;
        for out in self.rows.iter_mut().take(wanted).skip(1) {
            // The longest row that is not taken yet.
            let longer = |a: (T, usize), b: (T, usize)| if b.0 > a.0 { b } else { a };
            let lengths_left = lengths.iter().copied().zip(0..columns);
            let (length, index) = lengths_left.fold((T::ZERO, 0), longer);
            if length <= floor {
                break;
            }
            for (out, value) in out
                .iter_mut()
                .skip(1)
                .zip(part(factor, index..index + 1).as_flattened())
                .take(columns)
            {
                *out = *value / length;
            }
            part_mut(&mut lengths, index..index + 1).fill(T::ZERO);
            self.rank += 1;
        }
    }

    /// The rows of W^T.
    pub(crate) fn rows(&self) -> &[[T; PAPER_MODES]] {
        part(&self.rows, 0..self.rank)
    }

    /// out <- W^T x: local coordinates of global coefficients.
    pub(crate) fn project(&self, x: &[T], out: &mut [T; M]) {
        out.fill(T::ZERO);
        for (out, row) in out.iter_mut().zip(self.rows()) {
            *out = dot(part(row, 0..x.len()), x);
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
    for (k, row) in factor.iter_mut().enumerate() {
        let (row, snapshot) = (part_mut(row, k..K), part_mut(snapshot, k..snapshot.len()));
        let (Some(&mut a), Some(&mut b)) = (row.first_mut(), snapshot.first_mut()) else {
            return;
        };
        if b == T::ZERO {
            continue;
        }
        let largest = a.abs().max(b.abs());
        let (p, q) = (a / largest, b / largest);
        let scale = T::ONE / (p * p + q * q).sqrt();
        let (cosine, sine) = (p * scale, q * scale);
        for (r, x) in row.iter_mut().zip(snapshot) {
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
