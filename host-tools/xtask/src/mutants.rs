//! Mutation testing, on demand: cargo-mutants changes one function at a time, and a change that no test notices is
//! named. It takes hours, so it runs in shards and in no stage of `cargo xtask test`.

use crate::command::{command, run};
use crate::setup::{self, Tool};
use crate::target_directory;
use anyhow::Result;

#[derive(clap::Args)]
pub struct Options {
    /// Change the functions of these crates
    #[arg(long, value_delimiter = ',', default_values = ["capsule-rom-core", "capsule-database"])]
    package: Vec<String>,
    /// Run one of N equal samples of the mutants, counted from 0
    #[arg(long, value_name = "K/N", default_value = "0/1")]
    shard: String,
    /// Print the mutants and stop
    #[arg(long)]
    list: bool,
}

/// Tests the mutants of a shard; the results are in `target/mutants`. A crate's own tests must find its mutants.
pub fn mutants(options: &Options) -> Result<()> {
    setup::bring(&[setup::PIP, setup::NEXTEST, Tool::Subcommand("mutants")])?;
    let mut mutants =
        command("cargo mutants --test-tool nextest --no-shuffle --jobs 1 --sharding round-robin --output");
    mutants.arg(target_directory()).args(["--shard", &options.shard]);
    for package in &options.package {
        mutants.args(["--package", package]);
    }
    if options.list {
        mutants.arg("--list");
    }
    run(&mut mutants)
}
