//! Least squares within a part of the domain, by steps of Gauss and Newton that Levenberg's damping shortens.

use crate::algebra::Factor;
use crate::domain::{Domain, Side};
use crate::residuals::{Data, NUISANCES, Place};
use crate::shapes::{STEPS as STEPS_OF_SLOPES, Sensitivity, Shape, Shapes};
use capsule_core::EvaluateError;

/// The most steps.
const STEPS: usize = 12;
/// The most shorter steps that are tried in place of one.
const TRIALS: usize = 6;

/// How well a place is to be found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Accuracy {
    /// So that a fit can start there: without the model's error, and with derivatives of the interpolation. They are
    /// cheap, but jump where a sample enters or leaves its nearest ones, so that steps end a little beside the minimum.
    Start,
    /// As well as can be, with differences over a short way, which level that out.
    Full,
}

impl Accuracy {
    /// A step that is shorter than this share of the standard deviations ends the fit.
    fn close(self) -> f64 {
        match self {
            Self::Start => 0.3,
            Self::Full => 0.01,
        }
    }
}

/// Where a fit starts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Start<'s> {
    pub(crate) side: Side,
    pub(crate) theta: [f64; 2],
    pub(crate) nuisances: [f64; NUISANCES],
    /// Derivatives from an earlier fit.
    pub(crate) slopes: Option<&'s Slopes>,
}

/// Derivatives of the outline, and where they were computed.
#[derive(Clone, Debug)]
pub(crate) struct Slopes {
    theta: [f64; 2],
    pub(crate) sensitivity: Sensitivity,
}

impl Slopes {
    /// Whether a place is half as near as the differences reach.
    fn serve(&self, theta: [f64; 2]) -> bool {
        (0..2).all(|d| (theta[d] - self.theta[d]).abs() <= 0.5 * STEPS_OF_SLOPES[d])
    }
}

/// Where a fit has ended.
#[derive(Clone, Debug)]
pub(crate) struct Fit {
    pub(crate) side: Side,
    /// [ln Ca, a/l].
    pub(crate) theta: [f64; 2],
    pub(crate) nuisances: [f64; NUISANCES],
    /// The sum of squares.
    pub(crate) sum: f64,
    /// Twice the negative logarithm of the marginal likelihood, the nuisance parameters integrated over: by it fits
    /// with different bounds of the model are compared.
    pub(crate) evidence: f64,
    /// The model's bound that it counted with, in l.
    pub(crate) bound: f64,
    /// The scale of the model's error that it counted with.
    pub(crate) scale: f64,
    pub(crate) reduced: Reduced,
    pub(crate) shape: Shape,
    pub(crate) slopes: Slopes,
    /// The normal matrix of the nuisance parameters, and what the priors are of its diagonal.
    pub(crate) nuisance_matrix: [[f64; NUISANCES]; NUISANCES],
    pub(crate) priors: [f64; NUISANCES],
    /// By how much the sum would fall if the fit could leave the domain, at whose edge it is; else about 0.
    pub(crate) fall_outside: f64,
}

impl Fit {
    /// To go on from here with other data.
    pub(crate) fn start(&self) -> Start<'_> {
        Start {
            side: self.side,
            theta: self.theta,
            nuisances: self.nuisances,
            slopes: Some(&self.slopes),
        }
    }
}

/// The normal equations of [ln Ca, a/l] alone, the nuisance parameters eliminated (Schur complement).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reduced {
    pub(crate) matrix: [[f64; 2]; 2],
    gradient: [f64; 2],
    /// Step of the nuisance parameters at fixed Ca and a/l, and by a unit of either.
    nuisance_steps: [[f64; NUISANCES]; 3],
    sum: f64,
}

impl Reduced {
    /// Also gives the normal matrix of the nuisance parameters.
    fn new(
        data: &Data<'_>,
        shape: &Shape,
        sensitivity: &Sensitivity,
        nuisances: &[f64; NUISANCES],
    ) -> Option<(Self, [[f64; NUISANCES]; NUISANCES])> {
        let columns = |residual: f64, place: Place| {
            let [ca, confinement] = match place {
                Place::Along { trace, place, normal } => sensitivity.outward(trace, place, normal),
                Place::Scalar(scalar) => sensitivity.scalars[scalar],
            };
            [residual, -ca, -confinement]
        };
        let eliminated = data.products(shape, nuisances, columns).eliminate()?;
        let [[sum, ..], by_ca, by_confinement] = eliminated.leading;
        let reduced = Self {
            matrix: [by_ca, by_confinement].map(|[_, ca, confinement]| [ca, confinement]),
            gradient: [by_ca[0], by_confinement[0]],
            nuisance_steps: eliminated.solved.map(|solved| solved.map(|x| -x)),
            sum,
        };
        Some((reduced, eliminated.nuisances))
    }

    /// The nuisance parameters after a step of Ca and a/l.
    fn displaced(&self, nuisances: &[f64; NUISANCES], [ca, confinement]: [f64; 2]) -> [f64; NUISANCES] {
        let [none, by_ca, by_confinement] = &self.nuisance_steps;
        core::array::from_fn(|i| nuisances[i] + none[i] + ca * by_ca[i] + confinement * by_confinement[i])
    }

    /// Derivatives of a nuisance parameter by Ca and a/l along the profile.
    pub(crate) fn by_parameters(&self, nuisance: usize) -> [f64; 2] {
        let [_, by_ca, by_confinement] = &self.nuisance_steps;
        [by_ca[nuisance], by_confinement[nuisance]]
    }

    /// The covariance of the two; none where the data do not determine them.
    pub(crate) fn covariance(&self) -> Option<[[f64; 2]; 2]> {
        let [[a, b], [_, c]] = self.matrix;
        let determinant = a * c - b * b;
        (a > 0.0 && determinant > 1e-12 * a * c)
            .then(|| [[c / determinant, -b / determinant], [-b / determinant, a / determinant]])
    }

    /// The damped step.
    fn step(&self, damping: f64) -> [f64; 2] {
        let [[a, b], [_, c]] = self.matrix;
        let (a, c) = (
            a * (1.0 + damping) + f64::MIN_POSITIVE,
            c * (1.0 + damping) + f64::MIN_POSITIVE,
        );
        let [p, q] = self.gradient;
        let determinant = a * c - b * b;
        if determinant > 1e-14 * a * c {
            [(b * q - c * p) / determinant, (b * p - a * q) / determinant]
        } else {
            [-p / a, 0.0]
        }
    }

    /// The step along a direction alone.
    fn step_along(&self, [x, y]: [f64; 2], damping: f64) -> [f64; 2] {
        let [[a, b], [_, c]] = self.matrix;
        let square = (1.0 + damping) * (a * x * x + 2.0 * b * x * y + c * y * y);
        let share = -(self.gradient[0] * x + self.gradient[1] * y) / square.max(f64::MIN_POSITIVE);
        [share * x, share * y]
    }

    /// By how much the sum would fall by the full step.
    fn fall_outside(&self) -> f64 {
        let [x, y] = self.step(0.0);
        -(self.gradient[0] * x + self.gradient[1] * y)
    }

    /// A step's length in standard deviations.
    fn length(&self, [x, y]: [f64; 2]) -> f64 {
        let [[a, b], [_, c]] = self.matrix;
        libm::sqrt((a * x * x + 2.0 * b * x * y + c * y * y).max(0.0))
    }
}

/// The fit of a side, and what it works with.
pub(crate) struct Fitter<'f, 'a, 'w> {
    pub(crate) shapes: &'f mut Shapes<'a, 'w>,
    pub(crate) domain: Domain<'a>,
}

impl Fitter<'_, '_, '_> {
    /// Sum and nuisances with the best of them at a place: a step of Newton from given ones.
    pub(crate) fn profiled(
        data: &Data<'_>,
        shape: &Shape,
        nuisances: &[f64; NUISANCES],
    ) -> Option<(f64, [f64; NUISANCES])> {
        let eliminated = data.products(shape, nuisances, |residual, _| [residual]).eliminate()?;
        let ([[sum]], [steps]) = (eliminated.leading, eliminated.solved);
        Some((sum, core::array::from_fn(|i| nuisances[i] - steps[i])))
    }

    /// Derivatives at a place; differences stay in the domain.
    pub(crate) fn sensitivity(
        &mut self,
        accuracy: Accuracy,
        side: Side,
        theta: [f64; 2],
        shape: &Shape,
    ) -> Result<Sensitivity, EvaluateError> {
        if accuracy == Accuracy::Start {
            return self.shapes.derivatives(shape, theta);
        }
        let domain = self.domain;
        let [least, greatest] = domain.confinements();
        self.shapes.secants(shape, |step| {
            [-1.0, 1.0].map(|sign| {
                let confinement = (theta[1] + sign * step[1]).clamp(least, greatest);
                let ca = theta[0] + sign * step[0];
                match domain.range(side, confinement) {
                    // The other parameter stays, or the difference is none of this one.
                    Some([low, high]) if step[1] == 0.0 || (low <= ca && ca <= high) => {
                        [ca.clamp(low, high), confinement]
                    }
                    _ => theta,
                }
            })
        })
    }

    /// A step that stays in the domain: at an edge along it.
    fn step(&self, reduced: &Reduced, side: Side, theta: [f64; 2], damping: f64) -> [f64; 2] {
        const AT: f64 = 1e-7;
        let to = |step: [f64; 2]| self.domain.clamp(side, [theta[0] + step[0], theta[1] + step[1]], theta);
        let step = reduced.step(damping);
        let [low, high] = self.domain.confinements();
        let wanted = [theta[0] + step[0], theta[1] + step[1]];
        let at_end = |value: f64, wanted: f64, low: f64, high: f64| {
            (value - low < AT && wanted < low) || (high - value < AT && wanted > high)
        };
        if at_end(theta[1], wanted[1], low, high) {
            return to(reduced.step_along([1.0, 0.0], damping));
        }
        let range = self.domain.range(side, theta[1]);
        let ahead = self.domain.range(side, wanted[1].clamp(low, high)).or(range);
        if let (Some(range), Some(ahead)) = (range, ahead) {
            for (end, sign) in [(0, -1.0), (1, 1.0)] {
                if sign * (theta[0] - range[end]) > -AT && sign * (wanted[0] - ahead[end]) > 0.0 {
                    const WAY: f64 = 0.002;
                    let beside = (theta[1] + WAY).min(high);
                    let back = beside - 2.0 * WAY;
                    let slope = match [back, beside].map(|confinement| self.domain.range(side, confinement)) {
                        [Some(before), Some(after)] => (after[end] - before[end]) / (2.0 * WAY),
                        _ => 0.0,
                    };
                    return to(reduced.step_along([slope, 1.0], damping));
                }
            }
        }
        to(step)
    }

    /// Fits from a start.
    pub(crate) fn fit(
        &mut self,
        data: &Data<'_>,
        start: Start<'_>,
        accuracy: Accuracy,
    ) -> Result<Option<Fit>, EvaluateError> {
        let side = start.side;
        let mut theta = self.domain.clamp(side, start.theta, start.theta);
        let mut nuisances = start.nuisances;
        let mut shape = self.shapes.at(theta)?;
        let data = &Data {
            bound: shape.bound,
            modes: if accuracy == Accuracy::Start { 0 } else { data.modes },
            ..*data
        };
        let mut slopes = start.slopes.cloned();
        let mut sum = data.sum(&shape, &nuisances);
        let mut damping = 1e-4;
        for step in 0..STEPS {
            let slopes = match &slopes {
                Some(known) if known.serve(theta) => known,
                _ => slopes.insert(Slopes {
                    theta,
                    sensitivity: self.sensitivity(accuracy, side, theta, &shape)?,
                }),
            };
            let Some((reduced, nuisance_matrix)) = Reduced::new(data, &shape, &slopes.sensitivity, &nuisances) else {
                return Ok(None);
            };
            let mut next = None;
            for _ in 0..TRIALS {
                let to = self.step(&reduced, side, theta, damping);
                let way = [to[0] - theta[0], to[1] - theta[1]];
                if reduced.length(way) < accuracy.close() || step + 1 == STEPS {
                    break;
                }
                let there = self.shapes.at(to)?;
                let displaced = reduced.displaced(&nuisances, way);
                let less = data.sum(&there, &displaced);
                if less < sum {
                    next = Some((to, there, displaced));
                    (sum, damping) = (less, (damping * 0.2).max(1e-6));
                    break;
                }
                damping = (damping * 10.0).max(1e-2);
            }
            match next {
                Some(next) => (theta, shape, nuisances) = next,
                None => {
                    let deviation = |i: usize| data.deviation(i);
                    let freedom = Factor::new(&nuisance_matrix).map_or(0.0, |factor| factor.log_determinant());
                    return Ok(Some(Fit {
                        side,
                        evidence: reduced.sum
                            + freedom
                            + (0..NUISANCES).map(|i| 2.0 * libm::log(deviation(i))).sum::<f64>(),
                        bound: data.bound,
                        scale: data.scale,
                        nuisance_matrix,
                        priors: core::array::from_fn(|i| 1.0 / (deviation(i) * deviation(i))),
                        theta,
                        nuisances: reduced.displaced(&nuisances, [0.0; 2]),
                        sum: reduced.sum,
                        fall_outside: reduced.fall_outside(),
                        reduced,
                        shape,
                        slopes: slopes.clone(),
                    }));
                }
            }
        }
        Ok(None)
    }
}
