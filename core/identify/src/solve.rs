//! From a measurement to an answer.

use crate::algebra::Factor;
use crate::contour::ContourError;
use crate::curve::Curve;
use crate::domain::{Domain, Side};
use crate::fit::{Fit, Fitter};
use crate::grid::{FEATURES, Grid};
use crate::identification::{Alternative, Estimate, Frame, Identification, Verdict};
use crate::measurement::{Direction, Flow, Measurement};
use crate::profile::{Interval, Profile};
use crate::residuals::{Data, EDGE, MODES, NUISANCES, Point, SCALE, SHIFT, TILT};
use crate::shapes::{SCALARS, Shapes, VELOCITY};
use capsule_core::EvaluateError;

/// Points of a contour with which a start is improved.
const FEW: usize = 48;
/// Bins on each side of the axis into which a contour is gathered for its intervals.
const BINS: usize = 40;
/// Starts on each side of the border.
const STARTS: usize = 3;
/// A start whose features are farther from the measured ones than the nearest, by this, is not tried.
const FARTHER: f64 = 30.0;
/// A start whose sum is greater than the best by this is dropped before all points take part.
const HOPELESS: f64 = 40.0;
/// A solution whose sum is greater by no more than this is as good (95 %, one degree of freedom).
const AS_GOOD: f64 = 3.84;
/// The most rounds of fits and weights.
const ROUNDS: usize = 4;
/// A change of the noise that needs no new fit.
const SETTLED: f64 = 0.1;
/// Residuals beyond so many deviations count less (Huber, 1964).
const ROBUST: f64 = 2.5;
/// Variance of normal residuals over the one that is computed with Huber's weights, and of the estimate with it.
const ROBUST_VARIANCE: f64 = 1.013;
/// Standard normal quantiles of 68.27 and 95 %.
const QUANTILES: [f64; 2] = [1.0, 1.959_964];
/// The least noise, in l: what the model's numbers are rounded to.
const LEAST_NOISE: f64 = 1e-5;
/// More of the model's error than it ever has: with a normal distribution 24 on average and 51 once in a thousand, but
/// large errors are more frequent than that.
const STRUCTURE: f64 = 150.0;
/// Neighbouring residuals that err alike, more than by chance.
const TOGETHER: f64 = 3.0;
/// Deviations of scale or edge that are too many.
const FAR: f64 = 3.0;

/// Why there is no answer.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum IdentifyError {
    /// What is wrong with the contour.
    Contour(ContourError),
    /// A number of the measurement that cannot be.
    Number {
        /// Its name.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// Without a contour at least two lengths are needed.
    TooFewLengths {
        /// How many there are.
        found: usize,
    },
    /// The model did not answer.
    Model(EvaluateError),
    /// No start led to a minimum.
    NoFit,
}

impl From<EvaluateError> for IdentifyError {
    fn from(error: EvaluateError) -> Self {
        Self::Model(error)
    }
}

impl From<ContourError> for IdentifyError {
    fn from(error: ContourError) -> Self {
        Self::Contour(error)
    }
}

impl core::fmt::Display for IdentifyError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Contour(error) => error.fmt(f),
            Self::Number { what, value } => write!(f, "{what} is {value}: it must be a positive finite number"),
            Self::TooFewLengths { found } => write!(
                f,
                "{found} of the lengths, the velocity and the radius are given: without a contour at least two are needed"
            ),
            Self::Model(error) => error.fmt(f),
            Self::NoFit => f.write_str("no capsule of the model comes near the measurement"),
        }
    }
}

impl core::error::Error for IdentifyError {}

/// Identifies a capsule. `points` is room for as many points as the contour has.
///
/// # Errors
/// See [`IdentifyError`]. Data that fit badly, or capsules outside the domain, are no errors: see
/// [`Identification::verdict`].
pub fn identify(
    shapes: &mut Shapes<'_, '_>,
    grid: &Grid,
    measurement: &Measurement<'_>,
    points: &mut [Point],
) -> Result<Identification, IdentifyError> {
    check(measurement, points.len())?;
    let evaluated = shapes.evaluations();
    let domain = Domain::new(shapes.model()).ok_or(EvaluateError::UnsupportedReference)?;
    let mut solver = Solver {
        fitter: Fitter { shapes, domain },
        measurement,
        scalars: measurement.lengths.scaled(measurement.setup.half_width_um),
    };
    let (direction, candidates) = solver.candidates(grid)?;
    let count = measurement.contour.map_or(0, |contour| contour.points_um.len());
    let points = points.get_mut(..count).unwrap_or_default();
    let mut solved = solver.solve(direction, candidates, points)?;
    solved.evaluations = solver.fitter.shapes.evaluations() - evaluated;
    Ok(solved)
}

fn check(measurement: &Measurement<'_>, room: usize) -> Result<(), IdentifyError> {
    let setup = &measurement.setup;
    let (what, flow) = match setup.flow {
        Flow::MeanVelocity(value) => ("the mean velocity", value),
        Flow::Rate(value) => ("the flow rate", value),
        Flow::CapsuleVelocity(value) => ("the capsule's velocity", value),
    };
    let positive = [
        ("the half width of the channel", setup.half_width_um),
        ("the viscosity", setup.viscosity_pa_s),
        (what, flow),
    ];
    let priors = &measurement.priors;
    let not_negative = [
        ("the deviation of the edge", priors.edge_um),
        ("the deviation of the scale", priors.scale),
        ("the deviation of the tilt", priors.tilt),
        ("the factor of the model's error", priors.model),
    ];
    let bad = positive
        .into_iter()
        .find(|(_, value)| !(value.is_finite() && *value > 0.0));
    let bad = bad.or(not_negative
        .into_iter()
        .find(|(_, value)| !(value.is_finite() && *value >= 0.0)));
    if let Some((what, value)) = bad {
        return Err(IdentifyError::Number { what, value });
    }
    for measured in measurement.lengths.scaled(1.0).iter().flatten() {
        if !(measured.value.is_finite() && measured.value >= 0.0) {
            let (what, value) = ("a measured length or velocity", measured.value);
            return Err(IdentifyError::Number { what, value });
        }
        if !(measured.deviation.is_finite() && measured.deviation > 0.0) {
            let (what, value) = ("the deviation of a measured length or velocity", measured.deviation);
            return Err(IdentifyError::Number { what, value });
        }
    }
    match &measurement.contour {
        Some(contour) => {
            if let Some(value) = contour.noise_um
                && !(value.is_finite() && value > 0.0)
            {
                let what = "the noise of the contour";
                return Err(IdentifyError::Number { what, value });
            }
            Ok(contour.check(setup.half_width_um, room)?)
        }
        None if measurement.lengths.count() < 2 => Err(IdentifyError::TooFewLengths {
            found: measurement.lengths.count(),
        }),
        None => Ok(()),
    }
}

/// A start that was improved with a few points.
#[derive(Clone, Copy)]
struct Candidate {
    side: Side,
    theta: [f64; 2],
    unknowns: [f64; NUISANCES],
    sum: f64,
}

struct Solver<'f, 'a, 'w, 'm> {
    fitter: Fitter<'f, 'a, 'w>,
    measurement: &'m Measurement<'m>,
    scalars: [Option<crate::measurement::Measured>; SCALARS],
}

impl Solver<'_, '_, '_, '_> {
    fn data<'p>(&self, points: &'p [Point], noise: f64) -> Data<'p> {
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
    fn first_noise(&self) -> f64 {
        let half_width = self.measurement.setup.half_width_um;
        let given = self.measurement.contour.and_then(|contour| contour.noise_um);
        let noise = given.unwrap_or(2.0 * self.measurement.priors.edge_um) / half_width;
        noise.max(0.003)
    }

    /// The best direction, and the best start of either side in it.
    fn candidates(&mut self, grid: &Grid) -> Result<(Direction, [Option<Candidate>; 2]), IdentifyError> {
        let given = self.measurement.contour.map(|contour| contour.direction);
        let directions = match given {
            Some(Direction::Found) => Direction::ALL.map(Some),
            other => [other.or(Some(Direction::Right)), None, None, None],
        };
        let mut best: Option<(f64, Direction, [Option<Candidate>; 2])> = None;
        for direction in directions.into_iter().flatten() {
            let found = self.candidates_along(grid, direction)?;
            let least = found.iter().flatten().map(|c| c.sum).fold(f64::INFINITY, f64::min);
            if best.as_ref().is_none_or(|(sum, ..)| least < *sum) {
                best = Some((least, direction, found));
            }
        }
        let (_, direction, candidates) = best.ok_or(IdentifyError::NoFit)?;
        Ok((direction, candidates))
    }

    fn candidates_along(&mut self, grid: &Grid, direction: Direction) -> Result<[Option<Candidate>; 2], IdentifyError> {
        let half_width = self.measurement.setup.half_width_um;
        let mut few = [Point::default(); FEW];
        let mut count = 0;
        let mut features = [None; FEATURES];
        if let Some(contour) = &self.measurement.contour {
            let framed = contour.framed(direction, half_width);
            features = framed.features;
            let all = contour.points_um.len();
            count = all.min(FEW);
            for (i, point) in few.iter_mut().enumerate().take(count) {
                let one = crate::measurement::Contour {
                    points_um: contour.points_um.get(i * all / count..).unwrap_or_default(),
                    ..*contour
                };
                one.fill(direction, half_width, framed.middle, core::slice::from_mut(point));
                point.weight = 1.0;
            }
        }
        for (feature, measured) in features.iter_mut().zip(&self.scalars) {
            if let Some(measured) = measured {
                *feature = Some(measured.value);
            }
        }
        let noise = self.first_noise();
        let nearest = [Side::Smooth, Side::Dented]
            .into_iter()
            .flat_map(|side| grid.nearest::<1>(side, &features));
        let nearest = nearest
            .flatten()
            .map(|start| start.distance)
            .fold(f64::INFINITY, f64::min);
        let mut candidates = [None::<Candidate>; 2];
        for (candidate, side) in candidates.iter_mut().zip([Side::Smooth, Side::Dented]) {
            let starts: [_; STARTS] = grid.nearest(side, &features);
            for start in starts
                .into_iter()
                .flatten()
                .filter(|start| start.distance <= nearest + FARTHER)
            {
                let mut unknowns = [0.0; NUISANCES];
                if count > 0 {
                    let shape = self.fitter.shapes.at(start.theta)?;
                    let [front, rear] = shape.curve.extent();
                    unknowns[SHIFT] = -0.5 * (front + rear);
                }
                let data = self.data(few.get(..count).unwrap_or_default(), noise);
                if let Some(fit) = self.fitter.fit(&data, side, start.theta, unknowns)?
                    && candidate.is_none_or(|best| fit.sum < best.sum)
                {
                    *candidate = Some(Candidate {
                        side,
                        theta: fit.theta,
                        unknowns: fit.unknowns,
                        sum: fit.sum,
                    });
                }
            }
        }
        Ok(candidates)
    }

    /// Fits all points from the candidates and states what was found.
    fn solve(
        &mut self,
        direction: Direction,
        candidates: [Option<Candidate>; 2],
        points: &mut [Point],
    ) -> Result<Identification, IdentifyError> {
        let half_width = self.measurement.setup.half_width_um;
        if let Some(contour) = &self.measurement.contour {
            let framed = contour.framed(direction, half_width);
            contour.fill(direction, half_width, framed.middle, points);
        }
        let least = candidates.iter().flatten().map(|c| c.sum).fold(f64::INFINITY, f64::min);
        // Where even the best start leaves much, the noise is greater than was assumed.
        let hopeless = least + HOPELESS * (least / FEW as f64).max(1.0);
        let candidates = candidates.map(|candidate| candidate.filter(|c| c.sum <= hopeless));
        let mut bins = [Point::default(); 2 * BINS];
        // Noise and weights of the points from the residuals of the best fit so far, until they stay. A fit works with
        // the points in bins.
        let mut noise = Noise::default();
        let mut fits: [Option<Fit>; 2] = [None, None];
        for round in 0..ROUNDS {
            let best = best(&fits);
            let before = noise.counted;
            let from = best.map(|fit| (fit.theta, fit.unknowns));
            let started = candidates.iter().flatten().min_by(|a, b| a.sum.total_cmp(&b.sum));
            let Some((theta, unknowns)) = from.or(started.map(|c| (c.theta, c.unknowns))) else {
                return Err(IdentifyError::NoFit);
            };
            let shape = self.fitter.shapes.at(theta)?;
            noise = self.weigh(&shape.curve, &unknowns, best, points);
            if round > 1 && (noise.counted - before).abs() < SETTLED * before {
                break;
            }
            let count = gather(&self.data(&[], 1.0), &shape.curve, &unknowns, points, &mut bins);
            let data = self.data(bins.get(..count).unwrap_or_default(), noise.counted.max(LEAST_NOISE));
            for (fit, candidate) in fits.iter_mut().zip(&candidates) {
                if let Some(candidate) = candidate {
                    let (theta, unknowns) = fit
                        .as_ref()
                        .map_or((candidate.theta, candidate.unknowns), |fit| (fit.theta, fit.unknowns));
                    *fit = self.fitter.fit(&data, candidate.side, theta, unknowns)?;
                }
            }
        }
        let [a, b] = fits;
        let (fit, alternative) = match (a, b) {
            (Some(a), Some(b)) if b.evidence < a.evidence => (b, Some(a)),
            (Some(a), b) => (a, b),
            (None, Some(b)) => (b, None),
            (None, None) => return Err(IdentifyError::NoFit),
        };
        let alternative = alternative.map(|other| Alternative {
            capillary_number: libm::exp(other.theta[0]),
            confinement: other.theta[1],
            rise: other.evidence - fit.evidence,
        });
        self.state(
            direction,
            fit,
            alternative.filter(|other| other.rise <= AS_GOOD),
            points,
            noise,
        )
    }

    /// Noise of the residuals from a curve, and Huber's weights of the points.
    fn weigh(&self, curve: &Curve, unknowns: &[f64; NUISANCES], fit: Option<&Fit>, points: &mut [Point]) -> Noise {
        if points.is_empty() {
            return Noise::default();
        }
        let half_width = self.measurement.setup.half_width_um;
        let given = self
            .measurement
            .contour
            .and_then(|contour| contour.noise_um)
            .map(|noise| noise / half_width);
        let data = self.data(&[], 1.0);
        for point in &mut *points {
            let left = data.left(curve, point.place, unknowns);
            (point.residual, point.along, point.below) = left;
        }
        // The median of the residuals' sizes by halving, for which they need no order.
        let count = points.len() as f64;
        let (mut low, mut high) = (
            0.0,
            points
                .iter()
                .fold(0.0_f64, |most, point| most.max(point.residual.abs())),
        );
        for _ in 0..20 {
            let middle = 0.5 * (low + high);
            let below = points.iter().filter(|point| point.residual.abs() < middle).count() as f64;
            *(if below < 0.5 * count { &mut low } else { &mut high }) = middle;
        }
        let scale = (1.4826 * high).max(LEAST_NOISE).max(given.unwrap_or(0.0));
        let (mut sum, mut squares) = (0.0, 0.0);
        for point in &mut *points {
            let size = point.residual.abs() / scale;
            point.weight = if size > ROBUST { ROBUST / size } else { 1.0 };
            sum += point.weight * point.residual * point.residual;
            squares += point.residual * point.residual;
        }
        let fitted = fit.map_or(2.0, fitted);
        let freedom = (count - fitted).max(1.0);
        let estimated = libm::sqrt(ROBUST_VARIANCE * sum / freedom).max(LEAST_NOISE);
        // More scatter than was said is there, if it is not by chance.
        let noise = match given {
            Some(given) if estimated < given * (1.0 + FAR / libm::sqrt(2.0 * freedom)) => given,
            _ => estimated,
        };
        let together = together(points);
        Noise {
            counted: noise * libm::sqrt(together),
            point: noise,
            together,
            freedom,
            chi_squared: sum / (noise * noise),
            residual: libm::sqrt(squares / count.max(1.0)),
        }
    }

    /// Intervals and verdict.
    fn state(
        &mut self,
        direction: Direction,
        fit: Fit,
        alternative: Option<Alternative>,
        points: &[Point],
        noise: Noise,
    ) -> Result<Identification, IdentifyError> {
        let setup = &self.measurement.setup;
        let half_width = setup.half_width_um;
        let velocity = fit.shape.scalars[VELOCITY];
        let mean_velocity = match setup.flow {
            Flow::MeanVelocity(velocity) => velocity,
            Flow::Rate(rate) => rate / (4e-12 * half_width * half_width),
            Flow::CapsuleVelocity(capsule) => capsule / velocity,
        };
        let mut bins = [Point::default(); 2 * BINS];
        let count = gather(&self.data(&[], 1.0), &fit.shape.curve, &fit.unknowns, points, &mut bins);
        let bins = bins.get(..count).unwrap_or_default();
        let data = Data {
            bound: fit.bound,
            ..self.data(bins, noise.counted.max(LEAST_NOISE))
        };
        // Student's quantiles for a noise that is an estimate itself.
        let freedom = noise.freedom.max(3.0);
        let known = points.is_empty()
            || self
                .measurement
                .contour
                .is_some_and(|contour| contour.noise_um.is_some());
        let quantiles = QUANTILES.map(|z| {
            if known {
                z
            } else {
                z * (1.0 + (z * z + 1.0) / (4.0 * freedom))
            }
        });
        let mut profile = Profile {
            data,
            fit: &fit,
            sum: Fitter::profiled(&data, &fit.shape, &fit.unknowns).map_or(fit.sum, |(sum, _)| sum),
            local: None,
        };
        if let Some(steps) = fit
            .reduced
            .covariance()
            .and_then(|covariance| local_steps(&covariance, quantiles))
        {
            profile.local = self.fitter.local(&data, &fit, steps)?;
        }
        let ratio = fit.sensitivity.scalars[VELOCITY].map(|derivative| derivative / velocity);
        let gradients = [[1.0, 0.0], [0.0, 1.0], [1.0 + ratio[0], ratio[1]]];
        let told = matches!(setup.flow, Flow::CapsuleVelocity(_));
        let mut intervals = [None; 3];
        for (interval, gradient) in intervals.iter_mut().zip(gradients).take(if told { 3 } else { 2 }) {
            *interval = self.fitter.intervals(&profile, gradient, quantiles)?;
        }
        let [ca, confinement, modulus] = intervals;
        let modulus = if told { modulus } else { ca };
        let value = libm::exp(fit.theta[0]);
        let estimate = |value: f64, intervals: Option<[Interval; 2]>, from: &dyn Fn(f64) -> f64| {
            let none = Interval {
                low: f64::NEG_INFINITY,
                high: f64::INFINITY,
                open: [true; 2],
            };
            let [interval_68, interval_95] = intervals.map_or([none; 2], |all| all.map(|one| one.map(from)));
            Estimate {
                value,
                interval_68,
                interval_95,
            }
        };
        let shear = setup.viscosity_pa_s * mean_velocity / value;
        let structure = fit.unknowns.iter().enumerate().skip(NUISANCES - MODES).map(|(i, c)| {
            let share = c / data.deviation(i);
            share * share
        });
        let found = Identification {
            capillary_number: estimate(value, ca, &|change| value * libm::exp(change)),
            confinement: estimate(fit.theta[1], confinement, &|change| fit.theta[1] + change),
            radius_um: estimate(fit.theta[1] * half_width, confinement, &|change| {
                (fit.theta[1] + change) * half_width
            }),
            shear_modulus_n_per_m: estimate(shear, modulus, &|change| shear * libm::exp(-change)),
            mean_velocity_m_s: mean_velocity,
            deviations: fit.reduced.covariance().map_or([f64::INFINITY; 2], |covariance| {
                [0, 1].map(|d| libm::sqrt(covariance[d][d]))
            }),
            correlation: fit.reduced.covariance().map_or(f64::NAN, |covariance| {
                covariance[0][1] / libm::sqrt(covariance[0][0] * covariance[1][1])
            }),
            chi_squared: noise.chi_squared,
            degrees_of_freedom: noise.freedom,
            residual_um: noise.residual * half_width,
            noise_um: noise.point * half_width,
            correlated_points: noise.together,
            edge_um: fit.unknowns[EDGE] * half_width,
            scale_error: fit.unknowns[SCALE],
            tilt: fit.unknowns[TILT],
            direction,
            frame: Frame {
                direction,
                half_width_um: half_width,
                middle: self
                    .measurement
                    .contour
                    .map_or([0.0; 2], |contour| contour.framed(direction, half_width).middle),
                shift: [fit.unknowns[SHIFT], fit.unknowns[SHIFT + 1]],
                tilt: fit.unknowns[TILT],
                scale_error: fit.unknowns[SCALE],
            },
            structure: structure.sum(),
            side: fit.side,
            alternative,
            verdict: Verdict::Identified,
            evaluations: 0,
        };
        Ok(Identification {
            verdict: self.verdict(&found, &fit, intervals),
            ..found
        })
    }

    fn verdict(&self, found: &Identification, fit: &Fit, intervals: [Option<[Interval; 2]>; 3]) -> Verdict {
        let priors = &self.measurement.priors;
        let given = self.measurement.contour.and_then(|contour| contour.noise_um);
        let noisy = given.is_some_and(|given| found.noise_um > 2.0 * given);
        let far = |value: f64, deviation: f64| value.abs() > FAR * deviation && deviation > 0.0;
        let open = |intervals: Option<[Interval; 2]>| intervals.is_none_or(|[_, wide]| wide.open != [false; 2]);
        let [ca, confinement, _] = intervals;
        // What of the residuals is smooth along the contour, more than the edge and the model may err by.
        let smooth = found.residual_um * libm::sqrt(1.0 - 1.0 / found.correlated_points.max(1.0));
        let allowed = priors.edge_um.max(fit.bound * self.measurement.setup.half_width_um);
        let structured = found.correlated_points > TOGETHER && smooth > allowed;
        if structured || (priors.model > 0.0 && (found.structure > STRUCTURE || noisy)) {
            Verdict::NotSuchACapsule
        } else if fit.pressure > AS_GOOD {
            Verdict::OutsideDomain
        } else if far(found.edge_um, priors.edge_um) || far(found.scale_error, priors.scale) {
            Verdict::ScaleInconsistent
        } else if ca.is_none() || confinement.is_none() {
            Verdict::Undetermined
        } else if found.alternative.is_some() {
            Verdict::SeveralSolutions
        } else if open(ca) || open(confinement) {
            Verdict::Bounded
        } else {
            Verdict::Identified
        }
    }
}

/// The fit with the least sum.
fn best(fits: &[Option<Fit>; 2]) -> Option<&Fit> {
    fits.iter().flatten().min_by(|a, b| a.evidence.total_cmp(&b.evidence))
}

/// What the residuals of a contour say of its noise, in l.
#[derive(Clone, Copy, Debug, Default)]
struct Noise {
    /// That of a point, as if all were independent.
    counted: f64,
    /// That of a point.
    point: f64,
    /// How many neighbours err together.
    together: f64,
    freedom: f64,
    chi_squared: f64,
    residual: f64,
}

/// Steps of the polynomial beside a fit, so that it reaches as far as the intervals; none where these are too wide for
/// one.
fn local_steps(covariance: &[[f64; 2]; 2], quantiles: [f64; 2]) -> Option<[f64; 2]> {
    /// Steps below which outlines differ by little more than their rounding, and above which their third derivatives
    /// count.
    const RANGE: [[f64; 2]; 2] = [[0.01, 0.1], [0.002, 0.015]];
    let [_, widest] = quantiles;
    let wanted = [0, 1].map(|d| 1.1 * widest * libm::sqrt(covariance[d][d]));
    let steps = [0, 1].map(|d| wanted[d].max(RANGE[d][0]));
    (0..2).all(|d| steps[d] <= RANGE[d][1]).then_some(steps)
}

/// How many unknowns the points determine, each as far as they do.
fn fitted(fit: &Fit) -> f64 {
    let own = Factor::new(&fit.others).map_or(0.0, |factor| {
        (0..NUISANCES)
            .map(|i| 1.0 - fit.priors[i] * factor.inverse_column(i)[i])
            .sum()
    });
    2.0 + own
}

/// How many neighbouring residuals are as good as one: 1 + 2 sum of the autocorrelations, as far as they are more than
/// chance.
fn together(points: &[Point]) -> f64 {
    const LAGS: usize = 30;
    let n = points.len();
    let weighted = |i: usize| {
        points
            .get(i % n.max(1))
            .map_or(0.0, |point| point.weight * point.residual)
    };
    let square: f64 = (0..n).map(|i| weighted(i) * weighted(i)).sum();
    let chance = 2.0 / libm::sqrt(n as f64);
    let mut together = 1.0;
    for lag in 1..LAGS.min(n / 4) {
        let product: f64 = (0..n).map(|i| weighted(i) * weighted(i + lag)).sum();
        let correlation = product / square.max(f64::MIN_POSITIVE);
        if correlation < chance {
            break;
        }
        together += 2.0 * correlation;
    }
    together
}

/// Gathers points in bins along the curve, each on either side: the mean of the places, moved along the normal until its
/// residual is the mean of theirs, for the mean of places on a bent curve lies inside it.
fn gather(
    data: &Data<'_>,
    curve: &Curve,
    unknowns: &[f64; NUISANCES],
    points: &[Point],
    bins: &mut [Point; 2 * BINS],
) -> usize {
    bins.fill(Point::default());
    if points.len() <= bins.len() {
        bins.iter_mut().zip(points).for_each(|(bin, point)| *bin = *point);
        return points.len();
    }
    let width = curve.count().saturating_sub(1) as f64 / BINS as f64;
    for point in points {
        let bin = ((point.along / width) as usize).min(BINS - 1) + if point.below { BINS } else { 0 };
        let bin = &mut bins[bin];
        bin.weight += point.weight;
        bin.residual += point.weight * point.residual;
        (0..2).for_each(|d| bin.place[d] += point.weight * point.place[d]);
    }
    let mut count = 0;
    for i in 0..bins.len() {
        let bin = bins[i];
        if bin.weight > 0.0 {
            let place = bin.place.map(|x| x / bin.weight);
            let (left, along, below) = data.left(curve, place, unknowns);
            let normal = data.normal_at(curve, place, unknowns);
            let missing = bin.residual / bin.weight - left;
            bins[count] = Point {
                place: [0, 1].map(|d| place[d] + missing * normal[d]),
                weight: bin.weight,
                residual: bin.residual / bin.weight,
                along,
                below,
            };
            count += 1;
        }
    }
    count
}
