//! `capsule-rom fom integrators`: evaluations and time against error.

use crate::outputs::Outputs;
use crate::{print, progress};
use anyhow::Result;
use capsule_fom::{Configuration, Integrator, Settings};
use capsule_plot::{Axis, Curve, Figure, Lines, Panel};
use capsule_validation::integrators::{self, Outcome, Row};
use clap::Args;
use std::path::{Path, PathBuf};

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Capillary number Ca = mu V / G_s
    #[arg(long, allow_negative_numbers = true, default_value_t = 0.02)]
    ca: f64,
    /// Confinement a/l
    #[arg(long, allow_negative_numbers = true, default_value_t = 0.90)]
    confinement: f64,
    /// Mesh frequency n: 8 n^2 elements
    #[arg(long, default_value_t = 6)]
    mesh: usize,
    /// Last instant, in l/V
    #[arg(long, default_value_t = 1.0)]
    end_time: f64,
    /// Steps of the fixed-step schemes, in l/V
    #[arg(long, value_delimiter = ',', default_values_t = [2e-3, 1e-3, 5e-4, 2.5e-4])]
    steps: Vec<f64>,
    /// Position errors allowed a step of the stabilised scheme, in l
    #[arg(long, value_delimiter = ',', default_values_t = [1e-3, 1e-4, 1e-5, 1e-6, 1e-7])]
    tolerances: Vec<f64>,
    /// Print one JSON array
    #[arg(long)]
    json: bool,
    /// Plot error against evaluations and time into this file (.svg or .png)
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// No progress bar
    #[arg(short, long)]
    quiet: bool,
}

const EXAMPLES: &str = "\
Examples:
  capsule-rom fom integrators
  capsule-rom fom integrators --ca 0.10 --steps 1e-2,5e-3 --plot integrators.svg

The error is the greatest distance of a node, over a, from where the stabilised scheme with a tolerance of 1e-9 has \
it at the last instant.";

pub fn run(options: &Options) -> Result<()> {
    let mut outputs = Outputs::default().figure("--plot", options.plot.as_deref()).checked()?;
    let settings = Settings {
        mesh_frequency: options.mesh,
        end_time: options.end_time,
        ..Settings::default()
    };
    let configuration = Configuration {
        capillary_number: options.ca,
        confinement: options.confinement,
    };
    let steps = |scheme: fn(f64) -> Integrator| options.steps.iter().copied().map(scheme);
    let integrators: Vec<Integrator> = steps(|step| Integrator::ForwardEuler { step })
        .chain(steps(|step| Integrator::Ralston { step }))
        .chain(
            options
                .tolerances
                .iter()
                .map(|&tolerance| Integrator::Rkc2 { tolerance }),
        )
        .collect();
    let bar = progress::tasks(options.quiet);
    let rows = integrators::study(&settings, &configuration, &integrators, &|done, of| {
        progress::show(&bar, "runs", done, of);
    })?;
    bar.finish_and_clear();
    if let Some(file) = &options.plot {
        outputs.write(file, |file| plot(file, &rows))?;
    }
    outputs.finish()?;
    if options.json {
        return print::json(&rows);
    }
    table(&rows)
}

/// Name and parameter: the step or the tolerance.
fn describe(integrator: &Integrator) -> (&'static str, f64) {
    match *integrator {
        Integrator::ForwardEuler { step } => ("forward Euler", step),
        Integrator::Ralston { step } => ("Ralston", step),
        Integrator::Rkc2 { tolerance } => ("RKC2", tolerance),
    }
}

fn table(rows: &[Row]) -> Result<()> {
    let rows: Vec<Vec<String>> = rows
        .iter()
        .map(|row| {
            let (name, parameter) = describe(&row.integrator);
            let mut cells = vec![name.to_owned(), format!("{parameter:e}")];
            match row.outcome {
                Outcome::Finished {
                    velocity_evaluations,
                    wall_time_s,
                    error,
                } => cells.extend([
                    velocity_evaluations.to_string(),
                    format!("{wall_time_s:.2}"),
                    format!("{error:.1e}"),
                ]),
                Outcome::Unstable { stability_limit } => cells.extend([
                    String::new(),
                    String::new(),
                    format!("unstable: limit about {stability_limit:.1e}"),
                ]),
            }
            cells
        })
        .collect();
    print::table(
        &["scheme", "step or tolerance", "evaluations", "time/s", "error/a"],
        &rows,
    )
}

fn plot(file: &Path, rows: &[Row]) -> Result<()> {
    let panel = |title: &str, label: &str, cost: fn(usize, f64) -> f64| {
        let mut lines = Lines::new(title, Axis::logarithmic(label), Axis::logarithmic("error / a"));
        for name in ["forward Euler", "Ralston", "RKC2"] {
            let points = rows
                .iter()
                .filter(|row| describe(&row.integrator).0 == name)
                .filter_map(|row| match row.outcome {
                    Outcome::Finished {
                        velocity_evaluations,
                        wall_time_s,
                        error,
                    } => Some((cost(velocity_evaluations, wall_time_s), error)),
                    Outcome::Unstable { .. } => None,
                });
            lines = lines.with(Curve::line(name, points.collect()));
        }
        Panel::Lines(lines)
    };
    let panels = vec![
        panel("Error against work", "velocity evaluations", |evaluations, _| {
            evaluations as f64
        }),
        panel("Error against time", "time / s", |_, time| time),
    ];
    Figure::new(panels).save(file)?;
    Ok(())
}
