//! Asks the conformance vectors in single precision on the target; prints the lines that come out otherwise, and
//! counts.
#![no_std]
#![no_main]

use capsule_conformance::{Asker, Precision, check};
use core::panic::PanicInfo;
use cortex_m_rt::entry;
use cortex_m_semihosting::debug::{EXIT_FAILURE, EXIT_SUCCESS, exit};
use cortex_m_semihosting::hprintln;

/// Puts the model where its pads count from: on a 16-byte boundary.
#[repr(C, align(16))]
struct Aligned<Bytes>(Bytes);

const LENGTH: usize = include_bytes!(env!("CAPSULE_MODEL")).len();

// SAFETY: memory.x places the section in memory that is only read.
#[unsafe(link_section = ".model")]
static MODEL: Aligned<[u8; LENGTH]> = Aligned(*include_bytes!(env!("CAPSULE_MODEL")));
static VECTORS: &str = include_str!("../../../conformance/vectors.txt");

#[entry]
fn main() -> ! {
    let mut different = 0;
    let mut asker = Asker::new();
    let asked = check(&MODEL.0, VECTORS, Precision::Single, &mut asker, |expected, found| {
        different += 1;
        hprintln!("expected {}\nfound    {}", expected, found);
    });
    match asked {
        Ok(asked) => hprintln!("{} passed, {} failed", asked - different, different),
        Err(error) => hprintln!("{}", error),
    }
    exit(if asked.is_ok() && different == 0 {
        EXIT_SUCCESS
    } else {
        EXIT_FAILURE
    });
    fail()
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    fail()
}

fn fail() -> ! {
    loop {
        exit(EXIT_FAILURE);
    }
}
