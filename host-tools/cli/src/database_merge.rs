//! `capsule-rom database merge`: the parts of a sweep as one database.

use crate::outputs::Outputs;
use crate::sweep::design::DesignOptions;
use crate::sweep::queue::Queue;
use anyhow::{Result, bail};
use capsule_database::Merge;
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Folders of the parts
    #[arg(value_name = "DIR", required = true)]
    parts: Vec<PathBuf>,
    /// Folder of the database to write: a new one
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    design: DesignOptions,
}

const EXAMPLES: &str = "\
Examples:
  capsule-rom database merge --out whole part-1 part-2
  capsule-rom database merge --out models/database --design full parts/*

The parts must have the same settings and the same mesh, and a configuration that is in several must be the same in \
all. When a design is named, every configuration that a sweep over it computes must be there. The database appears \
whole or not at all.";

pub fn run(options: &Options) -> Result<()> {
    Merge::check(&options.out)?;
    let mut outputs = Outputs::default().folder("--out", options.out.as_path());
    for part in &options.parts {
        outputs = outputs.reads("DIR", part.as_path());
    }
    outputs.checked()?;
    let merge = Merge::gather(&options.parts)?;
    let entries: Vec<_> = merge.entries().cloned().collect();
    if options.design.is_given() {
        let queue = Queue::new(options.design.rule()?, options.design.rows()?, &entries);
        if let Some(first) = queue.missing().first() {
            let (done, most) = queue.count();
            bail!(
                "the design is not complete: Ca = {}, a/l = {} is missing ({done} of at most {most} configurations are \
                 there)",
                first.capillary_number,
                first.confinement
            );
        }
    }
    merge.write(&options.out)?;
    println!(
        "{} configurations of {} databases in {}; {} were in several",
        entries.len(),
        options.parts.len(),
        options.out.display(),
        merge.repeated()
    );
    Ok(())
}
