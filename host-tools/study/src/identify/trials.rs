//! Contours of known capsules, identified.

use std::time::Instant;

use capsule_identify::{
    Contour, Direction, Flow, Grid, Identification, Lengths, Measured, Measurement, Point, Priors, Setup, Shapes,
    identify,
};

use super::truth::{HALF_WIDTH_UM, Truth, normal};
use crate::StudyError;
use crate::random::Random;

/// Known quantities of a trial beside the contour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Known {
    pub(crate) priors: Priors,
    /// The contour's noise, where it is told.
    pub(crate) noise_um: Option<f64>,
    /// Half the channel's side, as it is told.
    pub(crate) half_width_um: f64,
}

/// An identification and its truth.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Trial {
    pub(crate) truth: [f64; 2],
    pub(crate) found: Identification,
    pub(crate) seconds: f64,
}

impl Trial {
    /// Relative errors of Ca and a.
    pub(crate) fn errors(&self) -> [f64; 2] {
        let [ca, confinement] = self.truth;
        [
            self.found.capillary_number.value / ca - 1.0,
            self.found.confinement.value / confinement - 1.0,
        ]
    }

    /// Its row in the table of all trials.
    pub(crate) fn row(&self, observable: &str, series: &str, pixels: f64) -> Vec<String> {
        let found = &self.found;
        let (ca, confinement) = (found.capillary_number, found.confinement);
        let numbers = [
            self.truth[0],
            self.truth[1],
            ca.value,
            confinement.value,
            ca.interval_95.low,
            ca.interval_95.high,
            confinement.interval_95.low,
            confinement.interval_95.high,
            found.structure,
        ];
        let texts = [observable.to_owned(), series.to_owned(), pixels.to_string()].into_iter();
        let numbers = numbers.iter().map(|number| format!("{number:.6}"));
        texts.chain(numbers).chain([found.verdict.name().to_owned()]).collect()
    }

    /// Whether the intervals of 68 and 95 % hold the true Ca and a.
    pub(crate) fn holds(&self) -> [[bool; 2]; 2] {
        let [ca, confinement] = self.truth;
        [(self.found.capillary_number, ca), (self.found.confinement, confinement)].map(|(estimate, truth)| {
            [
                estimate.interval_68.contains(truth),
                estimate.interval_95.contains(truth),
            ]
        })
    }
}

fn setup(half_width_um: f64) -> Setup {
    Setup {
        half_width_um,
        flow: Flow::MeanVelocity(5e-3),
        viscosity_pa_s: 0.8,
    }
}

/// Identifies a capsule from a contour, in um.
pub(crate) fn by_contour(
    shapes: &mut Shapes<'_, '_>,
    grid: &Grid,
    points: &mut [Point],
    truth: [f64; 2],
    drawn: &[[f64; 2]],
    known: &Known,
) -> Result<Trial, StudyError> {
    let measurement = Measurement {
        setup: setup(known.half_width_um),
        contour: Some(Contour {
            points_um: drawn,
            direction: Direction::Right,
            noise_um: known.noise_um,
        }),
        lengths: Lengths::default(),
        priors: known.priors,
    };
    let start = Instant::now();
    let found = identify(shapes, grid, &measurement, points)?;
    Ok(Trial {
        truth,
        found,
        seconds: start.elapsed().as_secs_f64(),
    })
}

/// Identifies a capsule from its length, half width and rear depth, measured to a pixel.
pub(crate) fn by_lengths(
    shapes: &mut Shapes<'_, '_>,
    grid: &Grid,
    truth: &Truth,
    deviation_um: f64,
    random: &mut Random,
) -> Result<Trial, StudyError> {
    let [length, half_width, rear_depth, _] = truth.scalars.map(|value| {
        Some(Measured {
            value: (value * HALF_WIDTH_UM + deviation_um * normal(random)).max(0.0),
            deviation: deviation_um,
        })
    });
    let measurement = Measurement {
        setup: setup(HALF_WIDTH_UM),
        contour: None,
        lengths: Lengths {
            axial_length_um: length,
            half_width_um: half_width,
            rear_depth_um: rear_depth,
            ..Lengths::default()
        },
        priors: Priors {
            edge_um: 0.0,
            scale: 0.0,
            ..Priors::of_pixel(deviation_um)
        },
    };
    let start = Instant::now();
    let found = identify(shapes, grid, &measurement, &mut [])?;
    Ok(Trial {
        truth: truth.parameters,
        found,
        seconds: start.elapsed().as_secs_f64(),
    })
}
