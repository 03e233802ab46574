//! Peak rates of one core of this machine.

use std::hint::black_box;
use std::time::Instant;

use multiversion::multiversion;

/// The least time of a pass, in seconds, over so many repetitions of several passes, enough of them to be timed.
pub fn least_time(repetitions: usize, passes: usize, mut pass: impl FnMut()) -> f64 {
    let mut least = f64::INFINITY;
    for _ in 0..repetitions {
        let start = Instant::now();
        (0..passes).for_each(|_| pass());
        least = least.min(start.elapsed().as_secs_f64());
    }
    least / passes as f64
}

/// A kind of arithmetic; each multiply-add counts as two operations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arithmetic {
    /// Fused multiply-adds in single precision, in the machine's widest registers.
    FusedSingle,
    /// Fused multiply-adds in double precision, in the machine's widest registers.
    FusedDouble,
    /// Products and sums in single precision, each rounded, in the machine's widest registers.
    RoundedSingle,
    /// Products and sums in single precision, each rounded, with the instructions that every processor of this kind
    /// has.
    PortableSingle,
}

/// Independent sums: enough to hide the latency, few enough to stay in registers.
const CHAINS: usize = 12;
const STEPS: usize = 10_000;

/// The most operations in a second, in registers.
#[must_use]
pub fn peak(arithmetic: Arithmetic, repetitions: usize) -> f64 {
    let (width, pass): (usize, fn(f32) -> f32) = match arithmetic {
        Arithmetic::FusedSingle => (16, fused_single),
        Arithmetic::FusedDouble => (8, fused_double),
        Arithmetic::RoundedSingle => (16, rounded_single),
        Arithmetic::PortableSingle => (4, portable_single),
    };
    let seconds = least_time(repetitions, 1, || {
        black_box(pass(black_box(0.9)));
    });
    (2 * width * CHAINS * STEPS) as f64 / seconds
}

/// Steps of independent sums in registers of so many lanes.
macro_rules! chains {
    ($scalar:ty, $lanes:literal, $factor:expr, $step:expr) => {{
        let mut sums = [[1.0; $lanes]; CHAINS];
        for _ in 0..STEPS {
            for lane in sums.as_flattened_mut() {
                *lane = $step(*lane, $factor);
            }
        }
        black_box(&sums).as_flattened().iter().sum::<$scalar>() as f32
    }};
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx2+fma", "x86_64+avx2+fma"))]
fn fused_single(factor: f32) -> f32 {
    chains!(f32, 16, factor, |lane: f32, factor| lane.mul_add(factor, 0.5))
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx2+fma", "x86_64+avx2+fma"))]
fn fused_double(factor: f32) -> f32 {
    chains!(f64, 8, f64::from(factor), |lane: f64, factor| lane.mul_add(factor, 0.5))
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx2+fma", "x86_64+avx2+fma"))]
fn rounded_single(factor: f32) -> f32 {
    chains!(f32, 16, factor, |lane: f32, factor| lane * factor + 0.5)
}

fn portable_single(factor: f32) -> f32 {
    chains!(f32, 4, factor, |lane: f32, factor| lane * factor + 0.5)
}

/// Bytes in a second of reading an array of so many bytes again and again.
#[must_use]
pub fn reading(bytes: usize, repetitions: usize) -> f64 {
    let array = vec![1.0_f32; bytes / 4];
    let seconds = least_time(repetitions, 1, || {
        black_box(total(black_box(&array)));
    });
    bytes as f64 / seconds
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx2+fma", "x86_64+avx2+fma"))]
fn total(array: &[f32]) -> f32 {
    let mut sums = [0.0; 64];
    for chunk in array.as_chunks::<64>().0 {
        for l in 0..64 {
            sums[l] += chunk[l];
        }
    }
    sums.iter().sum()
}
