//! Small dense kernels with a fixed order of accumulation, so that every target rounds alike.

pub(crate) mod cholesky;
pub(crate) mod jacobi;
mod qr;

pub(crate) use qr::{MOST_COLUMNS, Qr, symmetric_times};

use crate::Real;
use core::ops::Range;

/// Sums that a product is gathered in.
pub(crate) const LANES: usize = 8;

/// The entries in a range; none where the slice does not hold it. What the kernels work on is sized by validation, so
/// the range is always there, but the compiler cannot know; this way no panic is linked.
pub(crate) fn part<T>(x: &[T], range: Range<usize>) -> &[T] {
    x.get(range).unwrap_or_default()
}

/// As [`part`], to write to.
pub(crate) fn part_mut<T>(x: &mut [T], range: Range<usize>) -> &mut [T] {
    x.get_mut(range).unwrap_or_default()
}

/// Dot product of stored entries with a vector of the same length. Entry i goes to lane i mod 8 and the lanes are added in
/// pairs: wide enough to vectorise, and the same sum whatever the target's vectors are, and however many zeros follow.
#[inline(always)]
pub(crate) fn dot_by<E: Copy, T: Real>(a: &[E], x: &[T], value: impl Fn(E) -> T) -> T {
    let mut lanes = [T::ZERO; LANES];
    let (a_chunks, a_rest) = a.as_chunks::<LANES>();
    let (x_chunks, x_rest) = x.as_chunks::<LANES>();
    for (a, x) in a_chunks.iter().zip(x_chunks) {
        lanes = add_products(lanes, values(a, &value), *x);
    }
    if !a_rest.is_empty() {
        lanes = add_products(lanes, padded(a_rest, &value), padded(x_rest, &|x| x));
    }
    sum(lanes)
}

/// As [`dot_by`], with some vectors in one pass over the entries.
#[inline(always)]
pub(crate) fn dots_by<E: Copy, T: Real, const B: usize>(a: &[E], x: [&[T]; B], value: impl Fn(E) -> T) -> [T; B] {
    if B == 1 {
        return x.map(|x| dot_by(a, x, &value));
    }
    let mut lanes = [[T::ZERO; LANES]; B];
    let (a_chunks, a_rest) = a.as_chunks::<LANES>();
    let (x_chunks, x_rest) = (x.map(|x| x.as_chunks::<LANES>().0), x.map(|x| x.as_chunks::<LANES>().1));
    for (i, a) in a_chunks.iter().enumerate() {
        let values = values(a, &value);
        for (lanes, x) in lanes.iter_mut().zip(&x_chunks) {
            let Some(x) = x.get(i) else { continue };
            *lanes = add_products(*lanes, values, *x);
        }
    }
    if !a_rest.is_empty() {
        let values = padded(a_rest, &value);
        for (lanes, x) in lanes.iter_mut().zip(x_rest) {
            *lanes = add_products(*lanes, values, padded(x, &|x| x));
        }
    }
    lanes.map(sum)
}

/// The values of eight entries.
#[inline(always)]
fn values<E: Copy, T: Real>([a, b, c, d, e, f, g, h]: &[E; LANES], value: &impl Fn(E) -> T) -> [T; LANES] {
    [
        value(*a),
        value(*b),
        value(*c),
        value(*d),
        value(*e),
        value(*f),
        value(*g),
        value(*h),
    ]
}

/// The values of fewer than eight entries, and zeros.
fn padded<E: Copy, T: Real>(entries: &[E], value: &impl Fn(E) -> T) -> [T; LANES] {
    core::array::from_fn(|i| entries.get(i).map_or(T::ZERO, |entry| value(*entry)))
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
