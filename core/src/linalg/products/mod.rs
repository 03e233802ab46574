//! Products of panels of small integers with quantised vectors. Sums of integers are exact, so every target adds them
//! in the order that suits it and comes to the same bits.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
mod simd128;

mod scalar;

use super::LANES;
#[cfg(target_arch = "x86_64")]
pub(crate) use avx2::multiply_singles;
pub use scalar::ProductScalar;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
pub(crate) use simd128::multiply_singles;

/// Two columns of a panel of eight rows: for every two rows their bytes in the first column, then those in the second.
pub(crate) type Block = [[u8; 4]; LANES / 2];

/// Whether a product takes two panels at a time: a vector register holds the sums of both.
pub(crate) const TWO_PANELS: bool = cfg!(target_arch = "x86_64");

/// products <- panels times some quantised vectors, each with its scale and two factors to a block.
#[inline(always)]
pub(crate) fn multiply<T: ProductScalar, const B: usize, const P: usize>(
    panels: [&[Block]; P],
    factors: &[[T::PackedFactors; B]],
    scales: [T; B],
    products: &mut [[[T; LANES]; B]; P],
) {
    for (panel, products) in panels.iter().zip(products) {
        for (b, (products, scale)) in products.iter_mut().zip(scales).enumerate() {
            // Four sums, the entries, the factors and their addresses fill the registers of a Cortex-M.
            let (halves, _) = products.as_chunks_mut();
            if let [first, second] = halves {
                half::<T, B, 0>(panel, factors, b, scale, first);
                half::<T, B, 2>(panel, factors, b, scale, second);
            }
        }
    }
}

/// products <- four rows of a panel, from word `FIRST` of its blocks on, times vector number `b`.
#[inline(never)]
fn half<T: ProductScalar, const B: usize, const FIRST: usize>(
    panel: &[Block],
    factors: &[[T::PackedFactors; B]],
    b: usize,
    scale: T,
    products: &mut [T; 4],
) {
    let add = |[p, q, r, s]: [T::Accumulator; 4], block: &Block, factors: &[T::PackedFactors; B]| {
        let [p, q] = T::add_products([p, q], block[FIRST], factors[b]);
        let [r, s] = T::add_products([r, s], block[FIRST + 1], factors[b]);
        [p, q, r, s]
    };
    // Two blocks at a time: half the steps.
    let count = panel.len().min(factors.len());
    let (blocks, last) = super::slice_or_empty(panel, 0..count).as_chunks::<2>();
    let (factors, last_factors) = super::slice_or_empty(factors, 0..count).as_chunks::<2>();
    let mut sums = [T::ZERO_SUM; 4];
    for ([first, second], [of_first, of_second]) in blocks.iter().zip(factors) {
        sums = add(sums, first, of_first);
        sums = add(sums, second, of_second);
    }
    for (block, factors) in last.iter().zip(last_factors) {
        sums = add(sums, block, factors);
    }
    let [p, q, r, s] = sums;
    *products = [
        scale * T::from_sum(p),
        scale * T::from_sum(q),
        scale * T::from_sum(r),
        scale * T::from_sum(s),
    ];
}

/// As [`multiply`], of singles.
#[cfg(not(any(target_arch = "x86_64", all(target_arch = "wasm32", target_feature = "simd128"))))]
#[inline(always)]
pub(crate) fn multiply_singles<const B: usize, const P: usize>(
    panels: [&[Block]; P],
    factors: &[[u32; B]],
    scales: [f32; B],
    products: &mut [[[f32; LANES]; B]; P],
) {
    multiply(panels, factors, scales, products);
}
