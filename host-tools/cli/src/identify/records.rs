//! The answers of a batch in a file: a table (CSV) or one JSON object a line, to which rows are added.

use super::rows::Row;
use anyhow::{Context, Result, bail, ensure};
use capsule_measurement::Answer;
use serde_json::{Map, Value};
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

/// An answer and the row that it belongs to, as JSON.
pub type Record = Map<String, Value>;

/// The columns of a table, and their places in a record.
const COLUMNS: [(&str, &str); 28] = [
    ("row", "/row"),
    ("request", "/request"),
    ("id", "/id"),
    ("file", "/file"),
    ("verdict", "/verdict"),
    ("ca", "/ca"),
    ("ca_68_low", "/ca_68/0"),
    ("ca_68_high", "/ca_68/1"),
    ("ca_95_low", "/ca_95/0"),
    ("ca_95_high", "/ca_95/1"),
    ("confinement", "/confinement"),
    ("confinement_95_low", "/confinement_95/0"),
    ("confinement_95_high", "/confinement_95/1"),
    ("radius_um", "/radius_um"),
    ("radius_um_68_low", "/radius_um_68/0"),
    ("radius_um_68_high", "/radius_um_68/1"),
    ("radius_um_95_low", "/radius_um_95/0"),
    ("radius_um_95_high", "/radius_um_95/1"),
    ("gs_n_per_m", "/gs_n_per_m"),
    ("gs_n_per_m_68_low", "/gs_n_per_m_68/0"),
    ("gs_n_per_m_68_high", "/gs_n_per_m_68/1"),
    ("gs_n_per_m_95_low", "/gs_n_per_m_95/0"),
    ("gs_n_per_m_95_high", "/gs_n_per_m_95/1"),
    ("mean_velocity_mm_s", "/mean_velocity_mm_s"),
    ("residual_um", "/residual_um"),
    ("structure", "/structure"),
    ("alternative_ca", "/alternative/ca"),
    ("warnings", "/warnings"),
];

/// The file of a batch's answers.
pub struct Records {
    path: PathBuf,
    json: bool,
    file: File,
}

/// The record of a row.
pub fn record(row: &Row, answer: &Answer) -> Result<Record> {
    let mut record = Map::from_iter([
        ("row".to_owned(), row.number.into()),
        ("request".to_owned(), row.request.clone().into()),
        ("id".to_owned(), row.id.clone().into()),
        ("file".to_owned(), row.file.clone().into()),
    ]);
    if let Value::Object(fields) = serde_json::to_value(answer)? {
        record.extend(fields);
    }
    Ok(record)
}

impl Records {
    /// Opens the file, and gives the records that it holds already: none that the rows do not ask for.
    pub fn open(path: &Path, json: bool, rows: &[Row]) -> Result<(Self, Vec<Record>)> {
        let context = || format!("could not write {}", path.display());
        let there = if path.exists() {
            std::fs::read_to_string(path).with_context(|| format!("could not read {}", path.display()))?
        } else {
            String::new()
        };
        // An interruption may leave the last line unfinished.
        let whole = there.rfind('\n').map_or("", |end| &there[..=end]);
        let records = if json { objects(whole) } else { table(whole) };
        let records = records.with_context(|| path.display().to_string())?;
        for record in &records {
            let number = record.get("row").and_then(Value::as_u64);
            let asked = number.and_then(|number| rows.get((number as usize).wrapping_sub(1)));
            ensure!(
                asked.is_some_and(|row| record.get("request") == Some(&row.request.clone().into())),
                "{} holds an answer to row {} of another table, with other options or another model: name another file",
                path.display(),
                number.map_or("?".to_owned(), |number| number.to_string())
            );
        }
        let file = OpenOptions::new()
            .create(true)
            .append(true)
            .open(path)
            .with_context(context)?;
        file.set_len(whole.len() as u64).with_context(context)?;
        let mut opened = Self {
            path: path.to_owned(),
            json,
            file,
        };
        if whole.is_empty() && !json {
            opened.append(csv_line(COLUMNS.iter().map(|(heading, _)| (*heading).to_owned()))?)?;
        }
        Ok((opened, records))
    }

    /// Adds records.
    pub fn add(&mut self, records: &[Record]) -> Result<()> {
        let mut bytes = Vec::new();
        for record in records {
            if self.json {
                serde_json::to_writer(&mut bytes, record)?;
                bytes.push(b'\n');
            } else {
                let record = Value::Object(record.clone());
                bytes.extend(csv_line(COLUMNS.iter().map(|(_, place)| cell(record.pointer(place))))?);
            }
        }
        self.append(bytes)
    }

    fn append(&mut self, bytes: Vec<u8>) -> Result<()> {
        let written = self.file.write_all(&bytes);
        written.with_context(|| format!("could not write {}", self.path.display()))
    }
}

fn csv_line(cells: impl Iterator<Item = String>) -> Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(cells)?;
    Ok(writer.into_inner()?)
}

fn cell(value: Option<&Value>) -> String {
    match value {
        None | Some(Value::Null) => String::new(),
        Some(Value::String(text)) => text.clone(),
        Some(Value::Array(all)) => all.iter().map(|one| cell(Some(one))).collect::<Vec<_>>().join("; "),
        Some(value) => value.to_string(),
    }
}

fn objects(text: &str) -> Result<Vec<Record>> {
    let read =
        |(i, line)| serde_json::from_str(line).with_context(|| format!("line {} is no answer of a batch", i + 1));
    text.lines().enumerate().map(read).collect()
}

fn table(text: &str) -> Result<Vec<Record>> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let headings = reader.headers()?.clone();
    if !headings.is_empty() && !headings.iter().eq(COLUMNS.iter().map(|(heading, _)| *heading)) {
        bail!("its columns are not those of a batch's answers: name another file");
    }
    let read = |record: csv::Result<csv::StringRecord>| {
        let record = record?;
        let cells = headings.iter().zip(&record).map(|(heading, cell)| {
            let text = ["request", "id", "file", "verdict"].contains(&heading);
            let number = serde_json::from_str(cell).ok().filter(|_| !text);
            (heading.to_owned(), number.unwrap_or_else(|| cell.into()))
        });
        Ok(Map::from_iter(cells))
    };
    reader.records().map(read).collect()
}
