//! Running other programs, with errors that name the command.

use crate::{root, target_directory};
use anyhow::{Context, Result, bail};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A command that starts in the repository's root.
pub fn command(line: &str) -> Command {
    command_in(&root(), line)
}

/// A command that starts in `directory`; `line` is split at white space, without quoting.
pub fn command_in(directory: &Path, line: &str) -> Command {
    let mut words = line.split_whitespace();
    let mut command = Command::new(words.next().unwrap_or_default());
    command.args(words).current_dir(directory).env("PATH", search_path());
    command
}

/// Shows the command, runs it, and fails when it fails.
pub fn run(command: &mut Command) -> Result<()> {
    let shown = describe(command);
    eprintln!("$ {shown}");
    let status = command.status().with_context(|| format!("could not start `{shown}`"))?;
    if !status.success() {
        bail!("`{shown}` failed: {status}");
    }
    Ok(())
}

/// Runs the command and returns its standard output.
pub fn output(command: &mut Command) -> Result<String> {
    let shown = describe(command);
    let output = command
        .stderr(Stdio::inherit())
        .output()
        .with_context(|| format!("could not start `{shown}`"))?;
    if !output.status.success() {
        bail!("`{shown}` failed: {}", output.status);
    }
    String::from_utf8(output.stdout).with_context(|| format!("`{shown}` did not print UTF-8"))
}

/// Whether a program of this name can be run.
pub fn on_path(program: &str) -> bool {
    std::env::split_paths(&search_path()).any(|folder| folder.join(program).is_file())
}

/// The folders of the PATH, and after them those of the tools that `setup` installed.
fn search_path() -> OsString {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let installed = std::fs::read_dir(target_directory().join("tools"));
    let installed = installed.into_iter().flatten().flatten();
    let folders: Vec<PathBuf> = std::env::split_paths(&path)
        .chain(installed.map(|tool| tool.path().join("bin")))
        .collect();
    std::env::join_paths(folders).unwrap_or(path)
}

fn describe(command: &Command) -> String {
    let mut words = vec![command.get_program().to_string_lossy().into_owned()];
    words.extend(command.get_args().map(|word| word.to_string_lossy().into_owned()));
    words.join(" ")
}
