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

/// Refuses rows that are not of one number a name, numbers that are not finite, parameters that do not vary, and two rows
/// alike.
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
        let [least, greatest] = [column().fold(f64::INFINITY, f64::min), column().fold(f64::NEG_INFINITY, f64::max)];
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
    let pairs = names.iter().zip(row).map(|(name, value)| format!("{name} = {}", number(*value)));
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
