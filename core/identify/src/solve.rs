//! From a measurement to an answer.

use crate::domain::Domain;
use crate::error::{DentLineError, IdentifyError, MIN_LINE_POINTS};
use crate::fit::{Accuracy, Fit, Fitter, Start};
use crate::grid::Grid;
use crate::identification::{Alternative, Estimate, Frame, Identification, Verdict};
use crate::measurement::{Contour, Direction, Flow, Measurement};
use crate::misfit::Misfit;
use crate::model_error;
use crate::noise::{Bins, LEAST_NOISE, Noise};
use crate::profile::{Interval, Profile};
use crate::residuals::{Data, EDGE, Point, SCALE, SHIFT, TILT, Trace};
use crate::shapes::{Observable, Shapes, VELOCITY};
use crate::solver::{SIGNIFICANT, Solver};
use crate::starts::{Candidate, START_POINTS};
use capsule_core::{EvaluateError, MIDPLANE};

/// A start whose sum is greater than the best by this is dropped before all points take part.
pub(crate) const DROPPED_RISE: f64 = 40.0;
/// A solution whose sum is greater by no more than this is as good (95 %, one degree of freedom).
pub(crate) const CHI_SQUARED_95: f64 = 3.84;
/// The most rounds of fits and weights.
const ROUNDS: usize = 6;
/// A change of the noise or of the scale of the model's error that needs no new fit, as a share.
const NOISE_TOLERANCE: f64 = 0.1;
/// Standard normal quantiles of 68.27 and 95 %.
const QUANTILES: [f64; 2] = [1.0, 1.959_964];
/// More of the model's error than it ever has: with a normal distribution 24 on average and 51 once in a thousand, but
/// large errors are more frequent than that.
pub(crate) const GREATEST_STRUCTURE: f64 = 150.0;
/// By what share of the contour's extent the points of a dent line may lie outside of it: their coordinates are others
/// where they lie farther off.
const LINE_MARGIN: f64 = 0.05;

/// Identifies a capsule. `points` is room for as many points as the contour and a dent line have.
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
    run(shapes, grid, measurement, points, |_, _| ())
}

/// Identifies a capsule, and gives how badly all the others of the model fit. As [`identify`].
///
/// # Errors
/// See [`IdentifyError`].
pub fn identify_with_misfit(
    shapes: &mut Shapes<'_, '_>,
    grid: &Grid,
    measurement: &Measurement<'_>,
    points: &mut [Point],
) -> Result<(Identification, Misfit), IdentifyError> {
    let mut misfit = None;
    let found = run(shapes, grid, measurement, points, |profile, freedom| {
        misfit = Some(Misfit::of(profile, freedom));
    })?;
    misfit.map(|misfit| (found, misfit)).ok_or(IdentifyError::NoFit)
}

/// Identifies a capsule. `keep` is shown the likelihood at the end, and the degrees of freedom of the noise where that
/// is an estimate.
fn run(
    shapes: &mut Shapes<'_, '_>,
    grid: &Grid,
    measurement: &Measurement<'_>,
    points: &mut [Point],
    keep: impl FnOnce(&Profile<'_>, Option<f64>),
) -> Result<Identification, IdentifyError> {
    let line = measurement.dent_line_um.len();
    check(measurement, points.len().saturating_sub(line))?;
    check_dent_line(shapes, measurement)?;
    let evaluated = shapes.evaluations();
    let domain = Domain::new(shapes.model()).ok_or(EvaluateError::UnsupportedReference)?;
    let mut solver = Solver {
        fitter: Fitter { shapes, domain },
        measurement,
        scalars: measurement.lengths.scaled(measurement.setup.half_width_um),
    };
    let (direction, candidates) = solver.candidates(grid)?;
    let count = measurement.contour.map_or(0, |contour| contour.points_um.len());
    let (points, line) = points.get_mut(..count + line).unwrap_or_default().split_at_mut(count);
    let mut solved = solver.solve(direction, candidates, [points, line], keep)?;
    solved.evaluations = solver.fitter.shapes.evaluations() - evaluated;
    Ok(solved)
}

pub(crate) fn check(measurement: &Measurement<'_>, capacity: usize) -> Result<(), IdentifyError> {
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
            Ok(contour.check(setup.half_width_um, capacity)?)
        }
        None if measurement.lengths.count() < 2 => Err(IdentifyError::TooFewLengths {
            found: measurement.lengths.count(),
        }),
        None => Ok(()),
    }
}

/// Checks a dent line against the contour, which was checked.
fn check_dent_line(shapes: &Shapes<'_, '_>, measurement: &Measurement<'_>) -> Result<(), DentLineError> {
    let line = measurement.dent_line_um;
    if line.is_empty() {
        return Ok(());
    }
    let seen = shapes.observable() == Observable::Silhouette && shapes.model().node_set(MIDPLANE).is_some();
    let Some(contour) = measurement.contour.filter(|_| seen) else {
        return Err(DentLineError::NoSilhouette);
    };
    if line.len() < MIN_LINE_POINTS {
        return Err(DentLineError::TooFewPoints { found: line.len() });
    }
    let within = |d: usize, x: f64| {
        let values = contour.points_um.iter().map(|point| point[d]);
        let least = values.clone().fold(f64::INFINITY, f64::min);
        let most = values.fold(f64::NEG_INFINITY, f64::max);
        // Behind, the line may come out of the outline as traced.
        let margin = LINE_MARGIN * (most - least);
        (least - margin..=most + margin).contains(&x)
    };
    match line.iter().position(|point| !(0..2).all(|d| within(d, point[d]))) {
        Some(index) => Err(DentLineError::Outside { index }),
        None => Ok(()),
    }
}

impl Solver<'_, '_, '_, '_> {
    /// Fits all points from the candidates and states what was found.
    fn solve(
        &mut self,
        direction: Direction,
        candidates: [Option<Candidate>; 2],
        [points, line]: [&mut [Point]; 2],
        keep: impl FnOnce(&Profile<'_>, Option<f64>),
    ) -> Result<Identification, IdentifyError> {
        let half_width = self.measurement.setup.half_width_um;
        if let Some(contour) = &self.measurement.contour {
            let framed = contour.framed(direction, half_width);
            contour.fill(direction, half_width, framed.middle, points);
            let dent = Contour {
                points_um: self.measurement.dent_line_um,
                ..*contour
            };
            dent.fill(direction, half_width, framed.middle, line);
        }
        let least = candidates.iter().flatten().map(|c| c.sum).fold(f64::INFINITY, f64::min);
        // Where even the best start leaves much, the noise is greater than was assumed.
        let hopeless = least + DROPPED_RISE * (least / START_POINTS as f64).max(1.0);
        let candidates = candidates.map(|candidate| candidate.filter(|c| c.sum <= hopeless));
        // Noise and weights of the points from the residuals of the best fit so far, until they stay. A fit works with
        // the points in bins.
        let (mut noise, mut line_noise) = (Noise::default(), Noise::default());
        let mut scale = 1.0;
        let mut fits: [Option<Fit>; 2] = [None, None];
        for round in 0..ROUNDS {
            let best = best(&fits);
            let before = [noise.effective, line_noise.effective, scale];
            if let Some(fit) = best.filter(|_| !points.is_empty() && self.measurement.priors.model > 0.0) {
                scale = model_error::scale(fit, scale);
            }
            let started = candidates.iter().flatten().min_by(|a, b| a.sum.total_cmp(&b.sum));
            let Some(Start { theta, nuisances, .. }) = best.map(Fit::start).or(started.map(|c| c.start)) else {
                return Err(IdentifyError::NoFit);
            };
            let shape = self.fitter.shapes.at(theta)?;
            noise = self.estimate_noise(Trace::Outline, &shape, &nuisances, best, points);
            line_noise = self.estimate_noise(Trace::DentLine, &shape, &nuisances, None, line);
            let changes = [noise.effective, line_noise.effective, scale].into_iter().zip(before);
            if round > 1
                && changes
                    .into_iter()
                    .all(|(now, before)| (now - before).abs() <= NOISE_TOLERANCE * before)
            {
                break;
            }
            let plain = self.data(&[], 1.0);
            let bins = Bins::gather(&plain, (Trace::Outline, &shape), &nuisances, points);
            let line_bins = Bins::gather(&plain, (Trace::DentLine, &shape), &nuisances, line);
            let data = Data {
                scale,
                line: line_bins.all(),
                line_noise: line_noise.effective.max(LEAST_NOISE),
                ..self.data(bins.all(), noise.effective.max(LEAST_NOISE))
            };
            for (fit, candidate) in fits.iter_mut().zip(&candidates) {
                if let Some(candidate) = candidate {
                    let start = fit.as_ref().map_or(candidate.start, Fit::start);
                    *fit = self.fitter.fit(&data, start, Accuracy::Full)?;
                }
            }
        }
        let (fit, alternative) = match &fits {
            [Some(a), Some(b)] if b.evidence < a.evidence => (b, Some(a)),
            [Some(a), b] => (a, b.as_ref()),
            [None, Some(b)] => (b, None),
            [None, None] => return Err(IdentifyError::NoFit),
        };
        let alternative = alternative.map(|other| Alternative {
            capillary_number: libm::exp(other.theta[0]),
            confinement: other.theta[1],
            rise: other.evidence - fit.evidence,
        });
        self.state(
            direction,
            fit,
            alternative.filter(|other| other.rise <= CHI_SQUARED_95),
            [points, line],
            [noise, line_noise],
            keep,
        )
    }

    /// Intervals and verdict.
    fn state(
        &mut self,
        direction: Direction,
        fit: &Fit,
        alternative: Option<Alternative>,
        [points, line]: [&[Point]; 2],
        [noise, line_noise]: [Noise; 2],
        keep: impl FnOnce(&Profile<'_>, Option<f64>),
    ) -> Result<Identification, IdentifyError> {
        let setup = &self.measurement.setup;
        let half_width = setup.half_width_um;
        let velocity = fit.shape.scalars[VELOCITY];
        let mean_velocity = match setup.flow {
            Flow::MeanVelocity(velocity) => velocity,
            Flow::Rate(rate) => rate / (4e-12 * half_width * half_width),
            Flow::CapsuleVelocity(capsule) => capsule / velocity,
        };
        let plain = self.data(&[], 1.0);
        let bins = Bins::gather(&plain, (Trace::Outline, &fit.shape), &fit.nuisances, points);
        let line_bins = Bins::gather(&plain, (Trace::DentLine, &fit.shape), &fit.nuisances, line);
        let data = Data {
            bound: fit.bound,
            scale: fit.scale,
            line: line_bins.all(),
            line_noise: line_noise.effective.max(LEAST_NOISE),
            ..self.data(bins.all(), noise.effective.max(LEAST_NOISE))
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
        let model_parameters = if points.is_empty() {
            [0.0; 2]
        } else {
            model_error::of_parameters(&fit.shape, &fit.slopes.sensitivity)
                .map(|deviation| self.measurement.priors.model * deviation)
        };
        let mut profile = Profile {
            data,
            fit,
            sum: Fitter::profiled(&data, &fit.shape, &fit.nuisances).map_or(fit.sum, |(sum, _)| sum),
            local: None,
            model_parameters,
        };
        if let Some(steps) = fit
            .reduced
            .covariance()
            .and_then(|covariance| local_steps(&covariance, quantiles))
        {
            profile.local = self.fitter.local(&data, fit, steps)?;
        }
        keep(&profile, (!known).then_some(freedom));
        let ratio = fit.slopes.sensitivity.scalars[VELOCITY].map(|derivative| derivative / velocity);
        let gradients = [[1.0, 0.0], [0.0, 1.0], [1.0 + ratio[0], ratio[1]]];
        let of_capsule = matches!(setup.flow, Flow::CapsuleVelocity(_));
        let mut intervals = [None; 3];
        for (interval, gradient) in intervals.iter_mut().zip(gradients).take(if of_capsule { 3 } else { 2 }) {
            *interval = self.fitter.intervals(&profile, gradient, quantiles)?;
        }
        let [ca, confinement, modulus] = intervals;
        let modulus = if of_capsule { modulus } else { ca };
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
        let found = Identification {
            capillary_number: estimate(value, ca, &|change| value * libm::exp(change)),
            confinement: estimate(fit.theta[1], confinement, &|change| fit.theta[1] + change),
            radius_um: estimate(fit.theta[1] * half_width, confinement, &|change| {
                (fit.theta[1] + change) * half_width
            }),
            shear_modulus_n_per_m: estimate(shear, modulus, &|change| shear * libm::exp(-change)),
            mean_velocity_m_s: mean_velocity,
            deviations: fit.reduced.covariance().map_or([f64::INFINITY; 2], |covariance| {
                [0, 1].map(|d| libm::hypot(libm::sqrt(covariance[d][d]), model_parameters[d]))
            }),
            correlation: fit.reduced.covariance().map_or(f64::NAN, |covariance| {
                covariance[0][1] / libm::sqrt(covariance[0][0] * covariance[1][1])
            }),
            chi_squared: noise.chi_squared,
            degrees_of_freedom: noise.freedom,
            residual_um: noise.residual * half_width,
            dent_line_residual_um: (!line.is_empty()).then_some(line_noise.residual * half_width),
            noise_um: noise.point * half_width,
            correlated_points: noise.correlated,
            edge_um: fit.nuisances[EDGE] * half_width,
            scale_error: fit.nuisances[SCALE],
            tilt: fit.nuisances[TILT],
            direction,
            frame: Frame {
                direction,
                half_width_um: half_width,
                middle: self
                    .measurement
                    .contour
                    .map_or([0.0; 2], |contour| contour.framed(direction, half_width).middle),
                shift: [fit.nuisances[SHIFT], fit.nuisances[SHIFT + 1]],
                tilt: fit.nuisances[TILT],
                scale_error: fit.nuisances[SCALE],
            },
            structure: data.structure(&fit.nuisances),
            side: fit.side,
            alternative,
            verdict: Verdict::Identified,
            evaluations: 0,
        };
        Ok(Identification {
            verdict: self.verdict(&found, [noise, line_noise], fit, intervals),
            ..found
        })
    }

    fn verdict(
        &self,
        found: &Identification,
        noises: [Noise; 2],
        fit: &Fit,
        intervals: [Option<[Interval; 2]>; 3],
    ) -> Verdict {
        let priors = &self.measurement.priors;
        let given = self.measurement.contour.and_then(|contour| contour.noise_um);
        let noisy = given.is_some_and(|given| found.noise_um > 2.0 * given);
        let far = |value: f64, deviation: f64| value.abs() > SIGNIFICANT * deviation && deviation > 0.0;
        let open = |intervals: Option<[Interval; 2]>| intervals.is_none_or(|[_, wide]| wide.open != [false; 2]);
        let [ca, confinement, _] = intervals;
        let edge = priors.edge_um / self.measurement.setup.half_width_um;
        let structured = noises.iter().any(|noise| noise.is_structured(edge, fit.bound));
        if structured || (priors.model > 0.0 && (found.structure > GREATEST_STRUCTURE || noisy)) {
            Verdict::NotSuchACapsule
        } else if fit.fall_outside > CHI_SQUARED_95 {
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
