//! The sum of squares that is made small: points of the contour, lengths, priors.
//!
//! A point's residual is its distance from the model's curve along the normal, less the edge's offset and the model's
//! own error. That error is a smooth function of the place along the curve, a sum of cosines with coefficients around 0
//! that are nuisance parameters like the rest: so errors of the model widen the intervals as much as they can move the
//! answer, and are not averaged away as if they were noise.

use crate::curve::{Curve, MAX_HALF, dot};
use crate::measurement::{Measured, Priors};
use crate::shapes::{HALF_WIDTH, LENGTH, RADIUS, REAR_DEPTH, SCALARS, Sensitivity, Shape};

/// Cosines of the model's error.
pub(crate) const MODES: usize = 24;
/// Unknowns beside the capsule's two.
pub(crate) const NUISANCES: usize = MODE + MODES;
/// All unknowns: ln Ca, a/l, then the nuisance parameters.
pub(crate) const UNKNOWNS: usize = 2 + NUISANCES;

/// Place of the shift along the flow among the nuisance parameters.
pub(crate) const SHIFT: usize = 0;
/// Place of the tilt.
pub(crate) const TILT: usize = 2;
/// Place of the edge's offset.
pub(crate) const EDGE: usize = 3;
/// Place of the relative error of the scale.
pub(crate) const SCALE: usize = 4;
/// Place of the first cosine.
pub(crate) const MODE: usize = 5;

/// Standard deviation that stands for no knowledge: of a shift, in l.
const FLAT: f64 = 10.0;
/// Standard deviation that stands for certainty.
const EXACT: f64 = 1e-9;

/// A point of the contour in the frame of the flow, in l about the contour's middle.
#[derive(Clone, Copy, Debug, Default)]
pub struct Point {
    pub(crate) place: [f64; 2],
    /// How many independent points it counts as.
    pub(crate) weight: f64,
    /// Its residual from the last fit, in l, and where it lies on the curve.
    pub(crate) residual: f64,
    pub(crate) along: f64,
    /// Whether it lies on the side y < 0.
    pub(crate) below: bool,
}

/// The data of the residuals, without the model's part.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Data<'p> {
    pub(crate) points: &'p [Point],
    pub(crate) scalars: [Option<Measured>; SCALARS],
    pub(crate) deviations: [f64; MODE],
    /// Factor of the model's bound.
    pub(crate) model: f64,
    /// Standard deviation of a point, in l.
    pub(crate) noise: f64,
    /// The model's 95 % bound, in l, that of one place for the whole of a fit: sums are comparable.
    pub(crate) bound: f64,
    /// The scale of the model's error: see `model_error`.
    pub(crate) scale: f64,
}

/// The normal equations of a least-squares problem.
#[derive(Clone, Debug)]
pub(crate) struct NormalEquations {
    pub(crate) sum: f64,
    pub(crate) gradient: [f64; UNKNOWNS],
    pub(crate) matrix: [[f64; UNKNOWNS]; UNKNOWNS],
}

impl NormalEquations {
    const ZERO: Self = Self {
        sum: 0.0,
        gradient: [0.0; UNKNOWNS],
        matrix: [[0.0; UNKNOWNS]; UNKNOWNS],
    };

    /// Adds weight * (residual + step_i)^2.
    fn add_prior(&mut self, i: usize, weight: f64, residual: f64) {
        self.sum += weight * residual * residual;
        self.gradient[i] += weight * residual;
        self.matrix[i][i] += weight;
    }

    /// Adds weight * (residual + row . step)^2; the matrix below its diagonal only.
    fn add(&mut self, weight: f64, residual: f64, row: &[f64; UNKNOWNS]) {
        self.sum += weight * residual * residual;
        for (i, a) in row.iter().enumerate() {
            let a = weight * a;
            self.gradient[i] += a * residual;
            for (entry, b) in self.matrix[i].iter_mut().zip(row).take(i + 1) {
                *entry += a * b;
            }
        }
    }
}

impl<'p> Data<'p> {
    /// Priors in l; the noise is set later.
    pub(crate) fn new(
        points: &'p [Point],
        scalars: [Option<Measured>; SCALARS],
        priors: &Priors,
        half_width_um: f64,
        noise: f64,
    ) -> Self {
        let edge = priors.edge_um / half_width_um;
        let mut deviations = [FLAT, FLAT, priors.tilt, edge, priors.scale];
        if points.is_empty() {
            // Lengths do not tell where the capsule is.
            deviations[..EDGE].fill(EXACT);
        }
        Self {
            points,
            scalars,
            deviations: deviations.map(|deviation| deviation.max(EXACT)),
            model: priors.model,
            noise,
            bound: 0.0,
            scale: 1.0,
        }
    }

    /// Standard deviation of each unknown beside Ca and a/l before the measurement.
    pub(crate) fn deviation(&self, nuisance: usize) -> f64 {
        match self.deviations.get(nuisance) {
            Some(deviation) => *deviation,
            None => (self.scale * self.model * self.bound * spectrum(nuisance - MODE)).max(EXACT),
        }
    }

    /// A point as the nuisances place it, and its derivatives by tilt and scale.
    fn displaced(&self, [x, y]: [f64; 2], nuisances: &[f64; NUISANCES]) -> [[f64; 2]; 3] {
        let (cos, sin, grown) = (
            libm::cos(nuisances[TILT]),
            libm::sin(nuisances[TILT]),
            1.0 + nuisances[SCALE],
        );
        let turned = [cos * x + sin * y, cos * y - sin * x];
        [
            [
                grown * turned[0] - nuisances[SHIFT],
                grown * turned[1] - nuisances[SHIFT + 1],
            ],
            [grown * turned[1], -grown * turned[0]],
            turned,
        ]
    }

    /// Residual of a point without the model's error, its place along the curve, and its row but for the capsule's
    /// part.
    fn residual(&self, curve: &Curve, place: [f64; 2], nuisances: &[f64; NUISANCES]) -> Residual {
        let [place, by_tilt, by_scale] = self.displaced(place, nuisances);
        let side = if place[1] < 0.0 { -1.0 } else { 1.0 };
        let foot = curve.nearest([place[0], side * place[1]]);
        let normal = [foot.normal[0], side * foot.normal[1]];
        Residual {
            along: foot.place,
            normal: foot.normal,
            value: foot.distance - nuisances[EDGE],
            row: [
                -normal[0],
                -normal[1],
                dot(normal, by_tilt),
                -1.0,
                dot(normal, by_scale),
            ],
        }
    }

    /// The residual of a place, in l, less the model's error; its place along the curve, and whether it lies below.
    pub(crate) fn point_residual(
        &self,
        curve: &Curve,
        place: [f64; 2],
        nuisances: &[f64; NUISANCES],
    ) -> (f64, f64, bool) {
        let residual = self.residual(curve, place, nuisances);
        let modes = cosines(curve, residual.along);
        let error: f64 = modes.iter().zip(&nuisances[MODE..]).map(|(mode, c)| mode * c).sum();
        let [[_, y], ..] = self.displaced(place, nuisances);
        (residual.value - error, residual.along, y < 0.0)
    }

    /// The outward normal at a place of the contour, in its frame.
    pub(crate) fn normal_at(&self, curve: &Curve, place: [f64; 2], nuisances: &[f64; NUISANCES]) -> [f64; 2] {
        let [x, y] = self
            .residual(curve, place, nuisances)
            .row
            .first_chunk::<2>()
            .map_or([0.0; 2], |n| n.map(|x| -x));
        let (cos, sin) = (libm::cos(nuisances[TILT]), libm::sin(nuisances[TILT]));
        [cos * x - sin * y, cos * y + sin * x]
    }

    /// Each residual at a place, with its weight, its derivatives by the nuisances beside the two, and where its
    /// derivatives by the two are to be looked up.
    pub(crate) fn jacobian_rows(
        &self,
        shape: &Shape,
        nuisances: &[f64; NUISANCES],
        mut each: impl FnMut(f64, f64, &[f64; NUISANCES], Place),
    ) {
        let curve = &shape.curve;
        let precision = 1.0 / (self.noise * self.noise);
        for point in self.points {
            let residual = self.residual(curve, point.place, nuisances);
            let mut row = [0.0; NUISANCES];
            row[..MODE].copy_from_slice(&residual.row);
            let mut value = residual.value;
            let modes = cosines(curve, residual.along);
            for ((entry, mode), coefficient) in row[MODE..].iter_mut().zip(modes).zip(&nuisances[MODE..]) {
                value -= mode * coefficient;
                *entry = -mode;
            }
            each(precision * point.weight, value, &row, residual.place());
        }
        for (s, measured) in self.scalars.iter().enumerate() {
            let Some(Measured { value, deviation }) = *measured else {
                continue;
            };
            // Contributions of the edge and of the scale to a length.
            let (edge, scale) = match s {
                LENGTH => (2.0, value),
                HALF_WIDTH => (1.0, value),
                REAR_DEPTH => (0.0, value),
                _ => (0.0, 0.0),
            };
            let mut row = [0.0; NUISANCES];
            (row[EDGE], row[SCALE]) = (-edge, scale);
            let residual = value + scale * nuisances[SCALE] - edge * nuisances[EDGE] - shape.scalars[s];
            // A length errs as the outline does; the radius is what is asked for.
            let own = if s == RADIUS {
                0.0
            } else {
                0.5 * self.model * self.bound
            };
            each(
                1.0 / (deviation * deviation + own * own),
                residual,
                &row,
                Place::Scalar(s),
            );
        }
        for (nuisance, value) in nuisances.iter().enumerate() {
            let deviation = self.deviation(nuisance);
            let mut row = [0.0; NUISANCES];
            row[nuisance] = 1.0;
            each(1.0 / (deviation * deviation), *value, &row, Place::Prior(nuisance));
        }
    }

    /// The normal equations at a place; without the capsule's part if there is no sensitivity.
    pub(crate) fn normal(
        &self,
        shape: &Shape,
        sensitivity: Option<&Sensitivity>,
        nuisances: &[f64; NUISANCES],
    ) -> NormalEquations {
        let mut normal = NormalEquations::ZERO;
        self.jacobian_rows(shape, nuisances, |weight, residual, by_nuisances, place| {
            if let Place::Prior(nuisance) = place {
                normal.add_prior(2 + nuisance, weight, residual);
                return;
            }
            let mut row = [0.0; UNKNOWNS];
            if let Some(sensitivity) = sensitivity {
                let own = match place {
                    Place::Along { place, normal } => sensitivity.outward(place, normal),
                    Place::Scalar(scalar) => sensitivity.scalars[scalar],
                    Place::Prior(_) => [0.0; 2],
                };
                row[..2].copy_from_slice(&own.map(|derivative| -derivative));
            }
            row[2..].copy_from_slice(by_nuisances);
            normal.add(weight, residual, &row);
        });
        for i in 0..UNKNOWNS {
            for j in 0..i {
                normal.matrix[j][i] = normal.matrix[i][j];
            }
        }
        normal
    }
}

/// Where a residual has its derivatives by Ca and a/l.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Place {
    /// At a place of the curve with a normal.
    Along { place: f64, normal: [f64; 2] },
    /// Those of a scalar.
    Scalar(usize),
    /// It has none: the prior of a nuisance parameter, by number.
    Prior(usize),
}

impl Place {
    pub(crate) fn value<const W: usize>(
        self,
        curve: &Curve,
        outward: &[[f64; W]; MAX_HALF],
        scalars: &[[f64; W]; SCALARS],
    ) -> [f64; W] {
        match self {
            Self::Along { place, .. } => curve.value(outward, place),
            Self::Scalar(scalar) => scalars[scalar],
            Self::Prior(_) => [0.0; W],
        }
    }
}

struct Residual {
    along: f64,
    /// The curve's outward normal there, on the side y >= 0.
    normal: [f64; 2],
    value: f64,
    row: [f64; MODE],
}

impl Residual {
    fn place(&self) -> Place {
        Place::Along {
            place: self.along,
            normal: self.normal,
        }
    }
}

/// cos(k pi s) at a share s of the way along the curve.
fn cosines(curve: &Curve, place: f64) -> [f64; MODES] {
    let share = place / curve.count().saturating_sub(1).max(1) as f64;
    let first = libm::cos(core::f64::consts::PI * share);
    let mut cosines = [1.0; MODES];
    cosines[1] = first;
    for k in 2..MODES {
        cosines[k] = 2.0 * first * cosines[k - 1] - cosines[k - 2];
    }
    cosines
}

/// sigma_k: the standard deviation of cosine `k` of the model's error, in the model's 95 % bound.
pub(crate) fn spectrum(k: usize) -> f64 {
    let ratio = k as f64 / 7.0;
    0.2 / (1.0 + ratio * libm::sqrt(ratio))
}
