//! `capsule-rom fom limit`: the steady limit of each row of a database.

use crate::print;
use anyhow::{Result, bail};
use capsule_database::Database;
use capsule_offline::SteadyLimit;
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Folder of the database
    #[arg(long, value_name = "DIR", default_value = "models/database")]
    database: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

const EXAMPLES: &str = "\
Examples:
  capsule-rom fom limit
  capsule-rom fom limit --database coarse --json

For each confinement: the greatest capillary number with a steady state, the least one above it without, and the \
middle between them, an estimate of the limit to half the bracket.";

/// The JSON output.
#[derive(Serialize)]
struct Limits {
    limits: Vec<SteadyLimit>,
}

pub fn run(options: &Options) -> Result<()> {
    let limits = capsule_offline::steady_limits(&Database::open(&options.database)?.entries()?);
    if limits.is_empty() {
        bail!("{} holds no configuration", options.database.display());
    }
    if options.json {
        return print::json(&Limits { limits });
    }
    let text = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.5}"));
    let rows: Vec<Vec<String>> = limits
        .iter()
        .map(|limit| {
            vec![
                format!("{:.4}", limit.confinement),
                text(limit.largest_steady_ca),
                text(limit.smallest_unsteady_ca),
                text(limit.limit),
            ]
        })
        .collect();
    print::table(&["a/l", "steady_to_ca", "unsteady_from_ca", "limit"], &rows)
}
