//! Products of singles by AVX2.

use super::{Block, multiply};
use crate::linalg::{LANES, slice_or_empty};

/// As [`multiply`], of singles, by instructions of AVX2 if the machine knows them.
pub(crate) fn multiply_singles<const B: usize, const P: usize>(
    panels: [&[Block]; P],
    factors: &[[u32; B]],
    scales: [f32; B],
    products: &mut [[[f32; LANES]; B]; P],
) {
    let Some(simd) = pulp::x86::V3::try_new() else {
        return multiply(panels, factors, scales, products);
    };
    for (panels, products) in panels.chunks(2).zip(products.chunks_mut(2)) {
        if let (Some(first), Some(second)) = (panels.first(), panels.last()) {
            let both = simd.vectorize(
                #[inline(always)]
                || multiply_panels(simd, [first, second], factors, scales),
            );
            products
                .iter_mut()
                .zip(both)
                .for_each(|(products, both)| *products = both);
        }
    }
}

/// Two panels, which have as many columns, times some vectors.
#[inline(always)]
fn multiply_panels<const B: usize>(
    simd: pulp::x86::V3,
    [first, second]: [&[Block]; 2],
    factors: &[[u32; B]],
    scales: [f32; B],
) -> [[[f32; LANES]; B]; 2] {
    // One length for all, so that the loop looks at one.
    let count = factors.len().min(first.len()).min(second.len());
    let [first, second] = [first, second].map(|panel| slice_or_empty(panel, 0..count));
    // Of the first row of every two, and of the second: four of one panel, then four of the other.
    let mut sums = [[simd.splat_i32x8(0); 2]; B];
    for ((first, second), factors) in first.iter().zip(second).zip(factors) {
        let entries: pulp::i16x16 = pulp::cast([*first, *second]);
        let rows = [
            simd.shr_const_i16x16::<8>(simd.shl_const_i16x16::<8>(entries)),
            simd.shr_const_i16x16::<8>(entries),
        ];
        for (sums, factors) in sums.iter_mut().zip(factors) {
            let factors = pulp::cast(simd.splat_i32x8(factors.cast_signed()));
            for (sum, entries) in sums.iter_mut().zip(rows) {
                let products = simd.multiply_wrapping_add_adjacent_i16x16(entries, factors);
                *sum = simd.wrapping_add_i32x8(*sum, products);
            }
        }
    }
    let mut products = [[[0.0; LANES]; B]; 2];
    for (b, (sums, scale)) in sums.into_iter().zip(scales).enumerate() {
        let [even, odd]: [[[i32; 4]; 2]; 2] = sums.map(pulp::cast);
        for ((products, even), odd) in products.iter_mut().zip(even).zip(odd) {
            let [[p, r, t, v], [q, s, u, w]] = [even, odd];
            products[b] = [p, q, r, s, t, u, v, w].map(|sum| scale * sum as f32);
        }
    }
    products
}
