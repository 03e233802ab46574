//! `capsule-rom study scenes`: the cost of each kind of answer, counted and timed.

use crate::model::ModelFile;
use crate::print;
use anyhow::{Context, Result};
use capsule_study::scenes::{Cost, Limits, once, scenes};
use capsule_study::task::{questions, tasks};
use clap::Args;
use serde::Serialize;

#[derive(Args)]
#[command(after_help = "Example:\n  capsule-rom study scenes --json")]
pub struct Options {
    #[command(flatten)]
    model: ModelFile,
    /// Number of random queries that each task is timed with
    #[arg(long, default_value_t = 501)]
    queries: usize,
    /// Skip the search for the bytes of the model that each answer reads, which takes a minute
    #[arg(long)]
    no_bytes: bool,
    /// Run this task once and print nothing, for programs that count instructions
    #[arg(long, value_name = "TASK", conflicts_with_all = ["queries", "no_bytes", "json"])]
    once: Option<String>,
    /// Number of the random query to run it with
    #[arg(long, value_name = "NUMBER", default_value_t = 0, requires = "once")]
    query: usize,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Report {
    limits: Limits,
    tasks: Vec<Cost>,
}

pub fn run(options: &Options) -> Result<()> {
    let bytes = options.model.read()?;
    let model = options.model.open(&bytes)?;
    if let Some(name) = &options.once {
        let task = tasks(&model).find(|task| task.name == name);
        let task = task.with_context(|| format!("no task {name}"))?;
        let questions = questions(&model, options.query + 1)?;
        return Ok(once(&model, &task, &questions[options.query])?);
    }
    let limits = Limits::measure(bytes.len());
    let costs = scenes(&bytes, &questions(&model, options.queries)?, &limits, !options.no_bytes)?;
    if options.json {
        return print::json(&Report { limits, tasks: costs });
    }
    println!(
        "one core does at most {:.0} operations a nanosecond ({:.0} with the instructions of any processor of \
         its kind, by which all is done but products with panels) and reads {:.0} bytes of the model",
        limits.operations_per_ns, limits.portable_operations_per_ns, limits.bytes_per_ns
    );
    let rows: Vec<Vec<String>> = costs
        .iter()
        .map(|cost| {
            vec![
                cost.timing.task.replace('_', " "),
                cost.reads.to_string(),
                cost.operations.to_string(),
                cost.model_bytes.map_or(String::new(), |bytes| bytes.to_string()),
                cost.answer_bytes.to_string(),
                format!("{:.1}", cost.timing.median_us),
                format!("{:.2}", cost.least_us),
            ]
        })
        .collect();
    print::table(
        &[
            "task",
            "numbers read",
            "operations",
            "model bytes",
            "answer bytes",
            "median/us",
            "least possible/us",
        ],
        &rows,
    )
}
