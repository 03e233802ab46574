//! Lists of single configurations: CSV with the columns ca and confinement.

use anyhow::{Context, Result, bail};
use capsule_fom::Configuration;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// The columns that are read; a file may have others.
const COLUMNS: [&str; 2] = ["ca", "confinement"];

/// Reads a file, or the standard input where it is `-`.
pub fn read(file: &Path) -> Result<Vec<Configuration>> {
    let named = || format!("--points {}", file.display());
    if file.as_os_str() == "-" {
        return parse(std::io::stdin().lock()).with_context(named);
    }
    parse(File::open(file).with_context(named)?).with_context(named)
}

fn parse(text: impl Read) -> Result<Vec<Configuration>> {
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text);
    let headings = reader.headers()?.clone();
    let place = |name: &str| {
        let found = headings.iter().position(|heading| heading == name);
        found.with_context(|| format!("no column \"{name}\": the first line must name ca and confinement"))
    };
    let [ca, confinement] = [place(COLUMNS[0])?, place(COLUMNS[1])?];
    let mut points = Vec::new();
    for record in reader.records() {
        let record = record?;
        let line = record.position().map_or(0, csv::Position::line);
        let value = |column: usize| {
            let text = record.get(column).unwrap_or_default();
            text.parse::<f64>()
                .with_context(|| format!("line {line}: \"{text}\" is not a number"))
        };
        let point = Configuration {
            capillary_number: value(ca)?,
            confinement: value(confinement)?,
        };
        point.validate().with_context(|| format!("line {line}"))?;
        points.push(point);
    }
    if points.is_empty() {
        bail!("no configurations in it");
    }
    Ok(points)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_found_by_name() {
        let points = parse("why, confinement ,ca\nedge,0.75,0.1\nlow,1.2, 5e-3\n".as_bytes()).unwrap();
        let found: Vec<[f64; 2]> = points.iter().map(|p| [p.capillary_number, p.confinement]).collect();
        assert_eq!(found, [[0.1, 0.75], [5e-3, 1.2]]);
    }

    #[test]
    fn what_is_wrong_is_said_with_its_line() {
        for (text, expected) in [
            ("ca,al\n0.1,0.9\n", "no column \"confinement\""),
            ("ca,confinement\n0.1,0.9\nx,0.9\n", "line 3: \"x\" is not a number"),
            ("ca,confinement\n-0.1,0.9\n", "line 2"),
            ("ca,confinement\n0.1,NaN\n", "line 2"),
            ("ca,confinement\n", "no configurations"),
        ] {
            let error = parse(text.as_bytes()).unwrap_err();
            assert!(format!("{error:#}").contains(expected), "{error:#}");
        }
        assert!(parse("ca,confinement\n0.1\n".as_bytes()).is_err());
    }
}
