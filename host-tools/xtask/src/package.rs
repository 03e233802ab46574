//! Ready archives of the C interface, one a target: header, static library, model, examples, licences.

use crate::command::{command, output, run};
use crate::setup::{self, Tool};
use crate::targets::ARCHIVES;
use crate::{header, notices, root, target_directory};
use anyhow::{Context, Result};
use clap::builder::{PossibleValue, PossibleValuesParser};
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

#[derive(clap::Args)]
pub struct Options {
    /// Build the archive of this target alone; may be repeated [default: all]
    #[arg(long = "target", value_name = "TARGET", value_parser = targets())]
    targets: Vec<String>,
    /// Then link the examples with the archives and run them in emulators: they say what they say on this machine
    #[arg(long)]
    check: bool,
}

fn targets() -> PossibleValuesParser {
    PossibleValuesParser::new(ARCHIVES.map(|archive| PossibleValue::new(archive.target).help(archive.runs_on)))
}

/// Builds the archives.
pub fn package(options: &Options) -> Result<()> {
    let mut targets: Vec<&str> = ARCHIVES.iter().map(|archive| archive.target).collect();
    if !options.targets.is_empty() {
        targets.retain(|target| options.targets.iter().any(|wanted| wanted == target));
    }
    for target in &targets {
        let folder = folder(target)?;
        run(&mut command(&format!(
            "tar -czf {0}.tar.gz -C {1} {2}",
            folder.display(),
            packages().display(),
            name(target)
        )))?;
        println!("{}.tar.gz", folder.display());
    }
    if options.check {
        setup::bring(&setup::EMULATORS)?;
        test(&targets, "the_examples_say_the_same_on_every_machine")?;
    }
    Ok(())
}

/// Runs tests of this machine's archive and of those of some targets, whose folders were built. `name` is part of the
/// tests' names.
pub fn test(targets: &[&str], name: &str) -> Result<()> {
    let host = host()?;
    folder(&host)?;
    run(command(&format!("cargo test --workspace --test c -- {name}"))
        .env("CAPSULE_PACKAGES", packages())
        .env("CAPSULE_HOST", host)
        .env("CAPSULE_TARGETS", targets.join(" ")))
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
    for header in ["capsule.hpp", "capsule_model.h"] {
        let header = Path::new("include").join(header);
        copy(&source.join(&header), &folder.join(&header))?;
    }
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
    let cpu = ARCHIVES
        .iter()
        .find(|archive| archive.target == target)
        .and_then(|archive| archive.cpu);
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
