//! Fuzzing: the targets of fuzz/, each from its seeds, with what it finds kept in the target directory.

use crate::command::{command, on_path, run};
use crate::{root, setup, target_directory};
use anyhow::{Context, Result};

/// The targets, and the longest input that says anything to each.
const TARGETS: [(&str, u32); 3] = [("model", 1024), ("query", 256), ("calls", 1024)];

#[derive(clap::Args)]
pub struct Options {
    /// How long each target runs
    #[arg(long, default_value_t = 60)]
    pub seconds: u32,
}

/// Replays the seeds of every target and inputs made of them: needs nothing but the stable compiler.
pub fn replay() -> Result<()> {
    run(
        command("cargo test --quiet --manifest-path fuzz/Cargo.toml --target-dir")
            .arg(target_directory().join("fuzz-replay")),
    )
}

/// Whether all that fuzzing needs is there.
pub fn is_set_up() -> bool {
    on_path("cargo-fuzz") && on_path("g++") && setup::has_nightly("")
}

/// Runs every target; an input that fails is kept, and named.
pub fn fuzz(options: &Options) -> Result<()> {
    setup::nightly("")?;
    setup::debian_package("g++", "g++")?;
    setup::cargo_subcommand("fuzz")?;
    let folder = target_directory().join("fuzz");
    // Where numbers are compared in every line, to trace each comparison finds nothing and takes most of the time.
    run(command("cargo +nightly fuzz build --features fuzzer --no-trace-compares --target-dir").arg(&folder))?;
    for (target, longest) in TARGETS {
        let corpus = folder.join("corpus").join(target);
        std::fs::create_dir_all(&corpus).with_context(|| corpus.display().to_string())?;
        run(command(&format!(
            "cargo +nightly fuzz run --features fuzzer --no-trace-compares {target}"
        ))
        .arg(&corpus)
        .arg(root().join("fuzz/seeds").join(target))
        .arg("--target-dir")
        .arg(&folder)
        .args(["--", "-print_final_stats=1", "-verbosity=0"])
        .arg(format!("-max_len={longest}"))
        .arg(format!("-max_total_time={}", options.seconds)))?;
    }
    Ok(())
}
