//! Lengths of lines in sources. The formatters leave long strings and comments as they are; the book checks the pages.

use crate::command::command;
use crate::root;
use anyhow::{Context, Result, bail};

/// The greatest length of a line.
pub const COLUMNS: usize = 120;
/// The kinds of files.
const SOURCES: [&str; 15] = [
    "*.S", "*.c", "*.css", "*.h", "*.hpp", "*.html", "*.js", "*.ld", "*.mjs", "*.py", "*.rs", "*.sh", "*.toml", "*.ts",
    "*.x",
];

/// Fails if a source of the repository has a longer line.
pub fn check() -> Result<()> {
    let listed = command("git ls-files").args(SOURCES).current_dir(root()).output()?;
    if !listed.status.success() {
        bail!("git ls-files: {}", String::from_utf8_lossy(&listed.stderr).trim());
    }
    let mut faults = Vec::new();
    for file in String::from_utf8(listed.stdout)?.lines() {
        let text = std::fs::read_to_string(root().join(file)).with_context(|| file.to_owned())?;
        faults.extend(too_long(&text).map(|line| format!("{file}:{line}: more than {COLUMNS} columns")));
    }
    if !faults.is_empty() {
        bail!("{} faults:\n  {}", faults.len(), faults.join("\n  "));
    }
    Ok(())
}

/// The numbers of the lines that are too long.
fn too_long(text: &str) -> impl Iterator<Item = usize> {
    let lines = text.lines().enumerate();
    lines
        .filter(|(_, line)| line.chars().count() > COLUMNS)
        .map(|(index, _)| index + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_counted_in_characters() {
        let text = format!("short\n{}\n{}\n", "ö".repeat(COLUMNS), "x".repeat(COLUMNS + 1));
        assert_eq!(too_long(&text).collect::<Vec<_>>(), [3]);
    }
}
