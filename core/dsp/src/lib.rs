//! Products of pairs of small integers, and square roots.
//!
//! An ARM core with the DSP extension multiplies two pairs of halfwords and adds both products in one instruction,
//! which the compiler does not use of itself; one with a floating-point unit has an instruction for the square root, as
//! WebAssembly has, which `core` does not offer. The instructions read and write registers only; elsewhere the same is
//! said in Rust. They need `unsafe`, which capsule-rom-core forbids itself, so this is a crate of its own, and what it
//! exports is safe.
//!
//! The build script asks the assembler which of the two there are. Cortex-M4 and M7 (`thumbv7em`) have the DSP
//! extension always. Cortex-M33, M35P, M55 and M85 (`thumbv8m.main`) have it as an option: it is used where the
//! compiler is told, `-C target-cpu=cortex-m33` for one. The flags must reach this crate: in RUSTFLAGS or in cargo's
//! configuration.

#![no_std]

/// The correctly rounded square root.
#[inline(always)]
pub fn sqrt(x: f32) -> f32 {
    root(x)
}

/// The argument comes in the register of the result. (A function of its own, because the compiler takes no operands of
/// the floating-point unit here.)
#[cfg(all(vsqrt, target_abi = "eabihf"))]
#[unsafe(naked)]
extern "C" fn root(x: f32) -> f32 {
    core::arch::naked_asm!(".fpu fpv4-sp-d16", "vsqrt.f32 s0, s0", "bx lr")
}

#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
#[inline(always)]
fn root(x: f32) -> f32 {
    use core::arch::wasm32::{f32x4_extract_lane, f32x4_splat, f32x4_sqrt};
    f32x4_extract_lane::<0>(f32x4_sqrt(f32x4_splat(x)))
}

#[cfg(not(any(
    all(vsqrt, target_abi = "eabihf"),
    all(target_arch = "wasm32", target_feature = "simd128")
)))]
#[inline(always)]
fn root(x: f32) -> f32 {
    libm::sqrtf(x)
}

/// sums <- sums + entries times factors, for two rows of two columns: `entries` are those of the first column, then
/// those of the second. The factors are the low and the high half of `pair`. Sums that overflow wrap.
#[inline(always)]
pub fn add_products(sums: [i32; 2], entries: [u8; 4], pair: u32) -> [i32; 2] {
    add(sums, entries, pair)
}

#[cfg(smlad)]
#[inline(always)]
fn add([first, second]: [i32; 2], entries: [u8; 4], pair: u32) -> [i32; 2] {
    let entries = u32::from_le_bytes(entries);
    [
        add_halves(first, bytes::<0>(entries), pair),
        add_halves(second, bytes::<8>(entries), pair),
    ]
}

#[cfg(not(smlad))]
#[inline(always)]
fn add([first, second]: [i32; 2], entries: [u8; 4], pair: u32) -> [i32; 2] {
    let [a, b, c, d] = entries.map(|entry| i32::from(entry.cast_signed()));
    let (x, y) = (i32::from(pair as i16), pair.cast_signed() >> 16);
    let add = |sum: i32, first: i32, second: i32| sum.wrapping_add(first * x).wrapping_add(second * y);
    [add(first, a, c), add(second, b, d)]
}

/// The bytes at bits `FROM` and `FROM` + 16, as halves with their sign.
#[cfg(smlad)]
#[inline(always)]
fn bytes<const FROM: u32>(word: u32) -> u32 {
    let halves;
    // SAFETY: the instruction computes a register from a register.
    unsafe {
        core::arch::asm!(
            "sxtb16 {}, {}, ror #{}",
            out(reg) halves, in(reg) word, const FROM, options(pure, nomem, nostack)
        );
    }
    halves
}

/// sum + the products of the low and of the high halves.
#[cfg(smlad)]
#[inline(always)]
fn add_halves(mut sum: i32, a: u32, b: u32) -> i32 {
    // SAFETY: the instruction computes a register from three.
    unsafe {
        core::arch::asm!(
            "smlad {0}, {1}, {2}, {0}",
            inout(reg) sum, in(reg) a, in(reg) b, options(pure, nomem, nostack)
        );
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bytes_of_a_column_follow_each_other() {
        let most = u32::from(i16::MIN as u16) << 16 | u32::from(i16::MAX as u16);
        for (entries, pair, expected) in [
            ([1, 10, 2, 20], 3 | 5 << 16, [1 + 3 + 2 * 5, 2 + 10 * 3 + 20 * 5]),
            ([0xff, 0x80, 0x7f, 0], 7 | 0xfffe << 16, [1 - 7 - 127 * 2, 2 - 128 * 7]),
            ([0x80; 4], most, [1 + 128, 2 + 128]),
        ] {
            assert_eq!(add_products([1, 2], entries, pair), expected);
        }
    }

    #[test]
    fn a_root_is_the_nearest_number_to_it() {
        // A double has more than twice the digits: rounded again, its root is that of the single.
        for bits in (0..f32::INFINITY.to_bits()).step_by(9973) {
            let x = f32::from_bits(bits);
            assert_eq!(sqrt(x), libm::sqrt(x.into()) as f32, "{x:e}");
        }
        assert!(sqrt(-1.0).is_nan());
    }
}
