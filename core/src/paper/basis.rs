//! Local POD basis of a query (eqs. 32 to 39), computed in reduced coordinates.
//!
//! The global modes are orthonormal, so the POD of the pseudo-snapshots of 3 N_x components is the POD of their
//! coefficients: the local modes are Phi W. The translation stays a coordinate of its own: the first local mode is the
//! translation, the others are the leading left singular vectors of the shape's coefficients.
//!
//! The snapshots of one query have a low numerical rank r. A pivoted LQ factorisation in place reduces them to r
//! coordinates each, Givens rotations gather these into an r x r upper triangular factor, and one-sided Jacobi
//! rotations make its rows orthogonal. The factor is upper triangular because its rows then become shorter as the
//! coordinates do, which saves rotations. No product of the snapshots is formed: the condition number is that of the
//! snapshots.

use super::{Factor, PAPER_ROW, SNAPSHOTS};
use crate::Real;
use crate::linalg::givens::givens_update;
use crate::linalg::{LANES, add_scaled, dot, jacobi, lq, slice_or_empty, slice_or_empty_mut};

/// A local basis: `rank` orthonormal rows of W^T over the global coefficients.
#[derive(Clone, Debug)]
pub(crate) struct Basis<T, const M: usize> {
    rank: usize,
    rows: [[T; PAPER_ROW]; M],
}

/// Norm of a snapshot's residual that is neglected, as a share of the longest snapshot: far below the error of the
/// method, and above the quantisation of the model.
const NEGLIGIBLE: f32 = 1e-4;

/// The next piece of the computation of a basis.
#[derive(Clone, Copy, Debug)]
pub(crate) enum BasisStage<T> {
    /// Compute the snapshot at this stored instant.
    Snapshot(usize),
    /// Reflect the rows in direction `done`. Rows `done..open` have residuals with a squared norm above `floor`.
    Reflection { done: usize, open: usize, floor: T },
    /// Add this row to the triangular factor of the first `rank` columns. Rows `rank..2 rank` hold the factor, the rows
    /// before it the reflections, whose own coordinates are added last.
    Triangle { rank: usize, row: usize },
    /// Rotate the rows of that factor.
    Rotations {
        rank: usize,
        rotations: jacobi::Rotations<T>,
    },
    /// Take the next mode from the factor, if its singular value exceeds `floor`.
    Mode { rank: usize, floor: T },
}

impl<T> BasisStage<T> {
    pub(crate) const START: Self = Self::Snapshot(0);
}

impl<T: Real, const M: usize> Basis<T, M> {
    pub(crate) const EMPTY: Self = Self {
        rank: 0,
        rows: [[T::ZERO; PAPER_ROW]; M],
    };

    /// Does one piece of the computation of a field's basis from its snapshots at all stored instants: one snapshot,
    /// one reflection, one row of the factor, one row of rotations or one mode. Returns none when the basis is
    /// complete. `snapshot` computes the `rank` coefficients at a stored instant. `factor` stores the snapshots and
    /// must not change between the pieces. The local rank is at most `wanted`, and less where the snapshots have a
    /// lower rank.
    pub(crate) fn step(
        &mut self,
        stage: &mut BasisStage<T>,
        rank: usize,
        mut snapshot: impl FnMut(usize, &mut [T]),
        instants: usize,
        wanted: usize,
        factor: &mut Factor<T>,
    ) -> Option<()> {
        let columns = rank - 1;
        // More snapshots than the factor has rows are reduced to a triangular factor as they come.
        let count = if instants > SNAPSHOTS { columns } else { instants };
        *stage = match *stage {
            BasisStage::Snapshot(instant) => {
                if instant == 0 {
                    *factor = [[T::ZERO; PAPER_ROW]; SNAPSHOTS];
                }
                let mut coefficients = [T::ZERO; PAPER_ROW];
                snapshot(instant, slice_or_empty_mut(&mut coefficients, 0..rank));
                let shape = slice_or_empty_mut(&mut coefficients, 1..rank);
                match factor.get_mut(instant) {
                    Some(row) if instants <= SNAPSHOTS => {
                        row.iter_mut().zip(shape).for_each(|(row, shape)| *row = *shape);
                    }
                    _ => givens_update(slice_or_empty_mut(factor, 0..columns), shape),
                }
                if instant + 1 < instants {
                    BasisStage::Snapshot(instant + 1)
                } else {
                    BasisStage::Reflection {
                        done: 0,
                        open: count,
                        floor: T::ZERO,
                    }
                }
            }
            BasisStage::Reflection { done, open, floor } => {
                let residual = done..lane_end(done, columns);
                let (open, greatest) = lq::pivot(slice_or_empty_mut(factor, done..open), residual.clone(), floor);
                let open = done + open;
                let floor = if done == 0 {
                    greatest * T::from_f32(NEGLIGIBLE * NEGLIGIBLE)
                } else {
                    floor
                };
                // The reflections keep their rows, and the factor needs as many others.
                if done < open && done < columns && done < SNAPSHOTS / 2 {
                    lq::eliminate(slice_or_empty_mut(factor, done..open), residual);
                    BasisStage::Reflection {
                        done: done + 1,
                        open,
                        floor,
                    }
                } else {
                    BasisStage::Triangle { rank: done, row: done }
                }
            }
            BasisStage::Triangle { rank, row } if row < count => {
                if let Some((before, [row, ..])) = factor.split_at_mut_checked(row) {
                    let (_, triangle) = before.split_at_mut_checked(rank)?;
                    givens_update(triangle, slice_or_empty_mut(row, 0..rank));
                }
                BasisStage::Triangle { rank, row: row + 1 }
            }
            BasisStage::Triangle { rank, row } if row < count + rank => {
                let (reflections, triangle) = factor.split_at_mut_checked(rank)?;
                let mut coefficients = [T::ZERO; PAPER_ROW];
                let reflection = row - count;
                if let Some(row) = reflections.get(reflection) {
                    for (out, entry) in coefficients.iter_mut().zip(slice_or_empty(row, 0..reflection + 1)) {
                        *out = *entry;
                    }
                }
                givens_update(
                    slice_or_empty_mut(triangle, 0..rank),
                    slice_or_empty_mut(&mut coefficients, 0..rank),
                );
                BasisStage::Triangle { rank, row: row + 1 }
            }
            BasisStage::Triangle { rank, .. } => {
                let (_, triangle) = factor.split_at_mut_checked(rank)?;
                let rotations = jacobi::Rotations::new(
                    slice_or_empty(triangle, 0..rank),
                    lane_end(0, rank),
                    T::from_f32(NEGLIGIBLE / 4.0),
                );
                BasisStage::Rotations { rank, rotations }
            }
            BasisStage::Rotations {
                rank,
                ref mut rotations,
            } => {
                if rotations.advance(slice_or_empty_mut(factor, rank..2 * rank), lane_end(0, rank)) {
                    return Some(());
                }
                self.rows = [[T::ZERO; PAPER_ROW]; M];
                self.rows[0][0] = T::ONE;
                self.rank = 1;
                BasisStage::Mode { rank, floor: T::ZERO }
            }
            BasisStage::Mode { rank, floor } => {
                let (reflections, triangle) = factor.split_at_mut_checked(rank)?;
                let rows = slice_or_empty_mut(triangle, 0..rank);
                let mode = self.rows.get_mut(self.rank).filter(|_| self.rank < wanted)?;
                let shape = slice_or_empty_mut(mode, 1..PAPER_ROW);
                let sigma = jacobi::deflate(rows, slice_or_empty_mut(shape, 0..lane_end(0, rank)))
                    .filter(|sigma| *sigma > floor)?;
                for k in (0..rank).rev() {
                    let reflection = reflections.get(k)?;
                    let end = lane_end(k + 1, columns).min(PAPER_ROW - 1);
                    let tail = slice_or_empty(reflection, k + 1..end);
                    lq::reflect(tail, lq::beta(tail), slice_or_empty_mut(shape, k..end));
                }
                self.rank += 1;
                let floor = floor.max(sigma * T::EPSILON * T::from_index(columns));
                BasisStage::Mode { rank, floor }
            }
        };
        Some(())
    }

    /// The rows of W^T.
    pub(crate) fn rows(&self) -> &[[T; PAPER_ROW]] {
        slice_or_empty(&self.rows, 0..self.rank)
    }

    /// out <- W^T x: local coordinates of `rank` global coefficients, padded with zeros.
    pub(crate) fn project(&self, x: &[T; PAPER_ROW], rank: usize, out: &mut [T; M]) {
        out.fill(T::ZERO);
        let columns = 0..lane_end(0, rank);
        for (out, row) in out.iter_mut().zip(self.rows()) {
            *out = dot(slice_or_empty(row, columns.clone()), slice_or_empty(x, columns.clone()));
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

/// End of a range of columns, rounded up to a multiple of the lanes: products over the zeros that follow are cheaper
/// than a remainder.
fn lane_end(start: usize, end: usize) -> usize {
    (start + (end - start).next_multiple_of(LANES)).min(PAPER_ROW)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Coefficients of a motion with rates that are far apart, at equal distances in time.
    fn motion(instant: usize, out: &mut [f32]) {
        let t = 0.3 * instant as f32;
        for (k, out) in out.iter_mut().enumerate() {
            let size = 10.0 * 0.5_f32.powi(k as i32 / 2);
            *out = size * (t * (1 + 7 * k % 13) as f32 / 4.0).sin();
        }
    }

    fn basis(instants: usize) -> Basis<f32, 10> {
        let (mut basis, mut factor) = (Basis::EMPTY, [[0.0; PAPER_ROW]; SNAPSHOTS]);
        let mut stage = BasisStage::START;
        while basis.step(&mut stage, 40, motion, instants, 10, &mut factor).is_some() {}
        basis
    }

    /// Sum of the squared distances of the snapshots from the span of a basis.
    fn residual(basis: &[[f32; PAPER_ROW]], instants: usize) -> f64 {
        let mut sum = 0.0;
        for instant in 0..instants {
            let mut x = [0.0; PAPER_ROW];
            motion(instant, &mut x[..40]);
            let mut rest = x.map(f64::from);
            for row in basis {
                let row = row.map(f64::from);
                let share = dot(&row, &rest);
                add_scaled(&mut rest, -share, &row);
            }
            sum += dot(&rest, &rest);
        }
        sum
    }

    #[test]
    #[cfg_attr(miri, ignore = "too many rotations")]
    fn no_basis_of_the_rank_has_a_smaller_residual() {
        // Few snapshots are stored as they are, many are reduced to a triangular factor.
        for instants in [56, 100] {
            let basis = basis(instants);
            assert_eq!(basis.rank, 10);
            for (i, a) in basis.rows().iter().enumerate() {
                for (j, b) in basis.rows().iter().enumerate() {
                    assert!((dot(a, b) - f32::from(u8::from(i == j))).abs() < 3e-6);
                }
            }
            // The nine singular vectors by rotations of the snapshots themselves, in double precision.
            let mut shapes: [[f64; 40]; 100] = core::array::from_fn(|instant| {
                let mut x = [0.0; 40];
                motion(instant, &mut x);
                x[0] = 0.0;
                x.map(f64::from)
            });
            let shapes = &mut shapes[..instants];
            let mut rotations = jacobi::Rotations::new(shapes, 40, 0.0);
            while rotations.advance(shapes, 40) {}
            shapes.sort_unstable_by(|a, b| dot(a, a).total_cmp(&dot(b, b)));
            let least: f64 = shapes[..instants - 9].iter().map(|row| dot(row, row)).sum();
            let found = residual(basis.rows(), instants);
            assert!(found < (1.0 + 1e-4) * least, "{instants}: {found:e} {least:e}");
        }
    }
}
