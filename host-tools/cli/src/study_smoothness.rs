//! `capsule-rom study smoothness`: the scatter of the samples of a database.

use crate::print;
use anyhow::Result;
use capsule_database::Database;
use capsule_study::smoothness::{Difference, smoothness};
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
#[command(after_help = "Example:\n  capsule-rom study smoothness --database models/database --json")]
pub struct Options {
    /// Folder of the database
    #[arg(long, value_name = "DIR", default_value = "models/database")]
    database: PathBuf,
    /// Step in Ca of the samples that are compared
    #[arg(long, default_value_t = 0.01)]
    step: f64,
    /// Print one JSON array
    #[arg(long)]
    json: bool,
}

pub fn run(options: &Options) -> Result<()> {
    let rows = smoothness(&Database::open(&options.database)?, options.step)?;
    if options.json {
        return print::json(&rows);
    }
    let percent = |value: f64| format!("{:.4}", 100.0 * value);
    let mut table = Vec::new();
    for row in &rows {
        for (frame, differences) in [("laboratory", &row.laboratory), ("shape", &row.shape)] {
            table.extend(differences.iter().map(|difference: &Difference| {
                vec![
                    format!("{:.2}", row.confinement),
                    frame.to_owned(),
                    difference.order.to_string(),
                    percent(difference.greatest),
                    format!("{:.3}", difference.at[0]),
                    difference.at[1].to_string(),
                    percent(difference.median),
                    percent(difference.scatter),
                ]
            }));
        }
    }
    print::table(
        &[
            "a/l",
            "frame",
            "order",
            "greatest/%a",
            "at Ca",
            "at t",
            "median/%a",
            "scatter/%a",
        ],
        &table,
    )
}
