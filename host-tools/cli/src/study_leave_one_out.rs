//! `capsule-rom study leave-one-out`: each sample predicted from all the others.

use crate::outputs::Outputs;
use crate::source::SourceOptions;
use crate::{print, progress};
use anyhow::{Result, bail};
use capsule_plot::{Cells, Figure, Panel};
use capsule_study::Report;
use clap::Args;
use std::path::{Path, PathBuf};

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    #[command(flatten)]
    source: SourceOptions,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Write the errors of every sample as CSV
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Plot heat maps of the errors over the parameters (the paper's Fig. 13) into this folder
    #[arg(long, value_name = "DIR")]
    plots: Option<PathBuf>,
    /// No progress bar
    #[arg(short, long)]
    quiet: bool,
}

const EXAMPLES: &str = "\
Examples:
  capsule-rom study leave-one-out
  capsule-rom study leave-one-out --design paper --json
  capsule-rom study leave-one-out --csv errors.csv --plots plots/
  capsule-rom study leave-one-out --from data.npz

Modified Hausdorff distance over all mesh nodes in per cent of a, in the laboratory frame (with the translation) and \
for the shape alone (in the frame of the centroid). The whole model is built anew without each sample. Errors are \
over the samples in the domain that the model answers for; those around it take part, but are not counted.";

pub fn run(options: &Options) -> Result<()> {
    let outputs = options.source.reads(Outputs::default());
    let outputs = outputs.file("--csv", options.csv.as_deref());
    let mut outputs = outputs.folder("--plots", options.plots.as_deref()).checked()?;
    let (snapshots, settings) = options.source.open()?;
    let bar = progress::tasks(options.quiet);
    let report = capsule_study::leave_one_out(snapshots.source(), &settings, &|task, done, of| {
        progress::show(&bar, task, done, of);
    })?;
    bar.finish_and_clear();
    if let Some(file) = &options.csv {
        let text = report.csv()?;
        outputs.write(file, |file| std::fs::write(file, text))?;
    }
    if let Some(folder) = &options.plots {
        outputs.write_into(folder, |folder| plot(folder, &report))?;
    }
    outputs.finish()?;
    if options.json {
        return print::json(&report);
    }
    println!(
        "{} samples; per cent of a; default method: {}",
        report.samples, report.default
    );
    let rows: Vec<Vec<String>> = report
        .methods
        .iter()
        .flat_map(|(method, instants)| instants.iter().map(move |instant| (method, instant)))
        .map(|(method, instant)| {
            let errors = [
                instant.lab_mean_percent,
                instant.lab_max_percent,
                instant.shape_mean_percent,
                instant.shape_max_percent,
            ];
            let cells = errors.iter().map(|error| format!("{error:.3}"));
            [method.to_string(), instant.t.to_string()]
                .into_iter()
                .chain(cells)
                .collect()
        })
        .collect();
    print::table(
        &["method", "t", "lab mean", "lab max", "shape mean", "shape max"],
        &rows,
    )
}

/// One figure for each method and frame, one panel for each instant.
fn plot(folder: &Path, report: &Report) -> Result<()> {
    let [x, y] = &report.parameters[..] else {
        bail!("heat maps show two parameters, not {}", report.parameters.len());
    };
    let label = |name: &str| match name {
        "capillary_number" => "Ca".to_owned(),
        "confinement" => "a/l".to_owned(),
        other => other.to_owned(),
    };
    let (x, y) = (label(x), label(y));
    let size = cell_size(report);
    for (method, samples) in &report.values {
        for frame in ["lab", "shape"] {
            let panels = report.methods[method].iter().enumerate().map(|(i, instant)| {
                let title = format!("{method}, {frame}, t = {}", instant.t);
                let cells = samples.iter().map(|sample| {
                    let percent = if frame == "lab" {
                        &sample.lab_percent
                    } else {
                        &sample.shape_percent
                    };
                    (sample.parameters[0], sample.parameters[1], percent[i])
                });
                Panel::Cells(Cells::new(&title, &x, &y, "% of a", size, cells.collect()).logarithmic())
            });
            Figure::new(panels.collect()).save(&folder.join(format!("leave_one_out_{method}_{frame}.svg")))?;
        }
    }
    Ok(())
}

/// Size of a sample's cell: the steps of the paper's grid, or a twentieth of the samples' ranges.
fn cell_size(report: &Report) -> (f64, f64) {
    if report.parameters == ["capillary_number", "confinement"] {
        return (0.01, 0.05);
    }
    let share = |d: usize| {
        let values = report.values.values().flatten().map(|sample| sample.parameters[d]);
        let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)]);
        (high - low) / 20.0
    };
    (share(0), share(1))
}
