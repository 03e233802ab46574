//! The shipped models, built from `models/database`: one for each size.

use crate::command::{command, run};
use crate::{root, target_directory};
use anyhow::{Context, Result};

/// Files in `models/`, and the options of `offline build` that make them.
const MODELS: [(&str, &str); 2] = [("capsule-small.crom", "--tolerance 1.5e-3"), ("capsule.crom", "")];

/// The creation time of the models, in seconds since 1970: with the same snapshots it gives the same bytes.
const CREATED: &str = "0";

/// Builds the models.
pub fn build() -> Result<()> {
    run(&mut command("cargo build --quiet --release --package capsule-cli"))?;
    let program = target_directory().join("release/capsule-rom");
    let program = program.to_str().context("the target directory is not UTF-8")?;
    for (file, options) in MODELS {
        let line = format!("{program} offline build --quiet {options} --out");
        run(command(&line)
            .arg(root().join("models").join(file))
            .env("SOURCE_DATE_EPOCH", CREATED))?;
    }
    Ok(())
}
