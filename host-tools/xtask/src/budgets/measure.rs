//! The figures: queries counted by programs on the emulated board, code and modules measured in bytes.

use crate::command::{command, command_in, output, run};
use crate::package::{DIRECT, FULL, Library};
use crate::{header, package, root, target_directory, targets, wasm};
use anyhow::{Context, Result, bail};
use serde_json::{Map, Value};
use std::path::{Path, PathBuf};

/// The options of wasm-opt for the smallest module: repeated passes, and repeated constants in locals. The low 1 KiB of
/// memory is the far end of the stack, to which no address of the code points.
const SMALLEST: &str = "-Oz --low-memory-unused --converge --const-hoisting --reorder-functions";

/// Random queries whose median cost stands for a typical query.
const QUERIES: usize = 1001;

/// All figures.
pub fn measure() -> Result<Map<String, Value>> {
    let package = package::folder(targets::CORTEX_M)?;
    let mut figures = online(&package, &shipped())?;
    add(&mut figures, &identification()?)?;
    figures.insert("workspace_bytes".into(), capsule_capi::WORKSPACE_SIZE.into());
    for (prefix, library) in [("", FULL), ("direct_", DIRECT)] {
        let [text, flash] = code(&package, &library)?;
        figures.insert(format!("{prefix}text_bytes"), text.into());
        figures.insert(format!("{prefix}flash_bytes"), flash.into());
    }
    figures.insert("direct_wasm_bytes".into(), bytes(&module(&DIRECT)?)?.into());
    figures.insert("wasm_bytes".into(), bytes(&module(&FULL)?)?.into());
    Ok(figures)
}

/// The figures of another model.
pub fn of_model(model: &Path) -> Result<Map<String, Value>> {
    let model = model.canonicalize().with_context(|| model.display().to_string())?;
    online(&package::folder(targets::CORTEX_M)?, &model)
}

/// The figures that depend on the model: its queries on the board, and its bytes.
fn online(package: &Path, model: &Path) -> Result<Map<String, Value>> {
    let mut figures = Map::new();
    add(&mut figures, &emulated(package, model, "budgets.c", &[])?)?;
    let costs = costs(package, model, QUERIES)?;
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
    figures.insert("model_bytes".into(), bytes(model)?.into());
    Ok(figures)
}

/// Adds the figures that the board printed, "name value" in each line.
fn add(figures: &mut Map<String, Value>, text: &str) -> Result<()> {
    for line in text.lines().filter(|line| !line.contains("_bits ")) {
        let unexpected = || format!("unexpected output of the board: {line}");
        let (name, value) = line.split_once(' ').with_context(unexpected)?;
        let value: u64 = value.parse().with_context(unexpected)?;
        let name = if name.ends_with("_instructions") {
            format!("m4f_{name}")
        } else {
            name.to_owned()
        };
        figures.insert(name, value.into());
    }
    Ok(())
}

fn bytes(file: &Path) -> Result<u64> {
    Ok(file.metadata().with_context(|| file.display().to_string())?.len())
}

fn shipped() -> PathBuf {
    root().join("models/capsule.crom")
}

/// Prints the median and the maximum of the queries' costs, and their ratio, as CSV.
pub fn spread(queries: usize) -> Result<()> {
    let package = package::folder(targets::CORTEX_M)?;
    println!("queries,count,median,greatest,ratio");
    for (kind, counts) in costs(&package, &shipped(), queries)? {
        let (median, Some(&greatest)) = (median(&counts), counts.last()) else {
            continue;
        };
        let ratio = greatest as f64 / median as f64;
        println!("{kind},{},{median},{greatest},{ratio:.4}", counts.len());
    }
    Ok(())
}

/// Instructions of queries to the observables, in increasing order: random, adversarial and extrapolated queries, and a
/// few by the paper's method.
fn costs(package: &Path, model: &Path, queries: usize) -> Result<Vec<(&'static str, Vec<u64>)>> {
    let text = emulated(package, model, "spread.c", &[format!("-DRANDOM={queries}")])?;
    let of = |kind: &'static str| {
        let counts = text.lines().filter_map(|line| line.strip_prefix(kind));
        let mut counts: Vec<u64> = counts
            .map(|count| {
                count
                    .trim()
                    .parse()
                    .with_context(|| format!("unexpected output of the board: {count}"))
            })
            .collect::<Result<_>>()?;
        counts.sort_unstable();
        Ok((kind, counts))
    };
    ["random", "adversarial", "extrapolated", "paper"]
        .into_iter()
        .map(of)
        .collect()
}

/// The median of sorted numbers.
fn median(sorted: &[u64]) -> u64 {
    sorted.get(sorted.len() / 2).copied().unwrap_or_default()
}

/// Runs a program of tests/budgets on the emulated board and returns its output.
fn emulated(package: &Path, model: &Path, source: &str, defines: &[String]) -> Result<String> {
    let program = target_directory().join("budgets.elf");
    run(command(
        "arm-none-eabi-gcc -std=c11 -O2 -Wall -Wextra -Werror -mcpu=cortex-m4 -mthumb -mfloat-abi=hard \
         -mfpu=fpv4-sp-d16 --specs=rdimon.specs -Wl,--gc-sections -Iinclude -T examples/cortex-m/mps2.ld \
         examples/cortex-m/start.c examples/model.S",
    )
    .current_dir(package)
    .arg(format!("-DMODEL=\"{}\"", model.display()))
    .args(defines)
    .arg(root().join("tests/budgets").join(source))
    .args(["lib/libcapsule.a", "-o"])
    .arg(&program))?;
    on_the_board(&program)
}

/// Builds the firmware's program that identifies capsules and returns its output.
fn identification() -> Result<String> {
    // Where the test `firmware` builds: what both need is compiled once.
    let target = target_directory().join("tmp/firmware");
    run(command("cargo build --quiet --release --locked --bin identify")
        .current_dir(root().join("tests/firmware"))
        .env("CARGO_TARGET_DIR", &target))?;
    on_the_board(&target.join(targets::CORTEX_M).join("release/identify"))
}

/// Runs a program on the emulated board.
fn on_the_board(program: &Path) -> Result<String> {
    output(
        command(
            "qemu-system-arm -M mps2-an386 -cpu cortex-m4 -icount shift=6 -display none -serial none -monitor none \
             -semihosting-config enable=on,target=native -kernel",
        )
        .arg(program),
    )
}

/// Bytes of instructions, and of all sections in flash, of a program with every function of the interface. A function
/// that can panic does not link.
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
    package::interface(library, targets::WASM, "cdylib", "-C strip=symbols")?;
    let [built, optimised] = ["", "-optimised"].map(|suffix| {
        let name = format!("embedded/capsule_capi{suffix}.wasm");
        target_directory().join(targets::WASM).join(name)
    });
    std::fs::copy(&built, &optimised).with_context(|| built.display().to_string())?;
    wasm::optimise(&optimised, SMALLEST)?;
    Ok(optimised)
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
}
