//! Errors on a test set, configurations that are not samples, and the calibration of the errors that the model states.

use std::collections::BTreeMap;

use capsule_core::{Method, Model};
use capsule_database::{Database, DatabaseError, table};
use capsule_offline::{Comparison, Progress};
use serde::Serialize;

use crate::leave_one_out::{InstantErrors, SampleErrors, instant_errors};
use crate::{StudyError, name};

/// The default instants of comparison, in l/V.
pub const TEST_TIMES: [f64; 6] = [0.1, 1.0, 2.0, 4.0, 8.0, 20.0];

/// The columns of a table of all errors.
pub(crate) const HEADING: [&str; 8] = [
    "method",
    "capillary_number",
    "confinement",
    "t",
    "lab_percent",
    "shape_percent",
    "expected_percent",
    "bound_percent",
];

/// Errors of a model on configurations of a test set.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TestSetErrors {
    /// The default method of the model.
    pub default: &'static str,
    /// Number of configurations of the test set in the model's domain.
    pub samples: usize,
    /// For each method, the errors at each instant.
    pub methods: BTreeMap<&'static str, Vec<InstantErrors>>,
    /// For each method, the model's own estimates of its errors.
    pub stated: BTreeMap<&'static str, Stated>,
    /// Errors of the interpolation of direct evaluation alone, without the compression of the model file, at each
    /// instant; empty unless asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub interpolation: Vec<InstantErrors>,
    /// For each method, each configuration.
    #[serde(skip)]
    pub compared: BTreeMap<&'static str, Vec<Comparison>>,
}

/// Calibration of the stated errors, and two invariants.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Stated {
    /// Share of the errors below the stated 95 % bound, in per cent: at all instants together.
    pub below_bound_percent: f64,
    /// At each instant.
    pub instants: Vec<InstantStated>,
    /// Greatest relative error of the volume, in per cent.
    pub volume_max_percent: f64,
    /// How far the outermost node is beyond the walls, in l; negative within.
    pub beyond_walls: f64,
}

/// The model's own estimates of its errors at an instant: laboratory frame, per cent of a.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct InstantStated {
    /// The instant, in l/V.
    pub t: f64,
    /// Mean of the expected errors.
    pub expected_mean_percent: f64,
    /// Mean of the bounds.
    pub bound_mean_percent: f64,
    /// Share of the errors below their bound.
    pub below_bound_percent: f64,
}

/// Compares a model with the configurations of a test set that lie in its domain, at those of the `times` (l/V) at
/// which it has snapshots. With the `samples` that it was built from, also the error of their interpolation alone.
///
/// # Errors
/// Those of the databases; [`StudyError::NothingToCompare`] if none lies in the domain.
pub fn test_set(
    model: &Model,
    tests: &Database,
    samples: Option<&Database>,
    times: &[f64],
    progress: Progress,
) -> Result<TestSetErrors, StudyError> {
    let (times, compared) = capsule_offline::compare(model, tests, times, progress)?;
    if compared.is_empty() || times.is_empty() {
        return Err(StudyError::NothingToCompare);
    }
    let default = name(model.default_method());
    let mut errors = TestSetErrors::new(&times, compared, default);
    if let Some(samples) = samples {
        let interpolated = capsule_offline::interpolated(model, samples, tests, &times, progress)?;
        let samples = interpolated
            .iter()
            .map(|i| SampleErrors::new(&i.parameters, &i.laboratory, &i.shape));
        errors.interpolation = instant_errors(&times, &samples.collect::<Vec<_>>());
    }
    Ok(errors)
}

impl TestSetErrors {
    fn new(times: &[f64], compared: Vec<Comparison>, default: &'static str) -> Self {
        let mut errors = TestSetErrors {
            default,
            samples: 0,
            methods: BTreeMap::new(),
            stated: BTreeMap::new(),
            interpolation: Vec::new(),
            compared: BTreeMap::new(),
        };
        for method in [Method::Direct, Method::Paper] {
            let of_method = compared.iter().filter(|c| c.method == method).cloned();
            let of_method: Vec<Comparison> = of_method.collect();
            let values: Vec<SampleErrors> = of_method.iter().map(SampleErrors::of).collect();
            errors.samples = values.len();
            errors.methods.insert(name(method), instant_errors(times, &values));
            errors.stated.insert(name(method), Stated::new(times, &of_method));
            errors.compared.insert(name(method), of_method);
        }
        errors
    }

    /// One line a method, configuration and instant, with a heading; errors in per cent of a.
    ///
    /// # Errors
    /// [`DatabaseError::WrongLength`] for a configuration that has not the parameters of the heading.
    pub fn csv(&self) -> Result<Vec<u8>, DatabaseError> {
        table::csv(None, HEADING, self.rows())
    }

    /// Rows under [`HEADING`].
    pub(crate) fn rows(&self) -> Vec<Vec<String>> {
        let mut rows = Vec::new();
        for (method, compared) in &self.compared {
            for c in compared {
                for (i, instant) in self.methods[method].iter().enumerate() {
                    let values = [c.laboratory[i], c.shape[i], c.expected[i], c.bound[i]];
                    let mut row = vec![(*method).to_owned()];
                    row.extend(c.parameters.iter().chain([&instant.t]).map(f64::to_string));
                    row.extend(values.map(|value| format!("{:.6}", 100.0 * value)));
                    rows.push(row);
                }
            }
        }
        rows
    }
}

impl Stated {
    fn new(times: &[f64], compared: &[Comparison]) -> Self {
        let mean = |value: &dyn Fn(&Comparison) -> f64| {
            100.0 * compared.iter().map(value).sum::<f64>() / compared.len().max(1) as f64
        };
        let below = |c: &Comparison, i: usize| f64::from(u8::from(c.laboratory[i] <= c.bound[i]));
        let instants: Vec<InstantStated> = times
            .iter()
            .enumerate()
            .map(|(i, t)| InstantStated {
                t: *t,
                expected_mean_percent: mean(&|c| c.expected[i]),
                bound_mean_percent: mean(&|c| c.bound[i]),
                below_bound_percent: mean(&|c| below(c, i)),
            })
            .collect();
        let all = instants.iter().map(|instant| instant.below_bound_percent).sum::<f64>();
        Stated {
            below_bound_percent: all / instants.len().max(1) as f64,
            volume_max_percent: 100.0 * compared.iter().map(|c| c.volume).fold(0.0, f64::max),
            beyond_walls: compared
                .iter()
                .map(|c| c.beyond_walls)
                .fold(f64::NEG_INFINITY, f64::max),
            instants,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stated_errors_are_counted() {
        let compared = |laboratory: f64, bound: f64| Comparison {
            parameters: vec![0.1, 0.9],
            method: Method::Direct,
            laboratory: vec![laboratory, 0.5 * laboratory],
            shape: vec![0.0; 2],
            expected: vec![0.5 * bound; 2],
            bound: vec![bound; 2],
            volume: laboratory,
            beyond_walls: -laboratory,
        };
        let compared = vec![compared(0.01, 0.02), compared(0.03, 0.02), compared(0.05, 0.02)];
        let errors = TestSetErrors::new(&[1.0, 2.0], compared, "direct");
        let stated = &errors.stated["direct"];
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{a} {b}");
        close(stated.instants[0].below_bound_percent, 100.0 / 3.0);
        close(stated.instants[1].below_bound_percent, 200.0 / 3.0);
        close(stated.below_bound_percent, 50.0);
        close(stated.instants[0].expected_mean_percent, 1.0);
        close(stated.volume_max_percent, 5.0);
        close(stated.beyond_walls, -0.01);
        close(errors.methods["direct"][0].lab_mean_percent, 3.0);
        close(errors.methods["direct"][0].lab_max_percent, 5.0);
        assert_eq!(errors.samples, 0);
        let csv = String::from_utf8(errors.csv().unwrap()).unwrap();
        assert_eq!(csv.lines().count(), 7);
        assert!(csv.contains("\ndirect,0.1,0.9,1,"), "{csv}");
    }
}
