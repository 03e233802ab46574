//! Identifies capsules on the board: prints the bits of each answer, and the instructions and the stack that it took.
//! QEMU must run with `-icount shift=6`, which spends 64 ns on each instruction.
#![no_std]
#![no_main]

#[path = "../identifications.rs"]
mod identifications;

use capsule_core::Model;
use core::arch::asm;
use core::panic::PanicInfo;
use cortex_m_rt::entry;
use cortex_m_semihosting::debug::{EXIT_FAILURE, EXIT_SUCCESS, exit};
use cortex_m_semihosting::hprintln;
use identifications::{Storage, TASKS};

/// Puts the model where its pads count from: on a 16-byte boundary.
#[repr(C, align(16))]
struct Aligned<Bytes>(Bytes);

const LENGTH: usize = include_bytes!(env!("CAPSULE_MODEL")).len();

// SAFETY: memory.x places the section in memory that is only read.
#[unsafe(link_section = ".model")]
static MODEL: Aligned<[u8; LENGTH]> = Aligned(*include_bytes!(env!("CAPSULE_MODEL")));

/// Control, value and reload of the board's first timer, which counts down at 25 MHz.
const TIMER: *mut u32 = 0x4000_0000 as *mut u32;
/// Bytes of stack that are painted to see how far they are used.
const PAINTED: usize = 256 * 1024;
const COLOUR: u32 = 0x5a5a_5a5a;

#[entry]
fn main() -> ! {
    // SAFETY: the registers of the timer, which nothing else uses.
    unsafe {
        TIMER.add(2).write_volatile(u32::MAX);
        TIMER.add(1).write_volatile(u32::MAX);
        TIMER.write_volatile(1);
    }
    let Ok(model) = Model::open(&MODEL.0) else { fail() };
    let mut storage = Storage::new();
    hprintln!("identify_storage_bytes {}", size_of::<Storage>());
    let mut grid = None;
    measure("identify_grid", &mut || grid = storage.grid(&model).ok());
    let Some(grid) = grid else { fail() };
    hprintln!("identify_grid_bytes {}", size_of_val(&grid));
    if storage.draw(&model).is_err() {
        fail()
    }
    for (name, task) in TASKS {
        let mut found = None;
        measure(name, &mut || found = storage.identify(&model, &grid, task).ok());
        let Some(found) = found else { fail() };
        let [ca, confinement] = [found.capillary_number, found.confinement].map(|estimate| estimate.value.to_bits());
        hprintln!("{}_bits {:016x} {:016x}", name, ca, confinement);
    }
    exit(EXIT_SUCCESS);
    fail()
}

/// Runs a piece of work and prints what it took. Its stack is all below this function's frame.
#[inline(never)]
fn measure(name: &str, work: &mut dyn FnMut()) {
    let top: usize;
    // SAFETY: reads the stack pointer.
    unsafe { asm!("mov {}, sp", out(reg) top, options(nomem, nostack, preserves_flags)) };
    let painted = (top - PAINTED..top).step_by(4).map(|at| at as *mut u32);
    // SAFETY: below the stack pointer nothing is in use.
    painted.clone().for_each(|word| unsafe { word.write_volatile(COLOUR) });
    let before = now();
    work();
    let ticks = before - now();
    // SAFETY: the same words.
    let free = painted
        .take_while(|word| unsafe { word.read_volatile() } == COLOUR)
        .count();
    hprintln!("{}_instructions {}", name, u64::from(ticks) * 5 / 8);
    hprintln!("{}_stack_bytes {}", name, PAINTED - 4 * free);
}

fn now() -> u32 {
    // SAFETY: the value of the timer.
    unsafe { TIMER.add(1).read_volatile() }
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
