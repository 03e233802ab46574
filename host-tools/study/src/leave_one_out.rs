//! Leave-one-out errors: each sample predicted by a model that was built without it (paper, section 4.5, Fig. 13).

use std::collections::BTreeMap;

use capsule_core::Method;
use capsule_database::{DatabaseError, table};
use capsule_offline::{Comparison, LeftOut, Progress, Settings, Source};
use serde::Serialize;

use crate::{StudyError, name};

/// The errors of both methods.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// The default method of the model.
    pub default: &'static str,
    /// The parameters' names.
    pub parameters: Vec<String>,
    /// How many samples the errors are over.
    pub samples: usize,
    /// For each method, the errors over all samples at each instant.
    pub methods: BTreeMap<&'static str, Vec<InstantErrors>>,
    /// For each method, the errors of each sample: the values of the heat maps of Fig. 13.
    #[serde(skip)]
    pub values: BTreeMap<&'static str, Vec<SampleErrors>>,
}

/// Errors over all samples at an instant: modified Hausdorff distance to the full-order model, in per cent of a.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct InstantErrors {
    /// The instant, in l/V.
    pub t: f64,
    /// Mean in the laboratory frame, in which the paper measures.
    pub lab_mean_percent: f64,
    /// Maximum in the laboratory frame.
    pub lab_max_percent: f64,
    /// Mean in the frame of the centroid: of the shape alone.
    pub shape_mean_percent: f64,
    /// Maximum in the frame of the centroid.
    pub shape_max_percent: f64,
}

/// Errors of one sample at the instants of the report, in per cent of a.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SampleErrors {
    /// The sample: (Ca, a/l), or the parameters of other people's data.
    pub parameters: Vec<f64>,
    /// Laboratory frame.
    pub lab_percent: Vec<f64>,
    /// Centroid frame.
    pub shape_percent: Vec<f64>,
}

/// Leaves out every sample in turn and measures both methods at the samples in the domain that the model answers for:
/// for a database at t = 0.1, 1, 2, 4, 8 and 20, as far as it has snapshots there, for other people's data at the
/// instants of the settings.
///
/// The model is built again without the sample, all of it: POD, coefficients, interpolation. A sample on the row that
/// two clusters share is judged by the cluster that answers there.
///
/// # Errors
/// [`StudyError::Offline`] when the database gives no model.
pub fn leave_one_out<'a>(
    source: impl Into<Source<'a>>,
    settings: &Settings,
    progress: Progress,
) -> Result<Report, StudyError> {
    let source = source.into();
    let mut settings = settings.clone();
    if let Source::Database(_) = source {
        settings.error_times = vec![0.1, 1.0, 2.0, 4.0, 8.0, 20.0];
    }
    let (times, errors) = capsule_offline::leave_one_out(source, &settings, progress)?;
    Ok(Report::new(
        source.parameter_names(),
        &times,
        &errors,
        settings.default_method,
    ))
}

impl SampleErrors {
    /// Those of a comparison.
    pub(crate) fn of(comparison: &Comparison) -> Self {
        let Comparison {
            parameters,
            laboratory,
            shape,
            ..
        } = comparison;
        Self::new(parameters, laboratory, shape)
    }

    /// From fractions of a.
    pub(crate) fn new(parameters: &[f64], laboratory: &[f64], shape: &[f64]) -> Self {
        Self {
            parameters: parameters.to_vec(),
            lab_percent: percent(laboratory),
            shape_percent: percent(shape),
        }
    }
}

fn percent(fractions: &[f64]) -> Vec<f64> {
    fractions.iter().map(|f| 100.0 * f).collect()
}

impl Report {
    /// The report of given errors at given instants.
    #[must_use]
    pub fn new(parameters: Vec<String>, times: &[f64], errors: &[LeftOut], default: Method) -> Self {
        let mut report = Report {
            default: name(default),
            parameters,
            samples: 0,
            methods: BTreeMap::new(),
            values: BTreeMap::new(),
        };
        for method in [Method::Direct, Method::Paper] {
            let values: Vec<SampleErrors> = errors
                .iter()
                .filter(|e| e.answers && e.inside && e.method == method)
                .map(|e| SampleErrors::new(&e.parameters, &e.laboratory, &e.shape))
                .collect();
            report.methods.insert(name(method), instant_errors(times, &values));
            report.samples = values.len();
            report.values.insert(name(method), values);
        }
        report
    }

    /// One line a method, sample and instant, with a heading.
    ///
    /// # Errors
    /// [`DatabaseError::WrongLength`] for a sample that has not one value a parameter.
    pub fn csv(&self) -> Result<Vec<u8>, DatabaseError> {
        let names = self.parameters.iter().map(String::as_str);
        let heading = ["method"].into_iter().chain(names);
        let heading = heading.chain(["t", "lab_percent", "shape_percent"]);
        let mut rows = Vec::new();
        for (method, values) in &self.values {
            for v in values {
                for (i, instant) in self.methods[method].iter().enumerate() {
                    let mut row = vec![(*method).to_owned()];
                    row.extend(v.parameters.iter().chain([&instant.t]).map(f64::to_string));
                    row.extend([v.lab_percent[i], v.shape_percent[i]].map(|percent| format!("{percent:.6}")));
                    rows.push(row);
                }
            }
        }
        table::csv(None, heading, rows)
    }
}

/// Mean and maximum over samples at each instant.
pub(crate) fn instant_errors(times: &[f64], values: &[SampleErrors]) -> Vec<InstantErrors> {
    let at = |(i, t): (usize, &f64)| {
        let (lab_mean_percent, lab_max_percent) = mean_and_max(values.iter().map(|v| v.lab_percent[i]));
        let (shape_mean_percent, shape_max_percent) = mean_and_max(values.iter().map(|v| v.shape_percent[i]));
        InstantErrors {
            t: *t,
            lab_mean_percent,
            lab_max_percent,
            shape_mean_percent,
            shape_max_percent,
        }
    };
    times.iter().enumerate().map(at).collect()
}

fn mean_and_max(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (sum, max, count) = values.fold((0.0, 0.0, 0), |(s, m, n), v| (s + v, f64::max(m, v), n + 1));
    (sum / f64::from(count.max(1)), max)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(method: Method, answers: bool, laboratory: f64, shape: f64) -> LeftOut {
        LeftOut {
            parameters: vec![0.1, 0.9],
            cluster: 0,
            answers,
            inside: true,
            method,
            laboratory: vec![laboratory, 2.0 * laboratory],
            shape: vec![shape, shape],
            deviation: 1.0,
        }
    }

    #[test]
    fn means_and_maxima_are_over_the_answering_cluster_in_per_cent() {
        let mut outside = error(Method::Direct, true, 9.0, 9.0);
        outside.inside = false;
        let errors = [
            outside,
            error(Method::Direct, true, 0.01, 0.002),
            error(Method::Direct, false, 9.0, 9.0),
            error(Method::Direct, true, 0.03, 0.004),
            error(Method::Paper, true, 0.05, 0.05),
            error(Method::Paper, true, 0.05, 0.05),
        ];
        let names = ["Q, flow", "confinement"].map(str::to_owned).to_vec();
        let report = Report::new(names, &[1.0, 2.0], &errors, Method::Direct);
        assert_eq!((report.samples, report.default), (2, "direct"));
        let late = report.methods["direct"][1];
        assert_eq!(late.t, 2.0);
        let close = |a: f64, b: f64| (a - b).abs() < 1e-12;
        assert!(
            close(late.lab_mean_percent, 4.0) && close(late.lab_max_percent, 6.0),
            "{late:?}"
        );
        assert!(
            close(late.shape_mean_percent, 0.3) && close(late.shape_max_percent, 0.4),
            "{late:?}"
        );
        let csv = String::from_utf8(report.csv().unwrap()).unwrap();
        assert!(csv.starts_with("method,\"Q, flow\",confinement,t,"), "{csv}");
        assert_eq!(csv.lines().count(), 1 + 2 * 2 * 2);
        assert!(csv.contains("\ndirect,0.1,0.9,2,6.000000,0.400000\n"), "{csv}");
    }
}
