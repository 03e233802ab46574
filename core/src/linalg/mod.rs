//! Small dense linear algebra with a fixed order of sums, so that every target computes the same bits.
//!
//! `qr` and `cholesky` solve the interpolation's systems; `lq`, `givens` and `jacobi` are the singular value
//! decomposition of the paper's method; `ldl` is its fit of three unknowns; `gram_schmidt` fits the stencils of the
//! mechanics. `products` multiplies quantised matrices. Vector operations are below.

pub(crate) mod cholesky;
pub(crate) mod givens;
pub(crate) mod gram_schmidt;
pub(crate) mod jacobi;
pub(crate) mod ldl;
pub(crate) mod lq;
mod products;
mod qr;
mod real;
mod vectors;

pub use products::ProductScalar;
pub(crate) use products::{Block, TWO_PANELS};
pub(crate) use qr::{MAX_COLUMNS, Qr, symmetric_times};
pub use real::Real;
pub(crate) use vectors::in_vectors;

use core::ops::Range;

/// Numbers that are added side by side: rows of a panel.
pub const LANES: usize = 8;

/// The entries in a range; none where the slice does not hold it. Validation sizes the slices, so the range is always
/// there, but the compiler cannot know it: this way no panic is linked.
pub(crate) fn slice_or_empty<T>(x: &[T], range: Range<usize>) -> &[T] {
    x.get(range).unwrap_or_default()
}

/// As [`slice_or_empty`], to write to.
pub(crate) fn slice_or_empty_mut<T>(x: &mut [T], range: Range<usize>) -> &mut [T] {
    x.get_mut(range).unwrap_or_default()
}

/// Dot product of two vectors. Entry i is added to lane i mod 8 and the lanes are added in pairs: wide enough to
/// vectorise, and the same sum for every vector width and every number of trailing zeros.
pub(crate) fn dot<T: Real>(a: &[T], x: &[T]) -> T {
    let mut lanes = [T::ZERO; LANES];
    let (a_chunks, a_rest) = a.as_chunks::<LANES>();
    let (x_chunks, x_rest) = x.as_chunks::<LANES>();
    for (a, x) in a_chunks.iter().zip(x_chunks) {
        lanes = add_products(lanes, *a, *x);
    }
    // A copy, so that the compiler keeps the lanes of the loop above in registers.
    let mut sums = lanes;
    for (sum, (a, x)) in sums.iter_mut().zip(a_rest.iter().zip(x_rest)) {
        *sum += *a * *x;
    }
    let [a, b, c, d, e, f, g, h] = sums;
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}

/// lanes + a x, lane by lane.
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

/// Dot product of two short vectors, in order: lanes are faster from a few dozen entries on.
pub(crate) fn dot_in_order<T: Real>(a: &[T], x: &[T]) -> T {
    a.iter().zip(x).fold(T::ZERO, |sum, (a, x)| sum + *a * *x)
}

/// y <- y + factor times stored entries.
pub(crate) fn add_by<E: Copy, T: Real>(y: &mut [T], factor: T, entries: &[E], value: impl Fn(E) -> T) {
    for (y, entry) in y.iter_mut().zip(entries) {
        *y += value(*entry) * factor;
    }
}

/// y <- y + factor x.
pub(crate) fn add_scaled<T: Real>(y: &mut [T], factor: T, x: &[T]) {
    add_by(y, factor, x, |value| value);
}
