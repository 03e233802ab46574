//! `capsule-rom fom convergence`: the error of each numerical cause alone.

use crate::outputs::Outputs;
use crate::{print, progress};
use anyhow::{Result, bail};
use capsule_database::table;
use capsule_validation::convergence::{self, Error, Report, Row};
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Folder of the finished runs, from which an interrupted study resumes; empty it when the solver has changed
    #[arg(long, value_name = "DIR", default_value = "target/convergence")]
    runs: PathBuf,
    /// Cases computed at the same time, each on one thread
    #[arg(long, default_value_t = 2)]
    workers: usize,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Write the rows as CSV
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// No progress bar
    #[arg(short, long)]
    quiet: bool,
}

const EXAMPLES: &str = "\
Examples:
  capsule-rom fom convergence
  capsule-rom fom convergence --out docs/results/convergence.csv --json > convergence.json

Each case differs from the production settings (*) in one thing and is compared with the last, finest one of its \
cause, at t = 8 or when the shape stands still: modified Hausdorff distance of both section outlines in the frame of \
the centroid and difference of the rear depth in per cent of a, velocity and pressure drop in per cent. A total adds \
up the causes at the production settings. It takes an hour or more.";

pub fn run(options: &Options) -> Result<()> {
    if options.workers == 0 {
        bail!("--workers must be at least 1");
    }
    let mut outputs = Outputs::default()
        .reads("--runs", options.runs.as_path())
        .file("--out", options.out.as_deref())
        .checked()?;
    let bar = progress::tasks(options.quiet);
    let report = convergence::study(
        &convergence::cases(),
        &convergence::CONFIGURATIONS,
        &options.runs,
        options.workers,
        &|done, of| progress::show(&bar, "runs", done, of),
    )?;
    bar.finish_and_clear();
    if let Some(file) = &options.out {
        let heading = HEADING.iter().chain(&["production", "status"]);
        let text = table::csv(None, heading, report.rows.iter().map(record))?;
        outputs.write(file, |file| std::fs::write(file, text))?;
    }
    outputs.finish()?;
    if options.json {
        return print::json(&report);
    }
    table(&report)
}

const HEADING: [&str; 14] = [
    "Ca",
    "a/l",
    "cause",
    "value",
    "profile_percent",
    "velocity_percent",
    "pressure_drop_percent",
    "rear_depth_percent",
    "velocity",
    "pressure_drop",
    "rear_depth",
    "t",
    "evaluations",
    "wall_time_s",
];

fn record(row: &Row) -> Vec<String> {
    let mut cells = vec![
        row.ca.to_string(),
        row.confinement.to_string(),
        row.cause.to_owned(),
        row.value.clone(),
    ];
    cells.extend(errors(row.error.as_ref()));
    cells.extend([row.velocity, row.pressure_drop, row.rear_depth].map(|value| format!("{value:.6}")));
    cells.push(format!("{:.2}", row.t));
    cells.push(row.velocity_evaluations.to_string());
    cells.push(format!("{:.1}", row.wall_time_s));
    cells.extend([row.production.to_string(), row.status.clone()]);
    cells
}

fn errors(error: Option<&Error>) -> [String; 4] {
    error.map_or_else(Default::default, |error| {
        [
            error.profile_percent,
            error.velocity_percent,
            error.pressure_drop_percent,
            error.rear_depth_percent,
        ]
        .map(|percent| format!("{percent:.4}"))
    })
}

fn table(report: &Report) -> Result<()> {
    let heading = [
        "Ca", "a/l", "cause", "value", "profile", "velocity", "pressure", "rear", "t", "status",
    ];
    let mut rows: Vec<Vec<String>> = Vec::new();
    for row in &report.rows {
        let mark = if row.production { " *" } else { "" };
        let mut cells = vec![
            row.ca.to_string(),
            row.confinement.to_string(),
            row.cause.to_owned(),
            format!("{}{mark}", row.value),
        ];
        cells.extend(errors(row.error.as_ref()));
        cells.push(format!("{:.1}", row.t));
        cells.push(row.status.clone());
        rows.push(cells);
    }
    for total in &report.totals {
        let mut cells = vec![
            total.ca.to_string(),
            total.confinement.to_string(),
            format!("total, {}", total.membrane),
            String::new(),
        ];
        cells.extend(errors(total.error.as_ref()));
        cells.extend([String::new(), String::new()]);
        rows.push(cells);
    }
    print::table(&heading, &rows)
}
