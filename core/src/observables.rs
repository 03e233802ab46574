//! Scalars that describe the capsule at an instant.

use crate::Real;
use crate::error::EvaluateError;
use crate::model::Model;
use crate::model::{DIAGONAL, MIDPLANE};
use crate::reconstruct::Snapshot;

/// Scalars of an instant, lengths in l, velocity in V; the lengths from the two section outlines. Extremes are those
/// of the parabola through the extreme node of an outline and its two neighbours, the nodes taken as equidistant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observables<T> {
    /// max x - min x over both outlines.
    pub axial_length: T,
    /// max |y| in the plane z = 0.
    pub half_width: T,
    /// max sqrt(y^2 + z^2) in the plane y = z.
    pub half_diagonal: T,
    /// x of the rear pole on the axis - min x over both outlines, >= 0: the depth of the parachute.
    pub rear_depth: T,
    /// Axial velocity of the volume centroid.
    pub velocity: T,
    /// Axial position of the volume centroid in the laboratory frame.
    pub centroid: T,
}

/// Extremes of the two outlines.
pub(crate) struct Extremes<T> {
    pub(crate) front: T,
    pub(crate) rear: T,
    pub(crate) rear_pole: T,
    pub(crate) half_width: T,
    pub(crate) half_diagonal: T,
}

impl<T: Real> Extremes<T> {
    /// Reconstructs the nodes of the outlines, one at a time.
    pub(crate) fn new(model: &Model<'_>, snapshot: &Snapshot<'_, '_, T>) -> Result<Self, EvaluateError> {
        let midplane = Outline::new(model, snapshot, MIDPLANE)?;
        let diagonal = Outline::new(model, snapshot, DIAGONAL)?;
        Ok(Self {
            front: midplane.front.value().max(diagonal.front.value()),
            rear: -midplane.rear.value().max(diagonal.rear.value()),
            rear_pole: midplane.rear_pole,
            half_width: midplane.width.value(),
            half_diagonal: diagonal.width.value(),
        })
    }
}

struct Outline<T> {
    front: Greatest<T>,
    rear: Greatest<T>,
    width: Greatest<T>,
    rear_pole: T,
}

impl<T: Real> Outline<T> {
    fn new(model: &Model<'_>, snapshot: &Snapshot<'_, '_, T>, name: &str) -> Result<Self, EvaluateError> {
        let nodes = model.node_set(name).ok_or(EvaluateError::UnknownNodeSet)?;
        let mut outline = Self {
            front: Greatest::NONE,
            rear: Greatest::NONE,
            width: Greatest::NONE,
            rear_pole: T::ZERO,
        };
        for node in nodes.iter() {
            let [x, r] = axial_radial(snapshot.node(node)?);
            outline.front.push(x);
            outline.rear.push(-x);
            outline.width.push(r);
            outline.rear_pole = x;
        }
        Ok(outline)
    }
}

/// A point as [x, r].
pub(crate) fn axial_radial<T: Real>([x, y, z]: [T; 3]) -> [T; 2] {
    [x, (y * y + z * z).sqrt()]
}

/// The greatest of a sequence of values, with its two neighbours. Beyond its ends, which are the poles, an outline
/// goes on as its mirror image, so that a neighbour is missing at an end only, where the parabola's vertex is the node.
struct Greatest<T> {
    last: [Option<T>; 2],
    before: Option<T>,
    greatest: Option<T>,
    after: Option<T>,
}

impl<T: Real> Greatest<T> {
    const NONE: Self = Self {
        last: [None; 2],
        before: None,
        greatest: None,
        after: None,
    };

    fn push(&mut self, value: T) {
        let [previous, _] = self.last;
        if self.greatest.is_none_or(|greatest| value > greatest) {
            (self.before, self.greatest, self.after) = (previous, Some(value), None);
        } else if self.after.is_none() && previous == self.greatest {
            self.after = Some(value);
        }
        self.last = [Some(value), previous];
    }

    /// The vertex of the parabola.
    fn value(&self) -> T {
        let greatest = self.greatest.unwrap_or(T::ZERO);
        let (Some(before), Some(after)) = (self.before, self.after) else {
            return greatest;
        };
        let curvature = greatest + greatest - before - after;
        let slope = after - before;
        let eight = T::from_f32(8.0);
        if curvature > T::ZERO {
            greatest + slope * slope / (eight * curvature)
        } else {
            greatest
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parabola_s_vertex() {
        let vertex = |values: &[f64]| {
            let mut greatest = Greatest::NONE;
            values.iter().for_each(|&value| greatest.push(value));
            greatest.value()
        };
        let parabola = |i: f64| 3.0 - (i - 1.2) * (i - 1.2);
        assert!((vertex(&[0.0, 1.0, 2.0, 3.0].map(parabola)) - 3.0).abs() < 1e-15);
        assert_eq!(vertex(&[5.0, 4.0, 1.0]), 5.0);
        assert_eq!(vertex(&[1.0, 4.0, 5.0]), 5.0);
    }
}
