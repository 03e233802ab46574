//! Local POD basis of a query (eqs. 32 to 39), computed in reduced coordinates.
//!
//! The global modes are orthonormal, so the POD of the N_x-sized pseudo-snapshots is the POD of their coefficients: the
//! local modes are Phi W. The translation stays its own coordinate: the first local mode is the translation, the others
//! are the leading left singular vectors of the shape's coefficients. The snapshots of one query fill few directions.
//! So reflections turn them, the longest rest first, until what is left of all is negligible (a pivoted LQ
//! factorisation, in place); a triangular factor gathers the few coordinates that remain; and rotations make its rows
//! orthogonal. It is an upper one: its rows become shorter as the coordinates do, and few rotations are left to do.
//! Nothing is squared on the way: the condition stays that of the snapshots.

use crate::Real;
use crate::linalg::{LANES, add_scaled, dot, jacobi, slice_or_empty, slice_or_empty_mut};
use crate::workspace::{Factor, PAPER_ROW, SNAPSHOTS};
use core::ops::Range;

/// A local basis: `rank` orthonormal rows of W^T over the global coefficients.
#[derive(Clone, Debug)]
pub(crate) struct Basis<T, const M: usize> {
    rank: usize,
    rows: [[T; PAPER_ROW]; M],
}

/// Greatest part of a snapshot that may be left, as a share of the longest: below the error of the method by far, and
/// above the digits in which the model is stored.
const NEGLIGIBLE: f32 = 1e-4;

/// How far a basis is learned.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Learning<T> {
    /// The snapshot to take next.
    Snapshot(usize),
    /// The direction to find next. Rows from `done` to before `open` have more left than `floor`, the square of what is
    /// negligible.
    Direction { done: usize, open: usize, floor: T },
    /// The row to add to the factor of the first `rank` columns next. The factor lies in as many rows behind those of
    /// the reflections, which come last.
    Gathering { rank: usize, row: usize },
    /// The rotations of that factor.
    Rotations {
        rank: usize,
        rotations: jacobi::Rotations<T>,
    },
    /// The mode to take from it next, if it is longer than `floor`.
    Mode { rank: usize, floor: T },
}

impl<T> Learning<T> {
    pub(crate) const START: Self = Self::Snapshot(0);
}

impl<T: Real, const M: usize> Basis<T, M> {
    pub(crate) const EMPTY: Self = Self {
        rank: 0,
        rows: [[T::ZERO; PAPER_ROW]; M],
    };

    /// A piece of the work of finding a field's basis from its snapshots at all stored instants: one snapshot, one
    /// direction, one row of their factor or one mode. Returns none when nothing is left to do. `snapshot` gives the
    /// `rank` coefficients at a stored instant. `factor` is room for the snapshots, left alone between the pieces. The
    /// local rank is at most `wanted`, and less where the snapshots have no more.
    pub(crate) fn learn(
        &mut self,
        learning: &mut Learning<T>,
        rank: usize,
        mut snapshot: impl FnMut(usize, &mut [T]),
        instants: usize,
        wanted: usize,
        factor: &mut Factor<T>,
    ) -> Option<()> {
        let columns = rank - 1;
        // More snapshots than there is room for go into a triangular factor at once.
        let count = if instants > SNAPSHOTS { columns } else { instants };
        *learning = match *learning {
            Learning::Snapshot(instant) => {
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
                    _ => absorb(slice_or_empty_mut(factor, 0..columns), shape),
                }
                if instant + 1 < instants {
                    Learning::Snapshot(instant + 1)
                } else {
                    Learning::Direction {
                        done: 0,
                        open: count,
                        floor: T::ZERO,
                    }
                }
            }
            Learning::Direction { done, open, floor } => {
                let rest = done..whole(done, columns);
                let (open, longest) = sort(slice_or_empty_mut(factor, done..open), rest.clone(), floor);
                let open = done + open;
                let floor = if done == 0 {
                    longest * T::from_f32(NEGLIGIBLE * NEGLIGIBLE)
                } else {
                    floor
                };
                // The reflections stay in their rows, and the factor takes as many others.
                if done < open && done < columns && done < SNAPSHOTS / 2 {
                    reflect(slice_or_empty_mut(factor, done..open), rest);
                    Learning::Direction {
                        done: done + 1,
                        open,
                        floor,
                    }
                } else {
                    Learning::Gathering { rank: done, row: done }
                }
            }
            Learning::Gathering { rank, row } if row < count => {
                if let Some((before, [row, ..])) = factor.split_at_mut_checked(row) {
                    let (_, gathered) = before.split_at_mut_checked(rank)?;
                    absorb(gathered, slice_or_empty_mut(row, 0..rank));
                }
                Learning::Gathering { rank, row: row + 1 }
            }
            Learning::Gathering { rank, row } if row < count + rank => {
                let (reflections, gathered) = factor.split_at_mut_checked(rank)?;
                let mut coefficients = [T::ZERO; PAPER_ROW];
                let reflection = row - count;
                if let Some(row) = reflections.get(reflection) {
                    for (out, entry) in coefficients.iter_mut().zip(slice_or_empty(row, 0..reflection + 1)) {
                        *out = *entry;
                    }
                }
                absorb(
                    slice_or_empty_mut(gathered, 0..rank),
                    slice_or_empty_mut(&mut coefficients, 0..rank),
                );
                Learning::Gathering { rank, row: row + 1 }
            }
            Learning::Gathering { rank, .. } => {
                let (_, gathered) = factor.split_at_mut_checked(rank)?;
                let rotations = jacobi::Rotations::new(
                    slice_or_empty(gathered, 0..rank),
                    whole(0, rank),
                    T::from_f32(NEGLIGIBLE / 4.0),
                );
                Learning::Rotations { rank, rotations }
            }
            Learning::Rotations {
                rank,
                ref mut rotations,
            } => {
                if rotations.advance(slice_or_empty_mut(factor, rank..2 * rank), whole(0, rank)) {
                    return Some(());
                }
                self.rows = [[T::ZERO; PAPER_ROW]; M];
                self.rows[0][0] = T::ONE;
                self.rank = 1;
                Learning::Mode { rank, floor: T::ZERO }
            }
            Learning::Mode { rank, floor } => {
                let (reflections, gathered) = factor.split_at_mut_checked(rank)?;
                let rows = slice_or_empty_mut(gathered, 0..rank);
                let mode = self.rows.get_mut(self.rank).filter(|_| self.rank < wanted)?;
                let shape = slice_or_empty_mut(mode, 1..PAPER_ROW);
                let length = take_longest(rows, slice_or_empty_mut(shape, 0..whole(0, rank)))
                    .filter(|length| *length > floor)?;
                for k in (0..rank).rev() {
                    let reflection = reflections.get(k)?;
                    let end = whole(k + 1, columns).min(PAPER_ROW - 1);
                    let rest = slice_or_empty(reflection, k + 1..end);
                    mirror(rest, factor_of(rest), slice_or_empty_mut(shape, k..end));
                }
                self.rank += 1;
                let floor = floor.max(length * T::EPSILON * T::from_index(columns));
                Learning::Mode { rank, floor }
            }
        };
        Some(())
    }

    /// The rows of W^T.
    pub(crate) fn rows(&self) -> &[[T; PAPER_ROW]] {
        slice_or_empty(&self.rows, 0..self.rank)
    }

    /// out <- W^T x: local coordinates of `rank` global coefficients, which zeros follow.
    pub(crate) fn project(&self, x: &[T; PAPER_ROW], rank: usize, out: &mut [T; M]) {
        out.fill(T::ZERO);
        let columns = 0..whole(0, rank);
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

/// The end of a range of columns that fills the lanes of a product: zeros follow the columns that count, and a rest
/// that does not fill them costs more than they do.
fn whole(start: usize, end: usize) -> usize {
    (start + (end - start).next_multiple_of(LANES)).min(PAPER_ROW)
}

/// Sorts rows by the length of what these columns have, as far as it matters: the longest goes first, and those with a
/// square of at most `floor`, whose rest becomes 0, go last. Returns how many are before these, and the greatest
/// square.
#[inline(never)]
fn sort<T: Real>(rows: &mut [[T; PAPER_ROW]], columns: Range<usize>, floor: T) -> (usize, T) {
    let (mut open, mut longest, mut place) = (rows.len(), T::ZERO, 0);
    let mut i = 0;
    while let Some(row) = slice_or_empty_mut(rows, 0..open).get_mut(i) {
        let rest = slice_or_empty_mut(row, columns.clone());
        let square = dot(rest, rest);
        if square > floor {
            if square > longest {
                (longest, place) = (square, i);
            }
            i += 1;
        } else {
            rest.fill(T::ZERO);
            open -= 1;
            swap(rows, i, open);
        }
    }
    swap(rows, 0, place);
    (open, longest)
}

fn swap<R>(rows: &mut [R], i: usize, j: usize) {
    if let Ok([a, b]) = rows.get_disjoint_mut([i, j]) {
        core::mem::swap(a, b);
    }
}

/// Reflects rows so that the first has a single entry in these columns, and leaves the direction of the reflection,
/// whose first component is 1, in its place.
#[inline(never)]
fn reflect<T: Real>(rows: &mut [[T; PAPER_ROW]], columns: Range<usize>) {
    let Some((first, others)) = rows.split_first_mut() else {
        return;
    };
    let Some((head, rest)) = slice_or_empty_mut(first, columns.clone()).split_first_mut() else {
        return;
    };
    let length = (*head * *head + dot(rest, rest)).sqrt();
    let entry = if *head > T::ZERO { -length } else { length };
    let scale = T::ONE / (*head - entry);
    rest.iter_mut().for_each(|x| *x *= scale);
    *head = entry;
    let factor = factor_of(rest);
    for other in others {
        mirror(rest, factor, slice_or_empty_mut(other, columns.clone()));
    }
}

/// What a component along the direction (1, `rest`) is multiplied with in the reflection.
fn factor_of<T: Real>(rest: &[T]) -> T {
    T::from_f32(2.0) / (T::ONE + dot(rest, rest))
}

/// Reflects x along the direction (1, `rest`).
fn mirror<T: Real>(rest: &[T], factor: T, x: &mut [T]) {
    if let Some((head, tail)) = x.split_first_mut() {
        let component = factor * (*head + dot(rest, tail));
        *head -= component;
        add_scaled(tail, -component, rest);
    }
}

/// out <- the direction of the longest row, which is taken out of all rows: the rotations leave them orthogonal but for
/// what is negligible. Returns the length.
#[inline(never)]
fn take_longest<T: Real>(rows: &mut [[T; PAPER_ROW]], out: &mut [T]) -> Option<T> {
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
        let share = dot(row, out);
        add_scaled(row, -share, out);
    }
    Some(length)
}

/// Rotates a snapshot into the upper triangular factor of those before it (Givens rotations); what is left of it
/// continues the factor, if that has fewer rows.
fn absorb<T: Real>(factor: &mut [[T; PAPER_ROW]], snapshot: &mut [T]) {
    let end = snapshot.len();
    for (k, row) in factor.iter_mut().enumerate() {
        let (row, snapshot) = (slice_or_empty_mut(row, k..end), slice_or_empty_mut(snapshot, k..end));
        let (Some(&a), Some(&b)) = (row.first(), snapshot.first()) else {
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
        let mut factor = [[0.0; PAPER_ROW]; 4];
        for mut snapshot in snapshots {
            absorb(&mut factor, &mut snapshot);
        }
        for i in 0..4 {
            for j in 0..4 {
                let direct: f64 = snapshots.iter().map(|x| x[i] * x[j]).sum();
                let factored: f64 = factor.iter().map(|row| row[i] * row[j]).sum();
                assert!((direct - factored).abs() < 1e-12 * direct.abs().max(1.0));
                assert!(i <= j || factor[i][j].abs() < 1e-12);
            }
        }
    }

    /// Coefficients of a motion with rates that are far apart, at equal distances in time.
    fn motion(instant: usize, out: &mut [f32]) {
        let t = 0.3 * instant as f32;
        for (k, out) in out.iter_mut().enumerate() {
            let size = 10.0 * 0.5_f32.powi(k as i32 / 2);
            *out = size * (t * (1 + 7 * k % 13) as f32 / 4.0).sin();
        }
    }

    fn learned(instants: usize) -> Basis<f32, 10> {
        let (mut basis, mut factor) = (Basis::EMPTY, [[0.0; PAPER_ROW]; SNAPSHOTS]);
        let mut learning = Learning::START;
        while basis
            .learn(&mut learning, 40, motion, instants, 10, &mut factor)
            .is_some()
        {}
        basis
    }

    /// The square of what a basis leaves of the motion.
    fn left(basis: &[[f32; PAPER_ROW]], instants: usize) -> f64 {
        let mut left = 0.0;
        for instant in 0..instants {
            let mut x = [0.0; PAPER_ROW];
            motion(instant, &mut x[..40]);
            let mut rest = x.map(f64::from);
            for row in basis {
                let row = row.map(f64::from);
                let share = dot(&row, &rest);
                add_scaled(&mut rest, -share, &row);
            }
            left += dot(&rest, &rest);
        }
        left
    }

    #[test]
    #[cfg_attr(miri, ignore = "too many rotations")]
    fn no_basis_of_the_rank_leaves_less() {
        // Few snapshots are taken as they are, many into a triangular factor at once.
        for instants in [56, 100] {
            let basis = learned(instants);
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
            let found = left(basis.rows(), instants);
            assert!(found < (1.0 + 1e-4) * least, "{instants}: {found:e} {least:e}");
        }
    }
}
