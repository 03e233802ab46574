//! `capsule-rom study report`: all studies on one page.

use crate::outputs::Outputs;
use crate::progress;
use crate::subject::SubjectOptions;
use anyhow::Result;
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Folder that the page and its data are written to
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    subject: SubjectOptions,
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
    let outputs = options.subject.reads(Outputs::default());
    let mut outputs = outputs.folder("--out", options.out.as_path()).checked()?;
    let files = options.subject.open()?;
    let bar = progress::tasks(options.quiet);
    outputs.write_into(&options.out, |folder| {
        let progress = |task: &str, done, of| progress::show(&bar, task, done, of);
        Ok(capsule_study::report(&files.subject(), folder, &progress)?)
    })?;
    bar.finish_and_clear();
    outputs.finish()?;
    println!("{}", options.out.join("index.html").display());
    Ok(())
}
