//! Answers all questions on the target and prints the answers' bits, one line a question.
#![no_std]
#![no_main]

mod questions;

use capsule_core::{Model, Workspace};
use core::panic::PanicInfo;
use cortex_m_rt::entry;
use cortex_m_semihosting::debug::{EXIT_FAILURE, EXIT_SUCCESS, exit};
use cortex_m_semihosting::hio::{self, HostStream};

/// Puts the model where its pads count from: on a 16-byte boundary.
#[repr(C, align(16))]
struct Aligned<Bytes>(Bytes);

const LENGTH: usize = include_bytes!(env!("CAPSULE_MODEL")).len();

// SAFETY: memory.x places the section in memory that is only read.
#[unsafe(link_section = ".model")]
static MODEL: Aligned<[u8; LENGTH]> = Aligned(*include_bytes!(env!("CAPSULE_MODEL")));

#[entry]
fn main() -> ! {
    // Storage that a real program would keep in a static.
    let mut workspace = Workspace::<f32>::new();
    let Ok(mut out) = hio::hstdout() else { fail() };
    let Ok(model) = Model::open(&MODEL.0) else { fail() };
    for i in 0..questions::COUNT {
        let mut line = Line {
            bytes: [b' '; LINE],
            length: 0,
        };
        if questions::answer(&model, &mut workspace, i, &mut |value| line.push(value.to_bits())).is_err() {
            line.push(u32::MAX);
        }
        line.end(&mut out);
    }
    exit(EXIT_SUCCESS);
    fail()
}

const LINE: usize = 4096;

/// Words in hexadecimal, separated by spaces.
struct Line {
    bytes: [u8; LINE],
    length: usize,
}

impl Line {
    fn push(&mut self, word: u32) {
        let Some(room) = self.bytes.get_mut(self.length..self.length + 9) else {
            return;
        };
        for (digit, byte) in room.iter_mut().take(8).enumerate() {
            let nibble = (word >> (28 - 4 * digit)) as u8 & 15;
            *byte = if nibble < 10 { b'0' + nibble } else { b'a' + nibble - 10 };
        }
        self.length += 9;
    }

    fn end(self, out: &mut HostStream) {
        let text = self.bytes.get(..self.length).unwrap_or(&[]);
        if out.write_all(text).is_err() || out.write_all(b"\n").is_err() {
            fail()
        }
    }
}

fn fail() -> ! {
    loop {
        exit(EXIT_FAILURE);
    }
}

unsafe extern "C" {
    /// Defined nowhere: a panic that the optimiser cannot rule out becomes a link error.
    fn a_panic_can_be_reached() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    // SAFETY: never linked, so never called.
    unsafe { a_panic_can_be_reached() }
}
