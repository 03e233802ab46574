//! The cost of each scene, as a table for docs/reports/speed.md: the counts and times of `capsule-rom study scenes`,
//! and the instructions counted by callgrind.

use crate::command::{command, output, run};
use crate::{setup, target_directory};
use anyhow::{Context, Result, anyhow};
use serde_json::Value;

/// Prints the table.
pub fn scenes() -> Result<()> {
    setup::bring(&[setup::VALGRIND])?;
    run(&mut command("cargo build --quiet --release --package capsule-rom"))?;
    let program = target_directory().join("release/capsule-rom");
    let program = program.to_str().context("the target directory is not UTF-8")?;
    let found: Value = serde_json::from_str(&output(&mut command(&format!("{program} study scenes --json")))?)?;
    let limit = |name: &str| found["limits"][name].as_f64().unwrap_or(f64::NAN);
    println!(
        "One core does at most {:.0} operations a nanosecond ({:.0} with the instructions of any processor of \
         its kind, by which all is done but products with panels) and reads {:.0} bytes of the model.\n",
        limit("operations_per_ns"),
        limit("portable_operations_per_ns"),
        limit("bytes_per_ns")
    );
    println!(
        "| task | instructions | operations | numbers read | bytes of the model | bytes of the answer | us | least \
         possible us |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for task in found["tasks"].as_array().into_iter().flatten() {
        let name = task["task"].as_str().context("a task without a name")?;
        let number = |field: &str, digits: usize| format!("{:.digits$}", task[field].as_f64().unwrap_or(f64::NAN));
        println!(
            "| {} | {} | {} | {} | {} | {} | {} | {} |",
            name.replace('_', " "),
            instructions(
                program,
                name,
                task["typical"].as_u64().context("a task without a typical query")?
            )?,
            number("operations", 0),
            number("reads", 0),
            number("model_bytes", 0),
            number("answer_bytes", 0),
            number("median_us", 1),
            number("least_us", 2)
        );
    }
    Ok(())
}

/// Instructions of one task, once, with the random query of this number.
fn instructions(program: &str, task: &str, query: u64) -> Result<u64> {
    let line = format!(
        "valgrind --tool=callgrind --callgrind-out-file=/dev/null --toggle-collect=*Asker*::answer* {program} study \
         scenes \
         --once {task} --query {query}"
    );
    let counted = command(&line)
        .output()
        .with_context(|| format!("could not start `{line}`"))?;
    let told = String::from_utf8_lossy(&counted.stderr).into_owned();
    told.lines()
        .find_map(|line| line.split_once("Collected :"))
        .and_then(|(_, count)| count.trim().parse().ok())
        .ok_or_else(|| anyhow!("`{line}` says:\n{told}"))
}
