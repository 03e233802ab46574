//! Starts of the fit, on both sides of the jump.

use crate::domain::Side;
use crate::error::IdentifyError;
use crate::fit::{Accuracy, Start};
use crate::grid::{FEATURES, Grid};
use crate::measurement::Direction;
use crate::residuals::{NUISANCES, Point, SHIFT};
use crate::solver::Solver;

/// Points of a contour with which a start is improved.
pub(crate) const START_POINTS: usize = 48;
/// Starts on each side of the border.
const STARTS: usize = 3;
/// A start whose features are farther from the measured ones than the nearest of all directions, by this, is not tried.
const START_DISTANCE: f64 = 30.0;

/// A start, improved with a few points, and its sum of squares.
#[derive(Clone, Copy)]
pub(crate) struct Candidate {
    pub(crate) start: Start<'static>,
    pub(crate) sum: f64,
}

impl Solver<'_, '_, '_, '_> {
    /// The best direction, and the best start of either side in it.
    pub(crate) fn candidates(&mut self, grid: &Grid) -> Result<(Direction, [Option<Candidate>; 2]), IdentifyError> {
        let given = self.measurement.contour.map(|contour| contour.direction);
        let directions = match given {
            Some(Direction::Found) => Direction::ALL.map(Some),
            other => [other.or(Some(Direction::Right)), None, None, None],
        };
        let directions = directions.map(|direction| {
            direction.map(|direction| {
                let features = self.features(direction);
                let nearest = [Side::Smooth, Side::Dented].map(|side| grid.nearest::<1>(side, &features));
                let distances = nearest.as_flattened().iter().flatten().map(|start| start.distance);
                (direction, features, distances.fold(f64::INFINITY, f64::min))
            })
        });
        let nearest = directions.iter().flatten().map(|(.., nearest)| *nearest);
        let limit = nearest.fold(f64::INFINITY, f64::min) + START_DISTANCE;
        let mut best: Option<(f64, Direction, [Option<Candidate>; 2])> = None;
        for (direction, features, nearest) in directions.into_iter().flatten() {
            if nearest > limit {
                continue;
            }
            let found = self.candidates_along(grid, direction, &features, limit)?;
            let least = found.iter().flatten().map(|c| c.sum).fold(f64::INFINITY, f64::min);
            if best.as_ref().is_none_or(|(sum, ..)| least < *sum) {
                best = Some((least, direction, found));
            }
        }
        let (_, direction, candidates) = best.ok_or(IdentifyError::NoFit)?;
        Ok((direction, candidates))
    }

    /// The measured features for a direction of the flow.
    fn features(&self, direction: Direction) -> [Option<f64>; FEATURES] {
        let half_width = self.measurement.setup.half_width_um;
        let contour = self.measurement.contour;
        let mut features = contour.map_or([None; FEATURES], |contour| {
            contour.framed(direction, half_width).features
        });
        for (feature, measured) in features.iter_mut().zip(&self.scalars) {
            *feature = measured.map(|measured| measured.value).or(*feature);
        }
        features
    }

    /// The best start of either side, of those whose features are nearer to the measured ones than a limit.
    fn candidates_along(
        &mut self,
        grid: &Grid,
        direction: Direction,
        features: &[Option<f64>; FEATURES],
        limit: f64,
    ) -> Result<[Option<Candidate>; 2], IdentifyError> {
        let half_width = self.measurement.setup.half_width_um;
        let mut few = [Point::default(); START_POINTS];
        let mut count = 0;
        if let Some(contour) = &self.measurement.contour {
            let middle = contour.framed(direction, half_width).middle;
            let all = contour.points_um.len();
            count = all.min(START_POINTS);
            for (i, point) in few.iter_mut().enumerate().take(count) {
                let one = crate::measurement::Contour {
                    points_um: contour.points_um.get(i * all / count..).unwrap_or_default(),
                    ..*contour
                };
                one.fill(direction, half_width, middle, core::slice::from_mut(point));
                point.weight = 1.0;
            }
        }
        let noise = self.first_noise();
        let mut candidates = [None::<Candidate>; 2];
        for (candidate, side) in candidates.iter_mut().zip([Side::Smooth, Side::Dented]) {
            let starts: [_; STARTS] = grid.nearest(side, features);
            for start in starts.into_iter().flatten().filter(|start| start.distance <= limit) {
                let mut nuisances = [0.0; NUISANCES];
                if count > 0 {
                    let shape = self.fitter.shapes.at(start.theta)?;
                    let [front, rear] = shape.curve.extent();
                    nuisances[SHIFT] = -0.5 * (front + rear);
                }
                let data = self.data(few.get(..count).unwrap_or_default(), noise);
                let start = Start {
                    side,
                    theta: start.theta,
                    nuisances,
                    slopes: None,
                };
                if let Some(fit) = self.fitter.fit(&data, start, Accuracy::Start)?
                    && candidate.is_none_or(|best| fit.sum < best.sum)
                {
                    *candidate = Some(Candidate {
                        start: Start {
                            theta: fit.theta,
                            nuisances: fit.nuisances,
                            ..start
                        },
                        sum: fit.sum,
                    });
                }
            }
        }
        Ok(candidates)
    }
}
