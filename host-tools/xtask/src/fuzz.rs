//! Fuzzing: the targets of tests/fuzz/, each from its seeds. The corpus grows in the target directory.

use crate::command::{command, run};
use crate::setup::{self, Tool};
use crate::{root, target_directory};
use anyhow::{Context, Result, bail};
use std::path::Path;
use std::process::Command;
use std::thread;

struct Target {
    name: &'static str,
    /// The length beyond which the target ignores its input, in bytes.
    longest: u32,
    sanitizer: &'static str,
}

/// Without unsafe code the address sanitizer finds nothing, and takes two thirds of the time.
const TARGETS: [Target; 3] = [
    Target {
        name: "model",
        longest: 1024,
        sanitizer: "none",
    },
    Target {
        name: "query",
        longest: 256,
        sanitizer: "none",
    },
    Target {
        name: "calls",
        longest: 1024,
        sanitizer: "address",
    },
];

/// The tools of fuzzing.
const TOOLS: [Tool; 4] = [setup::NIGHTLY, setup::PIP, setup::CARGO_FUZZ, setup::GCC];

#[derive(clap::Args)]
pub struct Options {
    /// How long each target runs
    #[arg(long, default_value_t = 60)]
    pub seconds: u32,
}

/// Replays the seeds of every target, and inputs derived from them, with the stable compiler.
pub fn replay() -> Result<()> {
    run(
        command("cargo test --quiet --manifest-path tests/fuzz/Cargo.toml --target-dir")
            .arg(target_directory().join("fuzz-replay")),
    )
}

/// Whether the tools of fuzzing are there.
pub fn is_set_up() -> bool {
    TOOLS.iter().all(Tool::is_there)
}

/// Runs the targets side by side; an input that fails is kept, and named.
pub fn fuzz(options: &Options) -> Result<()> {
    setup::bring(&TOOLS)?;
    let folder = target_directory().join("fuzz");
    for target in &TARGETS {
        run(&mut target.cargo_fuzz("build", &folder))?;
    }
    let executed: Vec<Result<u64>> = thread::scope(|scope| {
        let runs = TARGETS.each_ref().map(|target| {
            let folder = &folder;
            scope.spawn(move || target.fuzz(options.seconds, folder))
        });
        runs.map(|run| run.join().expect("a thread that returns errors")).into()
    });
    let mut all: Result<u64> = Ok(0);
    for (target, executed) in TARGETS.iter().zip(executed) {
        if let Ok(executed) = &executed {
            println!("{:<6} {executed:>12} executions", target.name);
        }
        all = all.and_then(|sum| Ok(sum + executed?));
    }
    println!("{:<6} {:>12}", "all", all?);
    Ok(())
}

impl Target {
    /// A call of cargo-fuzz. Numerical code compares in every line: tracing each comparison finds nothing and takes
    /// most of the time.
    fn cargo_fuzz(&self, what: &str, folder: &Path) -> Command {
        let Self { name, sanitizer, .. } = self;
        let mut cargo_fuzz = command(&format!(
            "cargo +nightly fuzz {what} --features fuzzer --no-trace-compares --sanitizer {sanitizer} {name} \
             --target-dir"
        ));
        cargo_fuzz.arg(folder.join(sanitizer));
        cargo_fuzz
    }

    /// Searches for some time; returns the number of executions.
    fn fuzz(&self, seconds: u32, folder: &Path) -> Result<u64> {
        let Self { name, longest, .. } = self;
        let corpus = folder.join("corpus").join(name);
        std::fs::create_dir_all(&corpus).with_context(|| corpus.display().to_string())?;
        let searched = self
            .cargo_fuzz("run", folder)
            .arg(&corpus)
            .arg(root().join("tests/fuzz/seeds").join(name))
            .args(["--", "-print_final_stats=1", "-verbosity=0"])
            .arg(format!("-max_len={longest}"))
            .arg(format!("-max_total_time={seconds}"))
            .output()
            .context("could not start cargo-fuzz")?;
        let text = String::from_utf8_lossy(&searched.stderr);
        if !searched.status.success() {
            bail!("{name} found an input that fails:\n{text}");
        }
        let executed = text
            .lines()
            .find_map(|line| line.strip_prefix("stat::number_of_executed_units:"));
        let executed = executed.and_then(|number| number.trim().parse().ok());
        executed.with_context(|| format!("{name} does not say how much it did:\n{text}"))
    }
}
