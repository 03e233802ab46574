//! `cargo xtask`: the one entry for set-up, tests and the page, the same for a person and for CI.

mod book;
mod budgets;
mod command;
mod conformance;
mod explore;
mod fuzz;
mod header;
mod miri;
mod package;
mod scenes;
mod setup;
mod test;
mod wasm;

use anyhow::Result;
use clap::{Parser, Subcommand};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Developer tasks of capsule-rom.
#[derive(Parser)]
#[command(name = "cargo xtask", version, after_help = EXAMPLES)]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

const EXAMPLES: &str = "\
Examples:
  cargo xtask explore            build the page and serve it with the shipped model
  cargo xtask test               run every test, installing what is missing
  cargo xtask test --only rust   run the native tests alone";

#[derive(Subcommand)]
enum Task {
    /// Install what the other tasks need: Rust targets, Debian packages, npm modules
    Setup,
    /// Check the documents' links, figures and code, and build the book into target/book
    Book(book::Options),
    /// Measure what the online stage costs on a Cortex-M4F, and compare with what was recorded
    Budgets(budgets::Options),
    /// Check the conformance vectors on this machine, or write them
    Conformance(conformance::Options),
    /// Search for inputs that the core or its C interface cannot stand, with libFuzzer and the address sanitizer
    Fuzz(fuzz::Options),
    /// Run tests of the core and of its C interface in Miri, which finds undefined behaviour
    Miri,
    /// Print what scenes cost: instructions, operations, bytes, time
    Scenes,
    /// Generate core/capi/include/capsule.h from the Rust sources
    Header,
    /// Build an archive of the C interface for this machine and for Cortex-M into target/package
    Package,
    /// Build the WebAssembly module into wasm/explorer/src/wasm
    Wasm,
    /// Build CapsuleExplorer and serve it on 127.0.0.1 with the shipped model
    Explore(explore::Options),
    /// Run lints and all tests: native, firmware under QEMU, page in Chromium
    Test(test::Options),
}

/// The root of the repository.
fn root() -> PathBuf {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR"));
    manifest.ancestors().nth(2).unwrap_or(manifest).to_path_buf()
}

/// Where cargo builds.
fn target_directory() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), |set| root().join(set))
}

fn main() -> ExitCode {
    let result: Result<()> = match Arguments::parse().task {
        Task::Setup => setup::everything(),
        Task::Book(options) => book::book(&options),
        Task::Budgets(options) => budgets::budgets(&options),
        Task::Conformance(options) => conformance::conformance(&options),
        Task::Fuzz(options) => fuzz::fuzz(&options),
        Task::Miri => miri::miri(),
        Task::Scenes => scenes::scenes(),
        Task::Header => header::write(),
        Task::Package => package::package(),
        Task::Wasm => wasm::build(),
        Task::Explore(options) => explore::explore(&options),
        Task::Test(options) => test::test(&options),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
