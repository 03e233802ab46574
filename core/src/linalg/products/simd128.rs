//! Products of singles by the vectors of WebAssembly.

use super::Block;
use crate::linalg::LANES;
use core::arch::wasm32::{
    f32x4_convert_i32x4, f32x4_extract_lane, f32x4_mul, f32x4_splat, i16x8_shl, i16x8_shr, i32x4_add, i32x4_dot_i16x8,
    i32x4_shuffle, i32x4_splat, v128,
};

/// As [`multiply`](super::multiply), of singles.
#[inline(always)]
pub(crate) fn multiply_singles<const B: usize, const P: usize>(
    panels: [&[Block]; P],
    factors: &[[u32; B]],
    scales: [f32; B],
    products: &mut [[[f32; LANES]; B]; P],
) {
    for (panel, products) in panels.into_iter().zip(products) {
        one(panel, factors, scales, products);
    }
}

/// products <- a panel times some vectors.
#[inline(never)]
fn one<const B: usize>(panel: &[Block], factors: &[[u32; B]], scales: [f32; B], products: &mut [[f32; LANES]; B]) {
    // Of the first row of every two, and of the second.
    let mut sums = [[i32x4_splat(0); 2]; B];
    for (block, factors) in panel.iter().zip(factors) {
        let entries: v128 = bytemuck::cast(*block);
        let (first, second) = (i16x8_shr(i16x8_shl(entries, 8), 8), i16x8_shr(entries, 8));
        for ([even, odd], factors) in sums.iter_mut().zip(factors) {
            let factors = i32x4_splat(factors.cast_signed());
            *even = i32x4_add(*even, i32x4_dot_i16x8(first, factors));
            *odd = i32x4_add(*odd, i32x4_dot_i16x8(second, factors));
        }
    }
    for (([even, odd], scale), products) in sums.into_iter().zip(scales).zip(products) {
        let [p, q, r, s] = scaled(scale, i32x4_shuffle::<0, 4, 1, 5>(even, odd));
        let [t, u, v, w] = scaled(scale, i32x4_shuffle::<2, 6, 3, 7>(even, odd));
        *products = [p, q, r, s, t, u, v, w];
    }
}

/// Sums in their scale.
fn scaled(scale: f32, sums: v128) -> [f32; 4] {
    let x = f32x4_mul(f32x4_splat(scale), f32x4_convert_i32x4(sums));
    [
        f32x4_extract_lane::<0>(x),
        f32x4_extract_lane::<1>(x),
        f32x4_extract_lane::<2>(x),
        f32x4_extract_lane::<3>(x),
    ]
}
