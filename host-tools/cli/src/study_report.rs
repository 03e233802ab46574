//! `capsule-rom study report`: everything on one page.

use crate::{model, progress};
use anyhow::Result;
use capsule_database::Database;
use capsule_study::stability::Subject;
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Folder that the page and its data are written to
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Model file [default: the shipped model]
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// Folder of the snapshot database
    #[arg(long, value_name = "DIR", default_value = "models/database")]
    database: PathBuf,
    /// Folder of the configurations that the model does not contain
    #[arg(long, value_name = "DIR", default_value = "models/fresh")]
    fresh: PathBuf,
    /// A minute instead of half an hour, on a part of the data
    #[arg(long)]
    quick: bool,
    /// No progress bar
    #[arg(short, long)]
    quiet: bool,
}

const EXAMPLES: &str = "\
Examples:
  capsule-rom study report --out report/
  capsule-rom study report --out report/ --quick

Writes index.html, which needs no network, and the numbers of each of its figures as CSV.";

pub fn run(options: &Options) -> Result<()> {
    let bytes = model::read(options.model.as_deref())?;
    let (database, fresh) = (Database::open(&options.database)?, Database::open(&options.fresh)?);
    let subject = Subject {
        model: &bytes,
        database: &database,
        fresh: &fresh,
        quick: options.quick,
    };
    let bar = progress::tasks(options.quiet);
    capsule_study::report(&subject, &options.out, &|task, done, of| {
        progress::show(&bar, task, done, of)
    })?;
    bar.finish_and_clear();
    println!("{}", options.out.join("index.html").display());
    Ok(())
}
