//! The rows of a batch's table. A column is an option of `capsule-rom identify` without its dashes.

use super::given::Given;
use super::rtdc::{self, Masks};
use anyhow::{Context, Result, bail, ensure};
use clap::{Args, FromArgMatches};
use std::path::{Path, PathBuf};

/// The column of contours and pictures, that of names, and what the column of a deviation ends with.
const FILE: &str = "file";
const ID: &str = "id";
const DEVIATION: &str = "-deviation";

/// One capsule of a table.
pub struct Row {
    /// From 1, without the heading.
    pub number: usize,
    pub id: String,
    pub file: String,
    /// Where the file is.
    pub path: Option<PathBuf>,
    /// Inputs of the measurement, from the row and for all rows; an error names the cell.
    pub given: Result<Given>,
    /// A checksum of all that the answer depends on, but for the contents of files.
    pub request: String,
}

/// Reads a table. What `common` gives holds where a row does not say otherwise. `against` is the model's digest.
pub fn read(table: &Path, common: &Given, against: &str, warn: impl Fn(&str)) -> Result<Vec<Row>> {
    if rtdc::is_one(table) {
        return events(table, common, against);
    }
    let text = std::fs::read(table).with_context(|| format!("could not read {}", table.display()))?;
    let first = text.split(|byte| *byte == b'\n').next().unwrap_or_default();
    let separators = [b'\t', b';', b','];
    let separator = separators.into_iter().find(|separator| first.contains(separator));
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(separator.unwrap_or(b','))
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(&*text);
    let context = || table.display().to_string();
    let columns: Vec<String> = reader
        .headers()
        .with_context(context)?
        .iter()
        .map(option_name)
        .collect();
    let command = Given::augment_args(clap::Command::new("row").no_binary_name(true));
    let known = |name: &str| {
        command
            .get_arguments()
            .any(|argument| argument.get_long() == Some(name))
    };
    let used: Vec<bool> = columns
        .iter()
        .map(|name| known(name.strip_suffix(DEVIATION).unwrap_or(name)) || [FILE, ID].contains(&name.as_str()))
        .collect();
    ensure!(
        used.iter().any(|used| *used),
        "{}: none of its columns is \"file\" or an option of identify, such as half_width_um",
        table.display()
    );
    for (name, used) in columns.iter().zip(&used) {
        if !used {
            warn(&format!("{}: the column \"{name}\" is not used", table.display()));
        }
    }
    let folder = table.parent().unwrap_or(Path::new(""));
    let records: Vec<csv::StringRecord> = reader.records().collect::<Result<_, _>>().with_context(context)?;
    let is_option = |name: &str, used: bool| used && ![FILE, ID].contains(&name);
    // Where commas do not separate cells, spreadsheets of many languages write them for decimal points.
    let has_points = records.iter().any(|record| {
        let cells = columns.iter().zip(&used).zip(record);
        cells
            .into_iter()
            .any(|((name, used), cell)| is_option(name, *used) && is_decimal(cell, '.'))
    });
    let has_commas = separator.is_some_and(|separator| separator != b',') && !has_points;
    let with_point = |cell: &str| match has_commas && is_decimal(cell, ',') {
        true => cell.replace(',', "."),
        false => cell.to_owned(),
    };
    let mut rows = Vec::new();
    for (index, record) in records.iter().enumerate() {
        let cell = |name: &str| {
            let column = columns.iter().position(|column| column == name);
            column
                .and_then(|column| record.get(column))
                .filter(|cell| !cell.is_empty())
        };
        let mut arguments = Vec::new();
        for (name, used) in columns.iter().zip(&used) {
            let option = is_option(name, *used) && !name.ends_with(DEVIATION);
            if let Some(value) = cell(name).filter(|_| option) {
                let deviation =
                    cell(&format!("{name}{DEVIATION}")).map(|deviation| format!(",{}", with_point(deviation)));
                arguments.push(format!(
                    "--{name}={}{}",
                    with_point(value),
                    deviation.unwrap_or_default()
                ));
            }
        }
        let given = given(&command, common, &arguments, folder);
        let file = cell(FILE).unwrap_or_default().to_owned();
        let number = index + 1;
        rows.push(Row {
            number,
            id: cell(ID).unwrap_or_default().to_owned(),
            path: (!file.is_empty()).then(|| folder.join(&file)),
            request: request(number, &file, &given, against),
            file,
            given,
        });
    }
    if rows.is_empty() {
        bail!("{}: it has no rows below its heading", table.display());
    }
    Ok(rows)
}

/// The events of an RT-DC file, each with the options that hold for all.
fn events(path: &Path, common: &Given, against: &str) -> Result<Vec<Row>> {
    let file = path.display().to_string();
    let rows = (1..=Masks::open(path)?.count()).map(|number| {
        let mut given = common.clone();
        given.capsule = Some(number);
        let given = Ok(given);
        Row {
            number,
            id: number.to_string(),
            path: Some(path.to_owned()),
            request: request(number, &file, &given, against),
            file: file.clone(),
            given,
        }
    });
    Ok(rows.collect())
}

/// The checksum of a row.
fn request(number: usize, file: &str, given: &Result<Given>, against: &str) -> String {
    let request = format!("{number} {file} {given:?} {against}");
    format!("{:016x}", CHECKSUM.checksum(request.as_bytes()))
}

const CHECKSUM: crc::Crc<u64> = crc::Crc::<u64>::new(&crc::CRC_64_XZ);

/// Whether a cell is a number with this sign before its decimals.
fn is_decimal(cell: &str, sign: char) -> bool {
    let digits = |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    let parts = cell.trim_start_matches('-').split_once(sign);
    parts.is_some_and(|(whole, decimals)| digits(whole) && digits(decimals))
}

fn option_name(heading: &str) -> String {
    heading.to_lowercase().replace(['_', ' '], "-")
}

fn given(command: &clap::Command, common: &Given, arguments: &[String], folder: &Path) -> Result<Given> {
    let mut given = common.clone();
    let matches = command.clone().try_get_matches_from(arguments);
    match matches.and_then(|mut matches| given.update_from_arg_matches_mut(&mut matches)) {
        Ok(()) => {
            if arguments.iter().any(|argument| argument.starts_with("--background=")) {
                given.background = given.background.map(|background| folder.join(background));
            }
            Ok(given)
        }
        Err(error) => {
            let text = error.to_string();
            let line = text.lines().next().unwrap_or_default();
            bail!("{}", line.trim_start_matches("error: "))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_says_otherwise_than_what_is_common() {
        let folder = tempfile::tempdir().unwrap();
        let table = folder.path().join("table.csv");
        std::fs::write(
            &table,
            "id;File;pixel_um;noise_um;axial_length_um;axial_length_um_deviation;remark\n\
             a;a.csv;0.5;;49.2;0.2;x\n\
             b;b.csv;;0.1;;;y\n\
             c;c.csv;half;;;;\n",
        )
        .unwrap();
        let mut common = Given::default();
        common.pixel_um = Some(0.25);
        let warned = std::cell::RefCell::new(Vec::new());
        let rows = read(&table, &common, "model", |text| {
            warned.borrow_mut().push(text.to_owned())
        })
        .unwrap();
        let pixels: Vec<_> = rows
            .iter()
            .map(|row| row.given.as_ref().ok().map(|given| given.pixel_um))
            .collect();
        assert_eq!(pixels, [Some(Some(0.5)), Some(Some(0.25)), None]);
        assert_eq!(rows[1].given.as_ref().unwrap().noise_um, Some(0.1));
        assert!(format!("{:?}", rows[0].given).contains("[49.2, 0.2]"));
        let error = rows[2].given.as_ref().unwrap_err().to_string();
        assert!(error.contains("half") && error.contains("--pixel-um"), "{error}");
        assert!(warned.borrow()[0].contains("remark"));
        assert_eq!(rows[0].path.as_deref(), Some(&*folder.path().join("a.csv")));
        let commas = folder.path().join("commas.csv");
        std::fs::write(
            &commas,
            "file;pixel_um;axial_length_um;axial_length_um_deviation\na.csv;0,5;49,25;0,2\n",
        )
        .unwrap();
        let [row] = &read(&commas, &common, "model", |_| ()).unwrap()[..] else {
            panic!("not one row");
        };
        let given = row.given.as_ref().unwrap();
        assert_eq!(given.pixel_um, Some(0.5));
        assert!(format!("{given:?}").contains("[49.25, 0.2]"), "{given:?}");
        let others = read(&table, &common, "another model", |_| ()).unwrap();
        assert!(rows.iter().zip(&others).all(|(a, b)| a.request != b.request));
    }
}
