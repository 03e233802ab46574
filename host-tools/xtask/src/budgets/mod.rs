//! Budgets: the cost of the online stage on a Cortex-M4F. A figure beyond its limit fails, and so does one that exceeds
//! the recorded figure by more than 2 %.

mod measure;

use crate::command::{command, output};
use crate::root;
use anyhow::{Context, Result, bail};
use measure::{measure, of_model, spread};
use serde_json::{Map, Value, json};
use std::path::PathBuf;

/// The largest ratio of a figure to the recorded one that passes.
const TOLERANCE: f64 = 1.02;

/// Limits of figures.
const LIMITS: [(&str, u64); 6] = [
    ("m4f_observables_instructions", 250_000),
    ("m4f_observables_greatest_instructions", 250_000),
    ("m4f_outline_instructions", 400_000),
    ("m4f_dynamics_instructions", 12_000_000),
    ("workspace_bytes", 32 << 10),
    ("stack_bytes", 4 << 10),
];

/// Aims that are not met; docs/reports/embedded.md gives the reasons.
const SHORTFALLS: [(&str, u64); 2] = [("flash_bytes", 48 << 10), ("wasm_bytes", 40_000)];

#[derive(Default, clap::Args)]
pub struct Options {
    /// Print the figures as JSON
    #[arg(long)]
    json: bool,
    /// Record the figures instead of comparing them
    #[arg(long)]
    write: bool,
    /// Measure instead how the cost of a query varies, over this many random queries and over chosen ones
    #[arg(long, value_name = "QUERIES", conflicts_with_all = ["json", "write"])]
    spread: Option<usize>,
    /// Measure instead what depends on the model with this one, without a comparison
    #[arg(long, value_name = "FILE", conflicts_with_all = ["write", "spread"])]
    model: Option<PathBuf>,
}

/// Measures the figures and compares them with their limits and with the record.
pub fn budgets(options: &Options) -> Result<()> {
    if let Some(queries) = options.spread {
        return spread(queries);
    }
    let figures = options.model.as_deref().map_or_else(measure, of_model)?;
    if options.json {
        println!("{:#}", Value::Object(figures.clone()));
    } else {
        for (name, figure) in &figures {
            let aim = LIMITS.iter().chain(&SHORTFALLS).find(|(of, _)| of == name);
            let missed = |aim: u64| figure.as_u64().is_some_and(|figure| figure > aim);
            let aim = aim.map_or(String::new(), |&(_, aim)| {
                format!("  (aim {aim}{})", if missed(aim) { ", not met" } else { "" })
            });
            println!("{name:<36} {figure:>12}{aim}");
        }
    }
    if options.model.is_some() {
        return Ok(());
    }
    let beyond = beyond(&figures);
    if !beyond.is_empty() {
        bail!("beyond the limit:\n  {}", beyond.join("\n  "));
    }
    let compilers = compilers()?;
    if options.write {
        let record = json!({ "compilers": compilers, "figures": figures });
        return std::fs::write(record_path(), format!("{record:#}\n")).context("could not write the record");
    }
    let record: Value = serde_json::from_str(&std::fs::read_to_string(record_path()).context("the record")?)?;
    if record["compilers"] != json!(compilers) {
        bail!(
            "the figures were recorded with {} and cannot be compared with those of \"{compilers}\": use the recorded \
             compilers, or record new figures with `cargo xtask budgets --write`",
            record["compilers"]
        );
    }
    let risen = risen(&record["figures"], &figures);
    if risen.is_empty() {
        return Ok(());
    }
    bail!(
        "more than 2 % above the record (`cargo xtask budgets --write` records new figures):\n  {}",
        risen.join("\n  ")
    )
}

/// Figures that are missing or exceed their limit, with both numbers.
fn beyond(figures: &Map<String, Value>) -> Vec<String> {
    LIMITS
        .iter()
        .filter(|(name, limit)| {
            figures
                .get(*name)
                .and_then(Value::as_u64)
                .is_none_or(|figure| figure > *limit)
        })
        .map(|(name, limit)| {
            let figure = figures.get(*name).map_or("nothing".to_owned(), Value::to_string);
            format!("{name}: {limit} is the limit, {figure} measured")
        })
        .collect()
}

/// Figures that exceed the record by more than the tolerance, with both numbers.
fn risen(recorded: &Value, figures: &Map<String, Value>) -> Vec<String> {
    let number = |value: &Value| value.as_f64().unwrap_or(f64::INFINITY);
    figures
        .iter()
        .filter(|(name, _)| *name != "model_bytes")
        .filter(|(name, figure)| {
            recorded
                .get(name)
                .is_none_or(|before| number(figure) > TOLERANCE * number(before))
        })
        .map(|(name, figure)| format!("{name}: {} recorded, {figure} measured", recorded[name]))
        .collect()
}

/// The compilers that counts depend on.
fn compilers() -> Result<String> {
    let rust = output(&mut command("rustc --version"))?;
    let c = output(&mut command("arm-none-eabi-gcc -dumpfullversion"))?;
    Ok(format!("{}, arm-none-eabi-gcc {}", rust.trim(), c.trim()))
}

fn record_path() -> PathBuf {
    root().join("tests/budgets/recorded.json")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_beyond_its_limit_is_told_and_so_is_one_that_is_missing() {
        let mut figures: Map<String, Value> = LIMITS
            .iter()
            .map(|&(name, limit)| (name.into(), limit.into()))
            .collect();
        assert!(beyond(&figures).is_empty());
        figures.insert("stack_bytes".into(), 4097.into());
        figures.remove("workspace_bytes");
        let told = [
            "workspace_bytes: 32768 is the limit, nothing measured",
            "stack_bytes: 4096 is the limit, 4097 measured",
        ];
        assert_eq!(beyond(&figures), told);
    }

    #[test]
    fn a_rise_is_told_with_both_numbers() {
        let recorded = json!({ "a": 1000, "b": 1000 });
        let figures = json!({ "a": 1019, "b": 1021, "model_bytes": 7 });
        let told = risen(&recorded, figures.as_object().unwrap());
        assert_eq!(told, ["b: 1000 recorded, 1021 measured"]);
    }
}
