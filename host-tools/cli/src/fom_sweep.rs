//! `capsule-rom fom sweep`: a design of experiment, resumable, one file a configuration.

use crate::solver_options::SolverOptions;
use crate::{interrupt, progress};
use anyhow::{Context, Result, bail};
use capsule_database::{Database, Description, Trajectory};
use capsule_fom::{Configuration, Outcome, Settings, Solver, Status};
use clap::Args;
use indicatif::ProgressBar;
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Mutex;

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Folder of the database; what is there is kept and not computed again
    #[arg(long, value_name = "DIR", default_value = "models/database")]
    database: PathBuf,
    /// Capillary numbers [default: 0.005, and 0.01 to 0.20 by 0.01]
    #[arg(long, value_delimiter = ',')]
    ca: Vec<f64>,
    /// Confinements [default: 0.75 to 1.20 by 0.05]
    #[arg(long, value_delimiter = ',')]
    confinement: Vec<f64>,
    /// Configurations computed at the same time, each on one thread
    #[arg(long, default_value_t = 2)]
    workers: usize,
    #[command(flatten)]
    solver: SolverOptions,
    /// No progress bar
    #[arg(short, long)]
    quiet: bool,
}

const EXAMPLES: &str = "\
Examples:
  capsule-rom fom sweep --database models/database
  capsule-rom fom sweep --database coarse --mesh 4 --ca 0.05,0.10 --confinement 0.85,0.90

A row of equal confinement ends at its first capillary number without a steady state: above it there is none. That
configuration is recorded by its status alone.";

/// The confinements by rising capillary number, row by row in step, so that an interrupted sweep covers the whole range
/// of confinements.
struct Queue {
    waiting: Vec<Configuration>,
    ended_rows: BTreeSet<u64>,
}

impl Queue {
    fn next(&mut self) -> Option<Configuration> {
        let ended = &self.ended_rows;
        self.waiting
            .retain(|configuration| !ended.contains(&row(configuration)));
        (!self.waiting.is_empty()).then(|| self.waiting.remove(0))
    }

    fn end_row(&mut self, configuration: &Configuration) {
        self.ended_rows.insert(row(configuration));
    }
}

/// Rows are told apart by the bits of their confinement.
fn row(configuration: &Configuration) -> u64 {
    configuration.confinement.to_bits()
}

pub fn run(options: &Options) -> Result<()> {
    interrupt::listen()?;
    let design = design(options);
    for configuration in &design {
        configuration.validate()?;
    }
    if options.workers == 0 {
        bail!("--workers must be at least 1");
    }
    let solver = Solver::new(options.solver.settings())?;
    let database = Database::create(
        &options.database,
        description(solver.settings())?,
        database_mesh(&solver),
    )?;
    let queue = Mutex::new(queue(design, &database)?);
    let template = "{bar:40} {pos}/{len} configurations, {elapsed} gone, {eta} to go  {msg}";
    let bar = progress::bar(options.quiet, remaining(&queue), template);

    let results: Vec<Result<()>> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..options.workers)
            .map(|_| scope.spawn(|| work(&solver, &database, &queue, &bar)))
            .collect();
        workers
            .into_iter()
            .map(|worker| {
                worker
                    .join()
                    .unwrap_or_else(|_| Err(anyhow::anyhow!("a worker ended unexpectedly")))
            })
            .collect()
    });
    bar.finish_and_clear();
    results.into_iter().collect::<Result<Vec<()>>>()?;
    if interrupt::asked() {
        bail!("interrupted; the same command goes on where it stopped");
    }
    let entries = database.entries()?;
    let steady = entries.iter().filter(|entry| entry.status.is_steady()).count();
    println!(
        "{steady} steady of {} configurations in {}",
        entries.len(),
        options.database.display()
    );
    Ok(())
}

/// What is still to do: rows that ended in an earlier sweep stay ended.
fn queue(design: Vec<Configuration>, database: &Database) -> Result<Queue> {
    let mut queue = Queue {
        waiting: Vec::new(),
        ended_rows: BTreeSet::new(),
    };
    let ended: Vec<Vec<f64>> = database
        .entries()?
        .into_iter()
        .filter(|entry| !entry.status.is_steady())
        .map(|entry| entry.parameters)
        .collect();
    for configuration in design {
        let parameters = parameters(&configuration);
        if ended
            .iter()
            .any(|end| same(end[1], parameters[1]) && parameters[0] > end[0] - 1e-9)
        {
            continue;
        }
        if !database.contains(&parameters) {
            queue.waiting.push(configuration);
        }
    }
    Ok(queue)
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

fn design(options: &Options) -> Vec<Configuration> {
    let or = |given: &[f64], default: Vec<f64>| if given.is_empty() { default } else { given.to_vec() };
    let capillary_numbers = or(
        &options.ca,
        std::iter::once(0.005)
            .chain((1..=20).map(|i| f64::from(i) / 100.0))
            .collect(),
    );
    let confinements = or(
        &options.confinement,
        (0..10).map(|i| f64::from(75 + 5 * i) / 100.0).collect(),
    );
    capillary_numbers
        .iter()
        .flat_map(|&capillary_number| {
            confinements.iter().map(move |&confinement| Configuration {
                capillary_number,
                confinement,
            })
        })
        .collect()
}

fn remaining(queue: &Mutex<Queue>) -> u64 {
    queue.lock().map_or(0, |queue| queue.waiting.len() as u64)
}

/// One worker: takes configurations until none is left or Ctrl-C was pressed.
fn work(solver: &Solver, database: &Database, queue: &Mutex<Queue>, bar: &ProgressBar) -> Result<()> {
    let alone = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .context("could not start a worker thread")?;
    let lock = || queue.lock().map_err(|_| anyhow::anyhow!("another worker failed"));
    while !interrupt::asked() {
        let Some(configuration) = lock()?.next() else { break };
        bar.set_message(format!(
            "Ca = {}, a/l = {}",
            configuration.capillary_number, configuration.confinement
        ));
        let outcome = alone.install(|| solver.run(&configuration, &mut |_| interrupt::flow()))?;
        if interrupt::asked() {
            break;
        }
        match &outcome.status {
            Status::Steady { .. } => database.write(&trajectory(&outcome))?,
            Status::Unsteady | Status::Stopped { .. } => {
                database.record(&parameters(&configuration), status(&outcome.status))?;
                lock()?.end_row(&configuration);
            }
        }
        bar.inc(1);
        bar.set_length(bar.position() + remaining(queue) + 1);
    }
    Ok(())
}

/// The database's parameters of a configuration: (Ca, a/l).
fn parameters(configuration: &Configuration) -> Vec<f64> {
    vec![configuration.capillary_number, configuration.confinement]
}

/// The solver's mesh as the database keeps it.
pub fn database_mesh(solver: &Solver) -> capsule_database::Mesh {
    let mesh = solver.mesh();
    capsule_database::Mesh {
        nodes: mesh.nodes.clone(),
        elements: mesh.elements.clone(),
    }
}

/// The outcome of a run as the database keeps it.
pub fn trajectory(outcome: &Outcome) -> Trajectory {
    Trajectory {
        parameters: parameters(&outcome.configuration),
        status: status(&outcome.status),
        times: outcome.times.clone(),
        positions: outcome.positions.clone(),
        velocities: outcome.velocities.clone(),
        centroid: outcome.centroid.clone(),
        pressure_drop: outcome.pressure_drop.clone(),
    }
}

fn status(status: &Status) -> capsule_database::Status {
    match status {
        Status::Steady { time } => capsule_database::Status::Steady { time: *time },
        Status::Unsteady => capsule_database::Status::Unsteady,
        Status::Stopped { time, reason } => capsule_database::Status::Stopped {
            time: *time,
            reason: reason.clone(),
        },
    }
}

/// What the runs of a database have in common.
pub fn description(settings: &Settings) -> Result<Description> {
    let record = serde_json::to_value(settings).context("could not record the solver's settings")?;
    Ok(Description::new(settings.snapshot_interval, settings.end_time, record))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_ends_where_it_is_unsteady() {
        let at = |capillary_number, confinement| Configuration {
            capillary_number,
            confinement,
        };
        let mut queue = Queue {
            waiting: vec![at(0.1, 0.8), at(0.1, 0.9), at(0.2, 0.8), at(0.2, 0.9)],
            ended_rows: BTreeSet::new(),
        };
        let first = queue.next().unwrap();
        queue.end_row(&first);
        let rest: Vec<f64> = std::iter::from_fn(|| queue.next())
            .map(|next| next.confinement)
            .collect();
        assert_eq!(rest, [0.9, 0.9]);
    }
}
