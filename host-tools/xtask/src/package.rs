//! Ready archives of the C interface, one a target: header, static library, model, examples, licences.

use crate::command::{command, output, run};
use crate::setup::{self, Tool};
use crate::targets::{CORTEX_M, CORTEX_M33};
use crate::{header, notices, root, target_directory};
use anyhow::{Context, Result};
use std::fs;
use std::path::{Path, PathBuf};

/// A static library of the interface.
pub struct Library {
    /// Its file.
    pub name: &'static str,
    features: &'static str,
}

/// With both methods.
pub const FULL: Library = Library {
    name: "libcapsule.a",
    features: "standalone",
};
/// Without the paper's method.
pub const DIRECT: Library = Library {
    name: "libcapsule_direct.a",
    features: "standalone,direct",
};

/// Templates of the descriptions for build systems, and their places in the archive: CMake, pkg-config, PlatformIO,
/// Zephyr.
const DESCRIPTIONS: [(&str, &str); 7] = [
    ("capsule-config.cmake", "lib/cmake/capsule/capsule-config.cmake"),
    (
        "capsule-config-version.cmake.in",
        "lib/cmake/capsule/capsule-config-version.cmake",
    ),
    ("capsule.pc.in", "lib/pkgconfig/capsule.pc"),
    ("library.json.in", "library.json"),
    ("zephyr/module.yml", "zephyr/module.yml"),
    ("zephyr/CMakeLists.txt", "zephyr/CMakeLists.txt"),
    ("zephyr/Kconfig", "zephyr/Kconfig"),
];

/// Builds the archives of this machine and of Cortex-M.
pub fn package() -> Result<()> {
    for target in [host()?, CORTEX_M.to_owned(), CORTEX_M33.to_owned()] {
        let folder = folder(&target)?;
        run(&mut command(&format!(
            "tar -czf {0}.tar.gz -C {1} {2}",
            folder.display(),
            packages().display(),
            name(&target)
        )))?;
        println!("{}.tar.gz", folder.display());
    }
    Ok(())
}

/// Builds the archive's folder for a target and returns it.
pub fn folder(target: &str) -> Result<PathBuf> {
    let (source, folder) = (root().join("core/capi"), packages().join(name(target)));
    if folder.exists() {
        fs::remove_dir_all(&folder).with_context(|| format!("could not remove {}", folder.display()))?;
    }
    for library in [FULL, DIRECT] {
        copy(&build(&library, target)?, &folder.join("lib").join(library.name))?;
    }
    copy(&header::path(), &folder.join("include/capsule.h"))?;
    copy(&source.join("include/capsule.hpp"), &folder.join("include/capsule.hpp"))?;
    for (template, place) in DESCRIPTIONS {
        describe(&source.join("packaging").join(template), &folder.join(place))?;
    }
    copy(&source.join("README.md"), &folder.join("README.md"))?;
    for licence in ["LICENSE-MIT", "LICENSE-APACHE"] {
        copy(&root().join(licence), &folder.join(licence))?;
    }
    let notices = folder.join(notices::FILE);
    fs::write(&notices, notices::of("capsule-capi", target)?)
        .with_context(|| format!("could not write {}", notices.display()))?;
    copy(&root().join("models/capsule.crom"), &folder.join("models/capsule.crom"))?;
    for part in ["examples", "examples/cortex-m"] {
        for entry in fs::read_dir(source.join(part)).with_context(|| format!("core/capi/{part}"))? {
            let file = entry?.path();
            if let (true, Some(name)) = (file.is_file(), file.file_name()) {
                copy(&file, &folder.join(part).join(name))?;
            }
        }
    }
    Ok(folder)
}

/// Writes a description for a build system: its template with the version.
fn describe(template: &Path, place: &Path) -> Result<()> {
    copy(template, place)?;
    let text = fs::read_to_string(place).with_context(|| place.display().to_string())?;
    let text = text.replace("@VERSION@", env!("CARGO_PKG_VERSION"));
    fs::write(place, text).with_context(|| format!("could not write {}", place.display()))
}

/// Builds a static library for a target.
fn build(library: &Library, target: &str) -> Result<PathBuf> {
    interface(library, target, "staticlib", "")?;
    Ok(target_directory().join(target).join("embedded/libcapsule_capi.a"))
}

/// Builds the C interface for a target. A function that LLVM weighs more than seven instructions is called: on a
/// Cortex-M4F that takes 2 % less code than its own limit for size.
pub fn interface(library: &Library, target: &str, crate_type: &str, flags: &str) -> Result<()> {
    setup::bring(&[Tool::Target(target)])?;
    let cpu = match target {
        CORTEX_M => Some("cortex-m4"),
        CORTEX_M33 => Some("cortex-m33"),
        _ => None,
    };
    let mut build = command(&format!(
        "cargo rustc --quiet --package capsule-capi --crate-type {crate_type} --features {} --profile embedded \
         --target {target} -- -C llvm-args=-inline-threshold=7 {flags}",
        library.features
    ));
    // The processor is set for every crate: capsule-dsp chooses its instructions by it.
    if let Some(cpu) = cpu {
        build
            .env("RUSTFLAGS", format!("-C target-cpu={cpu}"))
            .env_remove("CARGO_ENCODED_RUSTFLAGS");
    }
    run(&mut build)
}

/// The target of this machine.
pub fn host() -> Result<String> {
    Ok(output(&mut command("rustc --print host-tuple"))?.trim().to_owned())
}

fn packages() -> PathBuf {
    target_directory().join("package")
}

fn name(target: &str) -> String {
    format!("capsule-rom-{}-{target}", env!("CARGO_PKG_VERSION"))
}

/// Copies a file, and makes its folder.
pub fn copy(from: &Path, to: &Path) -> Result<()> {
    let copied = to
        .parent()
        .map_or(Ok(()), fs::create_dir_all)
        .and_then(|()| fs::copy(from, to));
    copied.with_context(|| format!("could not copy {} to {}", from.display(), to.display()))?;
    Ok(())
}
