//! What commands print: one JSON object, or a table for people.

use anyhow::Result;
use serde::Serialize;
use std::io::Write;

/// Prints one JSON object and a newline.
pub fn json(value: &impl Serialize) -> Result<()> {
    let mut out = std::io::stdout().lock();
    serde_json::to_writer_pretty(&mut out, value)?;
    writeln!(out)?;
    Ok(())
}

/// Prints columns, right-aligned, with a heading.
pub fn table(heading: &[&str], rows: &[Vec<String>]) -> Result<()> {
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column)).map(String::len);
        cells.chain([heading[column].len()]).max().unwrap_or(0)
    };
    let line = |cells: &mut dyn Iterator<Item = &str>| -> String {
        cells
            .enumerate()
            .map(|(column, cell)| format!("{cell:>width$}  ", width = width(column)))
            .collect()
    };
    let mut out = std::io::stdout().lock();
    writeln!(out, "{}", line(&mut heading.iter().copied()).trim_end())?;
    for row in rows {
        writeln!(out, "{}", line(&mut row.iter().map(String::as_str)).trim_end())?;
    }
    Ok(())
}
