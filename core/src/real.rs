//! The two scalars of the core. Only + - * / sqrt and libm's exp are used, so the same bits come out on every target.

use core::fmt::{Debug, Display};
use core::iter::Sum;
use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// A floating-point scalar: `f32` or `f64`.
///
/// Products with entries of one byte are sums of whole numbers, which are exact, so that no order of them gives other
/// bits, and take a microcontroller half as long.
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

    /// A whole number: that of a sum of products.
    type Whole: Copy + Debug;
    /// 0.
    const NO_WHOLE: Self::Whole;
    /// The greatest sum of the wholes of a vector, without their signs: a power of two, so that more than 128 times it is a whole.
    const GREATEST_WHOLE: Self;

    /// Without its fraction; 0 for a NaN.
    fn to_whole(self) -> Self::Whole;
    /// The nearest number to a whole.
    fn from_whole(whole: Self::Whole) -> Self;
    /// A sum and the product of a stored entry and a factor.
    fn add_product(sum: Self::Whole, entry: i8, factor: Self::Whole) -> Self::Whole;

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
    /// The square root of a number that is not negative but for a few units in the last place.
    fn quick_sqrt(self) -> Self {
        self.sqrt()
    }
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
    ($scalar:ident, $whole:ident, $bits:literal, $sqrt:path, $quick_sqrt:path, $exp:path) => {
        impl Real for $scalar {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const EPSILON: Self = $scalar::EPSILON;

            type Whole = $whole;
            const NO_WHOLE: $whole = 0;
            const GREATEST_WHOLE: Self = (1_u64 << $bits) as $scalar;

            #[inline(always)]
            fn to_whole(self) -> $whole {
                self as $whole
            }
            #[inline(always)]
            fn from_whole(whole: $whole) -> Self {
                whole as $scalar
            }
            #[inline(always)]
            fn add_product(sum: $whole, entry: i8, factor: $whole) -> $whole {
                sum.wrapping_add($whole::from(entry).wrapping_mul(factor))
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
            fn quick_sqrt(self) -> Self {
                $quick_sqrt(self)
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

real!(f32, i32, 23, libm::sqrtf, newton, libm::expf);
real!(f64, i64, 52, libm::sqrt, libm::sqrt, libm::exp);

/// x / sqrt(x) by three of Newton's steps from a guess in the bits: a quarter of the instructions that a correctly rounded
/// root takes a Cortex-M, whose own no safe code reaches.
fn newton(x: f32) -> f32 {
    let half = 0.5 * x;
    let guess = f32::from_bits(0x5f37_5a86_u32.wrapping_sub(x.to_bits() >> 1));
    let step = |y: f32| y * (1.5 - half * y * y);
    x * step(step(step(guess)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn newton_s_root_is_the_root_but_for_units_in_the_last_place() {
        let mut x = 1e-30_f32;
        while x < 1e30 {
            let exact = f64::from(x).sqrt();
            let error = (f64::from(newton(x)) - exact).abs() / exact;
            assert!(error < 3.0 * f64::from(f32::EPSILON), "{x:e}: {error:e}");
            x *= 1.0173;
        }
        assert_eq!(newton(0.0), 0.0);
        assert!(newton(f32::NAN).is_nan());
    }
}
