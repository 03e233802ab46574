//! The fit of several frames: see `sequence`.

use crate::algebra::Factor;
use crate::curve::{Curve, dot};
use crate::domain::Side;
use crate::error::IdentifyError;
use crate::fit::{Accuracy, Fitter};
use crate::grid::{FEATURES, Grid, distance, of_curve};
use crate::measurement::{Contour, MAX_FRAMES, Measurement, Sequence};
use crate::noise::{Bins, LEAST_NOISE, Noise};
use crate::residuals::{Data, EDGE, NUISANCES, Place, Point, SCALE, SHIFT, Trace};
use crate::shapes::{SCALARS, Shape};
use crate::solver::Solver;
use crate::starts::{Candidate, START_POINTS};
use capsule_core::EvaluateError;

/// Unknowns of all frames: ln Ca, a/l, edge, scale.
pub(crate) const COMMON: usize = 4;
/// Unknowns of a frame: its instant, then the nuisance parameters; edge and scale stay where they are.
const OWN: usize = 1 + NUISANCES;
/// Instants at which starts are looked for.
const INSTANTS: usize = 10;
/// Capsules from which a fit starts.
pub(crate) const STARTS: usize = 2;
/// The most steps of a fit.
const STEPS: usize = 15;
/// Longest step of an instant, in that and 0.2 l/V: where little changes any more, steps would be far too long.
const LONGEST: f64 = 0.5;
/// Step of the difference that gives the derivative in time, in l/V.
const TIME_STEP: f64 = 0.02;
/// A frame and the fit's part in it.
#[derive(Clone, Copy)]
pub(crate) struct Frame {
    pub(crate) bins: Bins,
    /// Of a point, as if all were independent.
    pub(crate) noise: f64,
    /// The residuals of all points; none before they are gathered.
    pub(crate) residuals: Noise,
    pub(crate) t: f64,
    pub(crate) nuisances: [f64; NUISANCES],
}

/// Normal equations of the common unknowns, a frame's own eliminated.
#[derive(Clone, Copy)]
pub(crate) struct Linear {
    pub(crate) gradient: [f64; COMMON],
    pub(crate) matrix: [[f64; COMMON]; COMMON],
    /// Step of the own unknowns at fixed common ones, and by a unit of each.
    pub(crate) steps: [[f64; OWN]; COMMON + 1],
    /// Variance of the instant at fixed common unknowns.
    pub(crate) variance: f64,
    /// Twice the negative logarithm of the own unknowns' share in the marginal likelihood: the logarithms of their
    /// normal matrix' determinant and of the priors' variances.
    freedom: f64,
}

pub(crate) struct Fit<'f, 'a, 'w, 's> {
    pub(crate) fitter: Fitter<'f, 'a, 'w>,
    pub(crate) sequence: &'s Sequence<'s>,
    pub(crate) end: f64,
    pub(crate) side: Side,
    pub(crate) theta: [f64; 2],
    pub(crate) frames: [Frame; MAX_FRAMES],
}

/// A capsule from which a fit starts, and the instants of the frames.
type Start = (Side, [f64; 2], [f64; MAX_FRAMES]);

impl<'a, 'w> Fit<'_, 'a, 'w, '_> {
    pub(crate) fn count(&self) -> usize {
        self.sequence.contours.len()
    }

    pub(crate) fn shape(&mut self, theta: [f64; 2], t: f64) -> Result<Shape, EvaluateError> {
        self.fitter.shapes.set_instant(t);
        self.fitter.shapes.at(theta)
    }

    /// The capsules from which to start: of steady frames, those of the first contour alone; of a transient, those of
    /// the grid whose outlines come nearest to all contours, each at its best instants.
    pub(crate) fn starts(&mut self, grid: &Grid) -> Result<[Option<Start>; STARTS], IdentifyError> {
        if let (true, Some(first)) = (self.sequence.steady, self.sequence.contours.first()) {
            let instants = [self.end; MAX_FRAMES];
            self.fitter.shapes.set_instant(self.end);
            let measurement = self.sequence.measurement(first);
            let (_, candidates) = self.solver(&measurement).candidates(grid)?;
            let start = |candidate: Candidate| (candidate.start.side, candidate.start.theta, instants);
            return Ok(candidates.map(|candidate| candidate.map(start)));
        }
        let half_width = self.sequence.setup.half_width_um;
        let mut measured = [[None; FEATURES]; MAX_FRAMES];
        for (features, contour) in measured.iter_mut().zip(self.sequence.contours) {
            *features = contour.framed(contour.direction, half_width).features;
        }
        let mut best = [None::<(f64, Start)>; STARTS];
        for (side, theta) in grid.places() {
            let mut nearest = [(f64::INFINITY, self.end); MAX_FRAMES];
            // Early instants follow each other closely: there the shape changes fast.
            for k in 1..=INSTANTS {
                let share = k as f64 / INSTANTS as f64;
                let t = self.end * share * share;
                let shape = self.shape(theta, t)?;
                let own = of_curve(&shape.curve);
                for (nearest, features) in nearest.iter_mut().zip(&measured).take(self.count()) {
                    let distance = distance(features, shape.scalars.iter().chain(&own).copied());
                    if distance < nearest.0 {
                        *nearest = (distance, t);
                    }
                }
            }
            let sum: f64 = nearest.iter().take(self.count()).map(|(distance, _)| distance).sum();
            let start = (sum, (side, theta, nearest.map(|(_, t)| t)));
            // The least first.
            if let Some(place) = (0..STARTS).find(|i| best[*i].is_none_or(|(other, _)| sum < other)) {
                best[place..].rotate_right(1);
                best[place] = Some(start);
            }
        }
        Ok(best.map(|best| best.map(|(_, start)| start)))
    }

    /// Begins with a few points of each contour.
    pub(crate) fn begin(
        &mut self,
        side: Side,
        theta: [f64; 2],
        instants: [f64; MAX_FRAMES],
    ) -> Result<(), EvaluateError> {
        (self.side, self.theta) = (side, self.fitter.domain.clamp(side, theta, theta));
        let half_width = self.sequence.setup.half_width_um;
        for (j, contour) in self.sequence.contours.iter().enumerate() {
            let shape = self.shape(self.theta, instants[j])?;
            let [front, rear] = shape.curve.extent();
            let middle = self.sequence.middle(contour);
            let measurement = self.sequence.measurement(contour);
            let noise = self.solver(&measurement).first_noise();
            let frame = &mut self.frames[j];
            (frame.t, frame.noise, frame.nuisances) = (instants[j], noise, [0.0; NUISANCES]);
            frame.nuisances[SHIFT] = -0.5 * (front + rear);
            let all = contour.points_um.len();
            let count = all.min(START_POINTS);
            frame.bins.count = count;
            for (i, point) in frame.bins.points.iter_mut().enumerate().take(count) {
                let one = Contour {
                    points_um: contour.points_um.get(i * all / count..).unwrap_or_default(),
                    ..*contour
                };
                one.fill(contour.direction, half_width, middle, core::slice::from_mut(point));
            }
        }
        Ok(())
    }

    fn solver<'x, 'm>(&'x mut self, measurement: &'m Measurement<'m>) -> Solver<'x, 'a, 'w, 'm> {
        Solver {
            fitter: Fitter {
                shapes: &mut *self.fitter.shapes,
                domain: self.fitter.domain,
            },
            measurement,
            scalars: [None; SCALARS],
        }
    }

    /// Noise, weights and bins of all points of each contour.
    pub(crate) fn gather(&mut self, points: &mut [Point]) -> Result<(), EvaluateError> {
        let half_width = self.sequence.setup.half_width_um;
        for (j, contour) in self.sequence.contours.iter().enumerate() {
            let points = points.get_mut(..contour.points_um.len()).unwrap_or_default();
            contour.fill(contour.direction, half_width, self.sequence.middle(contour), points);
            let shape = self.shape(self.theta, self.frames[j].t)?;
            let measurement = self.sequence.measurement(contour);
            let nuisances = self.frames[j].nuisances;
            let solver = self.solver(&measurement);
            let noise = solver.estimate_noise(Trace::Outline, &shape, &nuisances, None, points);
            let data = solver.data(&[], 1.0);
            let frame = &mut self.frames[j];
            (frame.noise, frame.residuals) = (noise.effective.max(LEAST_NOISE), noise);
            frame.bins = Bins::gather(&data, (Trace::Outline, &shape), &nuisances, points);
        }
        Ok(())
    }

    /// The data of a frame, with the priors of edge and scale as they count once for all frames.
    pub(crate) fn data<'p>(&mut self, j: usize, frame: &'p Frame, bound: f64) -> Data<'p> {
        let root = libm::sqrt(self.count() as f64);
        let measurement = self.sequence.measurement(&self.sequence.contours[j]);
        let mut data = self.solver(&measurement).data(frame.bins.all(), frame.noise);
        (data.bound, data.scale) = (bound, root);
        (data.deviations[EDGE], data.deviations[SCALE]) = (root * data.deviations[EDGE], root * data.deviations[SCALE]);
        data
    }

    /// The sum of squares of all frames.
    fn sum(&mut self, theta: [f64; 2], frames: &[Frame; MAX_FRAMES]) -> Result<f64, EvaluateError> {
        let mut sum = 0.0;
        for (j, frame) in frames.iter().enumerate().take(self.count()) {
            let shape = self.shape(theta, frame.t)?;
            let data = self.data(j, frame, shape.bound);
            sum += data.sum(&shape, &frame.nuisances);
        }
        Ok(sum)
    }

    /// The normal equations of a frame at a capsule, its own unknowns eliminated.
    fn linear(&mut self, j: usize, frame: &Frame) -> Result<Option<Linear>, EvaluateError> {
        let theta = self.theta;
        let shape = self.shape(theta, frame.t)?;
        let sensitivity = self.fitter.sensitivity(Accuracy::Full, self.side, theta, &shape)?;
        let in_time = if self.sequence.steady {
            Curve::EMPTY
        } else {
            self.rate(theta, frame.t, &shape)?
        };
        let data = self.data(j, frame, shape.bound);
        let mut gradient = [0.0; COMMON];
        let mut matrix = [[0.0; COMMON]; COMMON];
        let mut own_gradient = [0.0; OWN];
        let mut own_matrix = [[0.0; OWN]; OWN];
        let mut mixed = [[0.0; OWN]; COMMON];
        data.rows(&shape, &frame.nuisances, |weight, residual, row, place| {
            let by_nuisances = &row.all();
            let mut common = [0.0, 0.0, by_nuisances[EDGE], by_nuisances[SCALE]];
            let mut own = [0.0; OWN];
            own[1..].copy_from_slice(by_nuisances);
            (own[1 + EDGE], own[1 + SCALE]) = (0.0, 0.0);
            if let Place::Along { trace, place, normal } = place {
                let [ca, confinement] = sensitivity.outward(trace, place, normal);
                (common[0], common[1]) = (-ca, -confinement);
                own[0] = -dot(in_time.at_place(place), normal);
            }
            for (i, a) in common.iter().enumerate() {
                gradient[i] += weight * a * residual;
                matrix[i]
                    .iter_mut()
                    .zip(common)
                    .for_each(|(entry, b)| *entry += weight * a * b);
                mixed[i]
                    .iter_mut()
                    .zip(own)
                    .for_each(|(entry, b)| *entry += weight * a * b);
            }
            for (i, a) in own.iter().enumerate() {
                own_gradient[i] += weight * a * residual;
                own_matrix[i]
                    .iter_mut()
                    .zip(own)
                    .for_each(|(entry, b)| *entry += weight * a * b);
            }
        });
        for (nuisance, weight, value) in data.priors(&frame.nuisances) {
            let (gradient, entry) = match nuisance {
                EDGE => (&mut gradient[2], &mut matrix[2][2]),
                SCALE => (&mut gradient[3], &mut matrix[3][3]),
                i => (&mut own_gradient[1 + i], &mut own_matrix[1 + i][1 + i]),
            };
            *gradient += weight * value;
            *entry += weight;
        }
        // An unknown that is held has an empty row: with a 1 on its diagonal the factor exists.
        for i in [0, 1 + EDGE, 1 + SCALE] {
            if own_matrix[i][i] == 0.0 {
                own_matrix[i][i] = 1.0;
            }
        }
        let Some(factor) = Factor::new(&own_matrix) else {
            return Ok(None);
        };
        let negative = |right: &[f64; OWN]| factor.solve(&right.map(|x| -x));
        let mut steps = [[0.0; OWN]; COMMON + 1];
        steps[0] = negative(&own_gradient);
        for (step, mixed) in steps[1..].iter_mut().zip(&mixed) {
            *step = negative(mixed);
        }
        let product = |a: &[f64; OWN], b: &[f64; OWN]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        Ok(Some(Linear {
            gradient: core::array::from_fn(|i| gradient[i] + product(&mixed[i], &steps[0])),
            matrix: core::array::from_fn(|i| {
                core::array::from_fn(|k| matrix[i][k] + product(&mixed[i], &steps[1 + k]))
            }),
            steps,
            variance: factor.inverse_column(0)[0],
            freedom: factor.log_determinant() + (0..NUISANCES).map(|i| 2.0 * libm::log(data.deviation(i))).sum::<f64>(),
        }))
    }

    /// The derivative of the curve in time.
    fn rate(&mut self, theta: [f64; 2], t: f64, shape: &Shape) -> Result<Curve, EvaluateError> {
        let [before, after] = [(t - TIME_STEP).max(0.0), (t + TIME_STEP).min(self.end)];
        let [low, high] = [self.shape(theta, before)?, self.shape(theta, after)?];
        Ok(self
            .fitter
            .shapes
            .difference(shape, [&low, &high], 1.0 / (after - before)))
    }

    /// The normal equations of each frame; none if one has no solution.
    pub(crate) fn total(&mut self) -> Result<Option<[Linear; MAX_FRAMES]>, EvaluateError> {
        let zero = Linear {
            gradient: [0.0; COMMON],
            matrix: [[0.0; COMMON]; COMMON],
            steps: [[0.0; OWN]; COMMON + 1],
            variance: 0.0,
            freedom: 0.0,
        };
        let frames = self.frames;
        let mut linears = [zero; MAX_FRAMES];
        for j in 0..self.count() {
            match self.linear(j, &frames[j])? {
                Some(linear) => linears[j] = linear,
                None => return Ok(None),
            }
        }
        Ok(Some(linears))
    }

    /// Twice the negative logarithm of the marginal likelihood where a fit has ended, the unknowns beside Ca and a/l
    /// integrated over: by it fits with different bounds of the model are compared.
    pub(crate) fn evidence(&mut self, sum: f64) -> Result<Option<f64>, EvaluateError> {
        let Some(linears) = self.total()? else {
            return Ok(None);
        };
        let [.., [_, _, a, b], [_, _, _, c]] = summed(&linears);
        let own: f64 = linears.iter().take(self.count()).map(|linear| linear.freedom).sum();
        // Each fit has a noise of its own.
        let noise = self.frames.iter().take(self.count()).map(|frame| {
            let weight: f64 = frame.bins.all().iter().map(|point| point.weight).sum();
            2.0 * weight / frame.residuals.correlated.max(1.0) * libm::log(frame.noise)
        });
        Ok(Some(sum + noise.sum::<f64>() + own + libm::log(a * c - b * b)))
    }

    /// Fits by steps of Gauss and Newton with Levenberg's damping; the sum of squares where it ends.
    pub(crate) fn run(&mut self) -> Result<Option<f64>, EvaluateError> {
        const TRIALS: usize = 6;
        const CLOSE: f64 = 0.01;
        let mut damping = 1e-3;
        let frames = self.frames;
        let mut here = self.sum(self.theta, &frames)?;
        for _ in 0..STEPS {
            let Some(linears) = self.total()? else {
                return Ok(None);
            };
            let mut moved = false;
            for _ in 0..TRIALS {
                let Some(step) = step(&linears, damping) else {
                    return Ok(None);
                };
                let wanted = [self.theta[0] + step[0], self.theta[1] + step[1]];
                let to = self.fitter.domain.clamp(self.side, wanted, self.theta);
                let frames = self.stepped(&linears, &step);
                let there = self.sum(to, &frames)?;
                if there < here {
                    (self.theta, self.frames) = (to, frames);
                    (damping, moved) = ((0.2 * damping).max(1e-7), here - there > CLOSE);
                    here = there;
                    break;
                }
                damping = (10.0 * damping).max(1e-3);
            }
            if !moved {
                break;
            }
        }
        Ok(Some(here))
    }

    /// The frames after a step of the common unknowns.
    fn stepped(&self, linears: &[Linear; MAX_FRAMES], step: &[f64; COMMON]) -> [Frame; MAX_FRAMES] {
        let mut frames = self.frames;
        for (frame, linear) in frames.iter_mut().zip(linears).take(self.count()) {
            let own: [f64; OWN] = core::array::from_fn(|i| {
                linear.steps[0][i] + (0..COMMON).map(|k| step[k] * linear.steps[1 + k][i]).sum::<f64>()
            });
            if !self.sequence.steady {
                let most = LONGEST * (frame.t + 0.2);
                frame.t = (frame.t + own[0].clamp(-most, most)).clamp(0.0, self.end);
            }
            frame
                .nuisances
                .iter_mut()
                .zip(&own[1..])
                .for_each(|(x, step)| *x += step);
            frame.nuisances[EDGE] += step[2];
            frame.nuisances[SCALE] += step[3];
        }
        frames
    }
}

/// By how much the sum would fall by the full step of all common unknowns, if it could leave the domain.
pub(crate) fn fall_outside(linears: &[Linear; MAX_FRAMES]) -> f64 {
    let gradient = gradient(linears);
    let step = step(linears, 0.0).unwrap_or([0.0; COMMON]);
    -gradient.iter().zip(step).map(|(g, step)| g * step).sum::<f64>()
}

/// By how much the sum would fall if a frame had a capsule of its own, edge and scale as they are.
pub(crate) fn fall(linear: &Linear) -> f64 {
    let [[a, b, ..], [_, c, ..], ..] = linear.matrix;
    let [p, q, ..] = linear.gradient;
    let determinant = a * c - b * b;
    if determinant > 1e-12 * a * c {
        (c * p * p - 2.0 * b * p * q + a * q * q) / determinant
    } else {
        0.0
    }
}

pub(crate) fn summed(linears: &[Linear; MAX_FRAMES]) -> [[f64; COMMON]; COMMON] {
    core::array::from_fn(|i| core::array::from_fn(|k| linears.iter().map(|linear| linear.matrix[i][k]).sum()))
}

/// The damped step of the common unknowns.
fn step(linears: &[Linear; MAX_FRAMES], damping: f64) -> Option<[f64; COMMON]> {
    let mut matrix = summed(linears);
    for (i, row) in matrix.iter_mut().enumerate() {
        row[i] *= 1.0 + damping;
    }
    Some(Factor::new(&matrix)?.solve(&gradient(linears).map(|g| -g)))
}

fn gradient(linears: &[Linear; MAX_FRAMES]) -> [f64; COMMON] {
    core::array::from_fn(|i| linears.iter().map(|linear| linear.gradient[i]).sum())
}
