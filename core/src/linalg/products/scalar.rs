//! The scalars of products with quantised matrices.

use super::{Block, multiply, multiply_singles};
use crate::linalg::LANES;
use core::fmt::Debug;
use core::ops::Mul;

/// A scalar whose products with stored integers are sums of integers: they are exact, so that their order does not
/// change a bit, and take a microcontroller a quarter of the time of a floating-point sum.
///
/// Private to the workspace: implemented by `f32`, `f64`, and the counting scalar of `capsule-opcount`.
pub trait ProductScalar: Copy + Mul<Output = Self> + 'static {
    /// Integer that sums of products are accumulated in.
    type Accumulator: Copy + Debug;
    /// 0.
    const ZERO_SUM: Self::Accumulator;
    /// Two integer factors.
    type PackedFactors: Copy + Debug;
    /// Two factors that are 0.
    const ZERO_FACTORS: Self::PackedFactors;
    /// The greatest factor: 500 products of it and of entries fit into the accumulator.
    const MAX_FACTOR: Self;

    /// The nearest factors to two numbers, neither beyond the greatest.
    fn pack(first: Self, second: Self) -> Self::PackedFactors;
    /// The nearest number to a sum.
    fn from_sum(sum: Self::Accumulator) -> Self;
    /// The sums of two rows plus their products with two factors: `entries` are those of the first column, then those
    /// of the second.
    fn add_products(
        sums: [Self::Accumulator; 2],
        entries: [u8; 4],
        factors: Self::PackedFactors,
    ) -> [Self::Accumulator; 2];
    /// products <- panels times some quantised vectors, each with its scale.
    #[inline(always)]
    fn multiply<const B: usize, const P: usize>(
        panels: [&[Block]; P],
        factors: &[[Self::PackedFactors; B]],
        scales: [Self; B],
        products: &mut [[[Self; LANES]; B]; P],
    ) {
        multiply(panels, factors, scales, products);
    }
}

impl ProductScalar for f32 {
    type Accumulator = i32;
    const ZERO_SUM: i32 = 0;
    type PackedFactors = u32;
    const ZERO_FACTORS: u32 = 0;
    const MAX_FACTOR: f32 = 32767.0;

    #[inline(always)]
    fn pack(first: f32, second: f32) -> u32 {
        // 1.5 * 2^23: its last mantissa bit counts ones, so the sum is rounded to an integer in the low bits.
        let half = |number: f32| (number + 12_582_912.0).to_bits();
        half(first) & 0xffff | half(second) << 16
    }
    #[inline(always)]
    fn add_products(sums: [i32; 2], entries: [u8; 4], factors: u32) -> [i32; 2] {
        capsule_dsp::add_products(sums, entries, factors)
    }
    #[inline(always)]
    fn multiply<const B: usize, const P: usize>(
        panels: [&[Block]; P],
        factors: &[[u32; B]],
        scales: [f32; B],
        products: &mut [[[f32; LANES]; B]; P],
    ) {
        multiply_singles(panels, factors, scales, products);
    }
    #[inline(always)]
    fn from_sum(sum: i32) -> f32 {
        sum as f32
    }
}

impl ProductScalar for f64 {
    type Accumulator = i64;
    const ZERO_SUM: i64 = 0;
    type PackedFactors = [i64; 2];
    const ZERO_FACTORS: [i64; 2] = [0; 2];
    const MAX_FACTOR: f64 = (1_u64 << 46) as f64;

    fn pack(first: f64, second: f64) -> [i64; 2] {
        // 1.5 * 2^52, as for singles.
        const ONES: f64 = 6_755_399_441_055_744.0;
        [first, second].map(|number| (number + ONES - ONES) as i64)
    }
    fn add_products([p, q]: [i64; 2], entries: [u8; 4], [x, y]: [i64; 2]) -> [i64; 2] {
        let [a, b, c, d] = entries.map(|entry| i64::from(entry.cast_signed()));
        let add = |sum: i64, first: i64, second: i64| {
            sum.wrapping_add(first.wrapping_mul(x))
                .wrapping_add(second.wrapping_mul(y))
        };
        [add(p, a, c), add(q, b, d)]
    }
    #[inline(always)]
    fn from_sum(sum: i64) -> f64 {
        sum as f64
    }
}
