//! `capsule-rom study speed`: how long the model takes to answer, on this machine.

use crate::{model, print};
use anyhow::Result;
use capsule_study::speed;
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
#[command(after_help = "Example:\n  capsule-rom study speed --json")]
pub struct Options {
    /// Model file [default: the shipped model]
    #[arg(long)]
    model: Option<PathBuf>,
    /// How often each task is repeated
    #[arg(long, default_value_t = 201)]
    repetitions: usize,
    /// Print one JSON array
    #[arg(long)]
    json: bool,
}

pub fn run(options: &Options) -> Result<()> {
    let path = options.model.as_deref();
    let bytes = model::read(path)?;
    let model = model::open(&bytes, path)?;
    // Between the samples, in both clusters.
    let queries = [
        [0.035, 0.83],
        [0.055, 1.03],
        [0.025, 1.13],
        [0.085, 0.88],
        [0.045, 0.97],
    ];
    let timings = speed::measure::<f32>(&model, &queries, options.repetitions)?;
    if options.json {
        return print::json(&timings);
    }
    let rows: Vec<Vec<String>> = timings
        .iter()
        .map(|timing| {
            vec![
                timing.method.to_owned(),
                format!("{:?}", timing.task).to_lowercase(),
                format!("{:.1}", timing.median_us),
                format!("{:.1}", timing.lower_quartile_us),
                format!("{:.1}", timing.upper_quartile_us),
            ]
        })
        .collect();
    print::table(
        &["method", "task", "median/us", "lower quartile", "upper quartile"],
        &rows,
    )
}
