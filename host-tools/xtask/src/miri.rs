//! Miri: an interpreter that stops at undefined behaviour. It is some hundred times slower than the processor, so it
//! runs the tests that reach unsafe code, and every entry point of the core on a small model.

use crate::command::{command, run};
use crate::setup;
use anyhow::Result;

/// A target for which libm has no assembler, which Miri cannot interpret.
const TARGET: &str = "riscv64gc-unknown-linux-gnu";

/// Two tests that reach all unsafe code of the C interface: its checks of pointers, its set-up of a workspace and its
/// writes. Each makes its own small model, which takes most of the time.
const QUICK: [&str; 1] = ["--package capsule-capi --test refusals -- \
     nothing_but_the_error_is_written_where_a_call_fails objects_that_were_not_set_up"];

/// All tests that make sense in Miri; they take tens of minutes.
const ALL: [&str; 3] = [
    "--package capsule-capi --lib --test refusals",
    "--package capsule-rom-core --lib",
    "--package capsule-rom-core --test suite -- flips",
];

#[derive(clap::Args)]
pub struct Options {
    /// Run a quick selection, as `cargo xtask test` does
    #[arg(long)]
    pub quick: bool,
}

/// Runs the tests.
pub fn miri(options: &Options) -> Result<()> {
    setup::bring(&[setup::MIRI])?;
    let selection: &[&str] = if options.quick { &QUICK } else { &ALL };
    for tests in selection {
        run(&mut command(&format!(
            "cargo +nightly miri test --target {TARGET} {tests}"
        )))?;
    }
    Ok(())
}
