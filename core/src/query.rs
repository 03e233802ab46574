//! A query and its check: parameters, method, and the domain in which they lie.

use crate::Real;
use crate::error::EvaluateError;
use crate::interpolate::Weights;
use crate::model::wire::{Cluster, Errors, Method, Parameter, Reference};
use crate::model::{MatrixView, Model, PARAMETER_TOLERANCE, Parameters};

/// A query: parameters, and how the answer is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Query<T> {
    /// As many parameters as the model has.
    pub parameters: Parameters<T>,
    /// Method of the answer.
    pub method: Method,
    /// Whether to answer outside the sampled domain too, instead of with an error.
    pub extrapolate: bool,
    /// Time step of [`Method::Paper`], > 0, in the model's unit of time (l/V); by default a thousandth of the end time.
    pub step: Option<T>,
    /// Time stepping scheme of [`Method::Paper`].
    pub scheme: Scheme,
}

impl<T: Real> Query<T> {
    /// A query within the domain, with forward Euler steps of the default length.
    pub fn new(parameters: impl Into<Parameters<T>>, method: Method) -> Self {
        Self {
            parameters: parameters.into(),
            method,
            extrapolate: false,
            step: None,
            scheme: Scheme::Euler,
        }
    }

    /// Checks the numbers of a query, and that it lies in the domain unless it extrapolates. Returns where it lies.
    ///
    /// # Errors
    /// [`EvaluateError::ParameterCount`]; [`EvaluateError::Parameter`]; [`EvaluateError::Value`] for the step;
    /// [`EvaluateError::OutsideDomain`]; [`EvaluateError::BeyondSteadyLimit`].
    pub(crate) fn validate(&self, model: &Model<'_>) -> Result<Domain, EvaluateError> {
        /// Bounds of a scaled parameter.
        const MAX: f32 = 1e6;
        const MIN_POSITIVE: f32 = 1e-6;
        const MAX_STEPS: f32 = 1e5;
        let end_time = model.end_time();
        let contents = model.contents();
        let ranges = &contents.metadata.parameters;
        let values = self.parameters.as_slice();
        if values.len() != ranges.len() {
            return Err(EvaluateError::ParameterCount {
                expected: ranges.len(),
                found: values.len(),
            });
        }
        let min = match contents.mesh.reference {
            Reference::Sphere => MIN_POSITIVE,
            Reference::Shape { .. } => -MAX,
        };
        let scaled = model.scaled(&self.parameters);
        for (index, (scaled, range)) in scaled.as_slice().iter().zip(ranges).enumerate() {
            if !in_range(*scaled, min, MAX) {
                let [origin, scale] = [range.origin as f32, range.scale as f32];
                return Err(EvaluateError::Parameter {
                    index,
                    value: self.parameters.get(index).to_f32(),
                    min: origin + scale * min,
                    max: origin + scale * MAX,
                });
            }
        }
        if let Some(step) = self.step {
            check_range("the step", step, end_time / MAX_STEPS, end_time)?;
        }
        let domain = model.domain(self.parameters)?;
        if self.extrapolate {
            return Ok(domain);
        }
        if let Some(index) = model.outside(&self.parameters)
            && let Some(range) = ranges.get(index)
        {
            return Err(EvaluateError::OutsideDomain {
                index,
                value: self.parameters.get(index).to_f32(),
                range: [range.min as f32, range.max as f32],
            });
        }
        if domain == Domain::BeyondSteadyLimit {
            let [capillary_number, confinement] = self.parameters.array();
            return Err(EvaluateError::BeyondSteadyLimit {
                capillary_number: capillary_number.to_f32(),
                confinement: confinement.to_f32(),
                limit: model.steady_limit(confinement).map_or(0.0, T::to_f32),
            });
        }
        Ok(domain)
    }

    /// The leave-one-out errors of the query's method.
    pub(crate) fn errors<'c, 'a>(&self, cluster: &'c Cluster<'a>) -> &'c Errors<'a> {
        match self.method {
            Method::Direct => &cluster.direct_errors,
            Method::Paper => &cluster.paper_errors,
        }
    }

    /// Checks that a query within the ranges of scattered samples is near enough to them: its deviation must not exceed
    /// the greatest deviation of a sample left out, beyond which no leave-one-out error was measured.
    ///
    /// # Errors
    /// [`EvaluateError::FarFromSamples`], unless the query extrapolates.
    pub(crate) fn check_distance<const N: usize>(
        &self,
        cluster: &Cluster<'_>,
        weights: &Weights<T, N>,
    ) -> Result<Domain, EvaluateError> {
        let deviations = MatrixView::new(&self.errors(cluster).deviation);
        let greatest = (0..deviations.rows())
            .map(|j| deviations.get(j, 0))
            .fold(0.0, Real::max);
        let deviation = weights.deviation();
        if deviation <= T::from_f32(greatest) {
            Ok(Domain::Inside)
        } else if self.extrapolate {
            Ok(Domain::FarFromSamples)
        } else {
            Err(EvaluateError::FarFromSamples {
                ratio: (deviation / T::from_f32(greatest)).to_f32(),
            })
        }
    }
}

/// The query that a workspace is prepared for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Prepared<T> {
    /// Digest of the model.
    pub(crate) digest: u32,
    pub(crate) query: Query<T>,
    pub(crate) domain: Domain,
}

/// An explicit Runge-Kutta scheme.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// Forward Euler, first order, as in the paper (eq. 48).
    Euler,
    /// Heun's scheme, second order.
    Heun,
    /// The classical scheme, fourth order.
    RungeKutta4,
}

impl Scheme {
    /// Stages (node, 1 / weight): each is evaluated at the node, a share of the step, along the rate of the stage
    /// before.
    pub(crate) const fn stages(self) -> &'static [(f32, f32)] {
        match self {
            Self::Euler => &[(0.0, 1.0)],
            Self::Heun => &[(0.0, 2.0), (1.0, 2.0)],
            Self::RungeKutta4 => &[(0.0, 6.0), (0.5, 3.0), (0.5, 3.0), (1.0, 6.0)],
        }
    }
}

/// Position of parameters relative to the sampled domain. Errors are calibrated [`Inside`](Self::Inside); everywhere
/// else an answer is an extrapolation without an error bound, and its expected error is a guess.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    /// Within the sampled ranges and below the steady limit, where there is one.
    Inside,
    /// Within the sampled ranges, at a Ca that has no steady state.
    BeyondSteadyLimit,
    /// Within the ranges of scattered samples, but farther from the samples than any sample from the others.
    FarFromSamples,
    /// Outside the sampled ranges.
    Outside,
}

impl Domain {
    /// Its name in JSON and JavaScript.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Inside => "inside",
            Self::BeyondSteadyLimit => "beyond-steady-limit",
            Self::FarFromSamples => "far-from-samples",
            Self::Outside => "outside",
        }
    }
}

impl Model<'_> {
    /// Position of parameters relative to the sampled ranges and the steady limit; parameters that are not finite are
    /// outside. [`Domain::FarFromSamples`] is found by [`Evaluator::prepare`](crate::Evaluator::prepare) only.
    ///
    /// # Errors
    /// [`EvaluateError::ParameterCount`].
    pub fn domain<T: Real>(&self, parameters: impl Into<Parameters<T>>) -> Result<Domain, EvaluateError> {
        let parameters = parameters.into();
        let (expected, found) = (self.contents().metadata.parameters.len(), parameters.as_slice().len());
        if found != expected {
            return Err(EvaluateError::ParameterCount { expected, found });
        }
        let beyond = |limit: T| parameters.get(0) > limit * T::from_f64(1.0 + PARAMETER_TOLERANCE);
        Ok(if self.outside(&parameters).is_some() {
            Domain::Outside
        } else if self.steady_limit(parameters.get(1)).is_some_and(beyond) {
            Domain::BeyondSteadyLimit
        } else {
            Domain::Inside
        })
    }

    /// Index of the first parameter outside its sampled range.
    fn outside<T: Real>(&self, parameters: &Parameters<T>) -> Option<usize> {
        let within = |(value, range): (&T, &Parameter<'_>)| {
            let (min, max) = (T::from_f64(range.min), T::from_f64(range.max));
            let rounding = T::from_f32(2.0 * f32::EPSILON) * min.abs().max(max.abs());
            let slack = T::from_f64(PARAMETER_TOLERANCE) * (max - min) + rounding;
            *value >= min - slack && *value <= max + slack
        };
        let mut ranges = parameters.as_slice().iter().zip(&self.contents().metadata.parameters);
        ranges.position(|pair| !within(pair))
    }
}

/// Refuses a value outside [min, max].
pub(crate) fn check_range<T: Real>(what: &'static str, value: T, min: f32, max: f32) -> Result<(), EvaluateError> {
    if in_range(value, min, max) {
        Ok(())
    } else {
        let value = value.to_f32();
        Err(EvaluateError::Value { what, value, min, max })
    }
}

/// Whether a value lies in [min, max]; a NaN is never in range.
fn in_range<T: Real>(value: T, min: f32, max: f32) -> bool {
    T::from_f32(min) <= value && value <= T::from_f32(max)
}
