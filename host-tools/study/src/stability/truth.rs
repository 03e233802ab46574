//! Configurations of the full-order model, and the distance of a model's answers from them.

use capsule_core::{Evaluator, Frame, Model, Nodes, Query, Real, Scene, Workspace};
use capsule_database::Database;

use crate::StudyError;

/// The instants of the errors, in l/V.
pub const INSTANTS: [f64; 2] = [2.0, 8.0];

/// An answer that errs by more than this share of a is none.
const FAILED: f64 = 1.0;

/// One configuration at some instants.
#[derive(Debug, Clone)]
pub struct Truth {
    /// (Ca, a/l)
    pub parameters: [f64; 2],
    /// Node positions in the laboratory frame at each instant.
    pub positions: Vec<Vec<[f64; 3]>>,
}

/// Errors over configurations: the mean distance of corresponding nodes in the laboratory frame, as a fraction of a. It
/// bounds the modified Hausdorff distance from above.
#[derive(Debug, Clone, Default)]
pub struct Errors {
    /// Configurations.
    pub configurations: usize,
    /// How many of them have no answer, or a useless one.
    pub failures: usize,
    answered: Vec<Vec<f64>>,
}

impl Errors {
    fn over(&self, combine: impl Fn(f64, f64) -> f64, scale: f64) -> [f64; 2] {
        let none = if self.answered.is_empty() { f64::NAN } else { 0.0 };
        [0, 1].map(|i| scale * self.answered.iter().map(|errors| errors[i]).fold(none, &combine))
    }

    /// Means at both instants, of those that did not fail.
    #[must_use]
    pub fn mean(&self) -> [f64; 2] {
        self.over(|a, b| a + b, 1.0 / self.answered.len().max(1) as f64)
    }

    /// The greatest at both instants, of those that did not fail.
    #[must_use]
    pub fn max(&self) -> [f64; 2] {
        self.over(f64::max, 1.0)
    }

    /// Counts a configuration.
    pub fn count(&mut self, errors: Option<Vec<f64>>) {
        self.configurations += 1;
        match errors.filter(|errors| errors.iter().all(|error| *error < FAILED)) {
            Some(errors) => self.answered.push(errors),
            None => self.failures += 1,
        }
    }
}

/// At most `most` steady configurations that are wanted, spread over all of them, at [`INSTANTS`].
///
/// # Errors
/// The database's; [`StudyError::NoTruth`] when there is none.
pub fn read(database: &Database, most: usize, wanted: impl Fn([f64; 2]) -> bool) -> Result<Vec<Truth>, StudyError> {
    let entries = database.entries()?;
    let steady: Vec<[f64; 2]> = entries
        .iter()
        .filter(|entry| entry.status.is_steady() && entry.snapshots > 0)
        .map(|entry| [entry.parameters[0], entry.parameters[1]])
        .filter(|parameters| wanted(*parameters))
        .collect();
    let count = steady.len().min(most);
    if count == 0 {
        return Err(StudyError::NoTruth {
            database: database.directory().to_owned(),
        });
    }
    let chosen = (0..count).map(|i| steady[i * steady.len() / count]);
    chosen.map(|parameters| read_one(database, parameters)).collect()
}

/// One configuration at [`INSTANTS`].
pub(crate) fn read_one(database: &Database, parameters: [f64; 2]) -> Result<Truth, StudyError> {
    let trajectory = database.read(&parameters)?.extended(database.mesh(), &INSTANTS)?;
    Ok(Truth {
        parameters,
        positions: trajectory.positions,
    })
}

/// The mean distance of corresponding nodes.
pub(crate) fn distance(found: &[[f64; 3]], exact: &[[f64; 3]]) -> f64 {
    let node = |(a, b): (&[f64; 3], &[f64; 3])| (0..3).map(|d| (a[d] - b[d]).powi(2)).sum::<f64>().sqrt();
    found.iter().zip(exact).map(node).sum::<f64>() / exact.len() as f64
}

/// The errors of a model in numbers of type `T`.
///
/// # Errors
/// A model that does not fit the workspace.
pub(crate) fn errors<T: Real>(
    model: &Model,
    truths: &[Truth],
    query: impl Fn([T; 2]) -> Query<T>,
) -> Result<Errors, StudyError> {
    let mut workspace = Box::new(Workspace::<T>::new());
    let mut evaluator = Evaluator::new(model, &mut workspace)?;
    let scene = Scene {
        nodes: Nodes::All,
        frame: Frame::Laboratory,
    };
    let mut errors = Errors::default();
    for truth in truths {
        let query = Query {
            extrapolate: true,
            ..query(truth.parameters.map(T::from_f64))
        };
        let mut found = vec![[T::ZERO; 3]; truth.positions[0].len()];
        let mut error = |(t, exact): (&f64, &Vec<[f64; 3]>)| -> Option<f64> {
            evaluator.prepare(&query).ok()?;
            evaluator.at(T::from_f64(*t)).ok()?.positions(&scene, &mut found).ok()?;
            let found: Vec<[f64; 3]> = found.iter().map(|node| node.map(T::to_f64)).collect();
            Some(distance(&found, exact) / truth.parameters[1])
        };
        errors.count(INSTANTS.iter().zip(&truth.positions).map(&mut error).collect());
    }
    Ok(errors)
}
