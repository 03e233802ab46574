//! The parts of an identification that its steps share.

use crate::fit::Fitter;
use crate::measurement::{Measured, Measurement};
use crate::residuals::{Data, Point};
use crate::shapes::SCALARS;

/// Deviations of scale or edge that are too many.
pub(crate) const SIGNIFICANT: f64 = 3.0;

pub(crate) struct Solver<'f, 'a, 'w, 'm> {
    pub(crate) fitter: Fitter<'f, 'a, 'w>,
    pub(crate) measurement: &'m Measurement<'m>,
    pub(crate) scalars: [Option<Measured>; SCALARS],
}

impl Solver<'_, '_, '_, '_> {
    pub(crate) fn data<'p>(&self, points: &'p [Point], noise: f64) -> Data<'p> {
        let measurement = self.measurement;
        Data::new(
            points,
            self.scalars,
            &measurement.priors,
            measurement.setup.half_width_um,
            noise,
        )
    }

    /// Noise in l before the residuals tell it.
    pub(crate) fn first_noise(&self) -> f64 {
        let half_width = self.measurement.setup.half_width_um;
        let given = self.measurement.contour.and_then(|contour| contour.noise_um);
        let noise = given.unwrap_or(2.0 * self.measurement.priors.edge_um) / half_width;
        noise.max(0.003)
    }
}
