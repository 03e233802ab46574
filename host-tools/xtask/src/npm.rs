//! The npm packages: their folders in target/npm, packed by npm, and their tests from the archives.

use crate::command::{command_in, run};
use crate::package::copy;
use crate::{explore, notices, root, target_directory};
use anyhow::{Context, Result, ensure};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// The API of the core, and the element.
const CORE: &str = "capsule-rom";
const ELEMENT: &str = "capsule-explorer";

/// Builds the packages and all that is in them, and shows what npm would publish.
pub fn npm() -> Result<()> {
    explore::build()?;
    pack()?;
    for name in [CORE, ELEMENT] {
        run(&mut command_in(
            &packages().join(name),
            "npm publish --dry-run --offline",
        ))?;
    }
    Ok(())
}

/// Makes the archives from the modules and the page that were built.
pub fn pack() -> Result<()> {
    let packages = packages();
    if packages.exists() {
        fs::remove_dir_all(&packages).with_context(|| format!("could not remove {}", packages.display()))?;
    }
    core(&packages.join(CORE))?;
    element(&packages.join(ELEMENT))?;
    for name in [CORE, ELEMENT] {
        run(command_in(&packages.join(name), "npm pack --loglevel error --pack-destination").arg(&packages))?;
    }
    Ok(())
}

/// Tests the packages from their archives, against `program`, the command.
pub fn test(program: &Path) -> Result<()> {
    run(
        command_in(&root().join("wasm/npm/tests"), "node --test --test-concurrency=2")
            .env("CAPSULE_ROM", program)
            .env("CAPSULE_NPM", packages()),
    )
}

/// The package of the core's API.
fn core(folder: &Path) -> Result<()> {
    let modules = root().join("wasm/explorer/src/wasm");
    let dist = folder.join("dist");
    describe(CORE, folder)?;
    run(command_in(
        &root().join("wasm/explorer"),
        "npx --no-install tsc --project ../npm/capsule-rom --outDir",
    )
    .arg(&dist))?;
    for module in ["capsule_wasm", "capsule_identify_wasm"] {
        for file in [format!("{module}.js"), format!("{module}_bg.wasm")] {
            copy(&modules.join(&file), &dist.join(&file))?;
        }
    }
    copy(&root().join("models/capsule.crom"), &dist.join("capsule.crom"))?;
    copy(&modules.join(notices::FILE), &folder.join(notices::FILE))
}

/// The package of the element: its script of the page, and what that loads.
fn element(folder: &Path) -> Result<()> {
    let page = root().join("wasm/explorer/dist");
    let dist = folder.join("dist");
    describe(ELEMENT, folder)?;
    // Written by hand: the page's `npm run check` compares them with its own types.
    let declarations = format!("{ELEMENT}.d.ts");
    copy(&source(ELEMENT).join(&declarations), &dist.join(&declarations))?;
    for file in loaded(&page, &format!("{ELEMENT}.js"))? {
        copy(&page.join(&file), &dist.join(&file))?;
    }
    // The script's link to the notices leads beside it.
    for file in ["capsule.crom", notices::FILE] {
        copy(&page.join(file), &dist.join(file))?;
    }
    Ok(())
}

/// Description, guide and licences of a package, whose version must be that of the workspace.
fn describe(name: &str, folder: &Path) -> Result<()> {
    let description = source(name).join("package.json");
    let text = fs::read_to_string(&description).with_context(|| description.display().to_string())?;
    let (stated, version) = (
        serde_json::from_str::<Value>(&text)?["version"].take(),
        env!("CARGO_PKG_VERSION"),
    );
    ensure!(
        stated == version,
        "{} has the version {stated}, the workspace \"{version}\"",
        description.display()
    );
    for file in ["package.json", "README.md"] {
        copy(&source(name).join(file), &folder.join(file))?;
    }
    for licence in ["LICENSE-MIT", "LICENSE-APACHE"] {
        copy(&root().join(licence), &folder.join(licence))?;
    }
    Ok(())
}

/// The files of the built page that a script needs: itself, and whatever these files name.
fn loaded(page: &Path, script: &str) -> Result<BTreeSet<String>> {
    let assets: Vec<String> = fs::read_dir(page.join("assets"))
        .with_context(|| format!("{}: the page is not built", page.display()))?
        .map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()))
        .collect::<Result<_>>()?;
    let mut needed = BTreeSet::new();
    let mut open = vec![script.to_owned()];
    while let Some(file) = open.pop() {
        let bytes = fs::read(page.join(&file)).with_context(|| format!("the page has no {file}"))?;
        if file.ends_with(".js") || file.ends_with(".css") {
            let text = String::from_utf8_lossy(&bytes);
            let named = assets.iter().filter(|asset| text.contains(&***asset));
            open.extend(
                named
                    .map(|asset| format!("assets/{asset}"))
                    .filter(|asset| !needed.contains(asset)),
            );
        }
        needed.insert(file);
    }
    Ok(needed)
}

/// The sources of a package.
fn source(name: &str) -> PathBuf {
    root().join("wasm/npm").join(name)
}

fn packages() -> PathBuf {
    target_directory().join("npm")
}
