//! Products of panels of small integers with vectors of whole numbers: sums that are exact, so that every target adds them as
//! it can, in any order, and comes to the same bits.

use super::LANES;
use crate::Real;

/// Two columns of a panel: for every two rows their entries in the first column, then those in the second.
pub(crate) type Block = [[u8; 4]; LANES / 2];

/// Whether products take two panels side by side: vectors hold the sums of both.
pub(crate) const IN_PAIRS: bool = cfg!(target_arch = "x86_64");

/// products <- panels times some vectors, each in its unit, whose entries come in pairs, one for every two columns.
#[inline(always)]
pub(crate) fn multiply<T: Real, const B: usize, const P: usize>(
    panels: [&[Block]; P],
    pairs: &[[T::Pair; B]],
    units: [T; B],
    products: &mut [[[T; LANES]; B]; P],
) {
    for (panel, products) in panels.iter().zip(products) {
        for (b, (products, unit)) in products.iter_mut().zip(units).enumerate() {
            // Four sums, the entries and the factors are as much as a Cortex-M has registers for beside what it needs to
            // get them.
            let (halves, _) = products.as_chunks_mut();
            if let [first, second] = halves {
                half::<T, B, 0>(panel, pairs, b, unit, first);
                half::<T, B, 2>(panel, pairs, b, unit, second);
            }
        }
    }
}

/// products <- four rows of a panel, from word `FIRST` of its blocks on, times vector number `b`.
#[inline(never)]
fn half<T: Real, const B: usize, const FIRST: usize>(
    panel: &[Block],
    pairs: &[[T::Pair; B]],
    b: usize,
    unit: T,
    products: &mut [T; 4],
) {
    let add = |[p, q, r, s]: [T::Whole; 4], block: &Block, pair: &[T::Pair; B]| {
        let [p, q] = T::add_products([p, q], block[FIRST], pair[b]);
        let [r, s] = T::add_products([r, s], block[FIRST + 1], pair[b]);
        [p, q, r, s]
    };
    // Two blocks at a time: half the steps.
    let count = panel.len().min(pairs.len());
    let (blocks, last) = super::part(panel, 0..count).as_chunks::<2>();
    let (pairs, last_pair) = super::part(pairs, 0..count).as_chunks::<2>();
    let mut sums = [T::NO_WHOLE; 4];
    for ([first, second], [pair, next]) in blocks.iter().zip(pairs) {
        sums = add(sums, first, pair);
        sums = add(sums, second, next);
    }
    for (block, pair) in last.iter().zip(last_pair) {
        sums = add(sums, block, pair);
    }
    let [p, q, r, s] = sums;
    *products = [
        unit * T::from_whole(p),
        unit * T::from_whole(q),
        unit * T::from_whole(r),
        unit * T::from_whole(s),
    ];
}

/// As [`multiply`], of singles.
#[cfg(not(target_arch = "x86_64"))]
#[inline(always)]
pub(crate) fn multiply_singles<const B: usize, const P: usize>(
    panels: [&[Block]; P],
    pairs: &[[u32; B]],
    units: [f32; B],
    products: &mut [[[f32; LANES]; B]; P],
) {
    multiply(panels, pairs, units, products);
}

/// As [`multiply`], of singles, by instructions of AVX2 if the machine knows them.
#[cfg(target_arch = "x86_64")]
pub(crate) fn multiply_singles<const B: usize, const P: usize>(
    panels: [&[Block]; P],
    pairs: &[[u32; B]],
    units: [f32; B],
    products: &mut [[[f32; LANES]; B]; P],
) {
    let Some(simd) = pulp::x86::V3::try_new() else {
        return multiply(panels, pairs, units, products);
    };
    for (panels, products) in panels.chunks(2).zip(products.chunks_mut(2)) {
        if let (Some(first), Some(second)) = (panels.first(), panels.last()) {
            let both = simd.vectorize(
                #[inline(always)]
                || side_by_side(simd, [first, second], pairs, units),
            );
            products
                .iter_mut()
                .zip(both)
                .for_each(|(products, both)| *products = both);
        }
    }
}

/// Two panels, which have as many columns, times some vectors.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn side_by_side<const B: usize>(
    simd: pulp::x86::V3,
    [first, second]: [&[Block]; 2],
    pairs: &[[u32; B]],
    units: [f32; B],
) -> [[[f32; LANES]; B]; 2] {
    // One length for all, so that the loop looks at one.
    let count = pairs.len().min(first.len()).min(second.len());
    let [first, second] = [first, second].map(|panel| super::part(panel, 0..count));
    // Of the first row of every two, and of the second: four of one panel, then four of the other.
    let mut sums = [[simd.splat_i32x8(0); 2]; B];
    for ((first, second), pairs) in first.iter().zip(second).zip(pairs) {
        let entries: pulp::i16x16 = pulp::cast([*first, *second]);
        let rows = [
            simd.shr_const_i16x16::<8>(simd.shl_const_i16x16::<8>(entries)),
            simd.shr_const_i16x16::<8>(entries),
        ];
        for (sums, pair) in sums.iter_mut().zip(pairs) {
            let pair = pulp::cast(simd.splat_i32x8(pair.cast_signed()));
            for (sum, entries) in sums.iter_mut().zip(rows) {
                let products = simd.multiply_wrapping_add_adjacent_i16x16(entries, pair);
                *sum = simd.wrapping_add_i32x8(*sum, products);
            }
        }
    }
    let mut products = [[[0.0; LANES]; B]; 2];
    for (b, (sums, unit)) in sums.into_iter().zip(units).enumerate() {
        let [even, odd]: [[[i32; 4]; 2]; 2] = sums.map(pulp::cast);
        for ((products, even), odd) in products.iter_mut().zip(even).zip(odd) {
            let [[p, r, t, v], [q, s, u, w]] = [even, odd];
            products[b] = [p, q, r, s, t, u, v, w].map(|sum| unit * sum as f32);
        }
    }
    products
}
