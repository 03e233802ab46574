//! `capsule-rom identify batch`: the capsules of a table.

use super::given::Given;
use super::outline;
use super::population::Population;
use super::records::{Record, Records, record};
use super::rows::{self, Row};
use crate::model::{self, ModelFile};
use crate::outputs::Outputs;
use crate::{interrupt, print, progress};
use anyhow::{Result, anyhow, bail};
use capsule_core::Model;
use capsule_identify::{Grid, Observable};
use capsule_measurement::{Answer, Bench};
use clap::Args;
use rayon::prelude::*;
use std::collections::HashSet;
use std::path::PathBuf;

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Table with a heading: one row a capsule; a column is an option, such as half_width_um, or "file" or "id". Or an
    /// RT-DC file, each of whose events is a row
    #[arg(value_name = "TABLE")]
    table: PathBuf,
    /// The answers, a row each (CSV); rows that it holds already are skipped
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    given: Given,
    #[command(flatten)]
    model: ModelFile,
    /// Write one JSON object a line in place of the table, and print the population as JSON
    #[arg(long)]
    json: bool,
    /// Plot histograms of the capsules that are identified (.png or .svg)
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Show no progress
    #[arg(short, long)]
    quiet: bool,
}

const EXAMPLES: &str = "\
Examples:
  capsule-rom identify batch table.csv --out results.csv
  capsule-rom identify batch table.csv --out results.jsonl --json --plot histograms.svg
  capsule-rom identify batch files.csv --out results.csv --half-width-um 25 -o midplane
  capsule-rom identify batch events.rtdc --out results.csv --pixel-um 0.34 -o silhouette

The options hold for all rows; a cell that is not empty says otherwise for its row. Paths are relative to the table. \
The deviation of a length is in a column of its own, such as axial_length_um_deviation.

Exit codes: 0 all rows answered, 1 some rows failed (each is named, the others are written) or nothing could be done, \
2 usage. After an interruption the same command goes on; rows that failed are tried again.";

/// Rows after which the answers are written.
const CHUNK: usize = 128;

pub fn run(options: &Options) -> Result<()> {
    let mut outputs = Outputs::default()
        .reads("TABLE", &*options.table)
        .reads("--background", options.given.background.as_deref())
        .reads("--model", options.model.path())
        .file("--out", &*options.out)
        .figure("--plot", options.plot.as_deref())
        .checked()?;
    let bytes = options.model.read()?;
    let model = options.model.open(&bytes)?;
    let rows = rows::read(&options.table, &options.given, &model::digest(&model), |text| {
        eprintln!("warning: {text}");
    })?;
    let (mut file, mut records) = Records::open(&options.out, options.json, &rows)?;
    let done: HashSet<usize> = records
        .iter()
        .filter_map(|record| record.get("row")?.as_u64())
        .map(|row| row as usize)
        .collect();
    let open: Vec<&Row> = rows.iter().filter(|row| !done.contains(&row.number)).collect();
    let grids = Grids::new(&model, &open)?;
    interrupt::listen()?;
    let bar = progress::bar(
        options.quiet,
        rows.len() as u64,
        "{bar:40} {pos} of {len} capsules, {elapsed} gone, {eta} to go",
    );
    bar.set_position(done.len() as u64);
    bar.reset_eta();
    for chunk in open.chunks(CHUNK) {
        let answers: Vec<Result<Record>> = chunk
            .par_iter()
            .map_init(
                || Bench::new(&model),
                |bench, row| {
                    let record = answer(&model, &grids, bench, row).and_then(|answer| record(row, &answer));
                    bar.inc(1);
                    record
                },
            )
            .collect();
        let mut fresh = Vec::new();
        for (row, answer) in chunk.iter().zip(answers) {
            match answer {
                Ok(record) => fresh.push(record),
                Err(error) => bar.suspend(|| eprintln!("row {}: {error:#}", row.number)),
            }
        }
        file.add(&fresh)?;
        records.extend(fresh);
        if interrupt::asked() {
            bar.finish_and_clear();
            bail!("interrupted: the same command goes on");
        }
    }
    bar.finish_and_clear();
    let population = Population::of(&records, rows.len());
    if let (Some(file), true) = (&options.plot, population.has_identified()) {
        outputs.write(file, |file| population.histograms().save(file))?;
    }
    outputs.finish()?;
    if options.plot.is_some() && !population.has_identified() {
        eprintln!("warning: no capsule is identified, so there is no histogram");
    }
    if options.json {
        print::json(&population)?;
    } else {
        population.print()?;
    }
    match rows.len() - records.len() {
        0 => Ok(()),
        failed => bail!("{failed} of {} rows have no answer: they are named above", rows.len()),
    }
}

/// The starts of the fits, for each kind of outline that the rows have.
struct Grids {
    midplane: Option<Grid>,
    silhouette: Option<Grid>,
}

impl Grids {
    fn new(model: &Model<'_>, rows: &[&Row]) -> Result<Self> {
        let mut bench = Bench::new(model);
        let mut grid = |kind: Observable| {
            let used = rows
                .iter()
                .flat_map(|row| &row.given)
                .any(|given| given.observable() == kind);
            used.then(|| bench.grid(model, kind))
                .transpose()
                .map_err(anyhow::Error::from)
        };
        Ok(Self {
            midplane: grid(Observable::Midplane)?,
            silhouette: grid(Observable::Silhouette)?,
        })
    }
}

/// The answer to a row, its warnings in it.
fn answer(model: &Model<'_>, grids: &Grids, bench: &mut Bench, row: &Row) -> Result<Answer> {
    let given = row.given.as_ref().map_err(|error| anyhow!("{error:#}"))?;
    let mut warnings = Vec::new();
    let (setup, _) = given.setup(&mut Vec::new())?;
    let outline = row.path.as_deref();
    let outline = outline.map(|path| outline::read(path, given, setup.half_width_um, &mut warnings));
    let grid = match given.observable() {
        Observable::Midplane => &grids.midplane,
        Observable::Silhouette => &grids.silhouette,
    };
    let grid = grid.as_ref().ok_or_else(|| anyhow!("no starts of its fit"))?;
    let outline = outline.transpose()?;
    let request = given.request(&mut warnings)?;
    Ok(bench
        .identify(model, grid, &request, outline.as_ref(), warnings)?
        .answer)
}
