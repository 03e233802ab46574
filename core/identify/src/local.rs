//! The model beside a fit as a polynomial of second degree in [ln Ca, a/l]: then the least sum of squares for given
//! parameters is a polynomial too, and an interval costs next to nothing.

use crate::curve::MAX_HALF;
use crate::domain::Side;
use crate::fit::{Fit, Fitter};
use crate::residuals::{Data, Place};
use crate::shapes::{SCALARS, Shape};
use capsule_core::EvaluateError;

/// Monomials: 1, x, y, x^2, x y, y^2.
const TERMS: usize = 6;
/// How far beyond its places the polynomial counts, in their distance.
const REACH: f64 = 1.3;

/// The sum of squares beside a fit.
#[derive(Clone, Debug)]
pub(crate) struct Local {
    theta: [f64; 2],
    steps: [f64; 2],
    /// Products of the terms' residuals, the nuisance parameters eliminated.
    products: [[f64; TERMS]; TERMS],
}

impl Local {
    /// The least sum at a place; none beyond the reach.
    pub(crate) fn sum(&self, theta: [f64; 2]) -> Option<f64> {
        let [x, y] = [0, 1].map(|d| (theta[d] - self.theta[d]) / self.steps[d]);
        if x.abs().max(y.abs()) > REACH {
            return None;
        }
        let terms = [1.0, x, y, x * x, x * y, y * y];
        let row = |i: usize| -> f64 {
            self.products[i]
                .iter()
                .zip(terms)
                .map(|(product, term)| product * term)
                .sum()
        };
        Some((0..TERMS).map(|i| terms[i] * row(i)).sum())
    }
}

impl Fitter<'_, '_, '_> {
    /// The polynomial through the fit and eight places around it, `steps` from it in either parameter; none if one of
    /// them lies outside the domain.
    pub(crate) fn local(
        &mut self,
        data: &Data<'_>,
        fit: &Fit,
        steps: [f64; 2],
    ) -> Result<Option<Local>, EvaluateError> {
        const PLACES: [[f64; 2]; 8] = [
            [-1.0, 0.0],
            [1.0, 0.0],
            [0.0, -1.0],
            [0.0, 1.0],
            [-1.0, -1.0],
            [1.0, 1.0],
            [-1.0, 1.0],
            [1.0, -1.0],
        ];
        let place = |[x, y]: [f64; 2]| [fit.theta[0] + x * steps[0], fit.theta[1] + y * steps[1]];
        if !PLACES.iter().all(|at| self.inside(fit.side, place(*at))) {
            return Ok(None);
        }
        // Outward movement of the curve's points and change of the scalars: the coefficients of the monomials but 1.
        let mut outward = [[0.0; TERMS - 1]; MAX_HALF];
        let mut of_section = [[0.0; TERMS - 1]; MAX_HALF];
        let mut scalars = [[0.0; TERMS - 1]; SCALARS];
        for at in PLACES {
            let Shape {
                curve,
                section,
                scalars: there,
                ..
            } = self.shapes.at(place(at))?;
            for (i, (sums, point)) in outward.iter_mut().zip(fit.shape.curve.points()).enumerate() {
                add(sums, at, -curve.nearest_from(i, *point).distance);
            }
            if !data.line.is_empty() {
                for (i, (sums, point)) in of_section.iter_mut().zip(fit.shape.section.points()).enumerate() {
                    add(sums, at, -section.nearest_from(i, *point).distance);
                }
            }
            for (sums, (there, here)) in scalars.iter_mut().zip(there.iter().zip(&fit.shape.scalars)) {
                add(sums, at, there - here);
            }
        }
        let columns = |residual: f64, place: Place| {
            let own = place.value(&fit.shape, [&outward, &of_section], &scalars);
            let mut terms = [residual; TERMS];
            terms.iter_mut().skip(1).zip(own).for_each(|(term, own)| *term = -own);
            terms
        };
        let eliminated = data.products(&fit.shape, &fit.nuisances, columns).eliminate();
        Ok(eliminated.map(|eliminated| Local {
            theta: fit.theta,
            steps,
            products: eliminated.leading,
        }))
    }

    pub(crate) fn inside(&self, side: Side, [ca, confinement]: [f64; 2]) -> bool {
        let [low, high] = self.domain.confinements();
        let range = self.domain.range(side, confinement);
        (low..=high).contains(&confinement) && range.is_some_and(|[low, high]| (low..=high).contains(&ca))
    }
}

/// Adds what a value at a place, in steps from the fit, tells of the coefficients of x, y, x^2, x y, y^2.
fn add(sums: &mut [f64; TERMS - 1], [x, y]: [f64; 2], value: f64) {
    if y == 0.0 {
        sums[0] += 0.5 * x * value;
        sums[2] += 0.5 * value;
    } else if x == 0.0 {
        sums[1] += 0.5 * y * value;
        sums[4] += 0.5 * value;
    } else {
        sums[3] += 0.25 * x * y * value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_are_those_of_the_polynomial() {
        let value = |x: f64, y: f64| 0.3 * x - 0.7 * y + 1.1 * x * x + 0.4 * x * y - 2.0 * y * y;
        let mut sums = [0.0; 5];
        for x in [-1.0, 0.0, 1.0] {
            for y in [-1.0, 0.0, 1.0] {
                if [x, y] != [0.0, 0.0] {
                    add(&mut sums, [x, y], value(x, y));
                }
            }
        }
        for (found, exact) in sums.into_iter().zip([0.3, -0.7, 1.1, 0.4, -2.0]) {
            assert!((found - exact).abs() < 1e-15, "{found} {exact}");
        }
    }
}
