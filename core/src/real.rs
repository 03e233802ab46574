//! The two scalars of the core. Only + - * / sqrt and libm's exp are used, so the same bits come out on every target.

use crate::linalg::{self, Block, LANES, multiply_singles};
use core::fmt::{Debug, Display};
use core::iter::Sum;
use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// A floating-point scalar: `f32` or `f64`.
///
/// Products with stored integers are sums of whole numbers, which are exact, so that no order of them gives other bits,
/// and take a microcontroller a quarter as long.
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

    /// A whole number: a sum of products.
    type Whole: Copy + Debug;
    /// 0.
    const NO_WHOLE: Self::Whole;
    /// Two whole numbers that are factors.
    type Pair: Copy + Debug;
    /// Two zeros.
    const NO_PAIR: Self::Pair;
    /// The greatest factor: 500 products of it and of entries are a whole.
    const MAX_FACTOR: Self;

    /// The nearest factors to two numbers, neither beyond the greatest.
    fn pair(first: Self, second: Self) -> Self::Pair;
    /// The nearest number to a whole.
    fn from_whole(whole: Self::Whole) -> Self;
    /// The sums of two rows and their products with a pair of factors: `entries` are those of the first column, then
    /// those of the second.
    fn add_products(sums: [Self::Whole; 2], entries: [u8; 4], pair: Self::Pair) -> [Self::Whole; 2];
    /// products <- panels times some vectors, each in its unit.
    #[inline(always)]
    fn multiply<const B: usize, const P: usize>(
        panels: [&[Block]; P],
        pairs: &[[Self::Pair; B]],
        units: [Self; B],
        products: &mut [[[Self; LANES]; B]; P],
    ) {
        linalg::multiply(panels, pairs, units, products);
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
    ($scalar:ident, $whole:ident, $sqrt:path, $exp:path, { $($products:tt)* }) => {
        impl Real for $scalar {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const EPSILON: Self = $scalar::EPSILON;

            type Whole = $whole;
            const NO_WHOLE: $whole = 0;
            $($products)*

            #[inline(always)]
            fn from_whole(whole: $whole) -> Self {
                whole as $scalar
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
    type Pair = u32;
    const NO_PAIR: u32 = 0;
    const MAX_FACTOR: f32 = 32767.0;

    #[inline(always)]
    fn pair(first: f32, second: f32) -> u32 {
        // At this size the last digit counts ones.
        let half = |number: f32| (number + 12_582_912.0).to_bits();
        half(first) & 0xffff | half(second) << 16
    }
    #[inline(always)]
    fn add_products(sums: [i32; 2], entries: [u8; 4], pair: u32) -> [i32; 2] {
        capsule_dsp::add_products(sums, entries, pair)
    }
    #[inline(always)]
    fn multiply<const B: usize, const P: usize>(
        panels: [&[Block]; P],
        pairs: &[[u32; B]],
        units: [f32; B],
        products: &mut [[[f32; LANES]; B]; P],
    ) {
        multiply_singles(panels, pairs, units, products);
    }
});
real!(f64, i64, libm::sqrt, libm::exp, {
    type Pair = [i64; 2];
    const NO_PAIR: [i64; 2] = [0; 2];
    const MAX_FACTOR: f64 = (1_u64 << 46) as f64;

    fn pair(first: f64, second: f64) -> [i64; 2] {
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
