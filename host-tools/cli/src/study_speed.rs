//! `capsule-rom study speed`: the time that the model takes to answer, on one core of this machine.

use crate::model::ModelFile;
use crate::{interrupt, print};
use anyhow::{Context, Result};
use capsule_core::{Method, Model};
use capsule_fom::{Configuration, Settings, Solver};
use capsule_study::speed::{Timing, time};
use capsule_study::task::{QUERIES, Question, Task, questions, tasks};
use clap::Args;
use serde::Serialize;

#[derive(Args)]
#[command(after_help = "Example:\n  capsule-rom study speed --json")]
pub struct Options {
    #[command(flatten)]
    model: ModelFile,
    /// Number of random queries that each task is timed with
    #[arg(long, default_value_t = 1001)]
    queries: usize,
    /// Number of configurations that the full-order model runs for comparison, some 3 s each; 0 for none
    #[arg(long, default_value_t = 3)]
    fom_runs: usize,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// The direct method's times in microseconds: medians with first and third quartiles.
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
    /// One trajectory of the full-order model against one of the reduced-order model at the same parameters, in the
    /// same run: the median of the configurations.
    fom_over_rom: Option<f64>,
    /// The least and the greatest of the configurations.
    fom_over_rom_spread: Option<[f64; 2]>,
    configurations: Vec<Ratio>,
    /// All tasks and both methods.
    timings: Vec<Timing>,
}

/// One configuration by both models, on one core.
#[derive(Serialize)]
struct Ratio {
    capillary_number: f64,
    confinement: f64,
    fom_us: f64,
    rom_us: f64,
}

/// Repetitions of the reduced-order model for one run of the full-order model.
const BESIDE: usize = 21;
/// The paper's method is a hundred times slower.
const PAPER_SHARE: usize = 20;

pub fn run(options: &Options) -> Result<()> {
    let bytes = options.model.read()?;
    let model = options.model.open(&bytes)?;
    let asked = questions(&model, options.queries)?;
    let mut timings = Vec::new();
    for task in tasks(&model) {
        timings.push(time::<f32>(&model, Method::Direct, &task, &asked)?);
    }
    let few = &asked[..asked.len().div_ceil(PAPER_SHARE)];
    for task in QUERIES {
        timings.push(time::<f32>(&model, Method::Paper, &task, few)?);
    }
    let of = |task: &str| {
        let timing = timings
            .iter()
            .find(|timing| timing.task == task && timing.method == "direct");
        timing.with_context(|| format!("{task} was not timed"))
    };
    let median = |task| of(task).map(|timing| timing.median_us);
    let spread = |task| of(task).map(|timing| [timing.lower_quartile_us, timing.upper_quartile_us]);
    let configurations = ratios(&model, &asked[..asked.len().min(options.fom_runs)])?;
    let mut ratios: Vec<f64> = configurations.iter().map(|ratio| ratio.fom_us / ratio.rom_us).collect();
    ratios.sort_by(f64::total_cmp);
    let report = Report {
        prepare_us: median("prepare")?,
        prepare_us_spread: spread("prepare")?,
        trajectory_us: median("trajectory")?,
        trajectory_us_spread: spread("trajectory")?,
        surface_us: median("surface")?,
        surface_us_spread: spread("surface")?,
        outline_us: median("outline")?,
        outline_us_spread: spread("outline")?,
        observables_us: median("observables")?,
        observables_us_spread: spread("observables")?,
        next_frame_us: median("next_frame")?,
        next_frame_us_spread: spread("next_frame")?,
        fom_over_rom: ratios.get(ratios.len() / 2).copied(),
        fom_over_rom_spread: ratios.first().zip(ratios.last()).map(|(least, most)| [*least, *most]),
        configurations,
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
                timing.task.replace('_', " "),
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
    if let (Some(ratio), Some([least, most])) = (report.fom_over_rom, report.fom_over_rom_spread) {
        println!("one trajectory of the full-order model takes {ratio:.0} times as long ({least:.0} to {most:.0})");
    }
    Ok(())
}

/// Runs the full-order model and the reduced-order model at the same parameters.
fn ratios(model: &Model<'_>, questions: &[Question]) -> Result<Vec<Ratio>> {
    if questions.is_empty() {
        return Ok(Vec::new());
    }
    let trajectory = QUERIES.iter().find(|task| task.name == "trajectory");
    let trajectory: &Task = trajectory.context("no task is a trajectory")?;
    let settings = Settings {
        end_time: model.end_time().into(),
        ..Settings::default()
    };
    let solver = Solver::new(settings)?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    questions
        .iter()
        .map(|question| {
            let [capillary_number, confinement] = [question.parameters.get(0), question.parameters.get(1)];
            let configuration = Configuration {
                capillary_number,
                confinement,
            };
            let outcome = pool.install(|| solver.run(&configuration, &mut |_| interrupt::flow()))?;
            let beside = time::<f32>(model, Method::Direct, trajectory, &vec![*question; BESIDE])?;
            Ok(Ratio {
                capillary_number,
                confinement,
                fom_us: 1e6 * outcome.wall_time_s,
                rom_us: beside.median_us,
            })
        })
        .collect()
}
