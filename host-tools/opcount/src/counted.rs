//! A number that counts.

use std::cell::Cell;
use std::fmt;
use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use capsule_core::{ProductScalar, Real};
use serde::Serialize;

thread_local!(static COUNTS: Cell<Counts> = const { Cell::new(Counts::NONE) });

/// Counts of the operations on [`Counted`] numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// Numbers made from a single: those that a model file stores, and the code's constants.
    pub reads: usize,
    /// Sums and differences.
    pub additions: usize,
    /// Products.
    pub multiplications: usize,
    /// Quotients, roots and exponentials.
    pub others: usize,
}

impl Counts {
    const NONE: Self = Self {
        reads: 0,
        additions: 0,
        multiplications: 0,
        others: 0,
    };

    /// All arithmetic, in floating-point operations.
    #[must_use]
    pub fn operations(&self) -> usize {
        self.additions + self.multiplications + self.others
    }
}

/// Runs `work` and returns its result with the operations on [`Counted`] numbers that it did on this thread.
pub fn count<R>(work: impl FnOnce() -> R) -> (R, Counts) {
    let outer = COUNTS.replace(Counts::NONE);
    let result = work();
    (result, COUNTS.replace(outer))
}

fn note(change: impl FnOnce(&mut Counts)) {
    COUNTS.with(|cell| {
        let mut counts = cell.get();
        change(&mut counts);
        cell.set(counts);
    });
}

/// A single that counts how often one is made from a stored number, and its arithmetic.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Counted(pub f32);

macro_rules! operators {
    ($($operator:ident, $method:ident, $assign:ident, $assign_method:ident, $counter:ident;)*) => {$(
        impl $operator for Counted {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                note(|counts| counts.$counter += 1);
                Self(self.0.$method(other.0))
            }
        }
        impl $assign for Counted {
            fn $assign_method(&mut self, other: Self) {
                note(|counts| counts.$counter += 1);
                self.0.$assign_method(other.0);
            }
        }
    )*};
}

operators! {
    Add, add, AddAssign, add_assign, additions;
    Sub, sub, SubAssign, sub_assign, additions;
    Mul, mul, MulAssign, mul_assign, multiplications;
    Div, div, DivAssign, div_assign, others;
}

impl Neg for Counted {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Sum for Counted {
    fn sum<I: Iterator<Item = Self>>(iter: I) -> Self {
        iter.fold(Self::ZERO, |sum, value| sum + value)
    }
}

impl fmt::Display for Counted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl ProductScalar for Counted {
    type Accumulator = i32;
    const ZERO_SUM: i32 = 0;
    const MAX_FACTOR: Self = Self(f32::MAX_FACTOR);
    type PackedFactors = u32;
    const ZERO_FACTORS: u32 = f32::ZERO_FACTORS;

    fn from_sum(sum: i32) -> Self {
        Self(f32::from_sum(sum))
    }
    fn pack(first: Self, second: Self) -> u32 {
        f32::pack(first.0, second.0)
    }
    fn add_products(sums: [i32; 2], entries: [u8; 4], pair: u32) -> [i32; 2] {
        note(|counts| {
            counts.reads += 4;
            counts.additions += 4;
            counts.multiplications += 4;
        });
        f32::add_products(sums, entries, pair)
    }
}

impl Real for Counted {
    const ZERO: Self = Self(0.0);
    const ONE: Self = Self(1.0);
    const EPSILON: Self = Self(f32::EPSILON);

    fn from_f32(value: f32) -> Self {
        note(|counts| counts.reads += 1);
        Self(value)
    }
    fn from_f64(value: f64) -> Self {
        Self(Real::from_f64(value))
    }
    fn to_f32(self) -> f32 {
        self.0
    }

    fn to_f64(self) -> f64 {
        self.0.into()
    }
    fn to_index(self) -> usize {
        self.0.to_index()
    }
    fn sqrt(self) -> Self {
        note(|counts| counts.others += 1);
        Self(Real::sqrt(self.0))
    }
    fn exp(self) -> Self {
        note(|counts| counts.others += 1);
        Self(Real::exp(self.0))
    }
    fn abs(self) -> Self {
        if self < Self::ZERO { -self } else { self }
    }
    fn is_finite(self) -> bool {
        self.0.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_done_is_counted_once() {
        let work = || {
            let (_, inner) = count(|| Counted(1.0) * Counted(2.0));
            assert_eq!((inner.multiplications, inner.operations()), (1, 1));
            let mut sum: Counted = [1.0, 2.0].map(Counted::from_f32).into_iter().sum();
            sum += Counted(1.0);
            (sum - Counted(2.0)) / Counted(2.0) * Counted(3.0)
        };
        let (value, counts) = count(work);
        assert_eq!(value.0, 3.0);
        let expected = Counts {
            reads: 2,
            additions: 4,
            multiplications: 1,
            others: 1,
        };
        assert_eq!(counts, expected);
    }

    #[test]
    fn the_absolute_value_has_no_sign() {
        assert_eq!([-2.0, 0.0, 3.0].map(|x| Counted(x).abs().0), [2.0, 0.0, 3.0]);
    }
}
