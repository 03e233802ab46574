//! The two precisions of the Stokeslet sums, and arithmetic that vectorises in both.

use std::ops::{Add, Mul, Sub};

/// `f32` or `f64`.
pub trait Real:
    Copy + Default + Send + Sync + Into<f64> + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
    /// The nearest number of this precision.
    fn from_f64(value: f64) -> Self;
    /// `a b + c`, rounded once.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// `1 / sqrt(x)` for normal positive `x`, 0 for 0 (a source does not act on itself), by multiplications only:
    /// halving the exponent in the bits gives 3.5 %, a polynomial in the defect of that guess the rest. Square root and
    /// division take longer.
    fn reciprocal_root<const FMA: bool>(self) -> Self;
}

/// `a b + c`, fused where the processor can.
#[inline(always)]
pub(super) fn fused<S: Real, const FMA: bool>(a: S, b: S, c: S) -> S {
    if FMA { a.mul_add(b, c) } else { a * b + c }
}

/// The sum of some lanes, in double precision. Not inlined: lanes that are also used one by one would not be kept in
/// vector registers.
#[inline(never)]
pub(super) fn total<S: Real, const L: usize>(lanes: &[S; L]) -> f64 {
    lanes.iter().map(|&lane| lane.into()).sum()
}

impl Real for f64 {
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        f64::mul_add(self, b, c)
    }

    /// A fitted quadratic leaves 3e-5, a step of third order 5e-14.
    #[inline(always)]
    fn reciprocal_root<const FMA: bool>(self) -> Self {
        let fused = fused::<f64, FMA>;
        let guess = f64::from_bits(0x5fe6_eb50_c7b5_37a9_u64.wrapping_sub(self.to_bits() >> 1));
        let h = fused(-(self * guess), guess, 1.0);
        let factor = fused(h, fused(h, 0.375_227_683_937, 0.501_095_186_429), 1.000_000_852_700);
        let better = guess * factor;
        let h = fused(-(self * better), better, 1.0);
        let root = fused(better * h, fused(h, 0.375, 0.5), better);
        if self > 0.0 { root } else { 0.0 }
    }
}

impl Real for f32 {
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        value as f32
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        f32::mul_add(self, b, c)
    }

    /// A fitted quartic leaves 2e-8.
    #[inline(always)]
    fn reciprocal_root<const FMA: bool>(self) -> Self {
        let fused = fused::<f32, FMA>;
        let guess = f32::from_bits(0x5f37_642f_u32.wrapping_sub(self.to_bits() >> 1));
        let h = fused(-(self * guess), guess, 1.0);
        let factor = fused(h, fused(h, 0.273_557_3, 0.313_940_94), 0.375_002_39);
        let root = guess * fused(h, fused(h, factor, 0.499_998_32), 1.0);
        if self > 0.0 { root } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reciprocal_root_is_good_over_the_range_of_distances() {
        for k in -80..80 {
            for part in 0..16 {
                let x = 1.7_f64.powi(k) * (1.0 + 0.05 * f64::from(part));
                assert!((f64::reciprocal_root::<false>(x) * x.sqrt() - 1.0).abs() < 1e-12, "{x}");
                let single: f64 = f32::reciprocal_root::<false>(x as f32).into();
                assert!((single * x.sqrt() - 1.0).abs() < 2.5e-7, "{x}");
            }
        }
        assert_eq!(f64::reciprocal_root::<false>(0.0), 0.0);
        assert_eq!(f32::reciprocal_root::<false>(0.0), 0.0);
    }
}
