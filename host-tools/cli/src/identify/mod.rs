//! `capsule-rom identify`: membrane properties from an outline, a picture, or a few lengths.

mod answer;
mod batch;
mod given;
mod outline;
mod plot;
mod population;
mod records;
mod rows;
mod rtdc;
mod sequence;

use crate::model::ModelFile;
use crate::outputs::Outputs;
use crate::print;
use anyhow::{Context, Result, ensure};
use capsule_measurement::Bench;
use clap::error::ErrorKind;
use clap::{Args, Subcommand};
use given::Given;
use plot::figure;
use std::path::PathBuf;

#[derive(Args)]
#[command(after_help = EXAMPLES, args_conflicts_with_subcommands = true)]
pub struct Options {
    #[command(subcommand)]
    batch: Option<Command>,
    #[command(flatten)]
    one: One,
}

#[derive(Subcommand)]
enum Command {
    /// Identify the capsules of a table, and their population
    Batch(Box<batch::Options>),
}

#[derive(Args)]
struct One {
    /// Contour: a text file of points in order around the capsule, one a line; or a picture (PNG, JPEG, TIFF)
    #[arg(value_name = "CONTOUR")]
    file: Option<PathBuf>,
    /// More contours or pictures of the same capsule, steady in all of them
    #[arg(long, value_name = "FILE", num_args = 1.., requires = "file",
          conflicts_with_all = ["plot", "contour_out", "overlay", "exposure_ms"])]
    frames: Vec<PathBuf>,
    /// The frames show the capsule on its way to the steady state, at instants that are not known
    #[arg(long, requires = "frames")]
    transient: bool,
    /// Points along the line at which the dent behind is seen through a silhouette, in the coordinates of the contour
    #[arg(long, value_name = "FILE", requires = "file", conflicts_with_all = ["frames", "rear_depth_um"])]
    dent_line: Option<PathBuf>,
    #[command(flatten)]
    given: Given,
    #[command(flatten)]
    model: ModelFile,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Plot the contour, the outline that was fitted and the residuals (.png or .svg)
    #[arg(long, value_name = "FILE", requires = "file")]
    plot: Option<PathBuf>,
    /// Write the contour that was found in a picture, in pixels; it can be corrected and given back
    #[arg(long, value_name = "FILE", requires = "file")]
    contour_out: Option<PathBuf>,
    /// Draw what was found over the picture (.png): contours red, walls blue, a dent green
    #[arg(long, value_name = "FILE", requires = "file")]
    overlay: Option<PathBuf>,
}

const EXAMPLES: &str = "\
Examples:
  capsule-rom identify o.csv --half-width-um 25 --velocity-mm-s 5 --viscosity-pa-s 1 -o midplane
  capsule-rom identify p.png --half-width-um 25 --velocity-mm-s 5 --viscosity-pa-s 1 -o silhouette
  capsule-rom identify batch table.csv --out results.csv --half-width-um 25 -o silhouette
  capsule-rom identify 1.csv --frames 2.csv 3.csv --half-width-um 25 --velocity-mm-s 5 --viscosity-pa-s 1 -o midplane

Contours in pixels need --pixel-um. In pictures the walls give the scale. Lengths take the place of the file: \
--axial-length-um 49.2,0.2 --width-um 41.6,0.2 --rear-depth-um 8.5,0.3. Points along the line of a dent behind go \
beside the contour of a silhouette: --dent-line line.csv.

The capsule flows steadily along the axis of a square channel. Its membrane has the model's law, neo-Hookean in the \
shipped one; the liquids inside and outside have the same viscosity. The answer is Ca = mu V / G_s, the confinement \
a/l, the radius a and the surface shear modulus G_s, each with the intervals that hold the true value in 68 and 95 of \
100 cases, and a verdict: an answer without \"identified\" is none, or a bound. Nothing is extrapolated.";

pub fn run(options: &Options) -> Result<()> {
    match &options.batch {
        Some(Command::Batch(batch)) => batch::run(batch),
        None => one(&options.one),
    }
}

fn one(options: &One) -> Result<()> {
    let given = &options.given;
    if let Some(missing) = given.missing() {
        let message = format!("{missing} is not given; see capsule-rom identify --help\n");
        return Err(clap::Error::raw(ErrorKind::MissingRequiredArgument, message).into());
    }
    let mut outputs = Outputs::default()
        .reads("CONTOUR", options.file.as_deref())
        .reads("--dent-line", options.dent_line.as_deref())
        .reads("--background", given.background.as_deref())
        .reads("--model", options.model.path())
        .figure("--plot", options.plot.as_deref())
        .file("--contour-out", options.contour_out.as_deref())
        .file("--overlay", options.overlay.as_deref())
        .checked()?;
    let bytes = options.model.read()?;
    let model = options.model.open(&bytes)?;
    let mut warnings = Vec::new();
    let (setup, _) = given.setup(&mut Vec::new())?;
    let outline = options.file.as_deref();
    let outline = outline.map(|file| outline::read(file, given, setup.half_width_um, &mut warnings));
    let mut outline = outline.transpose()?;
    if let (Some(file), Some(outline)) = (&options.dent_line, &mut outline) {
        outline::add_dent_line(outline, file, given)?;
    }
    let seen = outline.as_ref().and_then(|outline| outline.seen.as_ref());
    // Before the fit: a contour that the fit refuses is what one wants to see.
    if options.contour_out.is_some() || options.overlay.is_some() {
        ensure!(
            seen.is_some(),
            "--contour-out and --overlay need a picture, and this is a text"
        );
    }
    if let (Some(file), Some(seen)) = (&options.contour_out, seen) {
        outputs.write(file, |file| std::fs::write(file, seen.contour()))?;
    }
    if let (Some(file), Some(seen)) = (&options.overlay, seen) {
        let png = capsule_contour::overlay(&seen.picture, &seen.found).context("could not draw the overlay")?;
        outputs.write(file, |file| std::fs::write(file, png))?;
    }
    if let Some(first) = outline.as_ref().filter(|_| !options.frames.is_empty()) {
        let more = options.frames.iter();
        let more = more.map(|file| outline::read(file, given, setup.half_width_um, &mut warnings));
        let more = more.collect::<Result<Vec<_>>>()?;
        for warning in warnings {
            eprintln!("warning: {warning}");
        }
        let outlines: Vec<_> = std::iter::once(first).chain(&more).collect();
        return sequence::run(&model, given, &outlines, options.transient, options.json);
    }
    let mut bench = Bench::new(&model);
    let grid = bench.grid(&model, given.observable())?;
    let request = given.request(&mut warnings)?;
    let solved = match bench.identify(&model, &grid, &request, outline.as_ref(), warnings) {
        Ok(solved) => solved,
        Err(error) => {
            outputs.finish()?;
            return Err(error.into());
        }
    };
    for warning in &solved.answer.warnings {
        eprintln!("warning: {warning}");
    }
    if let (Some(file), Some(outline)) = (&options.plot, &outline) {
        let figure = figure(&solved.found, outline, &solved.shape, setup.half_width_um);
        outputs.write(file, |file| figure.save(file))?;
    }
    outputs.finish()?;
    if options.json {
        return print::json(&solved.answer);
    }
    answer::show(&solved.answer)
}
