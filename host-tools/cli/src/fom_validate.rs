//! `capsule-rom fom validate`: the full-order model against exact and published results.

use crate::{print, progress};
use anyhow::{Result, bail};
use capsule_database::Database;
use capsule_validation::{Check, Reference};
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;
use std::time::Instant;

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Folder of the snapshot database whose steady configurations are counted
    #[arg(long, value_name = "DIR", default_value = "models/database")]
    database: PathBuf,
    /// The checks that take seconds: each operator of the solver, one run in shear and one in the duct. Less than a
    /// minute on one core; reads no database
    #[arg(long, conflicts_with = "database")]
    quick: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// No progress bar
    #[arg(short, long)]
    quiet: bool,
}

const EXAMPLES: &str = "\
Examples:
  capsule-rom fom validate
  capsule-rom fom validate --quick
  capsule-rom fom validate --json > validation.json

Each row is computed by this solver at meshes 5 to 13; the last rows are counted in the database. `harmonics` and \
`elements` are the two discretisations of the membrane (fom run --membrane). All checks take some minutes.

Exit code 1 if a difference exceeds its tolerance.";

#[derive(Serialize)]
struct Report<'a> {
    checks: &'a [Check],
    failed: usize,
    wall_time_s: f64,
}

pub fn run(options: &Options) -> Result<()> {
    let clock = Instant::now();
    let bar = progress::tasks(options.quiet);
    let show = |part: &str, done, of| progress::show(&bar, part, done, of);
    let checks = if options.quick {
        capsule_validation::validate_quick(&show)?
    } else {
        capsule_validation::validate(&Database::open(&options.database)?, &show)?
    };
    bar.finish_and_clear();
    let failed = checks.iter().filter(|check| !check.passed).count();
    let wall_time_s = clock.elapsed().as_secs_f64();
    if options.json {
        print::json(&Report {
            checks: &checks,
            failed,
            wall_time_s,
        })?;
    } else {
        table(&checks)?;
        println!(
            "\n{} of {} pass, in {wall_time_s:.0} s",
            checks.len() - failed,
            checks.len()
        );
        if !options.quick {
            println!("{NOTES}");
        }
    }
    if failed > 0 {
        bail!("{failed} of {} checks failed", checks.len());
    }
    Ok(())
}

const NOTES: &str = "\
Where the reference is a range, the difference is the distance to its nearer end.
Steady D at Ca = 0.3: the range is that of three published codes; another converged implementation gives 0.397.";

fn table(checks: &[Check]) -> Result<()> {
    let rows: Vec<Vec<String>> = checks
        .iter()
        .map(|check| {
            vec![
                check.quantity.clone(),
                number(check.computed),
                match check.reference {
                    Reference::Value(value) => number(value),
                    Reference::Range([low, high]) => format!("{} to {}", number(low), number(high)),
                },
                format!("{:.1e}", check.difference),
                format!("{:.1e}", check.tolerance),
                if check.passed { "pass" } else { "FAIL" }.to_owned(),
                check.source.to_owned(),
            ]
        })
        .collect();
    print::table(
        &[
            "quantity",
            "computed",
            "reference",
            "difference",
            "tolerance",
            "verdict",
            "source",
        ],
        &rows,
    )
}

/// Nine significant digits at most, no trailing zeros.
fn number(value: f64) -> String {
    if value != 0.0 && value.abs() < 1e-4 {
        return format!("{value:.2e}");
    }
    let text = format!("{value:.8}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
