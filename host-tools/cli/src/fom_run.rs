//! `capsule-rom fom run`: one configuration of the full-order model.

use crate::fields::{self, Field, Surface};
use crate::outputs::Outputs;
use crate::solver_options::SolverOptions;
use crate::{interrupt, print, progress, record};
use anyhow::{Result, bail};
use capsule_database::fields::{write_csv, write_npz};
use capsule_database::{Database, vtu};
use capsule_fom::{Configuration, Film, MembraneLaw, Outcome, Solver, Status};
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Capillary number Ca = mu V / G_s
    #[arg(long, allow_negative_numbers = true)]
    ca: f64,
    /// Confinement a/l
    #[arg(long, allow_negative_numbers = true)]
    confinement: f64,
    #[command(flatten)]
    solver: SolverOptions,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Write the snapshots as a ParaView series and as a snapshot database into this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Mechanics of the membrane: at the nodes in --out, --csv and --npz, their totals in --json
    #[arg(long, value_enum, value_delimiter = ',', value_name = "FIELD,...")]
    fields: Vec<Field>,
    /// Write the fields as CSV, a row for each snapshot and node
    #[arg(long, value_name = "FILE", requires = "fields")]
    csv: Option<PathBuf>,
    /// Write positions, velocities and fields as arrays for NumPy
    #[arg(long, value_name = "FILE")]
    npz: Option<PathBuf>,
    /// No progress bar
    #[arg(short, long)]
    quiet: bool,
}

const EXAMPLES: &str = "\
Examples:
  capsule-rom fom run --ca 0.10 --confinement 0.90
  capsule-rom fom run --ca 0.10 --confinement 0.90 --mesh 13 --json > run.json
  capsule-rom fom run --ca 0.05 --confinement 1.00 --integrator ralston --step 5e-4 --out run/
  capsule-rom fom run --ca 0.10 --confinement 0.90 --fields tension,load --npz fields.npz
  capsule-rom fom run --ca 0.10 --confinement 0.90 --law skalak:1";

/// The database's folder in that of --out.
const SNAPSHOTS: &str = "snapshots";

#[derive(Serialize)]
struct Run<'a> {
    ca: f64,
    confinement: f64,
    law: MembraneLaw,
    mesh: usize,
    nodes: usize,
    elements: usize,
    integrator: String,
    velocity_evaluations: usize,
    wall_time_s: f64,
    status: &'static str,
    steady: bool,
    steady_time: Option<f64>,
    volume_drift: f64,
    thinnest_film: Film,
    /// The arrays as fields of the object, for programs that read columns ...
    #[serde(flatten)]
    columns: History<'a>,
    /// ... and in one object, for programs that read a table.
    history: History<'a>,
    profile_midplane: Vec<[f64; 2]>,
    profile_diagonal: Vec<[f64; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mechanics: Option<fields::History>,
}

#[derive(Clone, Copy, Serialize)]
struct History<'a> {
    t: &'a [f64],
    centroid_velocity: &'a [f64],
    axial_length: &'a [f64],
    half_width: &'a [f64],
    half_diagonal: &'a [f64],
    rear_depth: &'a [f64],
    pressure_drop: &'a [f64],
}

pub fn run(options: &Options) -> Result<()> {
    interrupt::listen()?;
    let configuration = Configuration {
        capillary_number: options.ca,
        confinement: options.confinement,
    };
    configuration.validate()?;
    let outputs = Outputs::default()
        .folder("--out", options.out.as_deref())
        .file("--csv", options.csv.as_deref())
        .file("--npz", options.npz.as_deref())
        .checked()?;
    let solver = Solver::new(options.solver.settings())?;
    fields::check(&options.fields, &solver)?;
    let snapshots = options.out.as_ref().map(|out| out.join(SNAPSHOTS));
    if let Some(there) = snapshots.filter(|folder| folder.join("database.json").exists()) {
        // Fail before the run if the database in this folder has other settings.
        Database::create(&there, record::description(solver.settings())?, record::mesh(&solver))?;
    }
    let bar = progress::run(options.quiet);
    let outcome = solver.run(&configuration, &mut |now| {
        progress::show_run(&bar, now);
        interrupt::flow()
    })?;
    bar.finish_and_clear();
    if interrupt::asked() {
        bail!(
            "interrupted, nothing is written; `capsule-rom fom sweep --database DIR --ca {} --confinement {}` with the \
             same solver's options can be interrupted and goes on where it stopped",
            options.ca,
            options.confinement
        );
    }
    if let Some(warning) = solver.film_warning(&outcome) {
        eprintln!("warning: {warning}");
    }
    let (surfaces, mechanics) = fields::of_run(&options.fields, &solver, &outcome)?;
    write(outputs, options, &solver, &outcome, &surfaces)?;
    if options.json {
        return print::json(&summary(options, &solver, &outcome, mechanics));
    }
    report(&outcome)
}

fn summary<'a>(
    options: &Options,
    solver: &Solver,
    outcome: &'a Outcome,
    mechanics: Option<fields::History>,
) -> Run<'a> {
    let history = &outcome.history;
    let steady_time = match outcome.status {
        Status::Steady { time } => Some(time),
        Status::Unsteady | Status::Stopped { .. } => None,
    };
    let columns = History {
        t: &history.t,
        centroid_velocity: &history.centroid_velocity,
        axial_length: &history.axial_length,
        half_width: &history.half_width,
        half_diagonal: &history.half_diagonal,
        rear_depth: &history.rear_depth,
        pressure_drop: &history.pressure_drop,
    };
    Run {
        ca: options.ca,
        confinement: options.confinement,
        law: solver.settings().law,
        mesh: solver.settings().mesh_frequency,
        nodes: solver.mesh().nodes.len(),
        elements: solver.mesh().elements.len(),
        integrator: options.solver.integrator_name(),
        velocity_evaluations: outcome.velocity_evaluations,
        wall_time_s: outcome.wall_time_s,
        status: status(&outcome.status),
        steady: steady_time.is_some(),
        steady_time,
        volume_drift: outcome.volume_drift,
        thinnest_film: outcome.thinnest_film,
        columns,
        history: columns,
        profile_midplane: outcome.profile_midplane.clone(),
        profile_diagonal: outcome.profile_diagonal.clone(),
        mechanics,
    }
}

fn status(status: &Status) -> &'static str {
    match status {
        Status::Steady { .. } => "steady",
        Status::Unsteady => "unsteady",
        Status::Stopped { .. } => "stopped",
    }
}

fn report(outcome: &Outcome) -> Result<()> {
    let history = &outcome.history;
    let every = (history.t.len() / 20).max(1);
    let rows: Vec<Vec<String>> = (0..history.t.len())
        .filter(|i| i % every == 0 || i + 1 == history.t.len())
        .map(|i| {
            let columns = [
                &history.t,
                &history.centroid_velocity,
                &history.axial_length,
                &history.half_width,
                &history.half_diagonal,
                &history.rear_depth,
                &history.pressure_drop,
            ];
            columns.iter().map(|column| format!("{:.4}", column[i])).collect()
        })
        .collect();
    print::table(
        &[
            "t",
            "velocity",
            "length",
            "half_width",
            "half_diagonal",
            "rear_depth",
            "pressure_drop",
        ],
        &rows,
    )?;
    println!(
        "{}; {} velocity evaluations in {:.1} s; relative volume drift {:.1e}",
        match &outcome.status {
            Status::Steady { time } => format!("steady from t = {time:.2}"),
            Status::Unsteady => "no steady state".to_owned(),
            Status::Stopped { time, reason } => format!("stopped at t = {time:.2}: {reason}"),
        },
        outcome.velocity_evaluations,
        outcome.wall_time_s,
        outcome.volume_drift
    );
    Ok(())
}

fn write(
    mut outputs: Outputs,
    options: &Options,
    solver: &Solver,
    outcome: &Outcome,
    surfaces: &[Surface],
) -> Result<()> {
    let mesh = record::mesh(solver);
    let instants: Vec<_> = surfaces.iter().map(Surface::instant).collect();
    if let Some(file) = &options.csv {
        let title = format!(
            "capsule-rom fom run; Ca = {}; a/l = {}; {}",
            options.ca,
            options.confinement,
            solver.settings().law
        );
        outputs.write(file, |file| write_csv(file, &title, &instants))?;
    }
    if let Some(file) = &options.npz {
        outputs.write(file, |file| write_npz(file, &mesh, &instants))?;
    }
    if let Some(folder) = &options.out {
        let description = record::description(solver.settings())?;
        outputs.write_into(folder, |folder| {
            vtu::Series::write(folder, "capsule", &mesh, &instants)?;
            let snapshots = Database::create(&folder.join(SNAPSHOTS), description, mesh.clone())?;
            Ok(snapshots.write(&record::trajectory(outcome))?)
        })?;
    }
    outputs.finish()
}
