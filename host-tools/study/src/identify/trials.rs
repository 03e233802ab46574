//! Contours of known capsules, identified.

use std::time::Instant;

use capsule_identify::{
    Contour, Direction, Estimate, Flow, Grid, Identification, Lengths, Measured, Measurement, Point, Priors, Sequence,
    SequenceIdentification, Setup, Shapes, Verdict, identify, identify_sequence,
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

impl Known {
    fn contour<'a>(&self, points_um: &'a [[f64; 2]]) -> Contour<'a> {
        Contour {
            points_um,
            direction: Direction::Right,
            noise_um: self.noise_um,
        }
    }
}

/// The answer of an identification, from one contour or from several.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Found {
    pub(crate) capillary_number: Estimate,
    pub(crate) confinement: Estimate,
    /// Of ln Ca and a/l.
    pub(crate) deviations: [f64; 2],
    /// That of a single contour.
    structure: Option<f64>,
    pub(crate) verdict: Verdict,
    pub(crate) evaluations: u32,
}

impl From<Identification> for Found {
    fn from(found: Identification) -> Self {
        Self {
            capillary_number: found.capillary_number,
            confinement: found.confinement,
            deviations: found.deviations,
            structure: Some(found.structure),
            verdict: found.verdict,
            evaluations: found.evaluations,
        }
    }
}

impl From<SequenceIdentification> for Found {
    fn from(found: SequenceIdentification) -> Self {
        Self {
            capillary_number: found.capillary_number,
            confinement: found.confinement,
            deviations: found.deviations,
            structure: None,
            verdict: found.verdict,
            evaluations: found.evaluations,
        }
    }
}

/// An identification and its truth.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Trial {
    pub(crate) truth: [f64; 2],
    pub(crate) found: Found,
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
        ];
        let number = |number: f64| format!("{number:.6}");
        let texts = [observable.to_owned(), series.to_owned(), pixels.to_string()].into_iter();
        let last = [
            found.structure.map_or(String::new(), number),
            found.verdict.name().to_owned(),
        ];
        texts.chain(numbers.map(number)).chain(last).collect()
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

/// Identifies a capsule from a contour and the line of a dent, which may be empty, in um.
pub(crate) fn by_contour(
    shapes: &mut Shapes<'_, '_>,
    grid: &Grid,
    points: &mut [Point],
    truth: [f64; 2],
    [drawn, line]: [&[[f64; 2]]; 2],
    known: &Known,
) -> Result<Trial, StudyError> {
    let measurement = Measurement {
        setup: setup(known.half_width_um),
        contour: Some(known.contour(drawn)),
        dent_line_um: line,
        lengths: Lengths::default(),
        priors: known.priors,
    };
    let start = Instant::now();
    let found = identify(shapes, grid, &measurement, points)?;
    Ok(Trial {
        truth,
        found: found.into(),
        seconds: start.elapsed().as_secs_f64(),
    })
}

/// Identifies a capsule from contours of several frames, in um, steady ones or ones of its transient.
pub(crate) fn by_frames(
    shapes: &mut Shapes<'_, '_>,
    grid: &Grid,
    points: &mut [Point],
    truth: [f64; 2],
    (drawn, steady): (&[Vec<[f64; 2]>], bool),
    known: &Known,
) -> Result<Trial, StudyError> {
    let contours: Vec<Contour<'_>> = drawn.iter().map(|points_um| known.contour(points_um)).collect();
    let sequence = Sequence {
        setup: setup(known.half_width_um),
        contours: &contours,
        priors: known.priors,
        steady,
    };
    let start = Instant::now();
    let found = identify_sequence(shapes, grid, &sequence, points)?;
    Ok(Trial {
        truth,
        found: found.into(),
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
        dent_line_um: &[],
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
        found: found.into(),
        seconds: start.elapsed().as_secs_f64(),
    })
}
