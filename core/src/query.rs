//! What is asked: parameters, method, and whether extrapolation is wanted.

use crate::Real;
pub use crate::model::wire::{MAX_PARAMETERS, Method};

/// The parameters of a query or of a sample, in the order of the model's: (Ca, a/l) for a capsule in the channel, one to
/// [`MAX_PARAMETERS`] numbers of other meaning for other models.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters<T> {
    values: [T; MAX_PARAMETERS],
    count: usize,
}

impl<T: Real> Parameters<T> {
    /// The parameters in a slice; none unless there are one to [`MAX_PARAMETERS`].
    pub fn new(values: &[T]) -> Option<Self> {
        let mut parameters = Self {
            values: [T::ZERO; MAX_PARAMETERS],
            count: values.len(),
        };
        parameters.values.get_mut(..values.len())?.copy_from_slice(values);
        (!values.is_empty()).then_some(parameters)
    }

    /// The numbers.
    pub fn as_slice(&self) -> &[T] {
        self.values.get(..self.count).unwrap_or_default()
    }

    /// Parameter number `index`, 0 beyond the last.
    pub fn get(&self, index: usize) -> T {
        self.values.get(index).copied().unwrap_or(T::ZERO)
    }

    /// The first `P` of them, with zeros beyond the last.
    pub(crate) fn array<const P: usize>(&self) -> [T; P] {
        core::array::from_fn(|index| self.get(index))
    }
}

impl<T: Real, const P: usize> From<[T; P]> for Parameters<T> {
    fn from(values: [T; P]) -> Self {
        const { assert!(P >= 1 && P <= MAX_PARAMETERS, "one to four parameters") };
        Self {
            values: core::array::from_fn(|index| values.get(index).copied().unwrap_or(T::ZERO)),
            count: P,
        }
    }
}

/// A question to the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Query<T> {
    /// As many as the model has.
    pub parameters: Parameters<T>,
    /// How the answer is computed.
    pub method: Method,
    /// Answer outside the sampled domain too, instead of with an error.
    pub extrapolate: bool,
    /// Step of [`Method::Paper`], > 0, in the model's unit of time; a thousandth of its end time if none is given.
    pub step: Option<T>,
    /// How [`Method::Paper`] steps.
    pub scheme: Scheme,
}

impl<T: Real> Query<T> {
    /// A query within the domain, with forward Euler steps.
    pub fn new(parameters: impl Into<Parameters<T>>, method: Method) -> Self {
        Self {
            parameters: parameters.into(),
            method,
            extrapolate: false,
            step: None,
            scheme: Scheme::Euler,
        }
    }
}

/// An explicit scheme of Runge and Kutta.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// Forward Euler, first order, as the paper (eq. 48).
    Euler,
    /// Second order.
    Heun,
    /// The classical one of fourth order.
    RungeKutta4,
}

impl Scheme {
    /// Its stages: how far into the step each is taken, along the stage before it, and what its weight is 1 divided by.
    pub(crate) const fn stages(self) -> &'static [(f32, f32)] {
        match self {
            Self::Euler => &[(0.0, 1.0)],
            Self::Heun => &[(0.0, 2.0), (1.0, 2.0)],
            Self::RungeKutta4 => &[(0.0, 6.0), (0.5, 3.0), (0.5, 3.0), (1.0, 6.0)],
        }
    }
}

/// Where parameters lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    /// Within the sampled ranges and below the steady limit, where there is one.
    Inside,
    /// Within the sampled ranges, at a Ca that has no steady state.
    BeyondSteadyLimit,
    /// Within the ranges of scattered samples, but farther from the samples than any of them is from the others.
    FarFromSamples,
    /// Outside the sampled ranges.
    Outside,
}
