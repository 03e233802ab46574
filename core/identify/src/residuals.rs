//! The sum of squares that is made small: points of the contour and of a dent line, lengths, priors.
//!
//! A point's residual is its distance from the model's curve along the normal, less the edge's offset and the model's
//! own error. That error is a smooth function of the place along the curve, a sum of cosines with coefficients around 0
//! that are nuisance parameters like the rest: so errors of the model widen the intervals as much as they can move the
//! answer, and are not averaged away as if they were noise. Along a dent line it is not fitted: there the model errs
//! in a few places independently.

use crate::curve::{Curve, MAX_HALF, dot};
use crate::measurement::{Measured, Priors};
use crate::products::{COSINES, Products, Row};
use crate::shapes::{HALF_WIDTH, LENGTH, RADIUS, REAR_DEPTH, SCALARS, Shape};

/// Cosines of the model's error.
pub(crate) const MODES: usize = 24;
/// Unknowns beside the capsule's two.
pub(crate) const NUISANCES: usize = MODE + MODES;

/// Place of the shift along the flow among the nuisance parameters.
pub(crate) const SHIFT: usize = 0;
/// Place of the tilt.
pub(crate) const TILT: usize = 2;
/// Place of the edge's offset.
pub(crate) const EDGE: usize = 3;
/// Place of the relative error of the scale.
pub(crate) const SCALE: usize = 4;
/// Place of the offset of a dent line.
pub(crate) const LINE: usize = 5;
/// Place of the first cosine.
pub(crate) const MODE: usize = 6;

/// In how many places along a dent line the model errs independently: it is about a fifth of the way along the
/// section, over which the errors of 24 cosines have about so many degrees of freedom.
const INDEPENDENT: f64 = 4.0;

/// Standard deviation that stands for no knowledge: of a shift, in l.
const FLAT: f64 = 10.0;
/// Standard deviation that stands for certainty.
const EXACT: f64 = 1e-9;

/// The curve that points are seen along.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Trace {
    Outline,
    DentLine,
}

impl Trace {
    /// The curve of a shape.
    pub(crate) fn curve(self, shape: &Shape) -> &Curve {
        match self {
            Self::Outline => &shape.curve,
            Self::DentLine => &shape.section,
        }
    }

    /// The place among the nuisance parameters of its offset, by which it is drawn too far out.
    fn offset(self) -> usize {
        match self {
            Self::Outline => EDGE,
            Self::DentLine => LINE,
        }
    }
}

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

impl Point {
    pub(crate) const ORIGIN: Self = Self {
        place: [0.0; 2],
        weight: 0.0,
        residual: 0.0,
        along: 0.0,
        below: false,
    };
}

/// The data of the residuals, without the model's part.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Data<'p> {
    pub(crate) points: &'p [Point],
    /// Points of a dent line, and their standard deviation, in l.
    pub(crate) line: &'p [Point],
    pub(crate) line_noise: f64,
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
    /// How many of its cosines are fitted.
    pub(crate) modes: usize,
}

/// Where nuisance parameters place the contour's points.
#[derive(Clone, Copy)]
struct Placement {
    cos: f64,
    sin: f64,
    grown: f64,
    shift: [f64; 2],
}

impl Placement {
    fn new(nuisances: &[f64; NUISANCES]) -> Self {
        Self {
            cos: libm::cos(nuisances[TILT]),
            sin: libm::sin(nuisances[TILT]),
            grown: 1.0 + nuisances[SCALE],
            shift: [nuisances[SHIFT], nuisances[SHIFT + 1]],
        }
    }

    fn turned(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.cos * x + self.sin * y, self.cos * y - self.sin * x]
    }

    fn placed(&self, point: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.turned(point);
        [self.grown * x - self.shift[0], self.grown * y - self.shift[1]]
    }

    /// The nearest place of a curve to a point, and the point's distance.
    fn residual(&self, curve: &Curve, point: [f64; 2]) -> Residual {
        let [x, y] = self.placed(point);
        let side = if y < 0.0 { -1.0 } else { 1.0 };
        let foot = curve.nearest([x, side * y]);
        Residual {
            along: foot.place,
            normal: foot.normal,
            side,
            distance: foot.distance,
        }
    }

    /// Its derivatives by shift, tilt, offsets and scale.
    fn head(&self, trace: Trace, residual: &Residual, point: [f64; 2]) -> [f64; MODE] {
        let [x, y] = self.turned(point);
        let normal = residual.placed_normal();
        let mut head = [0.0; MODE];
        (head[SHIFT], head[SHIFT + 1]) = (-normal[0], -normal[1]);
        head[TILT] = dot(normal, [self.grown * y, -self.grown * x]);
        head[SCALE] = dot(normal, [x, y]);
        head[trace.offset()] = -1.0;
        head
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
        let mut deviations = [FLAT, FLAT, priors.tilt, edge, priors.scale, edge];
        if points.is_empty() {
            // Lengths do not tell where the capsule is.
            deviations[..EDGE].fill(EXACT);
        }
        Self {
            points,
            line: &[],
            line_noise: 0.0,
            scalars,
            deviations: deviations.map(|deviation| deviation.max(EXACT)),
            model: priors.model,
            noise,
            bound: 0.0,
            scale: 1.0,
            modes: MODES,
        }
    }

    /// Standard deviation of each unknown beside Ca and a/l before the measurement.
    pub(crate) fn deviation(&self, nuisance: usize) -> f64 {
        match self.deviations.get(nuisance) {
            Some(deviation) => *deviation,
            None => (self.scale * self.model * self.bound * spectrum(nuisance - MODE)).max(EXACT),
        }
    }

    /// How much of the model's error nuisance parameters ask for: the sum of squares of its cosines' coefficients, each
    /// in its standard deviation where the scale is 1.
    pub(crate) fn structure(&self, nuisances: &[f64; NUISANCES]) -> f64 {
        let shares = (MODE..NUISANCES).map(|i| nuisances[i] * self.scale / self.deviation(i));
        shares.map(|share| share * share).sum()
    }

    /// The residual of a place, in l, less the model's error; its place along the curve, and whether it lies below.
    pub(crate) fn point_residual(
        &self,
        trace: Trace,
        shape: &Shape,
        place: [f64; 2],
        nuisances: &[f64; NUISANCES],
    ) -> (f64, f64, bool) {
        let curve = trace.curve(shape);
        let residual = Placement::new(nuisances).residual(curve, place);
        let error = match trace {
            Trace::Outline => self.model_error(curve, residual.along, nuisances),
            Trace::DentLine => 0.0,
        };
        let value = residual.distance - nuisances[trace.offset()] - error;
        (value, residual.along, residual.side < 0.0)
    }

    /// The outward normal at a place of the contour, in its frame.
    pub(crate) fn normal_at(&self, curve: &Curve, place: [f64; 2], nuisances: &[f64; NUISANCES]) -> [f64; 2] {
        let placement = Placement::new(nuisances);
        let [x, y] = placement.residual(curve, place).placed_normal();
        let Placement { cos, sin, .. } = placement;
        [cos * x - sin * y, cos * y + sin * x]
    }

    /// The model's error at a place along the curve.
    fn model_error(&self, curve: &Curve, along: f64, nuisances: &[f64; NUISANCES]) -> f64 {
        let cosines: [f64; MODES] = cosines(curve, along, self.modes);
        cosines
            .iter()
            .zip(&nuisances[MODE..])
            .map(|(cosine, c)| cosine * c)
            .sum()
    }

    /// Each length's residual, with its weight and its derivatives by the nuisances.
    fn lengths(&self, shape: &Shape, nuisances: &[f64; NUISANCES], mut each: impl FnMut(f64, f64, &Row, Place)) {
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
            let mut row = Row {
                head: [0.0; MODE],
                cosines: [0.0; COSINES],
            };
            (row.head[EDGE], row.head[SCALE]) = (-edge, scale);
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
    }

    /// The weight of a bin of a dent line, by that of its points.
    fn line_weight(&self, weight: f64) -> f64 {
        let own = 0.5 * self.model * self.bound;
        let own = own * own * self.line.len() as f64 / INDEPENDENT;
        1.0 / (self.line_noise * self.line_noise / weight + own)
    }

    /// Each residual of points and lengths, with its weight, its derivatives by the nuisances, and where its
    /// derivatives by the two are to be looked up.
    pub(crate) fn rows(
        &self,
        shape: &Shape,
        nuisances: &[f64; NUISANCES],
        mut each: impl FnMut(f64, f64, &Row, Place),
    ) {
        let curve = &shape.curve;
        let placement = Placement::new(nuisances);
        let precision = 1.0 / (self.noise * self.noise);
        for point in self.points {
            let residual = placement.residual(curve, point.place);
            let row = Row {
                head: placement.head(Trace::Outline, &residual, point.place),
                cosines: cosines(curve, residual.along, (2 * self.modes).min(COSINES)),
            };
            let modes = row.cosines.iter().zip(&nuisances[MODE..]).take(self.modes);
            let error: f64 = modes.map(|(cosine, c)| cosine * c).sum();
            let value = residual.distance - nuisances[EDGE] - error;
            each(precision * point.weight, value, &row, residual.place(Trace::Outline));
        }
        for point in self.line {
            let residual = placement.residual(&shape.section, point.place);
            let row = Row {
                head: placement.head(Trace::DentLine, &residual, point.place),
                cosines: [0.0; COSINES],
            };
            let value = residual.distance - nuisances[LINE];
            each(
                self.line_weight(point.weight),
                value,
                &row,
                residual.place(Trace::DentLine),
            );
        }
        self.lengths(shape, nuisances, each);
    }

    /// The priors of the nuisance parameters: number, weight, value.
    pub(crate) fn priors(&self, nuisances: &[f64; NUISANCES]) -> impl Iterator<Item = (usize, f64, f64)> {
        nuisances.iter().enumerate().map(|(i, value)| {
            let deviation = self.deviation(i);
            (i, 1.0 / (deviation * deviation), *value)
        })
    }

    /// The sum of squares.
    pub(crate) fn sum(&self, shape: &Shape, nuisances: &[f64; NUISANCES]) -> f64 {
        let curve = &shape.curve;
        let placement = Placement::new(nuisances);
        let square = |point: &Point| {
            let residual = placement.residual(curve, point.place);
            let value = residual.distance - nuisances[EDGE] - self.model_error(curve, residual.along, nuisances);
            point.weight * value * value
        };
        let mut sum = self.points.iter().map(square).sum::<f64>() / (self.noise * self.noise);
        for point in self.line {
            let value = placement.residual(&shape.section, point.place).distance - nuisances[LINE];
            sum += self.line_weight(point.weight) * value * value;
        }
        self.lengths(shape, nuisances, |weight, residual, _, _| {
            sum += weight * residual * residual
        });
        sum + self
            .priors(nuisances)
            .map(|(_, weight, value)| weight * value * value)
            .sum::<f64>()
    }

    /// Products of the columns at a place: leading ones are the residual's and those that are given for each row.
    pub(crate) fn products<const L: usize>(
        &self,
        shape: &Shape,
        nuisances: &[f64; NUISANCES],
        leading: impl Fn(f64, Place) -> [f64; L],
    ) -> Products<L> {
        let mut products = Products::new(self.modes);
        self.rows(shape, nuisances, |weight, residual, row, place| {
            products.add(weight, &leading(residual, place), row);
        });
        for (nuisance, weight, value) in self.priors(nuisances) {
            products.add_prior(nuisance, weight, value);
        }
        products
    }
}

/// Where a residual has its derivatives by Ca and a/l.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Place {
    /// At a place of a curve with a normal.
    Along { trace: Trace, place: f64, normal: [f64; 2] },
    /// Those of a scalar.
    Scalar(usize),
}

impl Place {
    pub(crate) fn value<const W: usize>(
        self,
        shape: &Shape,
        outward: [&[[f64; W]; MAX_HALF]; 2],
        scalars: &[[f64; W]; SCALARS],
    ) -> [f64; W] {
        let [of_outline, of_section] = outward;
        match self {
            Self::Along { trace, place, .. } => {
                let outward = match trace {
                    Trace::Outline => of_outline,
                    Trace::DentLine => of_section,
                };
                trace.curve(shape).value(outward, place)
            }
            Self::Scalar(scalar) => scalars[scalar],
        }
    }
}

struct Residual {
    along: f64,
    /// The curve's outward normal there, on the side y >= 0.
    normal: [f64; 2],
    /// 1 on that side, -1 below.
    side: f64,
    distance: f64,
}

impl Residual {
    fn place(&self, trace: Trace) -> Place {
        Place::Along {
            trace,
            place: self.along,
            normal: self.normal,
        }
    }

    /// The outward normal on the point's own side.
    fn placed_normal(&self) -> [f64; 2] {
        [self.normal[0], self.side * self.normal[1]]
    }
}

/// cos(k pi s) at a share s of the way along the curve, for k below a count; 0 beyond.
fn cosines<const N: usize>(curve: &Curve, place: f64, count: usize) -> [f64; N] {
    let mut cosines = [0.0; N];
    if count > 0 {
        let share = place / curve.count().saturating_sub(1).max(1) as f64;
        let first = libm::cos(core::f64::consts::PI * share);
        (cosines[0], cosines[1]) = (1.0, first);
        for k in 2..count {
            cosines[k] = 2.0 * first * cosines[k - 1] - cosines[k - 2];
        }
    }
    cosines
}

/// sigma_k: the standard deviation of cosine `k` of the model's error, in the model's 95 % bound.
pub(crate) fn spectrum(k: usize) -> f64 {
    let ratio = k as f64 / 7.0;
    0.2 / (1.0 + ratio * libm::sqrt(ratio))
}
