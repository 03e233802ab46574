//! What the online stage costs on a Cortex-M4F, against what was recorded: a rise of more than 2 % fails.

use crate::command::{command, command_in, output, run};
use crate::package::{DIRECT, FULL, Library};
use crate::{header, package, root, target_directory, wasm};
use anyhow::{Context, Result, anyhow, bail};
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};

/// The greatest rise that is not told.
const TOLERANCE: f64 = 1.02;

/// How wasm-opt makes a module smallest: again and again, then with repeated constants in locals. The low 1 KiB of
/// memory is the far end of the stack, which no address of the code points to.
const MIN: &str = "-Oz --low-memory-unused --converge --const-hoisting --reorder-functions";

/// Random queries of which a typical one's cost is the median.
const QUERIES: usize = 1001;

/// The aims that are met, and must stay so.
const LIMITS: [(&str, u64); 6] = [
    ("m4f_observables_instructions", 250_000),
    ("m4f_observables_greatest_instructions", 250_000),
    ("m4f_outline_instructions", 400_000),
    ("m4f_dynamics_instructions", 12_000_000),
    ("workspace_bytes", 32 << 10),
    ("stack_bytes", 4 << 10),
];

/// The aims that are not met: docs/reports/embedded.md says why.
const SHORTFALLS: [(&str, u64); 2] = [("flash_bytes", 48 << 10), ("wasm_bytes", 40_000)];

#[derive(Default, clap::Args)]
pub struct Options {
    /// Print the figures as JSON
    #[arg(long)]
    json: bool,
    /// Record the figures instead of comparing them
    #[arg(long)]
    write: bool,
    /// Instead, measure how much the cost of a query spreads, over this many random queries and over chosen ones
    #[arg(long, value_name = "QUERIES", conflicts_with_all = ["json", "write"])]
    spread: Option<usize>,
}

/// Measures, and compares with what was recorded.
pub fn budgets(options: &Options) -> Result<()> {
    if let Some(queries) = options.spread {
        return spread(queries);
    }
    let figures = measure()?;
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
            "the figures were recorded with {}, and cannot be compared with those of \"{compilers}\": take the compilers of \
             the record, or record new figures with `cargo xtask budgets --write`",
            record["compilers"]
        );
    }
    let risen = risen(&record["figures"], &figures);
    if risen.is_empty() {
        return Ok(());
    }
    bail!(
        "risen by more than 2 % (`cargo xtask budgets --write` records new figures):\n  {}",
        risen.join("\n  ")
    )
}

/// Figures that are missing or more than their limit, with both numbers.
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

/// Figures that are more than what was recorded, with both numbers.
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

/// All figures.
fn measure() -> Result<Map<String, Value>> {
    let package = package::folder(package::CORTEX_M)?;
    let mut figures = Map::new();
    for line in emulated(&package, "budgets.c", &[])?.lines() {
        let (name, value) = line.split_once(' ').ok_or_else(|| anyhow!("the board says: {line}"))?;
        let value: u64 = value.parse().with_context(|| format!("the board says: {line}"))?;
        let name = if name.ends_with("_instructions") {
            format!("m4f_{name}")
        } else {
            name.to_owned()
        };
        figures.insert(name, value.into());
    }
    let costs = costs(&package, QUERIES)?;
    let of = |kind: &str| {
        costs
            .iter()
            .find(|(name, _)| *name == kind)
            .map(|(_, counts)| &counts[..])
    };
    let (Some(random), Some(adversarial)) = (of("random"), of("adversarial")) else {
        bail!("the board counted no queries");
    };
    let greatest = random.iter().chain(adversarial).max().copied().unwrap_or_default();
    figures.insert("m4f_observables_instructions".into(), median(random).into());
    figures.insert("m4f_observables_greatest_instructions".into(), greatest.into());
    figures.insert("workspace_bytes".into(), capsule_capi::WORKSPACE_SIZE.into());
    for (prefix, library) in [("", FULL), ("direct_", DIRECT)] {
        let [text, flash] = code(&package, &library)?;
        figures.insert(format!("{prefix}text_bytes"), text.into());
        figures.insert(format!("{prefix}flash_bytes"), flash.into());
    }
    let bytes =
        |path: &Path| Ok::<u64, anyhow::Error>(path.metadata().with_context(|| path.display().to_string())?.len());
    figures.insert("model_bytes".into(), bytes(&root().join("models/capsule.crom"))?.into());
    figures.insert("direct_wasm_bytes".into(), bytes(&module(&DIRECT)?)?.into());
    figures.insert("wasm_bytes".into(), bytes(&module(&FULL)?)?.into());
    Ok(figures)
}

/// Prints the median and the greatest cost of queries, and their ratio.
fn spread(queries: usize) -> Result<()> {
    let package = package::folder(package::CORTEX_M)?;
    println!(
        "{:<12} {:>8} {:>12} {:>12} {:>6}",
        "queries", "count", "median", "greatest", "ratio"
    );
    for (kind, counts) in costs(&package, queries)? {
        let (median, Some(&greatest)) = (median(&counts), counts.last()) else {
            continue;
        };
        let ratio = greatest as f64 / median as f64;
        println!(
            "{kind:<12} {:>8} {median:>12} {greatest:>12} {ratio:>6.2}",
            counts.len()
        );
    }
    Ok(())
}

/// Instructions of queries to the observables, by rising number: random ones, adversarial ones, extrapolated ones, and
/// a few by the paper's method.
fn costs(package: &Path, queries: usize) -> Result<Vec<(&'static str, Vec<u64>)>> {
    let text = emulated(package, "spread.c", &[format!("-DRANDOM={queries}")])?;
    let of = |kind: &'static str| {
        let counts = text.lines().filter_map(|line| line.strip_prefix(kind));
        let mut counts: Vec<u64> = counts
            .map(|count| count.trim().parse().with_context(|| format!("the board says: {count}")))
            .collect::<Result<_>>()?;
        counts.sort_unstable();
        Ok((kind, counts))
    };
    ["random", "adversarial", "extrapolated", "paper"]
        .into_iter()
        .map(of)
        .collect()
}

/// The number in the middle of sorted ones.
fn median(sorted: &[u64]) -> u64 {
    sorted.get(sorted.len() / 2).copied().unwrap_or_default()
}

/// What a program of tests/budgets prints.
fn emulated(package: &Path, source: &str, defines: &[String]) -> Result<String> {
    let program = target_directory().join("budgets.elf");
    run(command(
        "arm-none-eabi-gcc -std=c11 -O2 -Wall -Wextra -Werror -mcpu=cortex-m4 -mthumb -mfloat-abi=hard \
         -mfpu=fpv4-sp-d16 --specs=rdimon.specs -Wl,--gc-sections -Iinclude -T examples/cortex-m/mps2.ld \
         -DMODEL=\"models/capsule.crom\" examples/cortex-m/start.c examples/model.S",
    )
    .current_dir(package)
    .args(defines)
    .arg(root().join("tests/budgets").join(source))
    .args(["lib/libcapsule.a", "-o"])
    .arg(&program))?;
    output(
        command(
            "qemu-system-arm -M mps2-an386 -cpu cortex-m4 -icount shift=6 -display none -serial none -monitor none \
             -semihosting-config enable=on,target=native -kernel",
        )
        .arg(&program),
    )
}

/// Bytes of instructions, and of all that flash holds of it, constants among them, that a program with every function
/// of the interface links. It does not link if one can panic.
fn code(package: &Path, library: &Library) -> Result<[u64; 2]> {
    let program = target_directory().join("interface.elf");
    let header = std::fs::read_to_string(header::path())?;
    let mut link = command_in(package, "arm-none-eabi-ld --gc-sections -Ttext=0");
    for name in header::functions(&header) {
        link.arg(format!("--undefined={}{name}", header::VERSIONED));
    }
    run(link
        .arg(format!("--entry={}open", header::VERSIONED))
        .arg(format!("lib/{}", library.name))
        .arg("-o")
        .arg(&program))?;
    let sizes = output(command("arm-none-eabi-size -A").arg(&program))?;
    let of = |sections: &[&str]| sections.iter().filter_map(|section| bytes_of(&sizes, section)).sum();
    match [
        of(&[".text"]),
        of(&[".text", ".rodata", ".data", ".ARM.exidx", ".ARM.extab"]),
    ] {
        [0, _] => bail!("no .text in:\n{sizes}"),
        found => Ok(found),
    }
}

/// Bytes of a section in the table of `size -A`.
fn bytes_of(sizes: &str, section: &str) -> Option<u64> {
    let mut lines = sizes.lines().map(str::split_whitespace);
    let mut line = lines.find(|line| line.clone().next() == Some(section))?;
    line.nth(1)?.parse().ok()
}

/// The interface as a WebAssembly module, optimised for size by wasm-opt.
fn module(library: &Library) -> Result<PathBuf> {
    package::interface(library, wasm::TARGET, "cdylib", "-C strip=symbols")?;
    let [built, optimised] = ["", "-optimised"].map(|suffix| {
        let name = format!("embedded/capsule_capi{suffix}.wasm");
        target_directory().join(wasm::TARGET).join(name)
    });
    std::fs::copy(&built, &optimised).with_context(|| built.display().to_string())?;
    wasm::optimise(&optimised, MIN)?;
    Ok(optimised)
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
    fn a_section_s_bytes_are_found_by_its_whole_name() {
        let sizes = "a.elf  :\nsection  size  addr\n.text.hot  7  0\n.text  4100  0\n.rodata  52  4100\nTotal  4152\n";
        let found = [".text", ".rodata", ".data"].map(|section| bytes_of(sizes, section));
        assert_eq!(found, [Some(4100), Some(52), None]);
    }

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
