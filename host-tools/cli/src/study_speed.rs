//! `capsule-rom study speed`: how long the model takes to answer, on this machine.

use crate::{interrupt, model, print};
use anyhow::{Context, Result};
use capsule_fom::{Configuration, Settings, Solver};
use capsule_study::speed::{self, Task, Timing};
use clap::Args;
use serde::Serialize;
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
    /// Do not run the full-order model beside it (some 15 s)
    #[arg(long)]
    no_fom: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// The direct method's times in microseconds: medians, and first and third quartile beside each.
#[derive(Serialize)]
struct Report {
    prepare_us: f64,
    prepare_us_spread: [f64; 2],
    trajectory_us: f64,
    trajectory_us_spread: [f64; 2],
    surface_us: f64,
    surface_us_spread: [f64; 2],
    outline_us: f64,
    outline_us_spread: [f64; 2],
    observables_us: f64,
    observables_us_spread: [f64; 2],
    next_frame_us: f64,
    next_frame_us_spread: [f64; 2],
    /// One trajectory of the full-order model against one of the reduced-order model, in the same run.
    fom_over_rom: Option<f64>,
    fom_over_rom_spread: Option<[f64; 2]>,
    /// All tasks and both methods.
    timings: Vec<Timing>,
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
    let of = |task: Task| {
        let timing = timings
            .iter()
            .find(|timing| timing.task == task && timing.method == "direct");
        timing.with_context(|| format!("{task:?} was not timed"))
    };
    let median = |task| of(task).map(|timing| timing.median_us);
    let spread = |task| of(task).map(|timing| [timing.lower_quartile_us, timing.upper_quartile_us]);
    let full = if options.no_fom {
        None
    } else {
        Some(1e6 * full_order_seconds()?)
    };
    let trajectory = median(Task::Trajectory)?;
    let quartiles = spread(Task::Trajectory)?;
    let report = Report {
        prepare_us: median(Task::Prepare)?,
        prepare_us_spread: spread(Task::Prepare)?,
        trajectory_us: trajectory,
        trajectory_us_spread: quartiles,
        surface_us: median(Task::Surface)?,
        surface_us_spread: spread(Task::Surface)?,
        outline_us: median(Task::Outline)?,
        outline_us_spread: spread(Task::Outline)?,
        observables_us: median(Task::Observables)?,
        observables_us_spread: spread(Task::Observables)?,
        next_frame_us: median(Task::NextFrame)?,
        next_frame_us_spread: spread(Task::NextFrame)?,
        fom_over_rom: full.map(|full| full / trajectory),
        fom_over_rom_spread: full.map(|full| [full / quartiles[1], full / quartiles[0]]),
        timings,
    };
    if options.json {
        return print::json(&report);
    }
    let rows: Vec<Vec<String>> = report
        .timings
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
    )?;
    if let Some(ratio) = report.fom_over_rom {
        println!("one trajectory of the full-order model takes {ratio:.3e} times as long");
    }
    Ok(())
}

/// Wall time of one run of the full-order model, mesh 13, at (0.10, 0.90), on one core.
fn full_order_seconds() -> Result<f64> {
    let solver = Solver::new(Settings::default())?;
    let configuration = Configuration {
        capillary_number: 0.10,
        confinement: 0.90,
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let outcome = pool.install(|| solver.run(&configuration, &mut |_| interrupt::flow()))?;
    Ok(outcome.wall_time_s)
}
