//! Miri: an interpreter that stops at undefined behaviour. It is some hundred times slower than the processor, so it runs
//! the tests that touch memory in new ways, not those that compute long.

use crate::command::{command, run};
use crate::setup;
use anyhow::Result;

/// Runs the tests.
pub fn miri() -> Result<()> {
    setup::nightly("miri rust-src")?;
    run(&mut command(
        "cargo +nightly miri test --package capsule-capi --test refusals",
    ))?;
    run(&mut command("cargo +nightly miri test --package capsule-core --lib"))
}
