//! Figures of the pages against stored results.
//!
//! `0.33<!-- = FILE PLACE KEY... -->` checks the numbers before the comment in its line, one for each key: they are the
//! stored ones, rounded. FILE is a path from the root of the repository. In a JSON file PLACE is a pointer such as
//! `/methods/direct/0` or `/checks[quantity=pressure]`, the first element that has these values, and a key a pointer
//! from there; in a CSV file PLACE selects rows, `[column=value][...]`, a key is a column, and the numbers are those of
//! the first row, then of the second ... A key `-` stands for a number that is not checked. Signs are not compared.
//!
//! `<!-- rows = FILE PLACE KEY... -->` above a table checks the last numbers of each of its rows in the same way, with
//! the number of the row, from 0, for every `*`.

use super::page::Page;
use anyhow::{Context, Result, anyhow, bail};
use serde_json::Value;
use std::cmp::Reverse;
use std::ops::Range;
use std::path::Path;

const START: &str = "<!-- = ";
const ROWS: &str = "<!-- rows = ";
const END: &str = " -->";

/// A figure that is not the stored one.
struct Difference {
    /// Its digits in the line.
    digits: Range<usize>,
    /// The stored number as the page would print it.
    stored: String,
    what: String,
}

/// Faults of the figures in the pages.
pub fn faults(pages: &[Page], root: &Path) -> Vec<String> {
    let mut faults = Vec::new();
    each_line(pages, root, |page, number, found| match found {
        Ok(differences) => faults.extend(
            differences
                .iter()
                .map(|difference| page.fault(number, &difference.what)),
        ),
        Err(error) => faults.push(page.fault(number, &format!("{error:#}"))),
    });
    faults
}

/// The texts of the pages with the stored numbers in place of those that differ, of the pages in which any do.
pub fn corrected(pages: &[Page], root: &Path) -> Vec<Page> {
    let mut corrected: Vec<Page> = Vec::new();
    for page in pages {
        let mut lines: Vec<String> = page.text().split('\n').map(str::to_owned).collect();
        each_line(std::slice::from_ref(page), root, |_, number, found| {
            let line = lines.get_mut(number - 1);
            if let (Ok(mut differences), Some(line)) = (found, line) {
                differences.sort_by_key(|difference| Reverse(difference.digits.start));
                for Difference { digits, stored, .. } in differences {
                    line.replace_range(digits, &stored);
                }
            }
        });
        let text = lines.join("\n");
        if text != page.text() {
            corrected.push(Page::new(page.path(), text));
        }
    }
    corrected
}

/// Checks all lines with figures.
fn each_line(pages: &[Page], root: &Path, mut found: impl FnMut(&Page, usize, Result<Vec<Difference>>)) {
    for page in pages {
        // The comment above a table, and how many of the table's lines were seen; two of them are its heading.
        let mut table: Option<(&str, usize)> = None;
        for (number, line) in page.prose() {
            let mut of_line = Ok(Vec::new());
            let mut add = |text: &str, before: usize, comment: &str| match (&mut of_line, check(text, comment, root)) {
                (Ok(all), Ok(differences)) => all.extend(differences.into_iter().map(|mut difference| {
                    difference.digits = before + difference.digits.start..before + difference.digits.end;
                    difference
                })),
                (of_line, Err(error)) => *of_line = Err(error),
                (Err(_), Ok(_)) => {}
            };
            table = match (line.strip_prefix(ROWS), table) {
                (Some(comment), _) => Some((comment.trim_end_matches(END), 0)),
                (None, Some((comment, seen))) if line.starts_with('|') => {
                    if let Some(row) = seen.checked_sub(2) {
                        add(line, 0, &comment.replace('*', &row.to_string()));
                    }
                    Some((comment, seen + 1))
                }
                (None, Some((comment, 0))) if line.is_empty() => Some((comment, 0)),
                (None, _) => None,
            };
            let mut from = 0;
            while let Some(start) = line[from..].find(START).map(|at| from + at) {
                let body = &line[start + START.len()..];
                let comment = body.split_once(END).map_or(body, |(comment, _)| comment);
                add(&line[from..start], from, comment);
                from = (start + START.len() + comment.len() + END.len()).min(line.len());
            }
            found(page, number, of_line);
        }
    }
}

/// Compares the last numbers of a text with those that a comment names.
fn check(text: &str, comment: &str, root: &Path) -> Result<Vec<Difference>> {
    let (file, rest) = comment
        .split_once(' ')
        .ok_or_else(|| anyhow!("`{comment}` names no key"))?;
    let stored = std::fs::read_to_string(root.join(file)).with_context(|| file.to_owned())?;
    let stored = if file.ends_with(".csv") {
        rows(&stored, rest)?
    } else {
        pointers(&stored, rest)?
    };
    let numbers = numbers(text);
    let Some(first) = numbers.len().checked_sub(stored.len()) else {
        bail!(
            "{} numbers stand before `{comment}`, {} expected",
            numbers.len(),
            stored.len()
        );
    };
    let difference = |(number, (key, stored)): (&Number, &(String, Option<f64>))| {
        let stored = (*stored)?;
        let differs = (number.value - stored.abs()).abs() > number.half_unit;
        differs.then(|| Difference {
            digits: number.digits.clone(),
            stored: number.print(stored),
            what: format!("{} stands where {file} has {key} = {stored}", number.value),
        })
    };
    Ok(numbers[first..].iter().zip(&stored).filter_map(difference).collect())
}

/// Stored numbers, with the names of their keys; none where a key is `-`.
type Stored = Vec<(String, Option<f64>)>;

/// Those of a JSON file.
fn pointers(json: &str, rest: &str) -> Result<Stored> {
    let json: Value = serde_json::from_str(json)?;
    // A value that selects may contain spaces.
    let end = rest.rfind(']').unwrap_or(0);
    let space = rest[end..].find(' ').ok_or_else(|| anyhow!("`{rest}` names no key"))?;
    let (place, keys) = rest.split_at(end + space);
    let found = at(&json, place.trim_end_matches('/'))?;
    let number = |key: &str| {
        let value = || {
            found
                .pointer(&format!("/{key}"))
                .and_then(Value::as_f64)
                .ok_or_else(|| anyhow!("no number at {place}/{key}"))
        };
        Ok((key.to_owned(), if key == "-" { None } else { Some(value()?) }))
    };
    keys.split_whitespace().map(number).collect()
}

/// The value at a place: pointers, and conditions that choose an element of a list.
fn at<'a>(json: &'a Value, place: &str) -> Result<&'a Value> {
    let nothing = || anyhow!("nothing at {place}");
    let (mut found, mut rest) = (json, place);
    while !rest.is_empty() {
        let conditions: &str;
        let pointer = &rest[..rest.find('[').unwrap_or(rest.len())];
        found = found.pointer(pointer).ok_or_else(nothing)?;
        rest = &rest[pointer.len()..];
        (conditions, rest) = rest.split_at(rest.find("]/").map_or(rest.len(), |end| end + 1));
        if !conditions.is_empty() {
            let conditions = conditions.trim_matches(['[', ']']).split("][");
            let conditions: Vec<_> = conditions.filter_map(|one| one.split_once('=')).collect();
            let is = |element: &&Value| conditions.iter().all(|(key, value)| is_value(&element[*key], value));
            found = found
                .as_array()
                .and_then(|list| list.iter().find(is))
                .ok_or_else(nothing)?;
        }
    }
    Ok(found)
}

fn is_value(json: &Value, value: &str) -> bool {
    json.as_str() == Some(value) || json.as_f64().is_some_and(|number| value.parse() == Ok(number))
}

/// Those of a CSV file.
fn rows(csv: &str, rest: &str) -> Result<Stored> {
    let (place, keys) = rest
        .rsplit_once(']')
        .ok_or_else(|| anyhow!("`{rest}` selects no rows"))?;
    let mut lines = csv.lines().map(cells);
    let header = lines.next().unwrap_or_default();
    let column = |name: &str| {
        let column = header.iter().position(|column| column == name);
        column.ok_or_else(|| anyhow!("no column {name}"))
    };
    let mut conditions = Vec::new();
    for condition in place.split(']') {
        let condition = condition.trim_start_matches('[');
        let (name, value) = condition
            .split_once('=')
            .ok_or_else(|| anyhow!("`{condition}` is no condition"))?;
        conditions.push((column(name)?, value));
    }
    let mut stored = Stored::new();
    for row in lines {
        let has = |(column, value): &(usize, &str)| row.get(*column).is_some_and(|cell| cell == value);
        if !conditions.iter().all(has) {
            continue;
        }
        for key in keys.split_whitespace() {
            let number = || {
                let cell = row.get(column(key)?).map_or("", String::as_str);
                cell.parse::<f64>().with_context(|| format!("{key} = `{cell}`"))
            };
            stored.push((key.to_owned(), if key == "-" { None } else { Some(number()?) }));
        }
    }
    if stored.is_empty() {
        bail!("no row has {place}]");
    }
    Ok(stored)
}

/// The cells of a line of CSV; commas within quotes separate none.
fn cells(line: &str) -> Vec<String> {
    let mut cells = vec![String::new()];
    let mut quoted = false;
    for c in line.chars() {
        match (c, cells.last_mut()) {
            ('"', _) => quoted = !quoted,
            (',', _) if !quoted => cells.push(String::new()),
            (c, Some(cell)) => cell.push(c),
            (_, None) => {}
        }
    }
    cells
}

/// A number as it is printed, without its sign.
struct Number {
    value: f64,
    /// Half a unit of its last digit, and what double precision may add.
    half_unit: f64,
    /// Where its digits stand in the text.
    digits: Range<usize>,
    decimals: usize,
    /// The power of ten that the digits count, by an exponent or a `k` or `M`.
    exponent: i32,
}

impl Number {
    /// Another number as this one is printed.
    fn print(&self, value: f64) -> String {
        let printed = format!("{:.*}", self.decimals, value.abs() / 10_f64.powi(self.exponent));
        let (whole, fraction) = printed.split_at(printed.find('.').unwrap_or(printed.len()));
        let mut grouped = String::new();
        for (index, digit) in whole.chars().enumerate() {
            if index > 0 && (whole.len() - index).is_multiple_of(3) {
                grouped.push(',');
            }
            grouped.push(digit);
        }
        grouped + fraction
    }
}

/// The numbers of a text: digits, with commas between thousands, a fraction, an exponent, and a `k` or `M` behind.
/// Digits that a letter precedes are part of a name.
fn numbers(text: &str) -> Vec<Number> {
    let bytes = text.as_bytes();
    let digit = |at: usize| bytes.get(at).is_some_and(u8::is_ascii_digit);
    let mut numbers = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        if !digit(at) {
            // A name is passed over with its digits.
            let letter = bytes[at].is_ascii_alphabetic();
            at += 1;
            while letter && bytes.get(at).is_some_and(|c| c.is_ascii_alphanumeric() || *c == b'_') {
                at += 1;
            }
            continue;
        }
        let start = at;
        let (mut digits, mut decimals, mut fraction) = (String::new(), 0, false);
        loop {
            match bytes.get(at) {
                Some(c) if c.is_ascii_digit() => {
                    digits.push(char::from(*c));
                    decimals += usize::from(fraction);
                }
                Some(b',') if !fraction && (1..=3).all(|next| digit(at + next)) && !digit(at + 4) => {}
                Some(b'.') if !fraction && digit(at + 1) => {
                    fraction = true;
                    digits.push('.');
                }
                _ => break,
            }
            at += 1;
        }
        let span = start..at;
        let mut exponent = 0;
        if bytes.get(at) == Some(&b'e') {
            let end = (at + 2..).find(|end| !digit(*end)).unwrap_or(at);
            if let Ok(found) = text[at + 1..end].parse::<i32>() {
                (exponent, at) = (found, end);
            }
        }
        for (suffix, power) in [(" k", 3), (" M", 6)] {
            let next = text[at..].strip_prefix(suffix).map(|rest| rest.chars().next());
            if next.is_some_and(|next| !next.is_some_and(char::is_alphanumeric)) {
                exponent += power;
            }
        }
        let unit = 10_f64.powi(exponent) / 10_f64.powi(decimals as i32);
        if let Ok(value) = digits.parse::<f64>() {
            let value = value * 10_f64.powi(exponent);
            let half_unit = 0.5 * unit + 1e-9 * value;
            numbers.push(Number {
                value,
                half_unit,
                digits: span,
                decimals,
                exponent,
            });
        }
    }
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_as_people_write_them() {
        let found = |text: &str| numbers(text).iter().map(|number| number.value).collect::<Vec<_>>();
        assert_eq!(
            found("| M4F | 27,280 bytes, 0.013 / 0.06 (-0.5 %) |"),
            [27280.0, 0.013, 0.06, 0.5]
        );
        assert_eq!(
            found("140 k, 3.6 M; 7 kB at t = 1, 2,345, 1.2e-4 l, 2e2."),
            [140e3, 3.6e6, 7.0, 1.0, 2345.0, 1.2e-4, 200.0]
        );
        let half_units: Vec<f64> = numbers("0.013 140 k 12")
            .iter()
            .map(|number| number.half_unit)
            .collect();
        for (found, expected) in half_units.iter().zip([0.0005, 500.0, 0.5]) {
            assert!((found - expected).abs() < 1e-3 * expected);
        }
    }

    #[test]
    fn another_number_is_printed_alike() {
        let printed = |text: &str, value: f64| numbers(text)[0].print(value);
        let found = [
            printed("27,280", 1_234_567.0),
            printed("140 k", 98_760.0),
            printed("0.013 %", -0.0249),
        ];
        assert_eq!(found, ["1,234,567", "99", "0.025"]);
    }

    #[test]
    fn json_and_csv_give_their_numbers() {
        let json = r#"{"a": [{"b": 1.25, "c": {"d": -3}}]}"#;
        let stored = pointers(json, "/a/0 b - c/d").unwrap();
        assert_eq!(
            stored.iter().map(|(_, value)| *value).collect::<Vec<_>>(),
            [Some(1.25), None, Some(-3.0)]
        );
        assert_eq!(pointers(json, "/a/1 b").unwrap_err().to_string(), "nothing at /a/1");
        assert_eq!(pointers(json, "/a/0 x").unwrap_err().to_string(), "no number at /a/0/x");
        let list = r#"{"rows": [{"set": "m v", "to": 2, "e": [1, 2]}, {"set": "m v", "to": 0.5, "e": [3, 4]}]}"#;
        let value = |place: &str| {
            pointers(list, place)
                .map(|stored| stored[0].1)
                .map_err(|error| error.to_string())
        };
        assert_eq!(value("/rows[set=m v][to=0.5] e/1"), Ok(Some(4.0)));
        assert_eq!(value("/rows[set=m v]/e 0"), Ok(Some(1.0)));
        assert_eq!(
            value("/rows[set=m][to=2] e/0"),
            Err("nothing at /rows[set=m][to=2]".to_owned())
        );
        let csv = "x,cause,y\n1,\"mesh, fine\",0.5\n2,time,0.6\n3,\"mesh, fine\",0.7\n";
        let stored = rows(csv, "[cause=mesh, fine] x y").unwrap();
        let values: Vec<_> = stored.iter().filter_map(|(_, value)| *value).collect();
        assert_eq!(values, [1.0, 0.5, 3.0, 0.7]);
        assert_eq!(
            rows(csv, "[cause=walls] x").unwrap_err().to_string(),
            "no row has [cause=walls]"
        );
    }

    #[test]
    fn a_figure_that_is_not_the_stored_one_is_told() {
        let folder = std::env::temp_dir().join(format!("capsule-book-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join("a.json"), r#"{"x": 0.0149, "y": 27280}"#).unwrap();
        let text = "It is 0.015<!-- = a.json / x --> and\n| row 3 | 0.014 | 27,280 | <!-- = a.json / x y -->\n";
        let rows = "<!-- rows = b.json /list/* x - -->\n\n| t | x | y |\n|---|---|---|\n| 1 | 0.5 | 9 |\n\
                    | 2 | 0.7 | 9 |\n\n| 3 |\n";
        std::fs::write(folder.join("b.json"), r#"{"list": [{"x": 0.51}, {"x": 0.6}]}"#).unwrap();
        let pages = [Page::new("p.md", text), Page::new("q.md", rows)];
        let faults = faults(&pages, &folder);
        let corrected = corrected(&pages, &folder);
        std::fs::remove_dir_all(&folder).unwrap();
        let told = [
            "p.md:2: 0.014 stands where a.json has x = 0.0149",
            "q.md:6: 0.7 stands where b.json has x = 0.6",
        ];
        assert_eq!(faults, told);
        let texts = [text.replace("0.014", "0.015"), rows.replace("0.7", "0.6")];
        assert_eq!(corrected.iter().map(Page::text).collect::<Vec<_>>(), texts);
    }
}
