//! Small dense kernels with a fixed order of accumulation, so that every target rounds alike.

pub(crate) mod cholesky;
pub(crate) mod jacobi;
mod qr;

pub(crate) use qr::Qr;

use crate::Real;
use core::ops::Range;

const LANES: usize = 8;

/// The entries in a range; none where the slice does not hold it. What the kernels work on is sized by validation, so
/// the range is always there, but the compiler cannot know; this way no panic is linked.
pub(crate) fn part<T>(x: &[T], range: Range<usize>) -> &[T] {
    x.get(range).unwrap_or_default()
}

/// As [`part`], to write to.
pub(crate) fn part_mut<T>(x: &mut [T], range: Range<usize>) -> &mut [T] {
    x.get_mut(range).unwrap_or_default()
}

/// Dot product of stored entries with a vector of the same length. Entry i goes to lane i mod 8 and the lanes
/// are added in pairs: wide enough to vectorise, and the same sum whatever the target's vectors are.
pub(crate) fn dot_by<E: Copy, T: Real>(a: &[E], x: &[T], value: impl Fn(E) -> T) -> T {
    let mut lanes = [T::ZERO; LANES];
    let (a_chunks, a_rest) = a.as_chunks::<LANES>();
    let (x_chunks, x_rest) = x.as_chunks::<LANES>();
    for (a, x) in a_chunks.iter().zip(x_chunks) {
        for lane in 0..LANES {
            lanes[lane] += value(a[lane]) * x[lane];
        }
    }
    for ((lane, a), x) in lanes.iter_mut().zip(a_rest).zip(x_rest) {
        *lane += value(*a) * *x;
    }
    let [a, b, c, d, e, f, g, h] = lanes;
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}

/// As [`dot_by`], of entries that have units of the same length.
pub(crate) fn dot_scaled<E: Copy, U: Copy, T: Real>(a: &[E], units: &[U], x: &[T], value: impl Fn(E, U) -> T) -> T {
    let mut lanes = [T::ZERO; LANES];
    let (a_chunks, a_rest) = a.as_chunks::<LANES>();
    let (unit_chunks, unit_rest) = units.as_chunks::<LANES>();
    let (x_chunks, x_rest) = x.as_chunks::<LANES>();
    for ((a, units), x) in a_chunks.iter().zip(unit_chunks).zip(x_chunks) {
        for lane in 0..LANES {
            lanes[lane] += value(a[lane], units[lane]) * x[lane];
        }
    }
    for (((lane, a), unit), x) in lanes.iter_mut().zip(a_rest).zip(unit_rest).zip(x_rest) {
        *lane += value(*a, *unit) * *x;
    }
    let [a, b, c, d, e, f, g, h] = lanes;
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}

/// Dot product of two vectors.
pub(crate) fn dot<T: Real>(a: &[T], x: &[T]) -> T {
    dot_by(a, x, |value| value)
}

/// y <- y + factor x.
pub(crate) fn add_scaled<T: Real>(y: &mut [T], factor: T, x: &[T]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += factor * *x;
    }
}
