//! What is asked: parameters, method, and whether extrapolation is wanted.

use crate::Real;
pub use crate::model::wire::Method;

/// A question to the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Query<T> {
    /// Ca = mu V / G_s, > 0.
    pub capillary_number: T,
    /// a/l, > 0.
    pub confinement: T,
    /// How the answer is computed.
    pub method: Method,
    /// Answer outside the sampled domain too, instead of with an error.
    pub extrapolate: bool,
    /// Step of [`Method::Paper`] in l/V, > 0.
    pub step: T,
}

impl<T: Real> Query<T> {
    /// A query within the domain, with the step 0.02 l/V.
    pub fn new(capillary_number: T, confinement: T, method: Method) -> Self {
        Self {
            capillary_number,
            confinement,
            method,
            extrapolate: false,
            step: T::from_f32(0.02),
        }
    }
}

/// Where a pair of parameters lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    /// Within the sampled ranges and below the steady limit.
    Inside,
    /// Within the sampled ranges, at a Ca that has no steady state.
    BeyondSteadyLimit,
    /// Outside the sampled ranges.
    Outside,
}
