//! `capsule-rom fom limit`: the steady limit of each row of a database.

use crate::print;
use anyhow::{Result, bail};
use capsule_database::{Database, Entry};
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Folder of the database
    #[arg(long, value_name = "DIR", default_value = "models/database")]
    database: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

const EXAMPLES: &str = "\
Examples:
  capsule-rom fom limit
  capsule-rom fom limit --database coarse --json

For each confinement: the greatest capillary number with a steady state, the least one above it without, and the middle
between them, an estimate of the limit to half the bracket.";

/// The bracket of one row's limit.
#[derive(Debug, PartialEq, Serialize)]
struct Limit {
    confinement: f64,
    largest_steady_ca: Option<f64>,
    smallest_unsteady_ca: Option<f64>,
    limit: Option<f64>,
}

#[derive(Serialize)]
struct Limits {
    limits: Vec<Limit>,
}

pub fn run(options: &Options) -> Result<()> {
    let limits = limits(&Database::open(&options.database)?.entries()?);
    if limits.is_empty() {
        bail!("{} holds no configuration", options.database.display());
    }
    if options.json {
        return print::json(&Limits { limits });
    }
    let text = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.5}"));
    let rows: Vec<Vec<String>> = limits
        .iter()
        .map(|limit| {
            vec![
                format!("{:.4}", limit.confinement),
                text(limit.largest_steady_ca),
                text(limit.smallest_unsteady_ca),
                text(limit.limit),
            ]
        })
        .collect();
    print::table(&["a/l", "steady_to_ca", "unsteady_from_ca", "limit"], &rows)
}

fn limits(entries: &[Entry]) -> Vec<Limit> {
    let mut confinements: Vec<f64> = entries.iter().map(|entry| entry.parameters[1]).collect();
    confinements.sort_by(f64::total_cmp);
    confinements.dedup();
    confinements
        .into_iter()
        .map(|confinement| {
            // Entries ascend in Ca.
            let row = entries.iter().filter(|entry| entry.parameters[1] == confinement);
            let ca = |entry: &Entry| entry.parameters[0];
            let largest_steady_ca = row.clone().rfind(|entry| entry.status.is_steady()).map(ca);
            let smallest_unsteady_ca = largest_steady_ca.and_then(|steady| row.map(ca).find(|ca| *ca > steady));
            let limit = largest_steady_ca
                .zip(smallest_unsteady_ca)
                .map(|(steady, unsteady)| 0.5 * (steady + unsteady));
            Limit {
                confinement,
                largest_steady_ca,
                smallest_unsteady_ca,
                limit,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use capsule_database::Status;

    #[test]
    fn the_limit_lies_between_the_last_steady_and_the_next() {
        let entry = |ca: f64, a: f64, steady: bool| Entry {
            parameters: vec![ca, a],
            status: if steady {
                Status::Steady { time: 3.0 }
            } else {
                Status::Unsteady
            },
            snapshots: 2,
            file: String::new(),
        };
        let entries = [
            entry(0.005, 1.0, false),
            entry(0.01, 0.9, true),
            entry(0.01, 1.0, true),
            entry(0.02, 1.0, true),
            entry(0.03, 1.0, false),
            entry(0.04, 1.0, false),
        ];
        let limits = limits(&entries);
        assert_eq!((limits[0].confinement, limits[0].largest_steady_ca), (0.9, Some(0.01)));
        assert_eq!((limits[0].smallest_unsteady_ca, limits[0].limit), (None, None));
        assert_eq!(
            (limits[1].largest_steady_ca, limits[1].smallest_unsteady_ca),
            (Some(0.02), Some(0.03))
        );
        assert_eq!(limits[1].limit, Some(0.025));
    }
}
