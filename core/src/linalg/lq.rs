//! Steps of a Householder LQ factorisation of rows, in place, with row pivoting (Golub and Van Loan, Matrix
//! Computations, 2013, sections 5.1 and 5.4).
//!
//! A reflection is I - beta v v^T with v = (1, tail) and beta = 2 / v^T v. The tail is stored in the row that the
//! reflection was made of, behind the entry that the reflection left there.

use super::{add_scaled, dot, slice_or_empty_mut};
use crate::Real;
use core::ops::Range;

/// Pivots rows by their norm in these columns: the longest goes first, and rows with a squared norm of at most `floor`
/// go last, their entries set to 0. Returns how many rows exceed the floor, and the greatest squared norm.
#[inline(never)]
pub(crate) fn pivot<T: Real, const W: usize>(rows: &mut [[T; W]], columns: Range<usize>, floor: T) -> (usize, T) {
    let (mut open, mut greatest, mut longest) = (rows.len(), T::ZERO, 0);
    let mut i = 0;
    while let Some(row) = slice_or_empty_mut(rows, 0..open).get_mut(i) {
        let row = slice_or_empty_mut(row, columns.clone());
        let square = dot(row, row);
        if square > floor {
            if square > greatest {
                (greatest, longest) = (square, i);
            }
            i += 1;
        } else {
            row.fill(T::ZERO);
            open -= 1;
            swap(rows, i, open);
        }
    }
    swap(rows, 0, longest);
    (open, greatest)
}

fn swap<R>(rows: &mut [R], i: usize, j: usize) {
    if let Ok([a, b]) = rows.get_disjoint_mut([i, j]) {
        core::mem::swap(a, b);
    }
}

/// Reflects rows so that the first has a single entry in these columns, and stores the reflection's tail behind it.
#[inline(never)]
pub(crate) fn eliminate<T: Real, const W: usize>(rows: &mut [[T; W]], columns: Range<usize>) {
    let Some((first, others)) = rows.split_first_mut() else {
        return;
    };
    let Some((head, tail)) = slice_or_empty_mut(first, columns.clone()).split_first_mut() else {
        return;
    };
    let length = (*head * *head + dot(tail, tail)).sqrt();
    let entry = if *head > T::ZERO { -length } else { length };
    let scale = T::ONE / (*head - entry);
    tail.iter_mut().for_each(|x| *x *= scale);
    *head = entry;
    let beta = beta(tail);
    for other in others {
        reflect(tail, beta, slice_or_empty_mut(other, columns.clone()));
    }
}

/// 2 / v^T v of the reflection with v = (1, tail).
pub(crate) fn beta<T: Real>(tail: &[T]) -> T {
    T::from_f32(2.0) / (T::ONE + dot(tail, tail))
}

/// x <- (I - beta v v^T) x with v = (1, tail).
pub(crate) fn reflect<T: Real>(tail: &[T], beta: T, x: &mut [T]) {
    if let Some((head, rest)) = x.split_first_mut() {
        let component = beta * (*head + dot(tail, rest));
        *head -= component;
        add_scaled(rest, -component, tail);
    }
}
