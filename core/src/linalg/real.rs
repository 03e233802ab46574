//! The two scalars of the core. They use only + - * /, correctly rounded square roots and libm's exp, so every target
//! computes the same bits.

use super::ProductScalar;
use core::fmt::{Debug, Display};
use core::iter::Sum;
use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// A floating-point scalar: `f32` or `f64`. The supertrait is private to the workspace: no other crate implements it.
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
    + DivAssign
    + Sum
    + ProductScalar
    + 'static
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// Distance from 1 to the next larger number.
    const EPSILON: Self;

    /// The nearest number to a stored single.
    fn from_f32(value: f32) -> Self;
    /// The nearest number to a double.
    fn from_f64(value: f64) -> Self;
    /// The nearest single.
    fn to_f32(self) -> f32;
    /// The number as a double, exactly.
    fn to_f64(self) -> f64;
    /// The integer part of a number, saturating; 0 for a NaN.
    fn to_index(self) -> usize;
    /// The correctly rounded square root.
    fn sqrt(self) -> Self;
    /// The exponential.
    fn exp(self) -> Self;
    /// Whether the number is neither infinite nor a NaN.
    fn is_finite(self) -> bool;

    /// The nearest number to an integer.
    fn from_index(value: usize) -> Self {
        Self::from_f64(value as f64)
    }
    /// The absolute value.
    fn abs(self) -> Self;
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
    ($scalar:ident, $sqrt:path, $exp:path) => {
        impl Real for $scalar {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const EPSILON: Self = $scalar::EPSILON;

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

real!(f32, capsule_dsp::sqrt, libm::expf);
real!(f64, libm::sqrt, libm::exp);
