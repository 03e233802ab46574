//! The table of parameters, `parameters.csv`.

use std::collections::HashMap;
use std::path::Path;

use super::super::MAX_PARAMETERS;
use super::malformed;
use crate::DatabaseError;

/// Names of the parameters, and a row for each configuration.
#[derive(Debug, PartialEq)]
pub(super) struct Table {
    pub names: Vec<String>,
    pub rows: Vec<Row>,
}

#[derive(Debug, PartialEq)]
pub(super) struct Row {
    /// Line in the file, from 1.
    pub line: usize,
    /// Path of the PVD file, as it stands in the table.
    pub series: String,
    pub parameters: Vec<f64>,
}

impl Table {
    pub fn read(path: &Path) -> Result<Self, DatabaseError> {
        let bytes = std::fs::read(path).map_err(DatabaseError::io("read", path))?;
        Self::parse(&bytes).map_err(|reason| malformed(path, reason))
    }

    fn parse(bytes: &[u8]) -> Result<Self, String> {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let text = std::str::from_utf8(bytes).map_err(|error| {
            let line = 1 + bytes[..error.valid_up_to()]
                .iter()
                .filter(|byte| **byte == b'\n')
                .count();
            format!("line {line} is not text in UTF-8; save the table in UTF-8")
        })?;
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .trim(csv::Trim::All)
            .delimiter(separator(text))
            .from_reader(text.as_bytes());
        let mut names: Option<Vec<String>> = None;
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|error| error.to_string())?;
            // Spreadsheets leave rows of separators alone.
            if record.iter().all(str::is_empty) {
                continue;
            }
            let start = record.position().map_or(0, |position| position.byte() as usize);
            match &names {
                None => names = Some(heading(&record)?),
                Some(names) => rows.push(Row::new(line(text, start), &record, names)?),
            }
        }
        let names = names.ok_or("no heading, expected `series,` and one to four parameters")?;
        if rows.is_empty() {
            return Err("no row, expected one for each configuration".to_owned());
        }
        let mut known = HashMap::new();
        for row in &rows {
            if let Some(first) = known.insert(&row.series, row.line) {
                let Row { line, series, .. } = row;
                return Err(format!(
                    "lines {first} and {line} both name the series `{series}`; expected one row each"
                ));
            }
        }
        for (index, row) in rows.iter().enumerate() {
            if let Some(first) = rows[..index].iter().find(|other| other.parameters == row.parameters) {
                let lines = format!("lines {} and {}", first.line, row.line);
                return Err(format!("{lines} have the same parameters; expected different ones"));
            }
        }
        Ok(Self { names, rows })
    }
}

/// The line of the first text at or after a byte: the reader counts the blank lines before a record to it.
fn line(text: &str, start: usize) -> usize {
    let blank = text[start..].len() - text[start..].trim_start_matches(['\r', '\n']).len();
    1 + text[..start + blank].matches('\n').count()
}

/// Comma, semicolon or tabulator: the one that comes first.
fn separator(text: &str) -> u8 {
    let mut bytes = text.bytes();
    bytes.find(|byte| b",;\t".contains(byte)).unwrap_or(b',')
}

fn heading(record: &csv::StringRecord) -> Result<Vec<String>, String> {
    let found = record.iter().collect::<Vec<_>>().join(",");
    if record.get(0) != Some("series") {
        return Err(format!("heading `{found}`, expected the column `series` first"));
    }
    let names: Vec<String> = record.iter().skip(1).map(str::to_owned).collect();
    if !(1..=MAX_PARAMETERS).contains(&names.len()) {
        let count = names.len();
        return Err(format!(
            "heading `{found}` has {count} parameters, expected one to four after `series`"
        ));
    }
    for (column, name) in names.iter().enumerate() {
        if name.is_empty() {
            return Err(format!("heading `{found}`: column {} has no name", column + 2));
        }
        if names[..column].contains(name) {
            return Err(format!(
                "heading `{found}` has two columns `{name}`, expected different names"
            ));
        }
    }
    Ok(names)
}

impl Row {
    fn new(line: usize, record: &csv::StringRecord, names: &[String]) -> Result<Self, String> {
        if record.len() != names.len() + 1 {
            let (found, expected, names) = (record.len(), names.len() + 1, names.join(", "));
            return Err(format!(
                "line {line} has {found} cells, expected {expected}: series, {names}"
            ));
        }
        let series = record[0].to_owned();
        if series.is_empty() {
            return Err(format!(
                "line {line}: `series` is empty, expected the path of a PVD file"
            ));
        }
        let number = |(text, name): (&str, &String)| {
            let value = text.parse::<f64>().ok().filter(|value| value.is_finite());
            value.ok_or_else(|| format!("line {line}: `{name}` is `{text}`, expected a finite number like 0.25"))
        };
        Ok(Self {
            line,
            series,
            parameters: record.iter().skip(1).zip(names).map(number).collect::<Result<_, _>>()?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Table {
        Table::parse(text.as_bytes()).unwrap()
    }

    fn row(line: usize, series: &str, parameters: [f64; 2]) -> Row {
        let (series, parameters) = (series.to_owned(), parameters.to_vec());
        Row {
            line,
            series,
            parameters,
        }
    }

    #[test]
    fn tables_of_spreadsheets_are_read() {
        let expected = Table {
            names: vec!["flow, mean".to_owned(), "size".to_owned()],
            rows: vec![row(2, "a/c.pvd", [0.5, -2e-3]), row(4, "b, 2/c.pvd", [1.0, 4.0])],
        };
        let plain = "series,\"flow, mean\",size\na/c.pvd,0.5,-2e-3\n\n\"b, 2/c.pvd\",1,4\n";
        assert_eq!(read(plain), expected);
        assert_eq!(read(&format!("\u{feff}{plain}")), expected);
        assert_eq!(read(&(plain.replace('\n', "\r\n") + "\r\n,,\r\n\r\n")), expected);
        let others = "series; flow, mean ;size\na/c.pvd ;0.5; -2e-3\n\nb, 2/c.pvd;1;4\n";
        assert_eq!(read(others), expected);
        assert_eq!(read(&others.replace(';', "\t")), expected);
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line_and_column() {
        for (text, words) in [
            ("", &["no heading", "`series,`"][..]),
            ("series,flow\n", &["no row"]),
            ("file,flow\na,1\n", &["`file,flow`", "`series` first"]),
            ("series\na\n", &["0 parameters", "one to four"]),
            ("series,a,b,c,d,e\n", &["5 parameters", "one to four"]),
            ("series,flow,\na,1,2\n", &["column 3 has no name"]),
            ("series,flow,flow\na,1,2\n", &["two columns `flow`"]),
            (
                "series,flow,size\na,1,2\n\nb,1\n",
                &["line 4 has 2 cells", "expected 3", "series, flow, size"],
            ),
            ("series,flow\r\na,1\r\nb,1,7\r\n", &["line 3 has 3 cells", "expected 2"]),
            ("series,flow\na,1\nb,\n", &["line 3", "`flow` is ``"]),
            ("series,flow\na,1\n,2\n", &["line 3", "`series` is empty"]),
            ("series,flow\na,1\nb,x\n", &["line 3", "`flow` is `x`"]),
            ("series,flow\na,nan\n", &["line 2", "`flow` is `nan`", "finite"]),
            ("series,flow\na,inf\n", &["line 2", "`flow` is `inf`", "finite"]),
            ("series;flow\na;0,5\n", &["line 2", "`flow` is `0,5`"]),
            ("series,flow\na,1\nb,2\na,3\n", &["lines 2 and 4", "`a`"]),
            ("series,flow\na,1\nb,2\nc,2.0\n", &["lines 3 and 4", "same parameters"]),
        ] {
            let error = Table::parse(text.as_bytes()).unwrap_err();
            assert!(words.iter().all(|word| error.contains(word)), "{text:?}: {error}");
        }
        let error = Table::parse(b"series,flow\na,1\n\xff,2\n").unwrap_err();
        assert!(error.contains("line 3") && error.contains("UTF-8"), "{error}");
    }
}
