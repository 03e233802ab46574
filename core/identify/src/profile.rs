//! Intervals from the profile of the sum of squares: how far a quantity can be from its best value before the best sum
//! that goes with it has risen by the square of a standard normal quantile.

use crate::fit::{Fit, Fitter};
use crate::local::Local;
use crate::residuals::Data;
use capsule_core::EvaluateError;

/// Ends of an interval; one that is open lies at the edge of the domain and says nothing of what is beyond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The lower end.
    pub low: f64,
    /// The upper end.
    pub high: f64,
    /// Which of them are open.
    pub open: [bool; 2],
}

impl Interval {
    pub(crate) fn map(self, f: impl Fn(f64) -> f64) -> Self {
        let [a, b] = [f(self.low), f(self.high)];
        if a <= b {
            Self {
                low: a,
                high: b,
                ..self
            }
        } else {
            Self {
                low: b,
                high: a,
                open: [self.open[1], self.open[0]],
            }
        }
    }

    /// Whether a value lies within; an open end excludes nothing.
    pub fn contains(&self, value: f64) -> bool {
        let [low, high] = self.open;
        (low || self.low <= value) && (high || value <= self.high)
    }
}

/// The likelihood that intervals are computed from.
pub(crate) struct Profile<'p> {
    /// The data of the fit, or bins of them.
    pub(crate) data: Data<'p>,
    pub(crate) fit: &'p Fit,
    /// Their least sum.
    pub(crate) sum: f64,
    /// The sum beside the fit, if it is known.
    pub(crate) local: Option<Local>,
    /// Standard deviations of the model's own parameters: see `model_error`.
    pub(crate) model_parameters: [f64; 2],
}

/// Sum of squares and place with the best value of the other parameter.
struct Best {
    rise: f64,
    theta: [f64; 2],
}

impl Fitter<'_, '_, '_> {
    /// Intervals of a quantity of [ln Ca, a/l] for several quantiles, relative to its value at the fit.
    pub(crate) fn intervals<const Q: usize>(
        &mut self,
        profile: &Profile<'_>,
        gradient: [f64; 2],
        quantiles: [f64; Q],
    ) -> Result<Option<[Interval; Q]>, EvaluateError> {
        let fit = profile.fit;
        let Some(covariance) = fit.reduced.covariance() else {
            return Ok(None);
        };
        let g = gradient;
        // Along C g the other parameter is at its best for each value of the quantity.
        let along = [0, 1].map(|d| covariance[d][0] * g[0] + covariance[d][1] * g[1]);
        let deviation = libm::sqrt(g[0] * along[0] + g[1] * along[1]);
        if deviation.is_nan() || deviation <= 0.0 {
            return Ok(None);
        }
        let along = along.map(|x| x / deviation);
        let across = [-g[1], g[0]];
        let [[a, b], [_, c]] = fit.reduced.matrix;
        let square = a * across[0] * across[0] + 2.0 * b * across[0] * across[1] + c * across[1] * across[1];
        let across = across.map(|x| x / libm::sqrt(square.max(f64::MIN_POSITIVE)));
        let mut intervals = [Interval {
            low: 0.0,
            high: 0.0,
            open: [false; 2],
        }; Q];
        for (end, sign) in [-1.0, 1.0].into_iter().enumerate() {
            for (interval, quantile) in intervals.iter_mut().zip(quantiles) {
                let (value, open) = self.end(profile, [along, across], g, sign, quantile)?;
                interval.open[end] = open;
                // The model's own error of the quantity is independent of the rest.
                let own =
                    quantile * libm::hypot(g[0] * profile.model_parameters[0], g[1] * profile.model_parameters[1]);
                let value = if open { value } else { sign * libm::hypot(value, own) };
                *(if end == 0 {
                    &mut interval.low
                } else {
                    &mut interval.high
                }) = value;
            }
        }
        Ok(Some(intervals))
    }

    /// One end: the quantity's change, and whether it is open.
    fn end(
        &mut self,
        profile: &Profile<'_>,
        [along, across]: [[f64; 2]; 2],
        gradient: [f64; 2],
        sign: f64,
        quantile: f64,
    ) -> Result<(f64, bool), EvaluateError> {
        const TRIALS: usize = 8;
        let fit = profile.fit;
        const CLOSE: f64 = 0.02;
        let change =
            |theta: [f64; 2]| gradient[0] * (theta[0] - fit.theta[0]) + gradient[1] * (theta[1] - fit.theta[1]);
        // The root of the rise grows about as the distance does.
        let (mut inner, mut outer) = ([0.0, 0.0], None::<[f64; 2]>);
        let mut last = fit.theta;
        let mut distance = quantile;
        for _ in 0..TRIALS {
            let place = [0, 1].map(|d| fit.theta[d] + sign * distance * along[d]);
            let Some(best) = self.best(profile, place, across)? else {
                // Beyond the domain: halfway back, and the edge if that is close.
                outer = Some([distance, f64::INFINITY]);
                if distance - inner[0] < CLOSE * quantile {
                    return Ok((change(last), true));
                }
                distance = 0.5 * (inner[0] + distance);
                continue;
            };
            let root = libm::sqrt(best.rise.max(0.0));
            if (root - quantile).abs() < CLOSE * quantile {
                // The remainder is subtracted in proportion.
                return Ok((change(best.theta) * quantile / root, false));
            }
            if root < quantile {
                inner = [distance, root];
                last = best.theta;
            } else {
                outer = Some([distance, root]);
            }
            distance = match outer {
                Some([far, high]) if high.is_finite() => {
                    let share = (quantile - inner[1]) / (high - inner[1]);
                    inner[0] + share.clamp(0.05, 0.95) * (far - inner[0])
                }
                Some([far, _]) => 0.5 * (inner[0] + far),
                None => distance * (quantile / root.max(0.1 * quantile)).clamp(1.02, 3.0),
            };
        }
        let open = outer.is_none_or(|[_, high]| !high.is_finite());
        // The quantity's change along C g, by which a unit of distance is a standard deviation.
        let unit = gradient[0] * along[0] + gradient[1] * along[1];
        Ok((sign * distance * unit, open))
    }

    /// The best place across from one: the least of a parabola through three.
    fn best(
        &mut self,
        profile: &Profile<'_>,
        place: [f64; 2],
        across: [f64; 2],
    ) -> Result<Option<Best>, EvaluateError> {
        const WAY: f64 = 0.7;
        let at = |s: f64| [place[0] + s * across[0], place[1] + s * across[1]];
        let rise = |fitter: &mut Self, theta: [f64; 2]| -> Result<Option<f64>, EvaluateError> {
            let Profile {
                data, fit, sum, local, ..
            } = profile;
            if !fitter.inside(fit.side, theta) {
                return Ok(None);
            }
            let found = match local.as_ref().and_then(|local| local.sum(theta)) {
                Some(found) => Some(found),
                None => Self::profiled(data, &fitter.shapes.at(theta)?, &fit.nuisances).map(|(found, _)| found),
            };
            Ok(found.map(|found| found - sum))
        };
        let mut shift = 0.0;
        let mut least: Option<Best> = None;
        for _ in 0..2 {
            let [Some(before), Some(middle), Some(after)] = [
                rise(self, at(shift - WAY))?,
                rise(self, at(shift))?,
                rise(self, at(shift + WAY))?,
            ] else {
                break;
            };
            let curvature = before - 2.0 * middle + after;
            let slope = 0.5 * (after - before);
            let to = if curvature > 0.0 { -slope / curvature } else { 0.0 };
            let value = middle + slope * to + 0.5 * curvature * to * to;
            let there = shift + WAY * to.clamp(-2.0, 2.0);
            if least.as_ref().is_none_or(|least| value < least.rise) {
                least = Some(Best {
                    rise: value,
                    theta: at(there),
                });
            }
            if to.abs() <= 1.5 {
                break;
            }
            shift = there;
        }
        if least.is_none() {
            // Beside an edge of the domain: what there is of the line across.
            for step in -4..=4 {
                let theta = at(f64::from(step) * WAY);
                if let Some(value) = rise(self, theta)?
                    && least.as_ref().is_none_or(|least| value < least.rise)
                {
                    least = Some(Best { rise: value, theta });
                }
            }
        }
        Ok(least)
    }
}
