//! `capsule-rom fom sweep`: a design of experiment, resumable, one file a configuration.

mod checkpoint;
pub mod design;
mod points;
pub mod queue;
pub mod row;
pub mod rule;

use crate::solver_options::SolverOptions;
use crate::{interrupt, progress, record};
use anyhow::{Context, Result, bail};
use capsule_database::Database;
use capsule_fom::{Configuration, RunState, Solver, Status};
use checkpoint::Checkpoints;
use clap::Args;
use design::DesignOptions;
use indicatif::ProgressBar;
use queue::Queue;
use std::ops::ControlFlow;
use std::path::PathBuf;

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Folder of the database; configurations that it holds are kept and not computed again
    #[arg(long, value_name = "DIR", default_value = "models/database")]
    database: PathBuf,
    #[command(flatten)]
    design: DesignOptions,
    /// Configurations computed at the same time, each on one thread
    #[arg(long, default_value_t = 2)]
    workers: usize,
    #[command(flatten)]
    solver: SolverOptions,
    /// No progress bars
    #[arg(short, long)]
    quiet: bool,
}

const EXAMPLES: &str = "\
Examples:
  capsule-rom fom sweep --database models/database --mesh 13
  capsule-rom fom sweep --database coarse --mesh 4 --ca 0.05,0.10 --confinement 0.85,0.90
  capsule-rom fom sweep --database part-2 --mesh 13 --shard 2/8
  capsule-rom fom sweep --database models/test-set --mesh 13 --points models/test-set.csv

Every configuration is recorded with its trajectory and how it ended: steady, unsteady at the end time, or stopped \
where the solver could not go on. A row of equal confinement ends --beyond grid points above its steady limit. An \
interrupted sweep goes on where it stopped when the same command is given again, and gives the same files.";

pub fn run(options: &Options) -> Result<()> {
    interrupt::listen()?;
    if options.workers == 0 {
        bail!("--workers must be at least 1");
    }
    let (rule, rows) = (options.design.rule()?, options.design.rows()?);
    let solver = Solver::new(options.solver.settings())?;
    // If the longest capsule fits in the duct, all do; fail before anything is computed or written.
    if let Some(longest) = rows.last() {
        solver.start(&longest.configuration(0))?;
    }
    let description = record::description(solver.settings())?;
    let database = Database::create(&options.database, description, record::mesh(&solver))?;
    let checkpoints = Checkpoints::new(&database, solver.settings())?;
    let queue = Queue::new(rule, rows, &database.entries()?);
    let bars = progress::Sweep::new(options.quiet, queue.count());

    let results: Vec<Result<()>> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..options.workers)
            .map(|_| {
                let worker = Worker {
                    solver: &solver,
                    database: &database,
                    checkpoints: &checkpoints,
                    queue: &queue,
                    bars: &bars,
                };
                scope.spawn(move || worker.run())
            })
            .collect();
        let joined = workers.into_iter().map(std::thread::ScopedJoinHandle::join);
        joined
            .map(|end| end.unwrap_or_else(|_| Err(anyhow::anyhow!("a worker ended unexpectedly"))))
            .collect()
    });
    bars.clear();
    results.into_iter().collect::<Result<Vec<()>>>()?;
    if interrupt::asked() {
        bail!(
            "interrupted; what was running is saved in {}, and the same command goes on from there",
            checkpoints.folder().display()
        );
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

/// Takes configurations until none is left or Ctrl-C was pressed.
struct Worker<'a> {
    solver: &'a Solver,
    database: &'a Database,
    checkpoints: &'a Checkpoints,
    queue: &'a Queue,
    bars: &'a progress::Sweep,
}

impl Worker<'_> {
    fn run(&self) -> Result<()> {
        let alone = rayon::ThreadPoolBuilder::new()
            .num_threads(1)
            .build()
            .context("could not start a worker thread")?;
        while !self.is_over() {
            let Some(configuration) = self.queue.next() else { break };
            let bar = self.bars.start(&configuration);
            let result = alone.install(|| self.compute(&configuration, &bar)).with_context(|| {
                let Configuration {
                    capillary_number,
                    confinement,
                } = configuration;
                format!("Ca = {capillary_number}, a/l = {confinement}")
            });
            bar.finish_and_clear();
            if result.is_err() {
                // The others could not do better: a full disk, or settings that no configuration can have.
                self.queue.end();
                return result;
            }
            self.bars.count(self.queue.count());
        }
        Ok(())
    }

    /// Whether to break off: Ctrl-C was pressed, or another worker failed.
    fn is_over(&self) -> bool {
        interrupt::asked() || self.queue.is_ended()
    }

    /// Computes one configuration to its end and records it, or saves it where it was interrupted.
    fn compute(&self, configuration: &Configuration, bar: &ProgressBar) -> Result<()> {
        let run = match self.checkpoints.read(configuration) {
            Some(run) => run,
            None => self.solver.start(configuration)?,
        };
        let state = self.solver.resume(run, &mut |now| {
            progress::show_run(bar, now);
            if self.is_over() {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        })?;
        match state {
            RunState::Interrupted(run) => self.checkpoints.save(&run),
            RunState::Finished(outcome) => {
                self.database.write(&record::trajectory(&outcome))?;
                self.checkpoints.forget(configuration);
                if let Some(warning) = self.solver.film_warning(&outcome) {
                    let Configuration {
                        capillary_number,
                        confinement,
                    } = configuration;
                    self.bars
                        .warn(&format!("Ca = {capillary_number}, a/l = {confinement}: {warning}"));
                }
                let steady = matches!(outcome.status, Status::Steady { .. });
                self.queue.finish(configuration, steady);
                Ok(())
            }
        }
    }
}
