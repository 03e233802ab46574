//! The Python package: its wheel, with the command `capsule-rom` in it, and its tests from an installation of it.

use crate::command::{command, output, run};
use crate::setup::{self, MATURIN, PIP, WHEEL};
use crate::{notices, root, target_directory};
use anyhow::{Context, Result};
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

/// Builds the wheel of this machine.
pub fn package() -> Result<()> {
    setup::bring(&[PIP, MATURIN, WHEEL])?;
    run(&mut command(
        "cargo build --quiet --release --package capsule-rom --package capsule-python",
    ))?;
    println!("{}", wheel("release")?.display());
    Ok(())
}

/// Builds the wheel, installs it into a folder of its own, and runs the package's tests there, against the command that
/// comes with it.
pub fn test() -> Result<()> {
    // With the features of the workspace's tests: of one package alone cargo chooses others, and compiles most crates
    // again.
    run(&mut command("cargo build --quiet --workspace --lib --test command"))?;
    let wheel = wheel("debug")?;
    let package = emptied("python/package")?;
    run(command("python3 -m pip install --quiet --no-deps --no-index --target")
        .arg(&package)
        .arg(wheel))?;
    run(command("python3 -m pytest --quiet host-tools/python/tests")
        .env("PYTHONPATH", import_path(&[&package])?)
        .env("CAPSULE_ROM_COMMAND", package.join("bin/capsule-rom")))
}

/// Packs what cargo has built: maturin writes the description, as for an installation from the sources.
fn wheel(profile: &str) -> Result<PathBuf> {
    let (content, wheels) = (emptied("python/content")?, emptied("python/wheels")?);
    let description = output(
        command("maturin pep517 write-dist-info --quiet --compatibility linux --manifest-path")
            .arg(root().join("host-tools/python/Cargo.toml"))
            .arg("--metadata-directory")
            .arg(&content),
    )?;
    let description = description.trim();
    let package = content.join("capsule_rom");
    let sources = root().join("host-tools/python/python/capsule_rom");
    for entry in fs::read_dir(&sources).with_context(|| sources.display().to_string())? {
        let file = entry?.path();
        if let (true, Some(name)) = (file.is_file(), file.file_name()) {
            copy(&file, &package.join(name))?;
        }
    }
    let built = target_directory().join(profile);
    let scripts = description.replace(".dist-info", ".data/scripts");
    strip(&built.join("lib_core.so"), &package.join("_core.abi3.so"))?;
    strip(&built.join("capsule-rom"), &content.join(scripts).join("capsule-rom"))?;
    let host = crate::package::host()?;
    let notices = ["capsule-python", "capsule-rom"].map(|package| notices::of(package, &host));
    let notices: Vec<String> = notices.into_iter().collect::<Result<_>>()?;
    let licences = content.join(description).join("licenses");
    fs::write(licences.join(notices::FILE), notices.join("\n")).context("could not write the notices")?;
    run(command("python3 -m wheel pack --dest-dir")
        .arg(&wheels)
        .arg(&content)
        .env("PYTHONPATH", import_path(&[])?)
        .stdout(std::process::Stdio::null()))?;
    let wheel = fs::read_dir(&wheels)?.next().context("there is no wheel")??;
    Ok(wheel.path())
}

/// Copies a program or library without its symbols.
fn strip(from: &Path, to: &Path) -> Result<()> {
    create_parent(to)?;
    run(command("strip -o").arg(to).arg(from))
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    create_parent(to)?;
    fs::copy(from, to).with_context(|| format!("could not copy {} to {}", from.display(), to.display()))?;
    Ok(())
}

fn create_parent(path: &Path) -> Result<()> {
    let created = path.parent().map_or(Ok(()), fs::create_dir_all);
    created.with_context(|| format!("could not create the folder of {}", path.display()))
}

/// An empty folder below the target directory.
fn emptied(name: &str) -> Result<PathBuf> {
    let folder = root().join(target_directory()).join(name);
    if folder.exists() {
        fs::remove_dir_all(&folder).with_context(|| format!("could not remove {}", folder.display()))?;
    }
    fs::create_dir_all(&folder).with_context(|| format!("could not create {}", folder.display()))?;
    Ok(folder)
}

/// Packages that are installed apart, and the tools from PyPI.
fn import_path(packages: &[&Path]) -> Result<OsString> {
    let tools = fs::read_dir(root().join(target_directory()).join("tools"));
    let tools = tools.into_iter().flatten().flatten().map(|tool| tool.path());
    let folders: Vec<PathBuf> = packages.iter().map(PathBuf::from).chain(tools).collect();
    Ok(std::env::join_paths(folders)?)
}
