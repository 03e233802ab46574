//! Parameters of a query or of a sample.

use super::wire::{MAX_PARAMETERS, Parameter};
use crate::Real;

/// The parameters of a query or of a sample, in the order of the model's: (Ca, a/l) for a capsule in the channel, one
/// to [`MAX_PARAMETERS`] numbers of other meaning for other models.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters<T> {
    values: [T; MAX_PARAMETERS],
    /// Rounding errors of the values.
    rests: [T; MAX_PARAMETERS],
    count: usize,
}

impl Parameters<f32> {
    /// The parameters in a slice of doubles; none unless there are one to [`MAX_PARAMETERS`]. The rounding errors of
    /// the conversion to single precision are stored too, so that values with a large offset (10000.2 in a range of
    /// 0.4) keep their precision:
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

    /// The values.
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

    /// The first `P` parameters, zeros beyond the last.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_large_offset_costs_no_precision() {
        let range = Parameter {
            origin: 10_000.0,
            scale: 0.4,
            ..Parameter::default()
        };
        let scaled = |parameters: Parameters<f32>| parameters.scaled(&[range]).get(0);
        let exact = Parameters::from_doubles(&[10_000.2]).map(scaled);
        assert!(exact.is_some_and(|value| (value - 0.5).abs() < 1e-6), "{exact:?}");
        // Single precision has a step of 1e-3 there.
        assert!((scaled(Parameters::from([10_000.2_f32])) - 0.5).abs() > 1e-4);
    }
}
