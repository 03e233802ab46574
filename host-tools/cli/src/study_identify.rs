//! `capsule-rom study identify`: how well capsules are identified.

use crate::model::ModelFile;
use crate::outputs::Outputs;
use crate::{print, progress};
use anyhow::Result;
use capsule_core::Model;
use capsule_database::Database;
use capsule_study::identify::identify_laws;
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    #[command(flatten)]
    model: ModelFile,
    /// Folder of the test set, a snapshot database
    #[arg(long, value_name = "DIR", default_value = "models/test-set")]
    tests: PathBuf,
    /// Noisy trials of each configuration
    #[arg(long, default_value_t = 17)]
    repeats: usize,
    /// Only the series of this name [default: all]
    #[arg(long, value_name = "NAME")]
    series: Option<String>,
    /// Instead: capsules of other membrane laws, a folder of a database for each
    #[arg(long, value_name = "DIR,...", value_delimiter = ',', conflicts_with_all = ["tests", "series"])]
    laws: Vec<PathBuf>,
    /// Write all trials and the table into this folder
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// No progress bar
    #[arg(short, long)]
    quiet: bool,
}

const EXAMPLES: &str = "\
Examples:
  capsule-rom study identify --out identify/
  capsule-rom study identify --out own/ --series '0.1 px, own outlines' --repeats 17
  capsule-rom study identify --out laws/ --laws models/test-set,models/other-laws/skalak-1

Contours are drawn along outlines of the full-order model at configurations that no sample shares, one point a pixel, \
100 pixels per l, and identified. In each noisy trial the edge (0.25 px), the scale (0.5 %) and the tilt (0.02) are \
drawn at random and fitted. The model's own outlines tell whether the intervals and the spread are right where the \
model is exact. Further series have 125, 50 and 25 pixels per l (0.2, 0.5 and 1 um in a channel of 50 um), contours \
that are found in pictures (blur 1 px, noise 2 % of the contrast), and a half width that is 2 and 5 % too great.

With --laws the outlines are those of any law, with 0.1 px of noise: how often the verdict notices that it is no such \
capsule, and how wrong the answers are where it says \"identified\".";

pub fn run(options: &Options) -> Result<()> {
    let inputs = Outputs::default()
        .reads("--model", options.model.path())
        .reads("--tests", options.tests.as_path());
    let laws = options.laws.iter();
    let inputs = laws.fold(inputs, |inputs, laws| inputs.reads("--laws", laws.as_path()));
    let mut outputs = inputs.folder("--out", options.out.as_path()).checked()?;
    let bytes = options.model.read()?;
    let model = options.model.open(&bytes)?;
    if !options.laws.is_empty() {
        return other_laws(options, &model, outputs);
    }
    let tests = Database::open(&options.tests)?;
    let bar = progress::tasks(options.quiet);
    let mut all = Vec::new();
    outputs.write_into(&options.out, |folder| {
        let wanted = (options.repeats, options.series.as_deref());
        all = capsule_study::identify::identify(&model, &tests, wanted, folder, &|task, done, of| {
            progress::show(&bar, task, done, of);
        })?;
        Ok(())
    })?;
    bar.finish_and_clear();
    outputs.finish()?;
    if options.json {
        return print::json(&all);
    }
    println!("errors in per cent: median, 90 %, greatest; away from the border of buckling: greatest");
    let three = |values: [f64; 3], digits: usize| values.map(|value| format!("{value:.digits$}")).join(" / ");
    let two = |values: [f64; 2], digits: usize| values.map(|value| format!("{value:.digits$}")).join(" / ");
    let rows: Vec<Vec<String>> = all
        .iter()
        .map(|series| {
            vec![
                series.observable.to_owned(),
                series.name.to_owned(),
                series.pixels.to_string(),
                series.trials.to_string(),
                series.refused.to_string(),
                three(series.ca_percent, 3),
                format!("{:.3}", series.away_ca_percent[2]),
                three(series.radius_percent, 4),
                format!("{:.4}", series.away_radius_percent[2]),
                two(series.held_95_percent, 1),
                two(series.spread, 2),
                series.lost.to_string(),
                format!("{:.2}", series.time_ms),
            ]
        })
        .collect();
    let headings = [
        "outline",
        "series",
        "px / l",
        "trials",
        "refused",
        "Ca",
        "away",
        "a",
        "away",
        "held 95 %",
        "spread",
        "lost",
        "ms",
    ];
    print::table(&headings, &rows)?;
    for series in &all {
        println!(
            "{}, {}, {} px / l: {:?}",
            series.observable, series.name, series.pixels, series.verdicts
        );
    }
    Ok(())
}

/// The capsules of `--laws`.
fn other_laws(options: &Options, model: &Model<'_>, mut outputs: Outputs) -> Result<()> {
    let databases: Vec<_> = options
        .laws
        .iter()
        .map(|laws| Database::open(laws))
        .collect::<Result<_, _>>()?;
    let bar = progress::tasks(options.quiet);
    let mut all = Vec::new();
    outputs.write_into(&options.out, |folder| {
        all = identify_laws(model, &databases, options.repeats, folder, &|task, done, of| {
            progress::show(&bar, task, done, of);
        })?;
        Ok(())
    })?;
    bar.finish_and_clear();
    outputs.finish()?;
    if options.json {
        return print::json(&all);
    }
    println!("identified: errors in per cent, median with its sign and greatest; wrong: outside of the 95 % interval");
    let two = |[median, greatest]: [f64; 2]| format!("{median:.2} / {greatest:.2}");
    let rows: Vec<Vec<String>> = all
        .iter()
        .map(|series| {
            vec![
                series.observable.to_owned(),
                series.name.to_owned(),
                series.law.clone(),
                format!("{} to {}", series.ca[0], series.ca[1]),
                series.trials.to_string(),
                series.refused.to_string(),
                series.noticed.to_string(),
                series.identified.to_string(),
                series.identified_wrong_ca.to_string(),
                series.identified_wrong_radius.to_string(),
                two(series.identified_ca_percent),
                two(series.identified_radius_percent),
            ]
        })
        .collect();
    let headings = [
        "observable",
        "series",
        "law",
        "Ca",
        "trials",
        "refused",
        "noticed",
        "identified",
        "wrong Ca",
        "wrong a",
        "Ca",
        "a",
    ];
    print::table(&headings, &rows)?;
    for series in &all {
        let [low, high] = series.ca;
        println!(
            "{}, {}, {}, Ca {low} to {high}: {:?}",
            series.observable, series.name, series.law, series.verdicts
        );
    }
    Ok(())
}
