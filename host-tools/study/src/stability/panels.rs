//! The results as panels of figures.

use capsule_plot::{Axis, Cells, Curve, Lines, Panel};

use super::{INSTANTS, Place, Row, Stability};

/// Settings that are varied by factors.
const BY_FACTORS: [&str; 3] = ["step", "noise", "regularisation"];
/// Where a logarithmic axis shows 0.
const ZERO: f64 = 1e-10;

/// A panel for each setting and for each quantity of the map, with a name for its file.
#[must_use]
pub fn panels(stability: &Stability) -> Vec<(String, Panel)> {
    let mut panels = Vec::new();
    let mut shown: Vec<&str> = Vec::new();
    for row in &stability.rows {
        if !shown.contains(&row.setting.as_str()) {
            shown.push(&row.setting);
            let rows: Vec<&Row> = stability
                .rows
                .iter()
                .filter(|other| other.setting == row.setting)
                .collect();
            panels.push((file_name(&row.setting), setting(&rows)));
        }
    }
    type Quantity = fn(&Place) -> f64;
    let quantities: [(&str, &str, Quantity); 4] = [
        ("lebesgue_direct", "Lebesgue constant, direct", |place| {
            place.direct_lebesgue
        }),
        ("lebesgue_paper", "Lebesgue constant, paper", |place| {
            place.paper_lebesgue
        }),
        ("condition", "Condition number, paper", |place| place.condition),
        ("single_precision", "Greatest error of a weight in f32", |place| {
            place.single_precision.max(1e-12)
        }),
    ];
    for (index, (name, title, value)) in quantities.into_iter().enumerate() {
        let cells = stability
            .places
            .iter()
            .map(|place| (place.capillary_number, place.confinement, value(place)));
        let map = Cells::new(title, "Ca", "a/l", "", cell(&stability.places), cells.collect());
        // Lebesgue constants are of one order, the others of many.
        let map = if index < 2 { map } else { map.logarithmic() };
        panels.push((name.to_owned(), Panel::Cells(map)));
    }
    panels
}

/// Size of the cells of the map.
fn cell(places: &[Place]) -> (f64, f64) {
    let step = |value: fn(&Place) -> f64| {
        let mut values: Vec<f64> = places.iter().map(value).collect();
        values.sort_by(f64::total_cmp);
        let steps = values
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .filter(|step| *step > 1e-9);
        steps.fold(f64::INFINITY, f64::min)
    };
    (step(|place| place.capillary_number), step(|place| place.confinement))
}

/// Mean errors at the later instant, and the greatest ones as dots.
fn setting(rows: &[&Row]) -> Panel {
    let name = &rows[0].setting;
    let factors = BY_FACTORS.iter().any(|start| name.starts_with(start));
    let x = if factors {
        Axis::logarithmic(name)
    } else {
        Axis::linear(name)
    };
    let title = format!("Error at t = {}: mean (lines), greatest (dots)", INSTANTS[1]);
    let mut by: Vec<&str> = rows.iter().map(|row| row.by.as_str()).collect();
    by.sort_unstable();
    by.dedup();
    let mut lines = Lines::new(&title, x, Axis::logarithmic("% of a"));
    let points = |by: &str, value: fn(&Row) -> f64| {
        let of_it = rows.iter().filter(|row| row.by == by);
        of_it
            .map(|row| (if factors { row.value.max(ZERO) } else { row.value }, value(row)))
            .collect::<Vec<_>>()
    };
    for by in &by {
        lines = lines.with(Curve::line(by, points(by, |row| row.mean_percent[1])));
    }
    for by in &by {
        lines = lines.with(Curve::points(by, points(by, |row| row.max_percent[1])));
    }
    Panel::Lines(lines)
}

pub(crate) fn file_name(setting: &str) -> String {
    let words = setting
        .split(|c: char| !c.is_ascii_alphanumeric())
        .filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("_").to_lowercase()
}
