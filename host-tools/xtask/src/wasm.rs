//! The WebAssembly modules of the page: cargo, then wasm-bindgen as a library (so that it is always the version of the
//! crate), then wasm-opt from the page's npm modules.

use crate::command::{command, run};
use crate::targets::WASM;
use crate::{notices, root, setup, target_directory};
use anyhow::{Context, Result};
use std::path::Path;

/// The features that rustc assumes of an engine, and the vectors of .cargo/config.toml; with more, wasm-opt writes
/// modules that browsers refuse.
const RUSTC_FEATURES: [&str; 8] = [
    "--enable-bulk-memory",
    "--enable-bulk-memory-opt",
    "--enable-multivalue",
    "--enable-mutable-globals",
    "--enable-nontrapping-float-to-int",
    "--enable-reference-types",
    "--enable-sign-ext",
    "--enable-simd",
];

/// The crates of the modules: the one that every page loads, and the one that it loads when it is asked for.
const CRATES: [&str; 2] = ["capsule-wasm", "capsule-identify-wasm"];

/// Builds `wasm/explorer/src/wasm/`.
pub fn build() -> Result<()> {
    setup::bring(&[setup::WASM])?;
    let folder = root().join("wasm/explorer/src/wasm");
    let mut texts = Vec::new();
    for name in CRATES {
        module(name, &folder)?;
        texts.push(notices::of(name, WASM)?);
    }
    std::fs::write(folder.join(notices::FILE), texts.join("\n"))
        .with_context(|| format!("could not write {}", notices::FILE))
}

/// Builds the module of a crate into a folder.
fn module(name: &str, folder: &Path) -> Result<()> {
    run(&mut command(&format!(
        "cargo build --quiet --package {name} --profile wasm --target {WASM}"
    )))?;
    let file = name.replace('-', "_");
    let module = target_directory().join(WASM).join(format!("wasm/{file}.wasm"));
    wasm_bindgen_cli_support::Bindgen::new()
        .input_path(&module)
        .web(true)?
        .typescript(true)
        .generate(folder)
        .with_context(|| format!("wasm-bindgen on {}", module.display()))?;
    optimise(&folder.join(format!("{file}_bg.wasm")), "-O3")
}

/// Optimises a module in place, by these options of wasm-opt.
pub fn optimise(module: &Path, options: &str) -> Result<()> {
    setup::bring(&[setup::EXPLORER_MODULES])?;
    let wasm_opt = root().join("wasm/explorer/node_modules/.bin/wasm-opt");
    run(command(&wasm_opt.to_string_lossy())
        .args(options.split_whitespace())
        .args(RUSTC_FEATURES)
        .arg("-o")
        .args([module, module]))
}
