//! The model as a source of outlines: what a camera sees of the capsule at parameters, and how that changes with them.

use crate::curve::{Curve, MAX_HALF, dot};
use capsule_core::{
    EvaluateError, Evaluator, Frame, MIDPLANE, Method, Model, Nodes, Parameters, Query, Scene, Workspace, scratch_len,
    silhouette,
};

/// The kind of the measured outline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Observable {
    /// The section by the plane z = 0: confocal and light-sheet microscopy, dyed membranes in focus.
    Midplane,
    /// The outline of the projection along z: bright field.
    Silhouette,
}

/// Storage for direct evaluation.
pub type Store = Workspace<f32, 129, 0, 32, { scratch_len(0, 32) }>;

/// Memory of the caller's.
#[derive(Debug)]
pub struct Memory<'w> {
    /// Storage of the model's evaluation.
    pub workspace: &'w mut Store,
    /// For [`Observable::Silhouette`], room for all nodes; else it may be empty.
    pub positions: &'w mut [[f32; 3]],
    /// For [`Observable::Silhouette`], room for the sector's nodes; else it may be empty.
    pub normals: &'w mut [[f32; 3]],
}

/// Rays of half a silhouette: so many that chords do for the curve, also where rays cut it at a small angle.
const RAYS: usize = 385;

/// Steps of the differences that give derivatives, in ln Ca and a/l. The outline of the shipped model comes with a
/// rounding of 1e-5 l and changes by 0.05 to 0.3 l per unit of ln Ca, by 0.5 to 2 l per unit of a/l.
const STEPS: [f64; 2] = [0.02, 0.004];

/// The outline at some parameters; lengths in l.
#[derive(Clone, Debug)]
pub struct Shape {
    /// Half the outline, in the frame of the centroid.
    pub curve: Curve,
    /// Lengths and velocity of the same.
    pub scalars: [f64; SCALARS],
    /// The bound that 95 % of the model's errors stay below.
    pub bound: f64,
}

/// Number of a shape's scalars.
pub const SCALARS: usize = 5;
/// Axial length of the outline.
pub const LENGTH: usize = 0;
/// Half its width.
pub const HALF_WIDTH: usize = 1;
/// Depth of the dent behind: from the rearmost place of the outline to the surface on the axis.
pub const REAR_DEPTH: usize = 2;
/// Velocity of the capsule in the mean velocity of the flow.
pub const VELOCITY: usize = 3;
/// Radius a.
pub const RADIUS: usize = 4;

/// Derivatives by [ln Ca, a/l].
#[derive(Clone, Debug)]
pub(crate) struct Sensitivity {
    /// Outward movement of the curve at its points.
    pub(crate) outward: [[f64; 2]; MAX_HALF],
    pub(crate) scalars: [[f64; 2]; SCALARS],
}

/// A model, looked at in one way.
#[derive(Debug)]
pub struct Shapes<'a, 'w> {
    model: &'a Model<'a>,
    memory: Memory<'w>,
    observable: Observable,
    t: f32,
    evaluations: u32,
}

impl<'a, 'w> Shapes<'a, 'w> {
    /// Looks at a model's capsules at an instant, in l/V: the end of its motions is the steady state.
    pub fn new(model: &'a Model<'a>, memory: Memory<'w>, observable: Observable, t: f32) -> Self {
        Self {
            model,
            memory,
            observable,
            t,
            evaluations: 0,
        }
    }

    /// The model.
    pub fn model(&self) -> &'a Model<'a> {
        self.model
    }

    /// The observed outline.
    pub fn observable(&self) -> Observable {
        self.observable
    }

    /// How many outlines were computed.
    pub fn evaluations(&self) -> u32 {
        self.evaluations
    }

    /// The outline at [ln Ca, a/l], which must lie in the sampled domain.
    ///
    /// # Errors
    /// Those of the evaluation: outside the domain, a model without outlines, memory that is too short.
    pub fn at(&mut self, [ca, confinement]: [f64; 2]) -> Result<Shape, EvaluateError> {
        self.evaluations += 1;
        let parameters = Parameters::from_doubles(&[libm::exp(ca), confinement]).ok_or(EvaluateError::NotFinite)?;
        let mut evaluator = Evaluator::new(self.model, self.memory.workspace)?;
        evaluator.prepare(&Query::new(parameters, Method::Direct))?;
        let mut instant = evaluator.at(self.t)?;
        let bound = f64::from(instant.error_bound()?) * confinement;
        let velocity = f64::from(instant.centroid_velocity()?);
        let mut points = [[0.0_f32; 2]; MAX_HALF];
        let (count, rear_pole) = match self.observable {
            Observable::Midplane => {
                let count = instant.outline(MIDPLANE, Frame::Centroid, &mut points)?;
                let rear = points.get(count.saturating_sub(1)).copied().unwrap_or_default();
                (count, f64::from(rear[0]))
            }
            Observable::Silhouette => {
                let scene = Scene {
                    nodes: Nodes::All,
                    frame: Frame::Centroid,
                };
                let mut rear = [[0.0; 2]; MAX_HALF];
                let nodes = instant.outline(MIDPLANE, Frame::Centroid, &mut rear)?;
                let [rear, _] = rear.get(nodes.saturating_sub(1)).copied().unwrap_or_default();
                instant.positions(&scene, self.memory.positions)?;
                let mesh = self.model.mesh();
                let mut rays = [[0.0; 2]; RAYS];
                silhouette(&mesh, self.memory.positions, [1.0, 0.0], self.memory.normals, &mut rays)?;
                evenly(&rays, &mut points);
                (MAX_HALF, f64::from(rear))
            }
        };
        let points = points.get(..count).unwrap_or_default();
        let points = points.iter().map(|point| point.map(f64::from));
        let curve = Curve::through(points).ok_or(EvaluateError::BufferTooShort {
            required: count,
            found: MAX_HALF,
        })?;
        let [front, rear] = curve.extent();
        let scalars = [
            front - rear,
            curve.half_width(),
            (rear_pole - rear).max(0.0),
            velocity,
            confinement,
        ];
        Ok(Shape { curve, scalars, bound })
    }

    /// Derivatives at a place, by differences between two places on either side in each parameter, as `ends` gives
    /// them for the steps: at an edge of the domain one of them may be the place itself.
    ///
    pub(crate) fn sensitivity(
        &mut self,
        shape: &Shape,
        ends: impl Fn([f64; 2]) -> [[f64; 2]; 2],
    ) -> Result<Sensitivity, EvaluateError> {
        let mut sensitivity = Sensitivity {
            outward: [[0.0; 2]; MAX_HALF],
            scalars: [[0.0; 2]; SCALARS],
        };
        for (d, step) in STEPS.into_iter().enumerate() {
            let mut along = [0.0; 2];
            along[d] = step;
            let [before, after] = ends(along);
            let width = after[d] - before[d];
            let [low, high] = [self.at(before)?, self.at(after)?];
            let share = if width > 0.0 { 1.0 / width } else { 0.0 };
            for (i, outward) in sensitivity.outward.iter_mut().enumerate().take(shape.curve.count()) {
                outward[d] = share * self.outward(i, shape, [&low.curve, &high.curve]);
            }
            let scalars = low.scalars.iter().zip(&high.scalars);
            for (derivative, (low, high)) in sensitivity.scalars.iter_mut().zip(scalars) {
                derivative[d] = share * (high - low);
            }
        }
        Ok(sensitivity)
    }
    /// How far a point of the curve moves outward from one curve to another beside it.
    fn outward(&self, i: usize, shape: &Shape, [low, high]: [&Curve; 2]) -> f64 {
        let point = |curve: &Curve| curve.points().get(i).copied().unwrap_or_default();
        match self.observable {
            // The same point of the membrane: what it moves along the curve does not count.
            Observable::Midplane => {
                let ([x0, y0], [x1, y1]) = (point(low), point(high));
                dot([x1 - x0, y1 - y0], shape.curve.normal(i))
            }
            // Other points of the membrane, which may move far along a bent curve.
            Observable::Silhouette => {
                let place = point(&shape.curve);
                low.nearest_from(i, place).distance - high.nearest_from(i, place).distance
            }
        }
    }
}

/// Points at equal distances along a chain of others, from its first to its last.
fn evenly(chain: &[[f32; 2]], out: &mut [[f32; 2]; MAX_HALF]) {
    let length = |pair: &[[f32; 2]]| match pair {
        [[x0, y0], [x1, y1]] => libm::sqrtf((x1 - x0) * (x1 - x0) + (y1 - y0) * (y1 - y0)),
        _ => 0.0,
    };
    let whole: f32 = chain.windows(2).map(length).sum();
    let step = whole / (MAX_HALF - 1) as f32;
    let mut way = 0.0;
    let mut next = 0;
    for pair in chain.windows(2) {
        let own = length(pair);
        while let (true, [[x0, y0], [x1, y1]], Some(out)) = (next as f32 * step <= way + own, pair, out.get_mut(next)) {
            let share = if own > 0.0 {
                (next as f32 * step - way) / own
            } else {
                0.0
            };
            *out = [x0 + share * (x1 - x0), y0 + share * (y1 - y0)];
            next += 1;
        }
        way += own;
    }
    // Rounding may leave out the last.
    if let (Some(last), Some(rest)) = (chain.last(), out.get_mut(next..)) {
        rest.fill(*last);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_lie_at_equal_distances() {
        let chain: [[f32; 2]; 200] = core::array::from_fn(|i| {
            let angle = core::f32::consts::PI * (i as f32 / 199.0) * (i as f32 / 199.0);
            [libm::cosf(angle), libm::sinf(angle)]
        });
        let mut out = [[0.0; 2]; MAX_HALF];
        evenly(&chain, &mut out);
        for (i, [x, y]) in out.into_iter().enumerate() {
            let angle = core::f32::consts::PI * i as f32 / (MAX_HALF - 1) as f32;
            assert!(
                (x - libm::cosf(angle)).abs() < 1e-3 && (y - libm::sinf(angle)).abs() < 1e-3,
                "{i}"
            );
        }
    }
}
