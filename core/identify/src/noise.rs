//! Noise of a contour's points from the residuals: robust weights, correlation of neighbours, bins.

use crate::algebra::Factor;
use crate::fit::Fit;
use crate::residuals::{Data, NUISANCES, Point, Trace};
use crate::shapes::Shape;
use crate::solver::{SIGNIFICANT, Solver};

/// Bins on each side of the axis into which a contour is gathered for its intervals.
pub(crate) const BINS: usize = 40;
/// Residuals beyond so many deviations count less (Huber, 1964).
const HUBER: f64 = 2.5;
/// Variance of normal residuals over the one that is computed with Huber's weights, and of the estimate with it.
const HUBER_VARIANCE: f64 = 1.013;
/// The least noise, in l: what the model's numbers are rounded to.
pub(crate) const LEAST_NOISE: f64 = 1e-5;

/// Noise of a contour by its residuals, in l.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Noise {
    /// That of a point, as if all were independent.
    pub(crate) effective: f64,
    /// That of a point.
    pub(crate) point: f64,
    /// How many neighbouring residuals count as one.
    pub(crate) correlated: f64,
    pub(crate) freedom: f64,
    pub(crate) chi_squared: f64,
    pub(crate) residual: f64,
}

/// Neighbouring residuals that err alike, more than by chance.
const CORRELATED: f64 = 3.0;

impl Noise {
    /// Whether the residuals that are smooth along the contour are greater than errors of the edge and of the model,
    /// in l, could make them.
    pub(crate) fn is_structured(&self, edge: f64, bound: f64) -> bool {
        let smooth = self.residual * libm::sqrt(1.0 - 1.0 / self.correlated.max(1.0));
        self.correlated > CORRELATED && smooth > edge.max(bound)
    }
}

impl Solver<'_, '_, '_, '_> {
    /// Noise of the residuals from a shape, and Huber's weights of the points.
    pub(crate) fn estimate_noise(
        &self,
        trace: Trace,
        shape: &Shape,
        nuisances: &[f64; NUISANCES],
        fit: Option<&Fit>,
        points: &mut [Point],
    ) -> Noise {
        if points.is_empty() {
            return Noise::default();
        }
        let half_width = self.measurement.setup.half_width_um;
        let given = self
            .measurement
            .contour
            .filter(|_| trace == Trace::Outline)
            .and_then(|contour| contour.noise_um)
            .map(|noise| noise / half_width);
        let data = self.data(&[], 1.0);
        for point in &mut *points {
            let residual = data.point_residual(trace, shape, point.place, nuisances);
            (point.residual, point.along, point.below) = residual;
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
            point.weight = if size > HUBER { HUBER / size } else { 1.0 };
            sum += point.weight * point.residual * point.residual;
            squares += point.residual * point.residual;
        }
        let effective_parameters = fit.map_or(2.0, effective_parameters);
        let freedom = (count - effective_parameters).max(1.0);
        let estimated = libm::sqrt(HUBER_VARIANCE * sum / freedom).max(LEAST_NOISE);
        // More scatter than was said is there, if it is not by chance.
        let noise = match given {
            Some(given) if estimated < given * (1.0 + SIGNIFICANT / libm::sqrt(2.0 * freedom)) => given,
            _ => estimated,
        };
        let correlated = correlated(points);
        Noise {
            effective: noise * libm::sqrt(correlated),
            point: noise,
            correlated,
            freedom,
            chi_squared: sum / (noise * noise),
            residual: libm::sqrt(squares / count.max(1.0)),
        }
    }
}

/// How many nuisances the points determine, each as far as they do.
fn effective_parameters(fit: &Fit) -> f64 {
    let own = Factor::new(&fit.nuisance_matrix).map_or(0.0, |factor| {
        (0..NUISANCES)
            .map(|i| 1.0 - fit.priors[i] * factor.inverse_column(i)[i])
            .sum()
    });
    2.0 + own
}

/// How many neighbouring residuals are as good as one: 1 + 2 sum of the autocorrelations, as far as they are more than
/// chance.
fn correlated(points: &[Point]) -> f64 {
    const LAGS: usize = 30;
    let n = points.len();
    let weighted = |i: usize| {
        points
            .get(i % n.max(1))
            .map_or(0.0, |point| point.weight * point.residual)
    };
    let square: f64 = (0..n).map(|i| weighted(i) * weighted(i)).sum();
    let chance = 2.0 / libm::sqrt(n as f64);
    let mut correlated = 1.0;
    for lag in 1..LAGS.min(n / 4) {
        let product: f64 = (0..n).map(|i| weighted(i) * weighted(i + lag)).sum();
        let correlation = product / square.max(f64::MIN_POSITIVE);
        if correlation < chance {
            break;
        }
        correlated += 2.0 * correlation;
    }
    correlated
}

/// Points of a contour, or bins of them, on both sides of the axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bins {
    pub(crate) points: [Point; 2 * BINS],
    pub(crate) count: usize,
}

impl Bins {
    pub(crate) const EMPTY: Self = Self {
        points: [Point::ORIGIN; 2 * BINS],
        count: 0,
    };

    /// The same points.
    pub(crate) fn of(points: &[Point]) -> Self {
        let mut bins = Self::EMPTY;
        bins.count = points.len().min(bins.points.len());
        bins.points
            .iter_mut()
            .zip(points)
            .for_each(|(bin, point)| *bin = *point);
        bins
    }

    /// Gathers points in bins along the curve, each on either side: the mean of the places, moved along the normal
    /// until its residual is the mean of theirs, for the mean of places on a bent curve lies inside it.
    pub(crate) fn gather(
        data: &Data<'_>,
        (trace, shape): (Trace, &Shape),
        nuisances: &[f64; NUISANCES],
        points: &[Point],
    ) -> Self {
        let mut bins = Self::EMPTY;
        if points.len() <= bins.points.len() {
            return Self::of(points);
        }
        let curve = trace.curve(shape);
        let width = curve.count().saturating_sub(1) as f64 / BINS as f64;
        for point in points {
            let bin = ((point.along / width) as usize).min(BINS - 1) + if point.below { BINS } else { 0 };
            let bin = &mut bins.points[bin];
            bin.weight += point.weight;
            bin.residual += point.weight * point.residual;
            (0..2).for_each(|d| bin.place[d] += point.weight * point.place[d]);
        }
        for i in 0..bins.points.len() {
            let bin = bins.points[i];
            if bin.weight > 0.0 {
                let place = bin.place.map(|x| x / bin.weight);
                let (residual, along, below) = data.point_residual(trace, shape, place, nuisances);
                let normal = data.normal_at(curve, place, nuisances);
                let missing = bin.residual / bin.weight - residual;
                bins.points[bins.count] = Point {
                    place: [0, 1].map(|d| place[d] + missing * normal[d]),
                    weight: bin.weight,
                    residual: bin.residual / bin.weight,
                    along,
                    below,
                };
                bins.count += 1;
            }
        }
        bins
    }

    pub(crate) fn all(&self) -> &[Point] {
        self.points.get(..self.count).unwrap_or_default()
    }
}
