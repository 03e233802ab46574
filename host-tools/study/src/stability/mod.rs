//! Limits of the accuracy of the online and the offline stage, and whether they report them.
//!
//! Three kinds of results: [`Row`]s, errors against a setting; [`Place`]s, a map of how well the samples around a query
//! determine its weights; and [`Check`]s, questions that have to be answered well or refused with an error.

mod checks;
pub(crate) mod data;
mod degenerate;
mod orders;
mod panels;
mod places;
mod random;
pub(crate) mod settings;
pub(crate) mod truth;

use std::path::Path;

use capsule_core::Model;
use capsule_database::Database;
use capsule_offline::Progress;
use serde::Serialize;

use crate::StudyError;
pub(crate) use panels::file_name;
pub use panels::panels;
pub use places::Place;
pub use truth::{Errors, INSTANTS, Truth};

/// The model and the data that are studied.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// The model file.
    pub model: &'a [u8],
    /// The database that the model is built from.
    pub database: &'a Database,
    /// Configurations that the model does not contain.
    pub tests: &'a Database,
    /// A minute instead of several.
    pub quick: bool,
}

/// All results.
#[derive(Debug, Clone, Serialize)]
pub struct Stability {
    /// Errors against settings.
    pub rows: Vec<Row>,
    /// The map.
    pub places: Vec<Place>,
    /// Questions that have to be answered well or refused.
    pub checks: Vec<Check>,
}

/// Errors at one value of one setting, over configurations that the model does not contain.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// The setting that is varied.
    pub setting: String,
    /// Its value.
    pub value: f64,
    /// The method, with its scheme, order or precision where that matters.
    pub by: String,
    /// Configurations.
    pub configurations: usize,
    /// Configurations without an answer, or with one that errs by more than the radius.
    pub failures: usize,
    /// Mean errors at [`INSTANTS`] of those that did not fail, in per cent of a.
    pub mean_percent: [f64; 2],
    /// The greatest ones.
    pub max_percent: [f64; 2],
}

impl Row {
    fn new(setting: &str, value: f64, by: &str, errors: &Errors) -> Self {
        Self {
            setting: setting.to_owned(),
            value,
            by: by.to_owned(),
            configurations: errors.configurations,
            failures: errors.failures,
            mean_percent: errors.mean().map(|error| 100.0 * error),
            max_percent: errors.max().map(|error| 100.0 * error),
        }
    }
}

/// Questions of one kind.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    /// The kind of query.
    pub question: String,
    /// How often.
    pub cases: usize,
    /// How many were answered.
    pub answered: usize,
    /// How many were refused with an error.
    pub refused: usize,
    /// Answers that are wrong, and refusals or answers where the other is right: there should be none.
    pub violations: usize,
    /// The worst case, in words.
    pub worst: String,
    /// The greatest difference, in per cent of a, where differences are what is checked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub greatest_percent: Option<f64>,
}

impl Check {
    fn new(question: &str) -> Self {
        Self {
            question: question.to_owned(),
            cases: 0,
            answered: 0,
            refused: 0,
            violations: 0,
            worst: String::new(),
            greatest_percent: None,
        }
    }

    /// Counts a case: answered or refused, rightly or not.
    fn count(&mut self, answered: bool, right: bool, worst: impl FnOnce() -> String) {
        self.cases += 1;
        *(if answered {
            &mut self.answered
        } else {
            &mut self.refused
        }) += 1;
        if !right {
            self.violations += 1;
            self.worst = worst();
        }
    }
}

/// Least and greatest Ca, least and greatest a/l of a model.
fn ranges(model: &Model) -> [[f64; 2]; 2] {
    let range = |index: usize| {
        let parameters = model.parameters();
        parameters.get(index).map_or([0.0; 2], |range| [range.min, range.max])
    };
    [range(0), range(1)]
}

/// Runs all parts. What is written on the way goes to `folder`.
///
/// # Errors
/// A model that cannot be opened, databases that cannot be read, or no configuration to compare with.
pub fn stability(subject: &Subject, folder: &Path, progress: Progress) -> Result<Stability, StudyError> {
    const PARTS: usize = 7;
    let step = |done: usize, name: &str| progress(name, done, PARTS);
    let model = Model::open(subject.model)?;
    step(0, "settings of the methods");
    let truths = truth::read(subject.tests, if subject.quick { 6 } else { 24 }, |_| true)?;
    let mut rows = settings::rows(&model, &truths, subject.quick)?;
    step(1, "orders of the diffuse approximation");
    rows.extend(orders::rows(subject, &model)?);
    step(2, "conditioning");
    let places = places::places(&model, subject.quick);
    step(3, "edges");
    let mut checks = checks::checks(&model)?;
    step(4, "degenerate samples");
    checks.extend(degenerate::checks());
    step(5, "random queries");
    checks.extend(random::checks(&model, subject.quick)?);
    step(6, "data: noise, gaps, ranks, horizon");
    let (of_data, refusals) = data::rows(subject, folder)?;
    rows.extend(of_data);
    checks.push(refusals);
    step(PARTS, "done");
    Ok(Stability { rows, places, checks })
}
