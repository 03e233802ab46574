//! The model's own error along an outline: what is known of it before the measurement, and its size from the residuals.
//!
//! It is a sum of cosines of the place along the curve. Their coefficients are normal with the standard deviations
//! s B sigma_k: B is the model's 95 % bound at the place, sigma_k the spectrum, s the scale at this capsule. The bound
//! holds for 95 of 100 capsules, and so most errors are far below it and a few are above: s^2 is distributed as
//! nu tau^2 over a chi-squared number with nu = 2 degrees of freedom, which makes the coefficients those of Student's
//! distribution. tau follows from the bound's meaning: the root mean square of the error along the outline,
//! s B (sigma_0^2 + sum sigma_k^2 / 2)^(1/2), is below B in 95 % of the cases.

use crate::algebra::Factor;
use crate::fit::Fit;
use crate::residuals::{MODE, MODES, NUISANCES, Trace};
use crate::shapes::{Sensitivity, Shape};

/// nu, the degrees of freedom of the scale.
const FREEDOM: f64 = 2.0;
/// tau^2: the 5 % quantile of chi-squared with two degrees of freedom, -2 ln 0.95, over nu (sigma_0^2 + sum sigma_k^2 /
/// 2), the mean square for s = 1.
const SQUARE: f64 = 0.3725;

/// The scale s that makes a fit likeliest, from one it was made with: a step of expectation and maximisation (Dempster,
/// Laird, Rubin, 1977). The expected squares of the coefficients are those of the fit and their variances.
pub(crate) fn scale(fit: &Fit, before: f64) -> f64 {
    let (Some(factor), Some(covariance)) = (Factor::new(&fit.nuisance_matrix), fit.reduced.covariance()) else {
        return before;
    };
    let squares: f64 = (MODE..NUISANCES)
        .map(|i| {
            // The variance at fixed Ca and a/l, and that with theirs.
            let [a, b] = fit.reduced.by_parameters(i);
            let [[p, q], [_, r]] = covariance;
            let variance = factor.inverse_column(i)[i] + a * a * p + 2.0 * a * b * q + b * b * r;
            (fit.nuisances[i] * fit.nuisances[i] + variance) * fit.priors[i]
        })
        .sum();
    let square = before * before * squares;
    libm::sqrt((FREEDOM * SQUARE + square) / (FREEDOM + MODES as f64))
}

/// Standard deviations of the model's parameters: an error of the interpolation may have the form of another capsule's
/// outline, which no measurement can tell from one. Its size is the expected error, root mean square along the outline,
/// shared by both parameters.
pub(crate) fn of_parameters(shape: &Shape, sensitivity: &Sensitivity) -> [f64; 2] {
    let curve = &shape.curve;
    let count = curve.count();
    let mut squares = [0.0; 2];
    for i in 0..count {
        let outward = sensitivity.outward(Trace::Outline, i as f64, curve.normal(i));
        (0..2).for_each(|d| squares[d] += 0.5 * outward[d] * outward[d] / count as f64);
    }
    // Half of the square each: (E^2 / 2) / (2 squares).
    squares.map(|square| 0.5 * shape.expected_error / libm::sqrt(square.max(f64::MIN_POSITIVE)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::residuals::spectrum;

    #[test]
    fn the_bound_is_that_of_95_of_100_scales() {
        // The mean square of a cosine is 1/2, that of the constant 1.
        let sum: f64 = (0..MODES)
            .map(|k| spectrum(k) * spectrum(k) * if k == 0 { 1.0 } else { 0.5 })
            .sum();
        let quantile = -2.0 * libm::log(0.95);
        let exact = quantile / (FREEDOM * sum);
        assert!((SQUARE / exact - 1.0).abs() < 1e-3, "{SQUARE} {exact}");
    }
}
