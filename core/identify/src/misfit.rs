//! How badly each capsule of the model fits a measurement: the profile of the sum of squares over the domain.

use crate::domain::{Domain, Side};
use crate::fit::Fitter;
use crate::local::Local;
use crate::noise::Bins;
use crate::profile::Profile;
use crate::residuals::{Data, NUISANCES};
use crate::shapes::{Shape, Shapes};
use capsule_core::EvaluateError;

/// The most steps in which the nuisance parameters are fitted at a place.
const STEPS: usize = 4;
/// A change of the sum that ends them, as a share of it.
const CLOSE: f64 = 1e-3;

/// The sum of squares of a measurement at any Ca and a/l, each with the nuisance parameters that suit it best.
///
/// The noise and the scale of the model's error are those of the best fit, so that sums are comparable.
#[derive(Clone, Debug)]
pub struct Misfit {
    data: Data<'static>,
    bins: Bins,
    line: Bins,
    nuisances: [f64; NUISANCES],
    /// The best fit, [ln Ca, a/l], and its sum.
    theta: [f64; 2],
    sum: f64,
    /// The sum beside the best fit, where the intervals take it from.
    local: Option<Local>,
    /// Covariance of [ln Ca, a/l] by the measurement, and the variances that the model's own parameters add.
    covariance: Option<[[f64; 2]; 2]>,
    own: [f64; 2],
    /// Degrees of freedom of the noise, where it is an estimate.
    freedom: Option<f64>,
}

impl Misfit {
    pub(crate) fn of(profile: &Profile<'_>, freedom: Option<f64>) -> Self {
        Self {
            data: Data {
                points: &[],
                line: &[],
                ..profile.data
            },
            bins: Bins::of(profile.data.points),
            line: Bins::of(profile.data.line),
            nuisances: profile.fit.nuisances,
            theta: profile.fit.theta,
            sum: profile.sum,
            local: profile.local.clone(),
            covariance: profile.fit.reduced.covariance(),
            own: profile.model_parameters.map(|deviation| deviation * deviation),
            freedom,
        }
    }

    /// By how much the sum of squares is greater at [ln Ca, a/l] than at the best fit; none outside the domain.
    ///
    /// It is as the intervals have it: errors of the model that look like another capsule make it smaller, by the ratio
    /// of d^T (C + M)^-1 d to d^T C^-1 d, with the distance d from the best fit, the covariance C of the measurement
    /// and M of these errors. A little less than 0 is possible: outlines are rounded.
    ///
    /// # Errors
    /// Those of the model's evaluation.
    pub fn rise(&self, shapes: &mut Shapes<'_, '_>, theta: [f64; 2]) -> Result<Option<f64>, EvaluateError> {
        let domain = Domain::new(shapes.model()).ok_or(EvaluateError::UnsupportedReference)?;
        let fitter = Fitter { shapes, domain };
        if ![Side::Smooth, Side::Dented]
            .into_iter()
            .any(|side| fitter.inside(side, theta))
        {
            return Ok(None);
        }
        let sum = match self.local.as_ref().and_then(|local| local.sum(theta)) {
            Some(sum) => sum,
            None => self.profiled(&fitter.shapes.at(theta)?),
        };
        Ok(sum.is_finite().then(|| (sum - self.sum) * self.shrinkage(theta)))
    }

    /// The least sum of a shape.
    fn profiled(&self, shape: &Shape) -> f64 {
        let data = Data {
            points: self.bins.all(),
            line: self.line.all(),
            ..self.data
        };
        let (mut nuisances, mut sum) = (self.nuisances, f64::INFINITY);
        for _ in 0..STEPS {
            let Some((next, to)) = Fitter::profiled(&data, shape, &nuisances) else {
                break;
            };
            let change = (next - sum).abs();
            (sum, nuisances) = (next, to);
            if change < CLOSE * sum {
                break;
            }
        }
        sum
    }

    /// The ratio by which errors that look like another capsule make a rise smaller.
    fn shrinkage(&self, theta: [f64; 2]) -> f64 {
        let Some([[p, q], [_, r]]) = self.covariance else {
            return 1.0;
        };
        let [x, y] = [0, 1].map(|d| theta[d] - self.theta[d]);
        // d^T [[p, q], [q, r]]^-1 d
        let square = |p: f64, r: f64| (r * x * x - 2.0 * q * x * y + p * y * y) / (p * r - q * q);
        let measured = square(p, r);
        if measured > 0.0 {
            square(p + self.own[0], r + self.own[1]) / measured
        } else {
            1.0
        }
    }

    /// The rise at the border of the region that holds the true Ca and a/l with a probability: chi-squared with two
    /// degrees of freedom, 2.30 for 68.27 % and 5.99 for 95 %. Where the noise is an estimate from nu degrees of
    /// freedom, twice Fisher's F with 2 and nu: nu ((1 - p)^(-2 / nu) - 1).
    pub fn level(&self, probability: f64) -> f64 {
        let logarithm = -2.0 * libm::log1p(-probability);
        match self.freedom {
            Some(freedom) => freedom * libm::expm1(logarithm / freedom),
            None => logarithm,
        }
    }
}
