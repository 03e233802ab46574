//! `capsule-rom database export`: a database as plain arrays for other programs.

use crate::outputs::Outputs;
use crate::{interrupt, print, progress};
use anyhow::{Result, bail};
use capsule_database::{Database, Entry, Export};
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Folder of the snapshot database
    #[arg(value_name = "DATABASE")]
    database: PathBuf,
    #[command(flatten)]
    output: Output,
    /// Instants in l/V, numbers or START:END:STEP, from 0 on [default: all of the database]
    #[arg(long, value_name = "T,...", allow_hyphen_values = true)]
    t: Option<String>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// No progress bar
    #[arg(short, long)]
    quiet: bool,
}

#[derive(Args)]
#[group(required = true, multiple = false)]
struct Output {
    /// Write arrays for NumPy
    #[arg(long, value_name = "FILE")]
    npz: Option<PathBuf>,
    /// Write an HDF5 file
    #[arg(long, value_name = "FILE")]
    hdf5: Option<PathBuf>,
    /// Write a ParaView series (PVD and VTU) for each configuration and parameters.csv into this folder
    #[arg(long, value_name = "DIR")]
    vtu: Option<PathBuf>,
}

const EXAMPLES: &str = "\
Examples:
  capsule-rom database export models/database --t 0:20:0.8 --hdf5 database.h5
  capsule-rom database export models/test-set --t 0,8,20 --npz test-set.npz
  capsule-rom database export run/snapshots --vtu series/
  capsule-rom offline build --from database.h5 --out database.crom

The arrays are those that `offline build --from` reads: parameters, parameter_names, times, positions, velocities, \
elements, length_unit, time_unit. All configurations have the same instants: a steady capsule goes on in rigid \
translation, and a configuration that is not steady when its snapshots end, before the last instant, is left out.";

#[derive(Serialize)]
struct Report<'a> {
    configurations: usize,
    /// Of these, those whose snapshots end before the last instant.
    extended: usize,
    instants: usize,
    nodes: usize,
    left_out: Vec<LeftOut<'a>>,
}

#[derive(Serialize)]
struct LeftOut<'a> {
    parameters: &'a [f64],
    status: &'static str,
    snapshots: usize,
}

pub fn run(options: &Options) -> Result<()> {
    interrupt::listen()?;
    let Output { npz, hdf5, vtu } = &options.output;
    let mut outputs = Outputs::default()
        .reads("DATABASE", options.database.as_path())
        .file("--npz", npz.as_deref())
        .file("--hdf5", hdf5.as_deref())
        .folder("--vtu", vtu.as_deref())
        .checked()?;
    let database = Database::open(&options.database)?;
    let times = match &options.t {
        Some(text) => instants(text)?,
        None => database.times().to_vec(),
    };
    let export = Export::new(&database, times)?;
    let bar = progress::tasks(options.quiet);
    let mut show = |done, of| {
        progress::show(&bar, "configurations", done, of);
        interrupt::flow()
    };
    if let Some(file) = npz {
        outputs.write(file, |file| export.write_npz(file, &mut show))?;
    }
    if let Some(file) = hdf5 {
        outputs.write(file, |file| export.write_hdf5(file, &mut show))?;
    }
    if let Some(folder) = vtu {
        outputs.write_into(folder, |folder| Ok(export.write_series(folder, &mut show)?))?;
    }
    bar.finish_and_clear();
    outputs.finish()?;
    let report = report(&database, &export);
    if options.json {
        return print::json(&report);
    }
    println!(
        "{} configurations ({} extended), {} instants, {} nodes; {} left out",
        report.configurations,
        report.extended,
        report.instants,
        report.nodes,
        report.left_out.len()
    );
    Ok(())
}

fn report<'a>(database: &Database, export: &'a Export) -> Report<'a> {
    let end = export.times().last().copied().unwrap_or_default();
    let stored = |entry: &Entry| database.times().get(entry.snapshots.saturating_sub(1)).copied();
    let ends_before = |entry: &&Entry| stored(entry).is_some_and(|last| last < end - SAME);
    let left_out = |entry: &'a Entry| LeftOut {
        parameters: &entry.parameters,
        status: entry.status.name(),
        snapshots: entry.snapshots,
    };
    Report {
        configurations: export.entries().len(),
        extended: export.entries().iter().filter(ends_before).count(),
        instants: export.times().len(),
        nodes: database.mesh().nodes.len(),
        left_out: export.left_out().iter().map(left_out).collect(),
    }
}

/// The instants that `--t` names, rising, each once.
fn instants(text: &str) -> Result<Vec<f64>> {
    let mut times = Vec::new();
    for part in text.split(',') {
        let numbers: Option<Vec<f64>> = part.split(':').map(number).collect();
        match numbers.as_deref() {
            Some(&[time]) => times.push(time),
            Some(&[start, end, step]) if step > 0.0 && end >= start && (end - start) / step < LIMIT => {
                // The last step may miss the end by rounding.
                let steps = ((end - start) / step + 1e-9).floor();
                times.extend((0..=steps as u32).map(|k| start + f64::from(k) * step));
            }
            _ => bail!("--t {text}: `{part}` is neither an instant from 0 on nor START:END:STEP with rising instants"),
        }
    }
    times.sort_by(f64::total_cmp);
    times.dedup_by(|after, before| *after - *before < SAME);
    match times[..] {
        [0.0, _, ..] => Ok(times),
        _ => bail!("--t {text}: expected 0, where all capsules start, and at least one later instant"),
    }
}

/// More steps than any database has instants.
const LIMIT: f64 = 1e6;
/// Instants closer than this are the same.
const SAME: f64 = 1e-9;

fn number(text: &str) -> Option<f64> {
    // Adding 0 turns -0 into 0.
    let number = text.trim().parse::<f64>().ok()? + 0.0;
    (number.is_finite() && number >= 0.0).then_some(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instants_are_numbers_and_ranges() {
        assert_eq!(instants("8, 0,0.5,8").unwrap(), [0.0, 0.5, 8.0]);
        let range = instants("0:20:0.8").unwrap();
        assert_eq!(range.len(), 26);
        assert!((range[25] - 20.0).abs() < 1e-12);
        assert_eq!(instants("0:1:0.3,1").unwrap().len(), 5);
    }

    #[test]
    fn other_texts_are_refused() {
        for (text, word) in [
            ("0,x", "`x`"),
            ("0,-1", "`-1`"),
            ("0:1", "`0:1`"),
            ("0:1:0", "`0:1:0`"),
            ("0:1e9:0.1", "`0:1e9:0.1`"),
            ("0:nan:1", "`0:nan:1`"),
            ("", "``"),
            ("0", "later instant"),
            ("1,2", "expected 0"),
        ] {
            let error = instants(text).unwrap_err().to_string();
            assert!(error.contains(word), "{text}: {error}");
        }
    }
}
