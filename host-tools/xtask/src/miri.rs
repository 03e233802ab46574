//! Miri: an interpreter that stops at undefined behaviour. It is some hundred times slower than the processor, so it
//! runs the C interface's refusals and its set-up of a workspace, where the unsafe code is, the core's own tests, and
//! every entry point on a small model, whole and with bits flipped.

use crate::command::{command, run};
use crate::setup;
use anyhow::Result;

/// A target for which libm has no assembler, which Miri cannot interpret; the tests need nothing else of it.
const TARGET: &str = "riscv64gc-unknown-linux-gnu";

/// Runs the tests.
pub fn miri() -> Result<()> {
    setup::bring(&[setup::MIRI])?;
    for tests in [
        "--package capsule-capi --lib --test refusals",
        "--package capsule-core --lib --test flips",
    ] {
        run(&mut command(&format!(
            "cargo +nightly miri test --target {TARGET} {tests}"
        )))?;
    }
    Ok(())
}
