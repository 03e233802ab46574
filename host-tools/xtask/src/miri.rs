//! Miri: an interpreter that stops at undefined behaviour. It is some hundred times slower than the processor, so it
//! runs where unsafe code is or can be reached: the refusals of the C interface, its set-up of a workspace, and every
//! entry point of the core on a small model, whole and with bits flipped.

use crate::command::{command, run};
use crate::setup;
use anyhow::Result;

/// A target for which libm has no assembler, which Miri cannot interpret.
const TARGET: &str = "riscv64gc-unknown-linux-gnu";

/// The tests that take less than three minutes together; `cargo xtask test` runs them.
const QUICK: [&str; 2] = [
    "--package capsule-capi --test refusals",
    "--package capsule-core --test flips",
];

/// The unit tests, which take longer.
const UNIT_TESTS: [&str; 2] = ["--package capsule-capi --lib", "--package capsule-core --lib"];

#[derive(clap::Args)]
pub struct Options {
    /// Run the quick tests alone
    #[arg(long)]
    pub quick: bool,
}

/// Runs the tests.
pub fn miri(options: &Options) -> Result<()> {
    setup::bring(&[setup::MIRI])?;
    let slow = if options.quick { &[][..] } else { &UNIT_TESTS };
    for tests in QUICK.iter().chain(slow) {
        run(&mut command(&format!(
            "cargo +nightly miri test --target {TARGET} {tests}"
        )))?;
    }
    Ok(())
}
