//! The shipped models, built from `models/database`: one for each size.

use crate::command::{command, run};
use crate::{root, target_directory};
use anyhow::{Context, Result};

/// A file in `models/`, and what gives its bytes again from the same snapshots.
struct Shipped {
    file: &'static str,
    /// Options of `offline build`.
    options: &'static str,
    /// The creation time in the file, in seconds since 1970.
    created: &'static str,
}

const MODELS: [Shipped; 2] = [
    Shipped {
        file: "capsule-small.crom",
        options: "--tolerance 1.5e-3",
        created: "0",
    },
    Shipped {
        file: "capsule.crom",
        options: "",
        created: "1795962880",
    },
];

/// Builds the models.
pub fn build() -> Result<()> {
    run(&mut command("cargo build --quiet --release --package capsule-rom"))?;
    let program = target_directory().join("release/capsule-rom");
    let program = program.to_str().context("the target directory is not UTF-8")?;
    for Shipped { file, options, created } in MODELS {
        let line = format!("{program} offline build --quiet {options} --out");
        run(command(&line)
            .arg(root().join("models").join(file))
            .env("SOURCE_DATE_EPOCH", created))?;
    }
    Ok(())
}
