//! The series of trials: outlines of the full-order model or the model's own, the way they are seen, and what is known.

use capsule_core::{Domain, Model};
use capsule_identify::{Grid, Observable, Point, Priors, Shapes};

use super::raster;
use super::trials::{Known, Trial, by_contour, by_frames, by_lengths};
use super::truth::{Drawing, HALF_WIDTH_UM, Truth, contour, contour_and_line, normal};
use crate::StudyError;
use crate::random::Random;

/// Pixels per l, unless a series says otherwise.
const PIXELS: f64 = 100.0;
/// Pixels per l of the series over the size of a pixel: 0.2, 0.5 and 1 um in a channel of 50 um.
const COARSER: [f64; 3] = [125.0, 50.0, 25.0];
/// Noise of the pictures, of the contrast.
const PICTURE_NOISE: f64 = 0.02;
/// The seed of all trials.
const SEED: u64 = 7;

/// Where a trial's outline comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum From {
    FullOrder,
    Own,
    Lengths,
    /// A picture of the full-order model's outline, in which it is found.
    Picture,
    /// The full-order model's silhouette and the line of its dent, if it has one.
    DentLine,
    /// Three frames of the steady capsule.
    Steady,
    /// Three frames of its transient, whose instants are not told.
    Transient,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Plan {
    pub(super) name: &'static str,
    pub(super) from: From,
    /// Pixels per l.
    pub(super) pixels: f64,
    /// Noise, in pixels, or of the contrast of a picture.
    noise: f64,
    /// Whether edge, scale and tilt are drawn at random and fitted; else they are exact and known to be.
    unknown_frame: bool,
    /// By how much the half width that is told is too great, relative.
    half_width_error: f64,
}

pub(super) fn plans() -> Vec<Plan> {
    let plan = Plan::new;
    let mut plans = vec![
        plan("no noise", From::FullOrder, 0.0, false),
        plan("no noise, frame fitted", From::FullOrder, 0.0, true),
        plan("0.1 px, own outlines", From::Own, 0.1, true),
        plan("0.1 px", From::FullOrder, 0.1, true),
        plan("1 px", From::FullOrder, 1.0, true),
        plan("lengths to 1 px", From::Lengths, 1.0, false),
        plan("0.1 px, with dent line", From::DentLine, 0.1, true),
        plan("1 px, with dent line", From::DentLine, 1.0, true),
        plan("1 px, 3 steady frames", From::Steady, 1.0, true),
        plan("1 px, 3 frames of a transient", From::Transient, 1.0, true),
    ];
    for pixels in COARSER {
        for (name, from, noise) in [
            ("0.1 px", From::FullOrder, 0.1),
            ("1 px", From::FullOrder, 1.0),
            ("picture", From::Picture, PICTURE_NOISE),
        ] {
            plans.push(Plan {
                pixels,
                ..plan(name, from, noise, true)
            });
        }
    }
    for (name, half_width_error) in [
        ("0.1 px, half width 2 % too great", 0.02),
        ("0.1 px, half width 5 % too great", 0.05),
    ] {
        plans.push(Plan {
            half_width_error,
            ..plan(name, From::FullOrder, 0.1, true)
        });
    }
    plans
}

impl Plan {
    pub(super) fn new(name: &'static str, from: From, noise: f64, unknown_frame: bool) -> Self {
        Self {
            name,
            from,
            pixels: PIXELS,
            noise,
            unknown_frame,
            half_width_error: 0.0,
        }
    }

    /// Whether an observable has the series: the dent is a part of a section's outline.
    pub(super) fn shows(&self, observable: Observable) -> bool {
        self.from != From::DentLine || observable == Observable::Silhouette
    }

    /// The trials of all truths, and how many were refused.
    pub(super) fn run(
        &self,
        model: &Model<'_>,
        truths: &[Truth],
        repeats: usize,
        (shapes, grid, points): (&mut Shapes<'_, '_>, &Grid, &mut [Point]),
    ) -> Result<(Vec<Trial>, usize), StudyError> {
        let mut random = Random(SEED);
        let (mut trials, mut refused) = (Vec::new(), 0);
        for _ in 0..if self.noise > 0.0 { repeats } else { 1 } {
            for truth in truths {
                let trial = match self.from {
                    From::Lengths => {
                        let deviation_um = self.noise * self.drawing(0.0).pixel_um();
                        by_lengths(shapes, grid, truth, deviation_um, &mut random)
                    }
                    From::Steady | From::Transient => self.by_frames(shapes, grid, points, truth, &mut random),
                    From::FullOrder | From::Own | From::Picture | From::DentLine => {
                        let drawing = self.drawn(&mut random);
                        let (parameters, outline) = if self.from == From::Own {
                            let [ca, confinement] = anywhere(model, &mut random);
                            let shape = shapes.at([ca.ln(), confinement])?;
                            let outline = (0..=2000).map(|i| shape.curve.position(f64::from(i) / 2000.0));
                            ([ca, confinement], outline.collect())
                        } else {
                            (truth.parameters, truth.outline.clone())
                        };
                        let known = self.known(&drawing);
                        let drawn = match self.from {
                            From::Picture => picture(&outline, &drawing, &mut random).map(|found| [found, Vec::new()]),
                            From::DentLine => Ok(contour_and_line([&outline, &truth.dent_line], &drawing, &mut random)),
                            _ => Ok([contour(&outline, &drawing, &mut random), Vec::new()]),
                        };
                        drawn.and_then(|[drawn, line]| {
                            by_contour(shapes, grid, points, parameters, [&drawn, &line], &known)
                        })
                    }
                };
                match trial {
                    Ok(trial) => trials.push(trial),
                    Err(StudyError::Identify(_) | StudyError::Picture(_)) => refused += 1,
                    Err(error) => return Err(error),
                }
            }
        }
        Ok((trials, refused))
    }

    /// Frames by one camera: edge and scale are the same in all, the tilt is not.
    fn by_frames(
        &self,
        shapes: &mut Shapes<'_, '_>,
        grid: &Grid,
        points: &mut [Point],
        truth: &Truth,
        random: &mut Random,
    ) -> Result<Trial, StudyError> {
        let steady = self.from == From::Steady;
        let camera = self.drawn(random);
        let drawn = truth.transient.each_ref().map(|moving| {
            let tilt = self.drawn(random).tilt;
            let outline = if steady { &truth.outline } else { moving };
            contour(outline, &Drawing { tilt, ..camera }, random)
        });
        by_frames(
            shapes,
            grid,
            points,
            truth.parameters,
            (&drawn, steady),
            &self.known(&camera),
        )
    }

    /// A drawing with a frame at random, where that is not known.
    fn drawn(&self, random: &mut Random) -> Drawing {
        let exact = self.drawing(self.noise);
        if !self.unknown_frame {
            return exact;
        }
        Drawing {
            edge: 0.25 * normal(random),
            scale: 0.005 * normal(random),
            tilt: 0.02 * normal(random),
            ..exact
        }
    }

    fn drawing(&self, noise: f64) -> Drawing {
        Drawing {
            pixels: self.pixels,
            noise,
            edge: 0.0,
            scale: 0.0,
            tilt: 0.0,
        }
    }

    fn known(&self, drawing: &Drawing) -> Known {
        let usual = Priors::of_pixel(drawing.pixel_um());
        let own = self.from == From::Own;
        let factor = if self.unknown_frame { 1.0 } else { 0.0 };
        Known {
            priors: Priors {
                edge_um: factor * usual.edge_um,
                scale: factor * usual.scale,
                tilt: 0.02,
                // Its own outlines have no error of the model.
                model: if own { 0.0 } else { 1.0 },
            },
            noise_um: own.then(|| drawing.noise * drawing.pixel_um()),
            half_width_um: HALF_WIDTH_UM * (1.0 + self.half_width_error),
        }
    }
}

/// The contour that is found in a picture of an outline, in um.
fn picture(outline: &[[f64; 2]], drawing: &Drawing, random: &mut Random) -> Result<Vec<[f64; 2]>, StudyError> {
    // The camera finds the edge itself, so none is added; and it has errors of its own.
    let placed = Drawing {
        edge: 0.0,
        noise: 0.0,
        ..*drawing
    };
    let smooth = contour(
        outline,
        &Drawing {
            pixels: 1000.0,
            ..placed
        },
        random,
    );
    let smooth: Vec<[f64; 2]> = smooth.iter().map(|point| point.map(|x| x / HALF_WIDTH_UM)).collect();
    let found = raster::seen(&smooth, drawing.pixels, drawing.noise, random)?;
    Ok(found
        .iter()
        .map(|point| point.map(|x| x * drawing.pixel_um()))
        .collect())
}

/// A capsule somewhere in the domain, even in ln Ca and a/l.
fn anywhere(model: &Model<'_>, random: &mut Random) -> [f64; 2] {
    let [first, second, ..] = model.parameters() else {
        return [0.0; 2];
    };
    loop {
        let ca = random.between(first.min.ln(), first.max.ln()).exp();
        let place = [ca, random.between(second.min, second.max)];
        if model.domain(place) == Ok(Domain::Inside) {
            return place;
        }
    }
}
