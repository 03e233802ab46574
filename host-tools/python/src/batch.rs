//! Many queries of one model, answered in parallel on all cores.

use crate::QueryError;
use crate::model::{Model, Shared};
use capsule_core::{EvaluateError, Evaluator, Instant, Method, Parameters, Query, Workspace};
use numpy::{PyReadonlyArray2, PyReadwriteArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::prelude::*;
use std::sync::Arc;

/// Queries of a model. A row of the answers belongs to each.
pub struct Queries {
    pub shared: Arc<Shared>,
    queries: Vec<Query<f32>>,
    /// Answer refused queries with NaN instead of an error.
    skip_refused: bool,
}

impl Queries {
    /// Queries from rows of parameters. `method` is "direct" or "paper"; the model's if none is given.
    pub fn new(
        model: &Model,
        parameters: PyReadonlyArray2<'_, f64>,
        method: Option<&str>,
        extrapolate: bool,
        skip_refused: bool,
    ) -> PyResult<Self> {
        let shared = model.shared.clone();
        let method = match method {
            None => shared.core().default_method(),
            Some("direct") => Method::Direct,
            Some("paper") => Method::Paper,
            Some(other) => {
                return Err(PyValueError::new_err(format!(
                    "method {other:?} is unknown: \"direct\" or \"paper\""
                )));
            }
        };
        let parameters = parameters.as_array();
        let (expected, found) = (shared.core().parameters().len(), parameters.ncols());
        let refusal = || QueryError::new_err(EvaluateError::ParameterCount { expected, found }.to_string());
        let query = |row: numpy::ndarray::ArrayView1<'_, f64>| {
            let parameters = Parameters::from_doubles(&row.to_vec()).ok_or_else(refusal)?;
            Ok(Query {
                extrapolate,
                ..Query::new(parameters, method)
            })
        };
        if expected != found {
            return Err(refusal());
        }
        let queries = parameters.rows().into_iter().map(query).collect::<PyResult<_>>()?;
        Ok(Self {
            shared,
            queries,
            skip_refused,
        })
    }

    /// Where the parameters of each query lie: inside, beyond-steady-limit, far-from-samples or outside.
    pub fn domains(&self, py: Python<'_>) -> Vec<&'static str> {
        py.detach(|| {
            let domain = |workspace: &mut Box<Workspace<f32>>, query: &Query<f32>| {
                let model = self.shared.core();
                let query = Query {
                    extrapolate: true,
                    ..*query
                };
                let prepared = Evaluator::new(model, workspace).and_then(|mut evaluator| evaluator.prepare(&query));
                prepared.map_or("outside", |domain| domain.name())
            };
            self.queries.par_iter().map_init(Box::default, domain).collect()
        })
    }

    /// out <- for each query and instant `width` numbers, which `answer` writes.
    pub fn fill(
        &self,
        py: Python<'_>,
        times: &[f32],
        width: usize,
        mut out: PyReadwriteArray1<'_, f32>,
        answer: impl Fn(&mut Instant<'_, '_, f32>, &Query<f32>, &mut [f32]) -> Result<(), EvaluateError> + Sync,
    ) -> PyResult<()> {
        let row = times.len() * width;
        let out = out.as_slice_mut()?;
        if out.len() != self.queries.len() * row {
            return Err(PyValueError::new_err(format!(
                "out holds {} numbers, {} are needed",
                out.len(),
                self.queries.len() * row
            )));
        }
        if row == 0 {
            return Ok(());
        }
        let work = |workspace: &mut Box<Workspace<f32>>, (index, out): (usize, &mut [f32])| {
            let query = &self.queries[index];
            let mut one = || -> Result<(), EvaluateError> {
                let mut evaluator = Evaluator::new(self.shared.core(), workspace)?;
                evaluator.prepare(query)?;
                for (t, out) in times.iter().zip(out.chunks_exact_mut(width)) {
                    answer(&mut evaluator.at(*t)?, query, out)?;
                }
                Ok(())
            };
            match one() {
                Err(error) if self.skip_refused && !matches!(error, EvaluateError::Value { .. }) => {
                    out.fill(f32::NAN);
                    None
                }
                outcome => outcome.err().map(|error| (index, error)),
            }
        };
        let failure = py.detach(|| {
            out.par_chunks_exact_mut(row)
                .enumerate()
                .map_init(Box::default, work)
                .flatten()
                .min_by_key(|(index, _)| *index)
        });
        failure.map_or(Ok(()), |(index, error)| Err(self.refusal(index, &error)))
    }

    /// The error of a query; its place is named where there are several.
    fn refusal(&self, index: usize, error: &EvaluateError) -> PyErr {
        let text = self.shared.core().describe(*error).to_string();
        if self.queries.len() == 1 {
            QueryError::new_err(text)
        } else {
            QueryError::new_err(format!("query {index}: {text}"))
        }
    }
}
