//! Small dense kernels with a fixed order of accumulation, so that every target rounds alike.

pub(crate) mod cholesky;
pub(crate) mod jacobi;
mod qr;
mod vectors;

pub(crate) use qr::{MOST_COLUMNS, Qr, symmetric_times};
pub(crate) use vectors::{IN_PAIRS, in_vectors};

use crate::Real;
use core::ops::Range;

/// Numbers that are added side by side.
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

/// lanes <- lanes + a panel times some vectors: the entries of a column times the vectors' entries of its number. Eight rows
/// lie side by side, so that every target adds them as it can and comes to the same sums.
#[inline(always)]
pub(crate) fn add_panel<E: Copy, T: Real, const B: usize>(
    panel: &[[E; LANES]],
    x: &[[T; B]],
    value: impl Fn(E) -> T,
    lanes: &mut [[T; LANES]; B],
) {
    // A copy stays in registers.
    let mut sums = *lanes;
    for (entries, x) in panel.iter().zip(x) {
        for (sums, x) in sums.iter_mut().zip(x) {
            *sums = add_column(*sums, entries, *x, &value);
        }
    }
    *lanes = sums;
}

/// A panel with entries of one byte times vector number `b`, in wholes.
pub(crate) fn whole_panel<T: Real, const B: usize>(
    panel: &[[u8; LANES]],
    x: &[[T::Whole; B]],
    b: usize,
) -> [T::Whole; LANES] {
    // Four sums, the entry and the factor are as much as a Cortex-M has registers for beside what it needs to get them.
    let [p, q, r, s] = whole_half::<T, B, 0>(panel, x, b);
    let [t, u, v, w] = whole_half::<T, B, 4>(panel, x, b);
    [p, q, r, s, t, u, v, w]
}

/// Four rows of it, from row `FIRST` on.
#[inline(never)]
fn whole_half<T: Real, const B: usize, const FIRST: usize>(
    panel: &[[u8; LANES]],
    x: &[[T::Whole; B]],
    b: usize,
) -> [T::Whole; 4] {
    let [mut p, mut q, mut r, mut s] = [T::NO_WHOLE; 4];
    for (entries, x) in panel.iter().zip(x) {
        let (entry, x) = (|lane: usize| entries[FIRST + lane].cast_signed(), x[b]);
        p = T::add_product(p, entry(0), x);
        q = T::add_product(q, entry(1), x);
        r = T::add_product(r, entry(2), x);
        s = T::add_product(s, entry(3), x);
    }
    [p, q, r, s]
}

/// As [`add_panels`], of entries of one byte, in wholes.
#[inline(always)]
pub(crate) fn add_whole_panels<T: Real, const B: usize, const P: usize>(
    panels: [&[[u8; LANES]]; P],
    x: &[[T::Whole; B]],
    lanes: &mut [[[T::Whole; LANES]; B]; P],
) {
    add_columns(panels, x, lanes, add_whole_column::<T>);
}

/// As [`add_column`], of wholes.
#[inline(always)]
fn add_whole_column<T: Real>(
    [l0, l1, l2, l3, l4, l5, l6, l7]: [T::Whole; LANES],
    [a0, a1, a2, a3, a4, a5, a6, a7]: &[u8; LANES],
    x: T::Whole,
) -> [T::Whole; LANES] {
    let add = |sum, entry: &u8| T::add_product(sum, entry.cast_signed(), x);
    [
        add(l0, a0),
        add(l1, a1),
        add(l2, a2),
        add(l3, a3),
        add(l4, a4),
        add(l5, a5),
        add(l6, a6),
        add(l7, a7),
    ]
}

/// As [`add_panel`] for several panels at a time, which have as many columns: a sum waits for the one before, and meanwhile
/// those of the other panels go on.
#[inline(always)]
pub(crate) fn add_panels<E: Copy, T: Real, const B: usize, const P: usize>(
    panels: [&[[E; LANES]]; P],
    x: &[[T; B]],
    value: impl Fn(E) -> T,
    lanes: &mut [[[T; LANES]; B]; P],
) {
    add_columns(panels, x, lanes, |sums, entries, x| {
        add_column(sums, entries, x, &value)
    });
}

/// Goes through the columns of some panels with the vectors' entries of their numbers.
#[inline(always)]
fn add_columns<E, X: Copy, S: Copy, const B: usize, const P: usize>(
    panels: [&[[E; LANES]]; P],
    x: &[[X; B]],
    lanes: &mut [[[S; LANES]; B]; P],
    add: impl Fn([S; LANES], &[E; LANES], X) -> [S; LANES],
) {
    // One length for all, so that the loop looks at one.
    let count = panels.iter().fold(x.len(), |count, panel| count.min(panel.len()));
    let (panels, x) = (panels.map(|panel| part(panel, 0..count)), part(x, 0..count));
    let mut sums = *lanes;
    for (column, x) in x.iter().enumerate() {
        for (sums, panel) in sums.iter_mut().zip(panels) {
            let Some(entries) = panel.get(column) else { continue };
            for (sums, x) in sums.iter_mut().zip(x) {
                *sums = add(*sums, entries, *x);
            }
        }
    }
    *lanes = sums;
}

/// lanes + a column times x. Written out, because code that is optimised for size would keep a loop, and the lanes in
/// memory.
#[inline(always)]
fn add_column<E: Copy, T: Real>(
    [l0, l1, l2, l3, l4, l5, l6, l7]: [T; LANES],
    [a0, a1, a2, a3, a4, a5, a6, a7]: &[E; LANES],
    x: T,
    value: &impl Fn(E) -> T,
) -> [T; LANES] {
    [
        l0 + value(*a0) * x,
        l1 + value(*a1) * x,
        l2 + value(*a2) * x,
        l3 + value(*a3) * x,
        l4 + value(*a4) * x,
        l5 + value(*a5) * x,
        l6 + value(*a6) * x,
        l7 + value(*a7) * x,
    ]
}

/// Dot product of two vectors. Entry i goes to lane i mod 8 and the lanes are added in pairs: wide enough to vectorise, and
/// the same sum whatever the target's vectors are, and however many zeros follow.
pub(crate) fn dot<T: Real>(a: &[T], x: &[T]) -> T {
    let mut lanes = [T::ZERO; LANES];
    let (a_chunks, a_rest) = a.as_chunks::<LANES>();
    let (x_chunks, x_rest) = x.as_chunks::<LANES>();
    for (a, x) in a_chunks.iter().zip(x_chunks) {
        lanes = add_products(lanes, *a, *x);
    }
    // A copy, so that the loop above has its lanes in registers.
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

/// Dot product of two short vectors, in order: lanes pay for themselves from a few dozen entries on.
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
