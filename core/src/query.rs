//! What is asked: parameters, method, and whether extrapolation is wanted.

use crate::Real;
use crate::model::wire::Parameter;
pub use crate::model::wire::{MAX_PARAMETERS, Method};

/// The parameters of a query or of a sample, in the order of the model's: (Ca, a/l) for a capsule in the channel, one
/// to [`MAX_PARAMETERS`] numbers of other meaning for other models.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters<T> {
    values: [T; MAX_PARAMETERS],
    /// Remainders of the rounding of the values to `T`.
    rests: [T; MAX_PARAMETERS],
    count: usize,
}

impl Parameters<f32> {
    /// The parameters in a slice of doubles; none unless there are one to [`MAX_PARAMETERS`]. Their rounding to single
    /// precision is kept beside them, so that values with a large offset (10000.2 in a range of 0.4) lose nothing:
    ///
    /// ```
    /// use capsule_core::Parameters;
    ///
    /// assert_ne!(Parameters::from_doubles(&[10000.2]), Parameters::new(&[10000.2_f32]));
    /// assert_eq!(Parameters::from_doubles(&[0.25]), Parameters::new(&[0.25_f32]));
    /// ```
    pub fn from_doubles(values: &[f64]) -> Option<Self> {
        let single = |index: usize| values.get(index).map_or(0.0, |value| *value as f32);
        let singles: [f32; MAX_PARAMETERS] = core::array::from_fn(single);
        let parameters = Self::new(singles.get(..values.len())?)?;
        let rest = |index: usize| {
            values
                .get(index)
                .map_or(0.0, |value| (value - f64::from(single(index))) as f32)
        };
        Some(Self {
            rests: core::array::from_fn(rest),
            ..parameters
        })
    }
}

impl<T: Real> Parameters<T> {
    /// The parameters in a slice; none unless there are one to [`MAX_PARAMETERS`].
    pub fn new(values: &[T]) -> Option<Self> {
        let mut parameters = Self {
            values: [T::ZERO; MAX_PARAMETERS],
            rests: [T::ZERO; MAX_PARAMETERS],
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

    /// The scaled parameters, (value - origin) / scale.
    pub(crate) fn scaled(&self, ranges: &[Parameter<'_>]) -> Self {
        let mut scaled = Self {
            rests: [T::ZERO; MAX_PARAMETERS],
            ..*self
        };
        for ((value, rest), range) in scaled.values.iter_mut().zip(&self.rests).zip(ranges) {
            *value = ((*value - T::from_f64(range.origin)) + *rest) / T::from_f64(range.scale);
        }
        scaled
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
            rests: [T::ZERO; MAX_PARAMETERS],
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

/// Where parameters lie. Errors are calibrated [`Inside`](Self::Inside): everywhere else an answer is an extrapolation,
/// its expected error a guess, and it has no bound.
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

impl Domain {
    /// Its name in JSON and in JavaScript.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Inside => "inside",
            Self::BeyondSteadyLimit => "beyond-steady-limit",
            Self::FarFromSamples => "far-from-samples",
            Self::Outside => "outside",
        }
    }
}
