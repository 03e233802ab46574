//! All checks, in stages: a stage whose tools are missing is named and left out, the others still run.

use crate::command::{command, command_in, run};
use crate::setup::{self, Tool};
use crate::{
    book, budgets, columns, conformance, explore, fuzz, licences, miri, npm, package, python, root, target_directory,
    targets,
};
use anyhow::{Result, bail};
use clap::ValueEnum;
use std::path::PathBuf;
use std::time::Instant;

#[derive(clap::Args)]
pub struct Options {
    /// Run these stages alone
    #[arg(long, value_enum, value_delimiter = ',')]
    only: Vec<Stage>,
    /// Fail when a stage's tools are missing, instead of leaving the stage out (CI does)
    #[arg(long, env = "CI", hide_env = true, value_parser = clap::builder::FalseyValueParser::new())]
    require_all: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum Stage {
    /// lengths of lines, rustfmt, clippy, rustdoc
    Lint,
    /// words of sources and documents (typos)
    Spelling,
    /// licences, duplicate versions and sources of the dependencies (cargo-deny)
    Licences,
    /// the documents: links, figures against stored results, code, the book
    Book,
    /// unit, property and command tests of every crate (nextest), and the examples in documentation
    Rust,
    /// the full-order model against exact and published results, in short
    Validate,
    /// the core and its C interface in Miri, which finds undefined behaviour
    Miri,
    /// the core on emulated Cortex-M4F, M7 and M33
    Firmware,
    /// the C interface: its archives, on this machine and on emulated Cortex-M4, M7 and M33
    C,
    /// instructions, stack and bytes of the online stage on an emulated Cortex-M4F
    Budgets,
    /// the seeds of fuzzing and inputs made of them; libFuzzer for a few seconds where its tools are there
    Fuzz,
    /// the Python package, from its wheel
    Python,
    /// a sharded sweep on a Slurm of one node
    Cluster,
    /// the page: types, lint, and a drive through it in Chromium; the npm packages, from their archives
    Browser,
}

impl Stage {
    /// The tools of the stage, beyond rustup and Node.
    fn tools(self) -> &'static [Tool<'static>] {
        match self {
            Self::Lint | Self::Validate | Self::Fuzz => &[],
            Self::Spelling => &[setup::PIP, setup::TYPOS],
            Self::Book => &[setup::PIP, setup::MDBOOK],
            Self::Licences => &[setup::PIP, setup::DENY],
            Self::Rust => &[setup::PIP, setup::NEXTEST],
            Self::Miri => &[setup::MIRI],
            Self::Firmware => &[setup::CORTEX_M, setup::CORTEX_M33, setup::QEMU],
            Self::C => &[
                setup::CORTEX_M,
                setup::CORTEX_M33,
                setup::CORTEX_M_SOFT,
                setup::GCC,
                setup::CLANG,
                setup::CMAKE,
                setup::PKG_CONFIG,
                setup::VALGRIND,
                setup::ARM_GCC,
                setup::QEMU,
            ],
            // wasm-opt, an npm module of the page, makes the module that is measured.
            Self::Budgets => &[
                setup::CORTEX_M,
                setup::WASM,
                setup::ARM_GCC,
                setup::QEMU,
                setup::EXPLORER_MODULES,
            ],
            Self::Python => &[setup::PIP, setup::MATURIN, setup::WHEEL, setup::NUMPY, setup::PYTEST],
            Self::Cluster => &[setup::SLURM],
            Self::Browser => &[
                setup::WASM,
                setup::CHROMIUM,
                setup::EXPLORER_MODULES,
                setup::BROWSER_MODULES,
            ],
        }
    }

    /// Whether the stage may be missing from a complete run: nightly toolchains come from a server of their own, which
    /// a closed network does not reach.
    fn is_optional(self) -> bool {
        self == Self::Miri
    }

    fn run(self) -> Result<()> {
        match self {
            Self::Lint => {
                columns::check()?;
                run(&mut command("cargo fmt --all --check"))?;
                run(&mut command(
                    "cargo clippy --quiet --workspace --all-targets -- -D warnings",
                ))?;
                run(command("cargo doc --quiet --workspace --no-deps").env("RUSTDOCFLAGS", "-D warnings"))
            }
            Self::Spelling => run(&mut command("typos")),
            Self::Licences => licences::check(),
            Self::Book => book::book(&book::Options::default()),
            Self::Rust => {
                run(&mut command("cargo nextest run --workspace --no-fail-fast"))?;
                run(&mut command("cargo test --workspace --doc --no-fail-fast"))
            }
            Self::Validate => run(command(&program()?.to_string_lossy()).args(["fom", "validate", "--quick"])),
            Self::Miri => miri::miri(&miri::Options { quick: true }),
            Self::Firmware => run(&mut command("cargo test --workspace --test firmware")),
            Self::C => {
                let targets = [targets::CORTEX_M, targets::CORTEX_M33, targets::CORTEX_M_SOFT];
                for target in targets {
                    package::folder(target)?;
                }
                package::test(&targets, "")
            }
            Self::Budgets => budgets::budgets(&budgets::Options::default()),
            Self::Fuzz => {
                fuzz::replay()?;
                if fuzz::is_set_up() {
                    fuzz::fuzz(&fuzz::Options { seconds: 20 })
                } else {
                    eprintln!("libFuzzer is left out: `cargo xtask fuzz --install` brings its tools");
                    Ok(())
                }
            }
            Self::Python => python::test(),
            Self::Cluster => run(&mut command("cargo test --workspace --test slurm")),
            Self::Browser => {
                explore::build()?;
                let program = program()?;
                run(&mut command_in(&root().join("wasm/explorer"), "npm run check"))?;
                run(&mut command_in(&root().join("wasm/explorer"), "npm run lint"))?;
                run(command_in(&root().join("tests/browser"), "npm test")
                    .env("CAPSULE_CONFORMANCE", conformance::module()?))?;
                npm::pack()?;
                npm::test(&program)
            }
        }
    }
}

/// Builds `capsule-rom`, which an integration test of its own needs, and returns where it is. Every build of a stage is
/// one of the whole workspace's tests: with one package alone, cargo chooses other features, and compiles most crates
/// again.
fn program() -> Result<PathBuf> {
    run(&mut command("cargo test --quiet --workspace --test command --no-run"))?;
    Ok(target_directory().join("debug/capsule-rom"))
}

/// Installs the tools of all stages.
pub fn set_up() -> Result<()> {
    setup::bring(&tools_of(Stage::value_variants()))
}

/// The tools of some stages, each once.
fn tools_of(stages: &[Stage]) -> Vec<Tool<'static>> {
    let mut tools = Vec::new();
    for tool in stages.iter().flat_map(|stage| stage.tools()) {
        if !tools.contains(tool) {
            tools.push(*tool);
        }
    }
    tools
}

/// Runs the stages; fails if one failed.
pub fn test(options: &Options) -> Result<()> {
    let stages: Vec<Stage> = Stage::value_variants()
        .iter()
        .copied()
        .filter(|stage| options.only.is_empty() || options.only.contains(stage))
        .collect();
    if let Err(error) = setup::bring(&tools_of(&stages)) {
        eprintln!("warning: {error:#}");
    }
    let mut report = Vec::new();
    let mut failed = false;
    for stage in stages {
        let start = Instant::now();
        let line = match setup::require(stage.tools()) {
            Err(error) => {
                failed |= options.require_all && !stage.is_optional();
                format!("LEFT OUT, {error:#}")
            }
            Ok(()) => match stage.run() {
                Ok(()) => "passed".to_owned(),
                Err(error) => {
                    failed = true;
                    format!("FAILED: {error:#}")
                }
            },
        };
        report.push(format!(
            "{:<10} {:>6.0} s  {line}",
            format!("{stage:?}").to_lowercase(),
            start.elapsed().as_secs_f64()
        ));
    }
    println!("\n{}", report.join("\n"));
    if failed {
        bail!("not all stages passed");
    }
    Ok(())
}
