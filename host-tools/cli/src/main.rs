//! `capsule-rom`: the full-order solver, the offline stage, predictions and studies from the command line.

mod bending_effect;
mod database_export;
mod database_merge;
mod fields;
mod fom_convergence;
mod fom_integrators;
mod fom_limit;
mod fom_run;
mod fom_shear;
mod fom_validate;
mod header;
mod identify;
mod interrupt;
mod membrane;
mod model;
mod names;
mod offline_build;
mod outlines;
mod outputs;
mod parameters;
mod predict;
mod print;
mod progress;
mod record;
mod solver_options;
mod source;
mod study_bending;
mod study_identify;
mod study_leave_one_out;
mod study_report;
mod study_scenes;
mod study_smoothness;
mod study_speed;
mod study_stability;
mod study_suggest;
mod study_test_set;
mod subject;
mod sweep;

use clap::{CommandFactory, Parser, Subcommand};
use std::process::ExitCode;

/// A capsule's motion in a square microchannel: full-order solver and reduced-order model.
///
/// Lengths are in l (half the channel's side), velocities in the mean velocity V, time in l/V.
#[derive(Parser)]
#[command(name = "capsule-rom", version, after_help = EXAMPLES)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

const EXAMPLES: &str = "\
Examples:
  capsule-rom predict --ca 0.10 --confinement 0.90 --t 0.4,3,6,9
  capsule-rom fom run --ca 0.10 --confinement 0.90 --out run/
  capsule-rom fom sweep --database models/database
  capsule-rom offline build --plots plots/
  capsule-rom study leave-one-out --json

Exit codes: 0 done, 1 failed, 2 usage";

#[derive(Subcommand)]
enum Command {
    /// Full-order model: boundary integrals and membrane finite elements
    #[command(subcommand)]
    Fom(Fom),
    /// Snapshot databases
    #[command(subcommand)]
    Database(Data),
    /// From snapshots to a model file
    #[command(subcommand)]
    Offline(Offline),
    /// Predict a capsule's motion with the reduced-order model
    Predict(predict::Options),
    /// Print the dimensions of a model as a C header
    Header(header::Options),
    /// Membrane properties from an outline or a picture of a capsule, or from a few lengths
    Identify(Box<identify::Options>),
    /// Accuracy and speed of the reduced-order model
    #[command(subcommand)]
    Study(Study),
    /// Print a completion script for a shell
    #[command(
        after_help = "Example:\n  capsule-rom completions bash > ~/.local/share/bash-completion/completions/capsule-rom"
    )]
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
}

#[derive(Subcommand)]
enum Fom {
    /// Run one configuration
    Run(fom_run::Options),
    /// Run a design of experiment into a database; resumable
    Sweep(sweep::Options),
    /// The steady limit of each row of a database
    Limit(fom_limit::Options),
    /// A capsule in unbounded simple shear flow, to compare with the literature
    Shear(fom_shear::Options),
    /// Check the solver against exact and published results
    Validate(fom_validate::Options),
    /// The error of each numerical cause alone (slow)
    Convergence(fom_convergence::Options),
    /// Cost of the time integrators against their error
    Integrators(fom_integrators::Options),
}

#[derive(Subcommand)]
enum Data {
    /// Merge the parts of a sweep into one database
    Merge(database_merge::Options),
    /// Write a database as plain arrays for other programs: NPZ, HDF5 or VTU
    Export(database_export::Options),
}

#[derive(Subcommand)]
enum Offline {
    /// Build a model file from a snapshot database or from other people's data
    Build(offline_build::Options),
}

#[derive(Subcommand)]
enum Study {
    /// Predict each sample from all the others and compare the two
    LeaveOneOut(study_leave_one_out::Options),
    /// Errors of the model at configurations that are not samples
    TestSet(study_test_set::Options),
    /// The effect of the full-order model's bending stiffness
    Bending(study_bending::Options),
    /// Suggest the configurations to compute next, where the model expects its largest errors
    Suggest(study_suggest::Options),
    /// Smoothness of the samples of a database along its rows: a lower limit of the model's error
    Smoothness(study_smoothness::Options),
    /// How well capsules are identified from their outlines: errors, coverage, spread, time
    Identify(study_identify::Options),
    /// Time of a query, a trajectory, a surface, an outline
    Speed(study_speed::Options),
    /// Cost of an outline, a section, a surface, velocities, tensions: operations, bytes, time
    Scenes(study_scenes::Options),
    /// Errors against settings, conditioning, edges, degenerate samples, random queries, damaged data
    Stability(study_stability::Options),
    /// One page with the paper's figures, run time against error, scene costs, stability and calibration
    Report(study_report::Options),
}

fn main() -> ExitCode {
    // A closed pipe (`capsule-rom ... | head`) ends the command silently.
    sigpipe::reset();
    let result = match Arguments::parse().command {
        Command::Fom(Fom::Run(options)) => fom_run::run(&options),
        Command::Fom(Fom::Sweep(options)) => sweep::run(&options),
        Command::Fom(Fom::Limit(options)) => fom_limit::run(&options),
        Command::Fom(Fom::Shear(options)) => fom_shear::run(&options),
        Command::Fom(Fom::Validate(options)) => fom_validate::run(&options),
        Command::Fom(Fom::Convergence(options)) => fom_convergence::run(&options),
        Command::Fom(Fom::Integrators(options)) => fom_integrators::run(&options),
        Command::Database(Data::Merge(options)) => database_merge::run(&options),
        Command::Database(Data::Export(options)) => database_export::run(&options),
        Command::Offline(Offline::Build(options)) => offline_build::run(&options),
        Command::Predict(options) => predict::run(&options),
        Command::Header(options) => header::run(&options),
        Command::Identify(options) => identify::run(&options),
        Command::Study(Study::LeaveOneOut(options)) => study_leave_one_out::run(&options),
        Command::Study(Study::TestSet(options)) => study_test_set::run(&options),
        Command::Study(Study::Bending(options)) => study_bending::run(&options),
        Command::Study(Study::Identify(options)) => study_identify::run(&options),
        Command::Study(Study::Suggest(options)) => study_suggest::run(&options),
        Command::Study(Study::Smoothness(options)) => study_smoothness::run(&options),
        Command::Study(Study::Scenes(options)) => study_scenes::run(&options),
        Command::Study(Study::Speed(options)) => study_speed::run(&options),
        Command::Study(Study::Stability(options)) => study_stability::run(&options),
        Command::Study(Study::Report(options)) => study_report::run(&options),
        Command::Completions { shell } => {
            clap_complete::generate(shell, &mut Arguments::command(), "capsule-rom", &mut std::io::stdout());
            Ok(())
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => match error.downcast::<clap::Error>() {
            Ok(usage) => usage.exit(),
            Err(error) => {
                eprintln!("error: {}", describe(&error));
                ExitCode::FAILURE
            }
        },
    }
}

/// The error and its causes in one line; a cause that a message already contains is left out.
fn describe(error: &anyhow::Error) -> String {
    error
        .chain()
        .map(ToString::to_string)
        .fold(String::new(), |text, cause| {
            if text.is_empty() {
                cause
            } else if text.ends_with(&cause) {
                text
            } else {
                format!("{text}: {cause}")
            }
        })
        .replace(['\r', '\n'], " ")
}
