//! Names and values of the parameters: each name can be asked for, each parameter separates configurations.

use crate::DatabaseError;

/// The longest name of a parameter or unit, in bytes.
const LONGEST: usize = 64;

/// Values closer than this share of the parameter's range are the same: rounding, not meaning.
const SAME: f64 = 1e-12;

/// Refuses a text that is too long or holds control characters; an empty one too, where it must not be.
pub(super) fn text(place: &str, text: &str) -> Result<(), DatabaseError> {
    let shown = text.escape_debug();
    if text.chars().any(char::is_control) {
        return Err(DatabaseError::collection(format!(
            "{place} is `{shown}`, expected no control characters"
        )));
    }
    if text.len() > LONGEST {
        let length = text.len();
        return Err(DatabaseError::collection(format!(
            "{place} has {length} bytes, expected at most {LONGEST}"
        )));
    }
    Ok(())
}

/// Refuses names that cannot be asked for: empty ones, two alike.
pub(super) fn names(names: &[String]) -> Result<(), DatabaseError> {
    for (second, name) in names.iter().enumerate() {
        text(&format!("`parameter_names[{second}]`"), name)?;
        if name.is_empty() {
            return Err(DatabaseError::collection(format!(
                "`parameter_names[{second}]` is empty, expected a name"
            )));
        }
        if let Some(first) = names[..second].iter().position(|other| other == name) {
            return Err(DatabaseError::collection(format!(
                "`parameter_names`: names {first} and {second} are both `{name}`, expected different ones"
            )));
        }
    }
    Ok(())
}

/// Refuses rows that are not of one number a name, numbers that are not finite, parameters that do not vary, and two
/// rows alike.
pub(super) fn values(names: &[String], rows: &[Vec<f64>]) -> Result<(), DatabaseError> {
    for (j, row) in rows.iter().enumerate() {
        if row.len() != names.len() {
            let (found, expected) = (row.len(), names.len());
            return Err(DatabaseError::collection(format!(
                "row {j} of `parameters` has {found} numbers, expected {expected}"
            )));
        }
        if let Some((d, value)) = row.iter().enumerate().find(|(_, value)| !value.is_finite()) {
            return Err(DatabaseError::collection(format!(
                "`parameters[{j}, {d}]` (`{}`) is {value}, expected a finite number",
                names[d]
            )));
        }
    }
    let mut same = Vec::new();
    for (d, name) in names.iter().enumerate() {
        let column = || rows.iter().map(|row| row[d]);
        let [least, greatest] = [
            column().fold(f64::INFINITY, f64::min),
            column().fold(f64::NEG_INFINITY, f64::max),
        ];
        if rows.len() > 1 && greatest - least <= SAME * least.abs().max(greatest.abs()) {
            return Err(DatabaseError::collection(format!(
                "`parameters`: `{name}` is {} in all configurations, expected one that varies: leave column {d} out",
                number(least)
            )));
        }
        same.push(SAME * (greatest - least));
    }
    let alike = |a: &[f64], b: &[f64]| (0..names.len()).all(|d| (a[d] - b[d]).abs() <= same[d]);
    for (second, row) in rows.iter().enumerate() {
        if let Some(first) = rows[..second].iter().position(|other| alike(other, row)) {
            return Err(DatabaseError::collection(format!(
                "`parameters`: rows {first} and {second} are the same ({}), expected different ones",
                listed(names, row)
            )));
        }
    }
    Ok(())
}

/// `flow = 0.4, size = 2`
pub(super) fn listed(names: &[String], row: &[f64]) -> String {
    let pairs = names
        .iter()
        .zip(row)
        .map(|(name, value)| format!("{name} = {}", number(*value)));
    pairs.collect::<Vec<_>>().join(", ")
}

/// A number as people write it: with a power of ten where it is large or small.
pub(super) fn number(value: f64) -> String {
    if value == 0.0 || (1e-3..1e6).contains(&value.abs()) {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(names: &[&str], rows: &[&[f64]], words: &[&str]) {
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        let rows: Vec<Vec<f64>> = rows.iter().map(|row| row.to_vec()).collect();
        let error = super::names(&names)
            .and_then(|()| values(&names, &rows))
            .unwrap_err()
            .to_string();
        assert!(words.iter().all(|word| error.contains(word)), "{error}");
    }

    #[test]
    fn names_of_any_language_and_sign_are_accepted() {
        let odd = ["Q, flow", "a=b", "größe \"µ\"", "流れ"].map(str::to_owned);
        names(&odd).unwrap();
        names(&["x".repeat(64)]).unwrap();
    }

    #[test]
    fn names_that_cannot_be_asked_for_are_named() {
        refused(&["flow", ""], &[], &["`parameter_names[1]`", "empty"]);
        refused(&["flow", "size", "flow"], &[], &["names 0 and 2", "`flow`"]);
        refused(&["fl\now"], &[], &["`parameter_names[0]`", "`fl\\now`", "control"]);
        refused(&[&"x".repeat(65)], &[], &["`parameter_names[0]`", "65 bytes", "64"]);
    }

    #[test]
    fn values_that_separate_nothing_are_named() {
        refused(
            &["flow"],
            &[&[1.0], &[f64::NAN]],
            &["`parameters[1, 0]`", "`flow`", "NaN"],
        );
        refused(&["flow"], &[&[1.0], &[2.0, 3.0]], &["row 1", "2 numbers", "expected 1"]);
        refused(
            &["flow", "size"],
            &[&[1.0, 0.3], &[2.0, 0.1 + 0.2]],
            &["`size` is 0.3 in all", "column 1"],
        );
        let rows: [&[f64]; 3] = [&[1e-30, 5e29], &[2e-30, 5e29], &[1e-30, 5e29]];
        refused(&["flow", "size"], &rows[..2], &["`size` is 5e29 in all"]);
        let rows: [&[f64]; 4] = [&[1e-30, 1.3e30], &[2e-30, 5e29], &[0.0, 5e29], &[1e-30, 1.2e30 + 1e29]];
        refused(
            &["flow", "size"],
            &rows,
            &["rows 0 and 3", "flow = 1e-30, size = 1.3e30"],
        );
    }

    #[test]
    fn small_ranges_on_a_large_offset_separate() {
        let names = ["temperature".to_owned()];
        values(&names, &[vec![10_000.0], vec![10_000.2], vec![10_000.4]]).unwrap();
    }
}
