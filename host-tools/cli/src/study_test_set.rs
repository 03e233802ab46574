//! `capsule-rom study test-set`: the errors of the model at configurations that are not samples.

use crate::model::ModelFile;
use crate::outputs::Outputs;
use crate::{print, progress};
use anyhow::Result;
use capsule_database::Database;
use capsule_study::{InstantErrors, InstantStated};
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
    /// Folder of the snapshots that the model was built from: adds the error of the interpolation alone, without the
    /// compression of the model file
    #[arg(long, value_name = "DIR")]
    samples: Option<PathBuf>,
    /// Instants to compare at, in l/V; the test set must have snapshots there
    #[arg(long, value_delimiter = ',', default_values_t = capsule_study::TEST_TIMES)]
    t: Vec<f64>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Write the errors of every configuration as CSV
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// No progress bar
    #[arg(short, long)]
    quiet: bool,
}

const EXAMPLES: &str = "\
Examples:
  capsule-rom study test-set
  capsule-rom study test-set --samples models/database
  capsule-rom study test-set --t 4.2,6.2,9,13,17     # instants that the shipped model leaves out
  capsule-rom study test-set --model mine.crom --tests runs/ --json

Modified Hausdorff distance over all mesh nodes in per cent of a, in the laboratory frame (with the translation) and \
for the shape alone (in the frame of the centroid), at the configurations of a test set that lie in the model's \
domain. The table also shows the model's own estimates: the expected error, and the bound that 95 % of the errors \
should stay below.";

pub fn run(options: &Options) -> Result<()> {
    let inputs = Outputs::default()
        .reads("--model", options.model.path())
        .reads("--tests", options.tests.as_path())
        .reads("--samples", options.samples.as_deref());
    let mut outputs = inputs.file("--csv", options.csv.as_deref()).checked()?;
    let bytes = options.model.read()?;
    let model = options.model.open(&bytes)?;
    let tests = Database::open(&options.tests)?;
    let samples = options.samples.as_deref().map(Database::open).transpose()?;
    let bar = progress::tasks(options.quiet);
    let errors = capsule_study::test_set(&model, &tests, samples.as_ref(), &options.t, &|task, done, of| {
        progress::show(&bar, task, done, of);
    })?;
    bar.finish_and_clear();
    if let Some(file) = &options.csv {
        let text = errors.csv()?;
        outputs.write(file, |file| std::fs::write(file, text))?;
    }
    outputs.finish()?;
    if options.json {
        return print::json(&errors);
    }
    println!(
        "{} configurations; errors against {}, per cent of a; default method: {}",
        errors.samples,
        model.errors_against(),
        errors.default
    );
    let cells = |name: &str, at: &InstantErrors, stated: Option<&InstantStated>| -> Vec<String> {
        let errors_alone = [
            at.lab_mean_percent,
            at.lab_max_percent,
            at.shape_mean_percent,
            at.shape_max_percent,
        ];
        // The model gives no estimate for the interpolation alone.
        let stated = stated.map_or([None; 3], |stated| {
            [
                stated.expected_mean_percent,
                stated.bound_mean_percent,
                stated.below_bound_percent,
            ]
            .map(Some)
        });
        let cell = |number: Option<f64>| number.map_or(String::new(), |number| format!("{number:.3}"));
        let names = [name.to_owned(), at.t.to_string()];
        let numbers = errors_alone.map(Some).into_iter().chain(stated);
        names.into_iter().chain(numbers.map(cell)).collect()
    };
    let of_methods = errors.methods.iter().flat_map(|(method, instants)| {
        let stated = errors.stated[method].instants.iter().map(Some);
        instants
            .iter()
            .zip(stated)
            .map(move |(at, stated)| (*method, at, stated))
    });
    let alone = errors.interpolation.iter().map(|at| ("interpolation", at, None));
    let rows: Vec<Vec<String>> = of_methods
        .chain(alone)
        .map(|(name, at, stated)| cells(name, at, stated))
        .collect();
    let headings = [
        "method",
        "t",
        "lab mean",
        "lab max",
        "shape mean",
        "shape max",
        "expected",
        "bound",
        "below bound",
    ];
    print::table(&headings, &rows)?;
    for (method, stated) in &errors.stated {
        println!(
            "{method}: {:.1} % below the bound; volume within {:.4} %; outermost node {:.4} l from the wall",
            stated.below_bound_percent, stated.volume_max_percent, -stated.beyond_walls
        );
    }
    Ok(())
}
