//! The Python package: its wheel, and its tests against the command line from an installation of the wheel.

use crate::command::{command, run};
use crate::{root, target_directory};
use anyhow::{Context, Result};
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// Builds the wheel, installs it into a folder of its own, and runs the package's tests with `program`, the command
/// that the numbers are compared with.
pub fn test(program: &Path) -> Result<()> {
    let (wheels, package) = (target_directory().join("wheels"), target_directory().join("python"));
    for folder in [&wheels, &package] {
        if folder.exists() {
            std::fs::remove_dir_all(folder).with_context(|| format!("could not remove {}", folder.display()))?;
        }
    }
    run(command(
        "maturin build --quiet --profile dev --compatibility linux --manifest-path host-tools/python/Cargo.toml --out",
    )
    .arg(&wheels))?;
    let wheel = std::fs::read_dir(&wheels)?
        .next()
        .context("maturin wrote no wheel")??
        .path();
    run(command("python3 -m pip install --quiet --no-deps --no-index --target")
        .arg(&package)
        .arg(wheel))?;
    run(command("python3 -m pytest --quiet host-tools/python/tests")
        .env("PYTHONPATH", import_path(&package)?)
        .env("CAPSULE_ROM_COMMAND", program))
}

/// The package and the tools from PyPI.
fn import_path(package: &Path) -> Result<OsString> {
    let tools = std::fs::read_dir(root().join(target_directory()).join("tools"));
    let tools = tools.into_iter().flatten().flatten().map(|tool| tool.path());
    let folders: Vec<PathBuf> = [package.to_owned()].into_iter().chain(tools).collect();
    Ok(std::env::join_paths(folders)?)
}
