//! `capsule-rom study suggest`: which configurations to compute next.

use crate::model::ModelFile;
use crate::outputs::Outputs;
use crate::{print, progress};
use anyhow::Result;
use capsule_database::{Database, table};
use capsule_study::suggest::{Replayed, Suggestion, replay, suggest};
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    #[command(flatten)]
    model: ModelFile,
    /// Number of configurations to suggest
    #[arg(long, default_value_t = 10)]
    count: usize,
    /// Count the errors up to this instant, in l/V
    #[arg(long, default_value_t = 8.0, value_name = "T")]
    until: f64,
    /// Write the suggestions as CSV, for `fom sweep --points`
    #[arg(long, value_name = "FILE", conflicts_with = "replay")]
    csv: Option<PathBuf>,
    /// Instead, choose a design of this size from the samples of --database, and compare it with the paper's grid on
    /// --tests
    #[arg(long, value_name = "SAMPLES")]
    replay: Option<usize>,
    /// Folder of the snapshot database
    #[arg(long, value_name = "DIR", default_value = "models/database")]
    database: PathBuf,
    /// Folder of the test set
    #[arg(long, value_name = "DIR", default_value = "models/test-set")]
    tests: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// No progress bar
    #[arg(short, long)]
    quiet: bool,
}

const EXAMPLES: &str = "\
Examples:
  capsule-rom study suggest --count 20 --csv points.csv
  capsule-rom fom sweep --database models/database --mesh 13 --points points.csv
  capsule-rom study suggest --replay 60

Suggests the configurations where the model expects its largest errors. Each suggestion counts the ones before it as \
computed.";

/// A replay starts with every `START`-th sample of the grid.
const START: usize = 4;
/// Number of samples that a replay adds between two measurements of the errors.
const BATCH: usize = 3;

#[derive(Serialize)]
struct Suggestions {
    suggestions: Vec<Suggestion>,
}

#[derive(Serialize)]
struct Replay {
    designs: Vec<Replayed>,
}

pub fn run(options: &Options) -> Result<()> {
    if let Some(most) = options.replay {
        return run_replay(options, most);
    }
    let inputs = Outputs::default().reads("--model", options.model.path());
    let mut outputs = inputs.file("--csv", options.csv.as_deref()).checked()?;
    let bytes = options.model.read()?;
    let model = options.model.open(&bytes)?;
    let suggestions = suggest(&model, options.count, options.until)?;
    let names = model.parameters().iter().map(|p| p.name);
    // The column names that `fom sweep --points` reads.
    let names = names.map(|name| if name == "capillary_number" { "ca" } else { name });
    let headings: Vec<&str> = names.chain(["expected_percent"]).collect();
    let row = |s: &Suggestion| -> Vec<String> {
        let parameters = s.parameters.iter().map(f64::to_string);
        parameters.chain([format!("{:.4}", s.expected_percent)]).collect()
    };
    let rows: Vec<Vec<String>> = suggestions.iter().map(row).collect();
    if let Some(file) = &options.csv {
        let text = table::csv(None, &headings, &rows)?;
        outputs.write(file, |file| std::fs::write(file, text))?;
    }
    outputs.finish()?;
    if options.json {
        return print::json(&Suggestions { suggestions });
    }
    print::table(&headings, &rows)
}

fn run_replay(options: &Options, most: usize) -> Result<()> {
    let database = Database::open(&options.database)?;
    let tests = Database::open(&options.tests)?;
    let bar = progress::tasks(options.quiet);
    let designs = replay(
        &database,
        &tests,
        [START, BATCH, most],
        options.until,
        &|task, done, of| {
            progress::show(&bar, task, done, of);
        },
    )?;
    bar.finish_and_clear();
    if options.json {
        return print::json(&Replay { designs });
    }
    let rows: Vec<Vec<String>> = designs
        .iter()
        .map(|design| {
            let errors = design.errors.methods["direct"]
                .iter()
                .filter(|e| e.t >= 1.0 && e.t <= options.until);
            let worst = |value: fn(&capsule_study::InstantErrors) -> f64| {
                format!("{:.3}", errors.clone().map(value).fold(0.0, f64::max))
            };
            vec![
                design.design.to_owned(),
                design.samples.to_string(),
                worst(|e| e.lab_mean_percent),
                worst(|e| e.lab_max_percent),
                worst(|e| e.shape_mean_percent),
                worst(|e| e.shape_max_percent),
            ]
        })
        .collect();
    print::table(
        &["design", "samples", "lab mean", "lab max", "shape mean", "shape max"],
        &rows,
    )
}
