//! `capsule-rom study bending`: the effect of the bending stiffness of the full-order model.

use crate::print;
use anyhow::Result;
use capsule_database::Database;
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Folder of the snapshot database; its file bending.csv is written
    #[arg(long, value_name = "DIR", default_value = "models/database")]
    database: PathBuf,
    /// Folder of a database without bending stiffness, of the same mesh
    #[arg(long, value_name = "DIR")]
    without: PathBuf,
}

const EXAMPLES: &str = "\
Examples:
  capsule-rom fom sweep --database unbent/ --mesh 13 --bending 0 --points points.csv
  capsule-rom study bending --without unbent/

`predict` tells the figure of the nearest configuration once the model is built again.";

pub fn run(options: &Options) -> Result<()> {
    let database = Database::open(&options.database)?;
    let effects = capsule_offline::bending_effect(&database, &Database::open(&options.without)?)?;
    database.write_bending_effect(&effects)?;
    let rows: Vec<Vec<String>> = effects
        .iter()
        .map(|effect| {
            vec![
                format!("{:.4}", effect.capillary_number),
                format!("{:.4}", effect.confinement),
                format!("{:.3}", 100.0 * effect.distance),
            ]
        })
        .collect();
    print::table(&["Ca", "a/l", "distance, % of a"], &rows)
}
