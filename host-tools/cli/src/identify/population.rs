//! The capsules of a batch as a population.

use super::records::Record;
use crate::print;
use anyhow::Result;
use capsule_plot::{Axis, Curve, Figure, Lines, Panel};
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// Counts, and means of the capsules with the verdict "identified".
#[derive(Serialize)]
pub struct Population {
    rows: usize,
    failed: usize,
    verdicts: BTreeMap<String, usize>,
    identified: usize,
    ca: Option<Spread>,
    radius_um: Option<Spread>,
    gs_n_per_m: Option<Spread>,
    #[serde(skip)]
    values: [Vec<f64>; 3],
}

/// Mean and spread of a quantity; without the latter for a single capsule.
#[derive(Clone, Copy, Serialize)]
struct Spread {
    mean: f64,
    standard_deviation: Option<f64>,
    /// That of the mean.
    standard_error: Option<f64>,
}

const FIELDS: [&str; 3] = ["ca", "radius_um", "gs_n_per_m"];
const IDENTIFIED: &str = "identified";
/// Bins of a histogram.
const BINS: [f64; 2] = [5.0, 60.0];

impl Population {
    pub fn of(records: &[Record], rows: usize) -> Self {
        let verdict = |record: &Record| {
            record
                .get("verdict")
                .and_then(Value::as_str)
                .unwrap_or_default()
                .to_owned()
        };
        let mut verdicts = BTreeMap::new();
        for record in records {
            *verdicts.entry(verdict(record)).or_insert(0) += 1;
        }
        let identified: Vec<&Record> = records.iter().filter(|record| verdict(record) == IDENTIFIED).collect();
        let values = FIELDS.map(|field| {
            let value = |record: &&Record| record.get(field).and_then(Value::as_f64);
            identified.iter().filter_map(value).collect::<Vec<_>>()
        });
        let [ca, radius_um, gs_n_per_m] = [0, 1, 2].map(|i| Spread::of(&values[i]));
        Self {
            rows,
            failed: rows - records.len(),
            verdicts,
            identified: identified.len(),
            ca,
            radius_um,
            gs_n_per_m,
            values,
        }
    }

    /// Whether there is a capsule to show.
    pub fn has_identified(&self) -> bool {
        self.identified > 0
    }

    /// Prints it as text.
    pub fn print(&self) -> Result<()> {
        println!("{} of {} rows answered", self.rows - self.failed, self.rows);
        for (verdict, count) in &self.verdicts {
            println!("{count} {verdict}");
        }
        let row = |name: &str, spread: Option<Spread>, unit: f64, digits: usize| {
            let spread = spread?;
            let text = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{:.digits$}", value / unit));
            Some(vec![
                name.to_owned(),
                text(Some(spread.mean)),
                text(spread.standard_error),
                text(spread.standard_deviation),
            ])
        };
        let rows: Vec<_> = [
            row("Ca", self.ca, 1.0, 5),
            row("a / um", self.radius_um, 1.0, 3),
            row("G_s / (mN/m)", self.gs_n_per_m, 1e-3, 4),
        ]
        .into_iter()
        .flatten()
        .collect();
        if rows.is_empty() {
            return Ok(());
        }
        println!("the {} identified:", self.identified);
        print::table(&["", "mean", "standard error", "standard deviation"], &rows)
    }

    /// Histograms of the capsules that were identified.
    pub fn histograms(&self) -> Figure {
        let panel = |i: usize, title: &str, axis: &str, unit: f64| {
            let values: Vec<f64> = self.values[i].iter().map(|value| value / unit).collect();
            let lines = Lines::new(title, Axis::linear(axis), Axis::linear("capsules"));
            Panel::Lines(lines.with(Curve::line("", steps(&values))))
        };
        Figure::new(vec![
            panel(2, "Surface shear modulus", "G_s / (mN/m)", 1e-3),
            panel(1, "Radius", "a / um", 1.0),
            panel(0, "Capillary number", "Ca", 1.0),
        ])
    }
}

impl Spread {
    fn of(values: &[f64]) -> Option<Self> {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        let standard_deviation = (values.len() > 1).then(|| (squares / (count - 1.0)).sqrt());
        (!values.is_empty()).then_some(Self {
            mean,
            standard_deviation,
            standard_error: standard_deviation.map(|deviation| deviation / count.sqrt()),
        })
    }
}

/// The outline of a histogram, its bins as wide as Freedman and Diaconis propose (Z. Wahrscheinlichkeitstheorie 57,
/// 1981).
fn steps(values: &[f64]) -> Vec<(f64, f64)> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let (Some(low), Some(high)) = (sorted.first().copied(), sorted.last().copied()) else {
        return Vec::new();
    };
    let quartile = |share: f64| sorted[(share * (sorted.len() - 1) as f64).round() as usize];
    let proposed = 2.0 * (quartile(0.75) - quartile(0.25)) / (sorted.len() as f64).cbrt();
    let range = (high - low).max(1e-6 * high.abs());
    let bins = (range / proposed).ceil().clamp(BINS[0], BINS[1]) as usize;
    let width = range / bins as f64;
    let mut counts = vec![0.0; bins];
    for value in &sorted {
        counts[(((value - low) / width) as usize).min(bins - 1)] += 1.0;
    }
    let mut steps = vec![(low, 0.0)];
    for (bin, count) in counts.into_iter().enumerate() {
        let [left, right] = [0.0, 1.0].map(|side| low + width * (bin as f64 + side));
        steps.extend([(left, count), (right, count)]);
    }
    steps.push((low + range, 0.0));
    steps
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_and_their_errors() {
        let record = |verdict: &str, ca: f64| {
            Record::from_iter([("verdict".to_owned(), verdict.into()), ("ca".to_owned(), ca.into())])
        };
        let records = [1.0, 2.0, 3.0, 6.0].map(|ca| record(IDENTIFIED, ca));
        let records = [records.to_vec(), vec![record("undetermined", 100.0)]].concat();
        let population = Population::of(&records, 7);
        let ca = population.ca.unwrap();
        // Of 1, 2, 3, 6: mean 3, variance 14 / 3.
        assert_eq!((ca.mean, population.failed, population.identified), (3.0, 2, 4));
        assert!((ca.standard_deviation.unwrap() - (14.0 / 3.0_f64).sqrt()).abs() < 1e-12);
        assert!((ca.standard_error.unwrap() - (14.0 / 12.0_f64).sqrt()).abs() < 1e-12);
        let area: f64 = steps(&population.values[0])
            .windows(2)
            .map(|pair| (pair[1].0 - pair[0].0) * pair[0].1)
            .sum();
        assert!(
            (area - 4.0 * 1.0).abs() < 1e-9,
            "four values in bins of width 1: {area}"
        );
        assert!(steps(&[]).is_empty() && Spread::of(&[]).is_none());
    }
}
