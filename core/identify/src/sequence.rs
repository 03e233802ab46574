//! Several frames of one capsule: steady ones, whose capsule is the same in all, or ones of its transient, at unknown
//! instants.
//!
//! Ca, a/l, the edge and the scale are common to all frames. Each frame has an instant of its own (unless the capsule
//! is steady), a shift, a tilt and an error of the model, which are eliminated from its normal equations; what remains
//! of all frames is added. The model errs alike in all frames, so its error is not averaged away: its standard
//! deviations are greater by the root of the number of frames.

use crate::algebra::Factor;
use crate::domain::{Domain, Side};
use crate::error::IdentifyError;
use crate::fit::{Accuracy, Fitter};
use crate::frames::{COMMON, Fit, Frame, STARTS, fall, fall_outside, summed};
use crate::grid::Grid;
use crate::identification::{Alternative, Estimate, Verdict};
use crate::measurement::{Contour, Direction, Flow, Lengths, MAX_FRAMES, Measurement, Sequence};
use crate::model_error;
use crate::noise::{Bins, Noise};
use crate::profile::Interval;
use crate::residuals::{EDGE, NUISANCES, Point, SCALE};
use crate::shapes::{Shapes, VELOCITY};
use crate::solve::{CHI_SQUARED_95, DROPPED_RISE, GREATEST_STRUCTURE};
use crate::solver::SIGNIFICANT;
use crate::starts::START_POINTS;
use capsule_core::EvaluateError;

/// Standard normal quantiles of 68.27 and 95 %.
const QUANTILES: [f64; 2] = [1.0, 1.959_964];

/// The result of an identification from several frames.
#[derive(Clone, Copy, Debug)]
pub struct SequenceIdentification {
    /// Capillary number mu V / G_s; intervals by the curvature of the sum of squares.
    pub capillary_number: Estimate,
    /// a/l.
    pub confinement: Estimate,
    /// Radius a, in um.
    pub radius_um: Estimate,
    /// Surface shear modulus G_s, in N/m.
    pub shear_modulus_n_per_m: Estimate,
    /// Standard deviations of ln Ca and a/l.
    pub deviations: [f64; 2],
    /// Instants of the frames, in l/V since the capsule was a sphere, and their standard deviations.
    pub instants: [[f64; 2]; MAX_FRAMES],
    /// Greatest noise of a point in a frame, in um.
    pub noise_um: f64,
    /// By how much the sum of squares would fall if each frame had a capsule of its own.
    pub drift: f64,
    /// Degrees of freedom of the drift: its mean where all frames show one capsule.
    pub drift_freedom: f64,
    /// Another capsule that fits as well.
    pub alternative: Option<Alternative>,
    /// Kind of answer.
    pub verdict: Verdict,
    /// How many outlines of the model were computed.
    pub evaluations: u32,
}

impl SequenceIdentification {
    /// Whether the frames differ by more than chance, three standard deviations of chi-squared: then they do not show
    /// one capsule, or it is not steady.
    pub fn drifts(&self) -> bool {
        self.drift > self.drift_freedom + 3.0 * libm::sqrt(2.0 * self.drift_freedom)
    }
}

/// Identifies a capsule from several frames. `points` is room for as many points as the longest contour has.
///
/// # Errors
/// See [`IdentifyError`].
pub fn identify_sequence(
    shapes: &mut Shapes<'_, '_>,
    grid: &Grid,
    sequence: &Sequence<'_>,
    points: &mut [Point],
) -> Result<SequenceIdentification, IdentifyError> {
    let count = sequence.contours.len();
    if count == 0 || count > MAX_FRAMES {
        return Err(IdentifyError::Frames { found: count });
    }
    for contour in sequence.contours {
        crate::solve::check(&sequence.measurement(contour), points.len())?;
        if contour.direction == Direction::Found {
            return Err(IdentifyError::Direction);
        }
    }
    if matches!(sequence.setup.flow, Flow::CapsuleVelocity(_)) && !sequence.steady {
        return Err(IdentifyError::ChangingVelocity);
    }
    let (evaluated, end) = (shapes.evaluations(), shapes.instant());
    let found = identify_frames(shapes, grid, sequence, points);
    let mut found = found.inspect_err(|_| shapes.set_instant(end))?;
    shapes.set_instant(end);
    found.evaluations = shapes.evaluations() - evaluated;
    Ok(found)
}

fn identify_frames(
    shapes: &mut Shapes<'_, '_>,
    grid: &Grid,
    sequence: &Sequence<'_>,
    points: &mut [Point],
) -> Result<SequenceIdentification, IdentifyError> {
    let domain = Domain::new(shapes.model()).ok_or(EvaluateError::UnsupportedReference)?;
    let empty = Frame {
        bins: Bins::EMPTY,
        noise: 0.0,
        residuals: Noise::default(),
        t: 0.0,
        nuisances: [0.0; NUISANCES],
    };
    let end = shapes.instant();
    let mut fit = Fit {
        fitter: Fitter { shapes, domain },
        sequence,
        end,
        side: Side::Dented,
        theta: [0.0; 2],
        frames: [empty; MAX_FRAMES],
    };
    let mut found: [Option<Found>; STARTS] = [None; STARTS];
    for (found, start) in found.iter_mut().zip(fit.starts(grid)?) {
        let Some((side, theta, instants)) = start else {
            continue;
        };
        fit.begin(side, theta, instants)?;
        *found = fit.run()?.map(|sum| fit.found(sum)).transpose()?.flatten();
    }
    if let [Some(a), Some(b)] = &found {
        // The second only if it is another capsule that may fit as well with all points. Where even the better one
        // leaves much, the noise is greater than was assumed.
        let (worse, left) = if a.evidence <= b.evidence {
            (1, a.sum)
        } else {
            (0, b.sum)
        };
        let expected = (START_POINTS * sequence.contours.len()) as f64;
        let hopeless = DROPPED_RISE * (left / expected).max(1.0);
        if (a.evidence - b.evidence).abs() > hopeless || a.is_near(b) {
            found[worse] = None;
        }
    }
    for found in &mut found {
        if let Some(start) = found {
            (fit.side, fit.theta, fit.frames) = (start.side, start.theta, start.frames);
            let mut sum = None;
            // Twice: the weights of the points, and the bins, from the residuals of the fit before.
            for _ in 0..2 {
                fit.gather(points)?;
                sum = fit.run()?;
            }
            *found = sum.map(|sum| fit.found(sum)).transpose()?.flatten();
        }
    }
    let (best, other) = match found {
        [Some(a), Some(b)] if b.evidence < a.evidence => (b, Some(a)),
        [Some(a), b] => (a, b),
        [None, Some(b)] => (b, None),
        [None, None] => return Err(IdentifyError::NoFit),
    };
    let other = other.filter(|other| other.evidence - best.evidence <= CHI_SQUARED_95 && !other.is_near(&best));
    (fit.side, fit.theta, fit.frames) = (best.side, best.theta, best.frames);
    let alternative = other.map(|other| Alternative {
        capillary_number: libm::exp(other.theta[0]),
        confinement: other.theta[1],
        rise: other.evidence - best.evidence,
    });
    fit.state(best.sum, alternative)
}

/// Where a fit has ended, its sum of squares and its evidence.
#[derive(Clone, Copy)]
struct Found {
    sum: f64,
    evidence: f64,
    side: Side,
    theta: [f64; 2],
    frames: [Frame; MAX_FRAMES],
}

impl Found {
    /// Whether another is the same minimum.
    fn is_near(&self, other: &Self) -> bool {
        const NEAR: [f64; 2] = [0.1, 0.02];
        self.side == other.side && (0..2).all(|d| (self.theta[d] - other.theta[d]).abs() < NEAR[d])
    }
}

impl<'s> Sequence<'s> {
    pub(crate) fn measurement(&self, contour: &Contour<'s>) -> Measurement<'s> {
        Measurement {
            setup: self.setup,
            contour: Some(*contour),
            dent_line_um: &[],
            lengths: Lengths::default(),
            priors: self.priors,
        }
    }

    /// The middle of a contour, in l, in the frame of the flow.
    pub(crate) fn middle(&self, contour: &Contour<'_>) -> [f64; 2] {
        contour.framed(contour.direction, self.setup.half_width_um).middle
    }
}

impl Fit<'_, '_, '_, '_> {
    fn found(&mut self, sum: f64) -> Result<Option<Found>, EvaluateError> {
        let evidence = self.evidence(sum)?;
        Ok(evidence.map(|evidence| Found {
            sum,
            evidence,
            side: self.side,
            theta: self.theta,
            frames: self.frames,
        }))
    }

    fn state(&mut self, sum: f64, alternative: Option<Alternative>) -> Result<SequenceIdentification, IdentifyError> {
        let linears = self.total()?.ok_or(IdentifyError::NoFit)?;
        let factor = Factor::new(&summed(&linears)).ok_or(IdentifyError::NoFit)?;
        let covariance: [[f64; COMMON]; COMMON] = core::array::from_fn(|i| factor.inverse_column(i));
        // The model's own parameters, from the last frame.
        let last = self.frames[self.count() - 1];
        let shape = self.shape(self.theta, last.t)?;
        let sensitivity = self.fitter.sensitivity(Accuracy::Full, self.side, self.theta, &shape)?;
        let own = model_error::of_parameters(&shape, &sensitivity).map(|own| self.sequence.priors.model * own);
        let deviations = [0, 1].map(|d| libm::hypot(libm::sqrt(covariance[d][d]), own[d]));
        let mut instants = [[0.0; 2]; MAX_FRAMES];
        for ((instant, frame), linear) in instants.iter_mut().zip(&self.frames).zip(&linears).take(self.count()) {
            let by = |k: usize| linear.steps[1 + k][0];
            let common: f64 = (0..COMMON)
                .flat_map(|i| (0..COMMON).map(move |k| (i, k)))
                .map(|(i, k)| by(i) * covariance[i][k] * by(k))
                .sum();
            let variance = if self.sequence.steady {
                0.0
            } else {
                linear.variance + common
            };
            *instant = [frame.t, libm::sqrt(variance)];
        }
        let [ca, confinement] = self.theta;
        let range = self.fitter.domain.range(self.side, confinement).unwrap_or([ca; 2]);
        let half_width = self.sequence.setup.half_width_um;
        let value = libm::exp(ca);
        let mean_velocity = match self.sequence.setup.flow {
            Flow::MeanVelocity(velocity) => velocity,
            Flow::Rate(rate) => rate / (4e-12 * half_width * half_width),
            Flow::CapsuleVelocity(capsule) => capsule / shape.scalars[VELOCITY],
        };
        let shear = self.sequence.setup.viscosity_pa_s * mean_velocity / value;
        let confinements = self.fitter.domain.confinements();
        let found = SequenceIdentification {
            capillary_number: estimate(ca, deviations[0], range, libm::exp),
            confinement: estimate(confinement, deviations[1], confinements, |x| x),
            radius_um: estimate(confinement, deviations[1], confinements, |x| x * half_width),
            shear_modulus_n_per_m: estimate(ca, deviations[0], range, |x| shear * value / libm::exp(x)),
            deviations,
            instants,
            noise_um: half_width
                * self
                    .frames
                    .iter()
                    .take(self.count())
                    .fold(0.0, |most: f64, f| most.max(f.noise)),
            drift: linears.iter().take(self.count()).map(fall).sum(),
            drift_freedom: 2.0 * (self.count() - 1) as f64,
            alternative,
            verdict: Verdict::Identified,
            evaluations: 0,
        };
        Ok(SequenceIdentification {
            verdict: self.verdict(&found, sum, fall_outside(&linears))?,
            ..found
        })
    }

    fn verdict(
        &mut self,
        found: &SequenceIdentification,
        sum: f64,
        fall_outside: f64,
    ) -> Result<Verdict, EvaluateError> {
        let priors = self.sequence.priors;
        let half_width = self.sequence.setup.half_width_um;
        let edge = priors.edge_um / half_width;
        let frames = self.frames;
        // Frames of several capsules leave residuals that no single one explains, but each frame's own does.
        if found.drifts() && found.drift > 0.5 * sum {
            return Ok(Verdict::FramesDiffer);
        }
        for (j, frame) in frames.iter().enumerate().take(self.count()) {
            let bound = self.shape(self.theta, frame.t)?.bound;
            let structure = self.data(j, frame, bound).structure(&frame.nuisances);
            let noisy = self.sequence.contours[j]
                .noise_um
                .is_some_and(|given| frame.residuals.point * half_width > 2.0 * given);
            if frame.residuals.is_structured(edge, bound)
                || (priors.model > 0.0 && (structure > GREATEST_STRUCTURE || noisy))
            {
                return Ok(Verdict::NotSuchACapsule);
            }
        }
        let far = |value: f64, deviation: f64| value.abs() > SIGNIFICANT * deviation && deviation > 0.0;
        let [first, ..] = &frames;
        let is_open = |estimate: &Estimate| estimate.interval_95.open != [false; 2];
        Ok(if fall_outside > CHI_SQUARED_95 {
            Verdict::OutsideDomain
        } else if far(first.nuisances[EDGE], edge) || far(first.nuisances[SCALE], priors.scale) {
            Verdict::ScaleInconsistent
        } else if found.drifts() {
            Verdict::FramesDiffer
        } else if found.alternative.is_some() {
            Verdict::SeveralSolutions
        } else if is_open(&found.capillary_number) || is_open(&found.confinement) {
            Verdict::Bounded
        } else {
            Verdict::Identified
        })
    }
}

/// A quantity that is a monotonic function of a normal one, with its intervals, open at the ends of a range.
fn estimate(x: f64, deviation: f64, [low, high]: [f64; 2], of: impl Fn(f64) -> f64) -> Estimate {
    let interval = |quantile: f64| {
        let ends = [x - quantile * deviation, x + quantile * deviation];
        let open = [ends[0] < low, ends[1] > high];
        Interval {
            low: ends[0].max(low),
            high: ends[1].min(high),
            open,
        }
        .map(&of)
    };
    let [interval_68, interval_95] = QUANTILES.map(interval);
    Estimate {
        value: of(x),
        interval_68,
        interval_95,
    }
}
