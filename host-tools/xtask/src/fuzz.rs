//! Fuzzing: the targets of fuzz/, each from its seeds, with what it finds kept in the target directory.

use crate::command::{command, run};
use crate::{root, setup, target_directory};
use anyhow::{Context, Result};

const TARGETS: [&str; 3] = ["model", "query", "calls"];

#[derive(clap::Args)]
pub struct Options {
    /// How long each target runs
    #[arg(long, default_value_t = 60)]
    pub seconds: u32,
}

/// Brings the compiler and cargo-fuzz.
pub fn set_up() -> Result<()> {
    setup::nightly("")?;
    setup::debian_package("g++", "g++")?;
    setup::cargo_subcommand("fuzz")
}

/// Runs every target; an input that fails is kept, and named.
pub fn fuzz(options: &Options) -> Result<()> {
    set_up()?;
    let folder = target_directory().join("fuzz");
    run(command("cargo +nightly fuzz build --target-dir").arg(&folder))?;
    for target in TARGETS {
        let corpus = folder.join("corpus").join(target);
        std::fs::create_dir_all(&corpus).with_context(|| corpus.display().to_string())?;
        run(command(&format!("cargo +nightly fuzz run {target}"))
            .arg(&corpus)
            .arg(root().join("fuzz/seeds").join(target))
            .arg("--target-dir")
            .arg(&folder)
            .args(["--", "-max_len=4096", "-print_final_stats=1", "-verbosity=0"])
            .arg(format!("-max_total_time={}", options.seconds)))?;
    }
    Ok(())
}
