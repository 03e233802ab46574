//! What the tasks need beyond rustup and Node: installed where that is possible, else named with the command that
//! installs it.

use crate::command::{command, command_in, on_path, output, run};
use crate::{package, root};
use anyhow::{Result, anyhow, bail};

/// The oldest Node that the page's tools run on.
const NODE_MAJOR: u32 = 20;

/// Every requirement of every task; goes on after a failure and reports all of them.
pub fn everything() -> Result<()> {
    let missing: Vec<String> = [
        rust_target("wasm32-unknown-unknown"),
        rust_target(package::CORTEX_M),
        rust_target(package::CORTEX_M33),
        debian_package("qemu-system-arm", "qemu-system-arm"),
        debian_package("chromium", "chromium"),
        npm_modules("wasm/explorer"),
        npm_modules("tests/browser"),
    ]
    .into_iter()
    .filter_map(|step| step.err().map(|error| format!("  - {error:#}")))
    .collect();
    if missing.is_empty() {
        return Ok(());
    }
    bail!("still missing:\n{}", missing.join("\n"))
}

/// A compilation target of the installed toolchain.
pub fn rust_target(target: &str) -> Result<()> {
    let install = format!("rustup target add {target}");
    if !on_path("rustup") {
        bail!("Rust target {target}: rustup is not on the PATH; with it, `{install}`");
    }
    let installed = output(&mut command("rustup target list --installed"))?;
    if installed.lines().any(|line| line == target) {
        return Ok(());
    }
    run(&mut command(&install)).map_err(|error| anyhow!("Rust target {target}: run `{install}` ({error})"))
}

/// A nightly compiler with these components, separated by spaces, for what the stable one does not do.
pub fn nightly(components: &str) -> Result<()> {
    if !on_path("rustup") {
        bail!("nightly Rust: rustup is not on the PATH");
    }
    if has_nightly(components) {
        return Ok(());
    }
    let mut install = "rustup toolchain install nightly --profile minimal".to_owned();
    components
        .split_whitespace()
        .for_each(|component| install += &format!(" --component {component}"));
    run(&mut command(&install)).map_err(|error| anyhow!("nightly Rust: run `{install}` ({error})"))
}

/// Whether there is one.
pub fn has_nightly(components: &str) -> bool {
    let installed = command("rustup component list --installed --toolchain nightly").output();
    let installed = installed.map_or(String::new(), |output| {
        String::from_utf8_lossy(&output.stdout).into_owned()
    });
    let has = |component: &str| installed.lines().any(|line| line.starts_with(component));
    has("rustc") && components.split_whitespace().all(has)
}

/// A subcommand of cargo.
pub fn cargo_subcommand(name: &str) -> Result<()> {
    if on_path(&format!("cargo-{name}")) {
        return Ok(());
    }
    let install = format!("cargo install cargo-{name} --locked");
    run(&mut command(&install)).map_err(|error| anyhow!("cargo {name}: run `{install}` ({error})"))
}

/// A program that a Debian package brings.
pub fn debian_package(program: &str, package: &str) -> Result<()> {
    if on_path(program) {
        return Ok(());
    }
    let by_hand = format!("sudo apt-get install {package}");
    if !on_path("apt-get") {
        bail!("{program}: not on the PATH; on Debian, `{by_hand}`");
    }
    if output(&mut command("id -u"))?.trim() != "0" {
        bail!("{program}: not on the PATH; run `{by_hand}`");
    }
    run(&mut command("apt-get update -qq"))?;
    let mut install = command(&format!("apt-get install -y -qq --no-install-recommends {package}"));
    // Daemons of packages stay off; tests start their own.
    install.env("DEBIAN_FRONTEND", "noninteractive").env("RUNLEVEL", "1");
    run(&mut install).map_err(|error| anyhow!("{program}: run `{by_hand}` ({error})"))
}

/// The npm modules of a folder, exactly as its lock file has them.
pub fn npm_modules(folder: &str) -> Result<()> {
    node()?;
    let folder = root().join(folder);
    let installed = folder.join("node_modules/.package-lock.json");
    let wanted = folder.join("package-lock.json");
    let modified = |path: &std::path::Path| path.metadata().and_then(|data| data.modified());
    if let (Ok(installed), Ok(wanted)) = (modified(&installed), modified(&wanted))
        && installed >= wanted
    {
        return Ok(());
    }
    run(&mut command_in(&folder, "npm ci --no-audit --no-fund"))
        .map_err(|error| anyhow!("npm modules of {}: run `npm ci` there ({error})", folder.display()))
}

fn node() -> Result<()> {
    let ask = || {
        anyhow!(
            "Node {NODE_MAJOR} or newer with npm is needed: https://nodejs.org or `sudo apt-get install nodejs npm`"
        )
    };
    if !on_path("node") || !on_path("npm") {
        return Err(ask());
    }
    let version = output(&mut command("node --version"))?;
    let major = version
        .trim()
        .trim_start_matches('v')
        .split('.')
        .next()
        .and_then(|digits| digits.parse::<u32>().ok());
    match major {
        Some(major) if major >= NODE_MAJOR => Ok(()),
        _ => Err(ask().context(format!("found node {}", version.trim()))),
    }
}
