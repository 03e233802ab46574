//! The two scalars of the core. Only + - * / sqrt and libm's exp are used, so the same bits come out on every target.

use crate::linalg::{self, Block, LANES, multiply_singles};
use core::fmt::{Debug, Display};
use core::iter::Sum;
use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// A floating-point scalar: `f32` or `f64`.
///
/// Products with stored integers are sums of integers: they are exact, so that their order does not change a bit, and
/// take a microcontroller a quarter of the time of a floating-point sum.
pub trait Real:
    Copy
    + Debug
    + Display
    + PartialEq
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + Sum
    + 'static
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// Distance from 1 to the next larger number.
    const EPSILON: Self;

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
        linalg::multiply(panels, factors, scales, products);
    }

    /// The nearest number to a stored single.
    fn from_f32(value: f32) -> Self;
    /// The nearest number to a double.
    fn from_f64(value: f64) -> Self;
    /// The nearest single.
    fn to_f32(self) -> f32;
    /// The number as a double, exactly.
    fn to_f64(self) -> f64;
    /// The integer part, saturating; 0 for a NaN.
    fn to_index(self) -> usize;
    /// The correctly rounded square root.
    fn sqrt(self) -> Self;
    /// e to the power of the number.
    fn exp(self) -> Self;
    /// Whether it is neither infinite nor a NaN.
    fn is_finite(self) -> bool;

    /// The nearest number to a count.
    fn from_index(value: usize) -> Self {
        Self::from_f64(value as f64)
    }
    /// The absolute value.
    fn abs(self) -> Self {
        if self < Self::ZERO { -self } else { self }
    }
    /// The larger of two numbers.
    fn max(self, other: Self) -> Self {
        if self < other { other } else { self }
    }
    /// The smaller of two numbers.
    fn min(self, other: Self) -> Self {
        if other < self { other } else { self }
    }
}

macro_rules! real {
    ($scalar:ident, $accumulator:ident, $sqrt:path, $exp:path, { $($products:tt)* }) => {
        impl Real for $scalar {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const EPSILON: Self = $scalar::EPSILON;

            type Accumulator = $accumulator;
            const ZERO_SUM: $accumulator = 0;
            $($products)*

            #[inline(always)]
            fn from_sum(sum: $accumulator) -> Self {
                sum as $scalar
            }

            fn from_f32(value: f32) -> Self {
                value as $scalar
            }
            fn from_f64(value: f64) -> Self {
                value as $scalar
            }
            fn from_index(value: usize) -> Self {
                value as $scalar
            }
            fn to_f32(self) -> f32 {
                self as f32
            }
            fn to_f64(self) -> f64 {
                self as f64
            }
            fn to_index(self) -> usize {
                self as usize
            }
            fn sqrt(self) -> Self {
                $sqrt(self)
            }
            fn exp(self) -> Self {
                $exp(self)
            }
            fn abs(self) -> Self {
                $scalar::abs(self)
            }
            fn is_finite(self) -> bool {
                $scalar::is_finite(self)
            }
        }
    };
}

real!(f32, i32, capsule_dsp::sqrt, libm::expf, {
    type PackedFactors = u32;
    const ZERO_FACTORS: u32 = 0;
    const MAX_FACTOR: f32 = 32767.0;

    #[inline(always)]
    fn pack(first: f32, second: f32) -> u32 {
        // At this size the last digit counts ones.
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
});
real!(f64, i64, libm::sqrt, libm::exp, {
    type PackedFactors = [i64; 2];
    const ZERO_FACTORS: [i64; 2] = [0; 2];
    const MAX_FACTOR: f64 = (1_u64 << 46) as f64;

    fn pack(first: f64, second: f64) -> [i64; 2] {
        // As for singles.
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
});
