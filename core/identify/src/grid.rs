//! Starts of the fit: a few numbers of the outline over the whole domain, computed once for a model.

use crate::curve::Curve;
use crate::domain::{Domain, Side};
use crate::shapes::{SCALARS, Shapes};
use capsule_core::EvaluateError;

/// Rows of a/l and places of ln Ca in each.
const ROWS: usize = 16;
const COLUMNS: usize = 12;
/// The most entries, with both sides of the border.
const ENTRIES: usize = 2 * ROWS * COLUMNS;

/// Numbers by which outlines are told apart: the scalars, the area, and how far the area's centroid is in front of the
/// middle of the extent.
pub(crate) const FEATURES: usize = SCALARS + 2;

/// How much each may differ.
const SPREAD: [f64; FEATURES] = [0.02, 0.01, 0.03, 0.01, 0.01, 0.03, 0.02];

/// The outlines of a model over its domain, by a few numbers.
#[derive(Clone, Debug)]
pub struct Grid {
    count: usize,
    entries: [Entry; ENTRIES],
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    theta: [f32; 2],
    side: Side,
    features: [f32; FEATURES],
}

/// A start and how far its features are from the measured ones.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Start {
    pub(crate) theta: [f64; 2],
    pub(crate) distance: f64,
}

/// The last two features of a curve.
pub(crate) fn of_curve(curve: &Curve) -> [f64; 2] {
    let [front, rear] = curve.extent();
    let [area, centroid] = curve.area();
    [area, centroid - 0.5 * (front + rear)]
}

/// Squared distance of features from measured ones, as far as these are known.
pub(crate) fn distance(measured: &[Option<f64>; FEATURES], own: impl Iterator<Item = f64>) -> f64 {
    let differences = measured.iter().zip(own).zip(SPREAD);
    differences
        .filter_map(|((measured, own), spread)| measured.map(|measured| (measured - own) / spread))
        .map(|difference| difference * difference)
        .sum()
}

impl Grid {
    /// Every third place of the domain, with its side.
    pub(crate) fn places(&self) -> impl Iterator<Item = (Side, [f64; 2])> + '_ {
        let entries = self.entries.iter().take(self.count).step_by(3);
        entries.map(|entry| (entry.side, entry.theta.map(f64::from)))
    }

    /// Computes the outlines of a model that are looked at in one way.
    ///
    /// # Errors
    /// Those of the model's evaluation; [`EvaluateError::UnsupportedReference`] for a model of anything but capsules in
    /// the channel.
    pub fn new(shapes: &mut Shapes<'_, '_>) -> Result<Self, EvaluateError> {
        let domain = Domain::new(shapes.model()).ok_or(EvaluateError::UnsupportedReference)?;
        let mut grid = Self {
            count: 0,
            entries: [Entry {
                theta: [0.0; 2],
                side: Side::Dented,
                features: [0.0; FEATURES],
            }; ENTRIES],
        };
        let [low, high] = domain.confinements();
        for side in [Side::Smooth, Side::Dented] {
            for row in 0..ROWS {
                let confinement = low + (high - low) * row as f64 / (ROWS - 1) as f64;
                let Some([least, greatest]) = domain.range(side, confinement) else {
                    continue;
                };
                // Few places where the range is short.
                let columns = ((greatest - least) * 4.0) as usize + 3;
                let columns = columns.min(COLUMNS);
                for column in 0..columns {
                    let share = column as f64 / (columns - 1) as f64;
                    let theta = [least + share * (greatest - least), confinement];
                    let shape = shapes.at(theta)?;
                    let own = of_curve(&shape.curve);
                    let features = shape.scalars.iter().chain(&own);
                    if let Some(entry) = grid.entries.get_mut(grid.count) {
                        entry.theta = theta.map(|x| x as f32);
                        entry.side = side;
                        entry
                            .features
                            .iter_mut()
                            .zip(features)
                            .for_each(|(f, value)| *f = *value as f32);
                        grid.count += 1;
                    }
                }
            }
        }
        Ok(grid)
    }

    /// The nearest entries to measured features on a side, the nearest first; of neighbours only the nearest.
    pub(crate) fn nearest<const N: usize>(&self, side: Side, features: &[Option<f64>; FEATURES]) -> [Option<Start>; N] {
        /// Entries closer than this in ln Ca and a/l lead to the same minimum.
        const APART: [f64; 2] = [0.2, 0.035];
        let mut found: [Option<Start>; N] = [None; N];
        for slot in 0..N {
            let mut best: Option<Start> = None;
            for entry in self.entries.iter().take(self.count).filter(|entry| entry.side == side) {
                let theta = entry.theta.map(f64::from);
                let near = |start: &Start| (0..2).all(|d| (start.theta[d] - theta[d]).abs() < APART[d]);
                if found.iter().flatten().any(near) {
                    continue;
                }
                let distance = distance(features, entry.features.iter().map(|own| f64::from(*own)));
                if best.is_none_or(|best| distance < best.distance) {
                    best = Some(Start { theta, distance });
                }
            }
            found[slot] = best;
        }
        found
    }
}
