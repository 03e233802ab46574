//! Small dense kernels with a fixed order of accumulation, so that every target rounds alike.

pub(crate) mod cholesky;
pub(crate) mod jacobi;
mod qr;

pub(crate) use qr::{MOST_COLUMNS, Qr, symmetric_times};

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

/// Dot product of stored entries with a vector of the same length.
pub(crate) fn dot_by<E: Copy, T: Real>(a: &[E], x: &[T], value: impl Fn(E) -> T) -> T {
    let [dot] = dots_by(a, [x], value);
    dot
}

/// Dot products of stored entries with some vectors of the same length. Entry i goes to lane i mod 8 and the lanes
/// are added in pairs: wide enough to vectorise, and the same sum whatever the target's vectors are, however many
/// zeros follow, and however many products are taken at once.
#[inline(always)]
pub(crate) fn dots_by<E: Copy, T: Real, const B: usize>(a: &[E], x: [&[T]; B], value: impl Fn(E) -> T) -> [T; B] {
    let mut lanes = [[T::ZERO; LANES]; B];
    let (a_chunks, a_rest) = a.as_chunks::<LANES>();
    let (x_chunks, x_rest) = (x.map(|x| x.as_chunks::<LANES>().0), x.map(|x| x.as_chunks::<LANES>().1));
    for (i, a) in a_chunks.iter().enumerate() {
        let [a0, a1, a2, a3, a4, a5, a6, a7] = *a;
        let values = [
            value(a0),
            value(a1),
            value(a2),
            value(a3),
            value(a4),
            value(a5),
            value(a6),
            value(a7),
        ];
        for (lanes, x) in lanes.iter_mut().zip(&x_chunks) {
            let Some(x) = x.get(i) else { continue };
            *lanes = add_products(*lanes, values, *x);
        }
    }
    if !a_rest.is_empty() {
        let values = core::array::from_fn(|i| a_rest.get(i).map_or(T::ZERO, |a| value(*a)));
        for (lanes, x) in lanes.iter_mut().zip(x_rest) {
            let x = core::array::from_fn(|i| x.get(i).copied().unwrap_or(T::ZERO));
            *lanes = add_products(*lanes, values, x);
        }
    }
    lanes.map(sum)
}

/// lanes + a x, lane by lane. Written out, because code that is optimised for size would keep a loop, and the lanes in
/// memory.
#[inline(always)]
fn add_products<T: Real>(lanes: [T; LANES], a: [T; LANES], x: [T; LANES]) -> [T; LANES] {
    let [l0, l1, l2, l3, l4, l5, l6, l7] = lanes;
    let [a0, a1, a2, a3, a4, a5, a6, a7] = a;
    let [x0, x1, x2, x3, x4, x5, x6, x7] = x;
    [
        l0 + a0 * x0,
        l1 + a1 * x1,
        l2 + a2 * x2,
        l3 + a3 * x3,
        l4 + a4 * x4,
        l5 + a5 * x5,
        l6 + a6 * x6,
        l7 + a7 * x7,
    ]
}

/// The sum of the lanes.
fn sum<T: Real>([a, b, c, d, e, f, g, h]: [T; LANES]) -> T {
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}

/// Dot product of two vectors.
pub(crate) fn dot<T: Real>(a: &[T], x: &[T]) -> T {
    dot_by(a, x, |value| value)
}

/// Dot product of two short vectors, in order: lanes pay for themselves from a few dozen entries on.
pub(crate) fn dot_in_order<T: Real>(a: &[T], x: &[T]) -> T {
    a.iter().zip(x).fold(T::ZERO, |sum, (a, x)| sum + *a * *x)
}

/// y <- y + factor times stored entries.
pub(crate) fn add_by<E: Copy, T: Real>(y: &mut [T], factor: T, entries: &[E], value: impl Fn(E) -> T) {
    for (y, entry) in y.iter_mut().zip(entries) {
        *y += factor * value(*entry);
    }
}

/// y <- y + factor x.
pub(crate) fn add_scaled<T: Real>(y: &mut [T], factor: T, x: &[T]) {
    add_by(y, factor, x, |value| value);
}
