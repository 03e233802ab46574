//! All checks, in stages: a stage whose tools cannot be had is named and left out, the others still run.

use crate::command::{command, command_in, run};
use crate::{book, budgets, conformance, explore, fuzz, package, root, setup};
use anyhow::{Result, bail};
use clap::ValueEnum;
use std::time::Instant;

#[derive(clap::Args)]
pub struct Options {
    /// Run these stages alone
    #[arg(long, value_enum, value_delimiter = ',')]
    only: Vec<Stage>,
    /// Fail when a stage's tools are missing, instead of leaving the stage out (CI does)
    #[arg(long, env = "CI", value_parser = clap::builder::FalseyValueParser::new())]
    require_all: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum Stage {
    /// rustfmt, clippy, rustdoc
    Lint,
    /// the documents: links, figures against stored results, code, the book
    Book,
    /// unit, property and command tests of every crate
    Rust,
    /// the core on emulated Cortex-M4F, M7 and M33
    Firmware,
    /// the C interface: its archives, on this machine and on emulated Cortex-M4F, M7 and M33
    C,
    /// instructions, stack and bytes of the online stage on an emulated Cortex-M4F
    Budgets,
    /// the seeds of fuzzing and inputs made of them; libFuzzer for a few seconds where it is installed
    Fuzz,
    /// a sharded sweep on a Slurm of one node
    Cluster,
    /// the page: types, lint, and a drive through it in Chromium
    Browser,
}

impl Stage {
    const ALL: [Self; 9] = [
        Self::Lint,
        Self::Book,
        Self::Rust,
        Self::Firmware,
        Self::C,
        Self::Budgets,
        Self::Fuzz,
        Self::Cluster,
        Self::Browser,
    ];

    /// Brings what the stage needs beyond rustup.
    fn set_up(self) -> Result<()> {
        match self {
            Self::Lint | Self::Rust | Self::Fuzz => Ok(()),
            Self::Book => book::set_up(),
            Self::Firmware => {
                setup::rust_target(package::CORTEX_M)?;
                setup::rust_target(package::CORTEX_M33)?;
                setup::debian_package("qemu-system-arm", "qemu-system-arm")
            }
            Self::Budgets => {
                setup::rust_target(package::CORTEX_M)?;
                setup::debian_package("arm-none-eabi-gcc", "gcc-arm-none-eabi libnewlib-arm-none-eabi")?;
                setup::debian_package("qemu-system-arm", "qemu-system-arm")
            }
            Self::C => {
                setup::rust_target(package::CORTEX_M)?;
                setup::rust_target(package::CORTEX_M33)?;
                setup::debian_package("gcc", "gcc g++ libc6-dev")?;
                setup::debian_package("clang", "clang")?;
                setup::debian_package("valgrind", "valgrind")?;
                setup::debian_package("arm-none-eabi-gcc", "gcc-arm-none-eabi libnewlib-arm-none-eabi")?;
                setup::debian_package("qemu-system-arm", "qemu-system-arm")
            }
            Self::Cluster => setup::debian_package("slurmctld", "slurmctld slurmd slurm-client munge"),
            Self::Browser => {
                setup::rust_target("wasm32-unknown-unknown")?;
                setup::debian_package("chromium", "chromium")?;
                setup::npm_modules("wasm/explorer")?;
                setup::npm_modules("tests/browser")
            }
        }
    }

    fn run(self) -> Result<()> {
        match self {
            Self::Lint => {
                run(&mut command("cargo fmt --all --check"))?;
                run(&mut command(
                    "cargo clippy --quiet --workspace --all-targets -- -D warnings",
                ))?;
                run(command("cargo doc --quiet --workspace --no-deps").env("RUSTDOCFLAGS", "-D warnings"))
            }
            Self::Book => book::book(&book::Options::default()),
            Self::Rust => run(&mut command("cargo test --workspace --no-fail-fast")),
            Self::Firmware => run(&mut command("cargo test --package capsule-core --test firmware")),
            Self::C => {
                let host = package::host()?;
                let mut test = command("cargo test --package capsule-capi --test c");
                for (variable, target) in [
                    ("CAPSULE_HOST_PACKAGE", &*host),
                    ("CAPSULE_CORTEX_M_PACKAGE", package::CORTEX_M),
                    ("CAPSULE_CORTEX_M33_PACKAGE", package::CORTEX_M33),
                ] {
                    test.env(variable, package::folder(target)?);
                }
                run(&mut test)
            }
            Self::Budgets => budgets::budgets(&budgets::Options::default()),
            Self::Fuzz => {
                fuzz::replay()?;
                if fuzz::is_set_up() {
                    fuzz::fuzz(&fuzz::Options { seconds: 20 })
                } else {
                    eprintln!("libFuzzer is left out: `cargo xtask fuzz` installs what it needs");
                    Ok(())
                }
            }
            Self::Cluster => run(&mut command("cargo test --package capsule-cli --test slurm")),
            Self::Browser => {
                explore::build()?;
                run(&mut command("cargo build --quiet --package capsule-cli"))?;
                run(&mut command_in(&root().join("wasm/explorer"), "npm run check"))?;
                run(&mut command_in(&root().join("wasm/explorer"), "npm run lint"))?;
                run(command_in(&root().join("tests/browser"), "npm test")
                    .env("CAPSULE_CONFORMANCE", conformance::module()?))
            }
        }
    }
}

/// Runs the stages; fails if one failed.
pub fn test(options: &Options) -> Result<()> {
    let mut report = Vec::new();
    let mut failed = false;
    for stage in Stage::ALL {
        if !options.only.is_empty() && !options.only.contains(&stage) {
            continue;
        }
        let start = Instant::now();
        let line = match stage.set_up() {
            Err(error) => {
                failed |= options.require_all;
                format!("LEFT OUT, tools are missing:\n    {error:#}")
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
