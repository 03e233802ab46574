//! The steady configurations of a snapshot database on the paper's grid.

use capsule_database::{Database, Entry};

use crate::{Check, Reference, ValidationError};

/// The largest steady capillary numbers (before t = 20) by row of a/l, by another implementation at mesh 10 and more; a
/// range where it is between two columns of the grid.
const LIMITS: [(f64, Reference); 6] = [
    (0.75, Reference::Value(0.20)),
    (0.80, Reference::Value(0.17)),
    (0.90, Reference::Value(0.13)),
    (1.00, Reference::Range([0.08, 0.09])),
    (1.10, Reference::Value(0.07)),
    (1.20, Reference::Range([0.04, 0.05])),
];

/// The number of steady configurations on the paper's grid and the largest steady capillary number of its rows.
pub fn checks(database: &Database) -> Result<Vec<Check>, ValidationError> {
    let entries = database.entries()?;
    let steady: Vec<&Entry> = entries
        .iter()
        .filter(|entry| entry.status.is_steady() && on_grid(&entry.parameters))
        .collect();
    let mut checks = vec![Check::new(
        "steady configurations on the paper's grid",
        steady.len() as f64,
        118.0,
        5.0,
        "the paper",
    )];
    for (confinement, reference) in LIMITS {
        let row = steady.iter().filter(|entry| same(entry.parameters[1], confinement));
        checks.push(Check::new(
            format!("largest steady Ca on the grid at a/l = {confinement:.2}"),
            row.map(|entry| entry.parameters[0]).fold(f64::NAN, f64::max),
            reference,
            // One column of the grid.
            0.0101,
            "another implementation, mesh 10 and more",
        ));
    }
    Ok(checks)
}

/// Ca = 0.005, and 0.01 to 0.20 by 0.01; a/l = 0.75 to 1.20 by 0.05.
fn on_grid(parameters: &[f64]) -> bool {
    let &[capillary_number, confinement] = parameters else {
        return false;
    };
    let multiple = |value: f64, step: f64| same((value / step).round() * step, value);
    let column = same(capillary_number, 0.005)
        || multiple(capillary_number, 0.01) && (0.0099..0.2001).contains(&capillary_number);
    column && multiple(confinement, 0.05) && (0.7499..1.2001).contains(&confinement)
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_grid_is_the_papers() {
        let columns = (1..=450).map(|i| 0.0005 * f64::from(i));
        let configurations: Vec<_> = columns
            .flat_map(|ca| (130..=260).map(move |i| [ca, 0.005 * f64::from(i)]))
            .filter(|parameters| on_grid(parameters))
            .collect();
        assert_eq!(configurations.len(), 21 * 10);
    }
}
