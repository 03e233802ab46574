//! Starts of the fit, on both sides of the jump.

use crate::domain::Side;
use crate::error::IdentifyError;
use crate::fit::Slopes;
use crate::grid::{FEATURES, Grid};
use crate::measurement::Direction;
use crate::residuals::{NUISANCES, Point, SHIFT};
use crate::solver::Solver;

/// Points of a contour with which a start is improved.
pub(crate) const START_POINTS: usize = 48;
/// Starts on each side of the border.
const STARTS: usize = 3;
/// A start whose features are farther from the measured ones than the nearest, by this, is not tried.
const START_DISTANCE: f64 = 30.0;

/// A start, improved with a few points.
#[derive(Clone, Copy)]
pub(crate) struct Candidate {
    pub(crate) side: Side,
    pub(crate) theta: [f64; 2],
    pub(crate) nuisances: [f64; NUISANCES],
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
        let mut few = [Point::default(); START_POINTS];
        let mut count = 0;
        let mut features = [None; FEATURES];
        if let Some(contour) = &self.measurement.contour {
            let framed = contour.framed(direction, half_width);
            features = framed.features;
            let all = contour.points_um.len();
            count = all.min(START_POINTS);
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
                .filter(|start| start.distance <= nearest + START_DISTANCE)
            {
                let mut nuisances = [0.0; NUISANCES];
                if count > 0 {
                    let shape = self.fitter.shapes.at(start.theta)?;
                    let [front, rear] = shape.curve.extent();
                    nuisances[SHIFT] = -0.5 * (front + rear);
                }
                let data = self.data(few.get(..count).unwrap_or_default(), noise);
                if let Some(fit) = self.fitter.fit(&data, side, start.theta, Slopes::Local, nuisances)?
                    && candidate.is_none_or(|best| fit.sum < best.sum)
                {
                    *candidate = Some(Candidate {
                        side,
                        theta: fit.theta,
                        nuisances: fit.nuisances,
                        sum: fit.sum,
                    });
                }
            }
        }
        Ok(candidates)
    }
}
