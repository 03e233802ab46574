//! Products of panels of small integers with vectors of whole numbers: sums that are exact, so that every target adds
//! them as it can, in any order, and comes to the same bits.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
mod simd128;

use super::LANES;
use crate::Real;
#[cfg(target_arch = "x86_64")]
pub(crate) use avx2::multiply_singles;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
pub(crate) use simd128::multiply_singles;

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
            // Four sums, the entries and the factors are as much as a Cortex-M has registers for beside what it needs
            // to get them.
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
    let (blocks, last) = super::slice_or_empty(panel, 0..count).as_chunks::<2>();
    let (pairs, last_pair) = super::slice_or_empty(pairs, 0..count).as_chunks::<2>();
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
#[cfg(not(any(target_arch = "x86_64", all(target_arch = "wasm32", target_feature = "simd128"))))]
#[inline(always)]
pub(crate) fn multiply_singles<const B: usize, const P: usize>(
    panels: [&[Block]; P],
    pairs: &[[u32; B]],
    units: [f32; B],
    products: &mut [[[f32; LANES]; B]; P],
) {
    multiply(panels, pairs, units, products);
}
