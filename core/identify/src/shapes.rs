//! The model as a source of outlines: what a camera sees of the capsule at parameters, and how that changes with them.

use crate::curve::{self, Curve, MAX_HALF, dot};
use crate::residuals::Trace;
use capsule_core::{
    EvaluateError, Evaluator, Frame, MIDPLANE, Method, Model, Nodes, Parameters, Query, Scene, Workspace, scratch_len,
    silhouette, silhouette_derivatives,
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
    /// For [`Observable::Silhouette`], room for [`NODES_ROOM`] times all nodes; else it may be empty.
    pub positions: &'w mut [[f32; 3]],
    /// For [`Observable::Silhouette`], room for the sector's nodes; else it may be empty.
    pub normals: &'w mut [[f32; 3]],
}

/// Steps of the differences that give derivatives, in ln Ca and a/l. The outline of the shipped model comes with a
/// rounding of 1e-5 l and changes by 0.05 to 0.3 l per unit of ln Ca, by 0.5 to 2 l per unit of a/l.
pub(crate) const STEPS: [f64; 2] = [0.02, 0.004];

/// How many vectors each node needs for a silhouette: its position, and the derivatives by both parameters.
pub const NODES_ROOM: usize = 3;

/// Rays of half a silhouette: so many that chords do for the curve, also where rays cut it at a small angle.
const RAYS: usize = 385;

/// The outline at some parameters; lengths in l.
#[derive(Clone, Debug)]
pub struct Shape {
    /// Half the outline, in the frame of the centroid.
    pub curve: Curve,
    /// Of a silhouette, half the section through the axis: where it lies within the outline, the membrane of a dent is
    /// seen along it. Else empty.
    pub section: Curve,
    /// Lengths and velocity of the same.
    pub scalars: [f64; SCALARS],
    /// The bound that 95 % of the model's errors stay below.
    pub bound: f64,
    /// The error that the model expects.
    pub expected_error: f64,
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
    /// Derivatives of the curve: a curve is linear in its points, so they are the curves through theirs. What its
    /// points move along the curve does not count.
    pub(crate) curves: [Curve; 2],
    /// Outward movement of the section's points.
    pub(crate) of_section: [[f64; 2]; MAX_HALF],
    pub(crate) scalars: [[f64; 2]; SCALARS],
}

impl Sensitivity {
    /// Outward movement of a curve at a place with its normal.
    pub(crate) fn outward(&self, trace: Trace, place: f64, normal: [f64; 2]) -> [f64; 2] {
        match trace {
            Trace::Outline => [0, 1].map(|d| dot(self.curves[d].at_place(place), normal)),
            Trace::DentLine => curve::between(&self.of_section, place as usize, place),
        }
    }
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

    /// The instant, in l/V.
    pub fn instant(&self) -> f64 {
        f64::from(self.t)
    }

    /// Looks at another instant from now on.
    pub fn set_instant(&mut self, t: f64) {
        self.t = t as f32;
    }

    /// How many outlines were computed.
    pub fn evaluations(&self) -> u32 {
        self.evaluations
    }

    /// The outline at [ln Ca, a/l], which must lie in the sampled domain.
    ///
    /// # Errors
    /// Those of the evaluation: outside the domain, a model without outlines, memory that is too short.
    pub fn at(&mut self, theta: [f64; 2]) -> Result<Shape, EvaluateError> {
        self.evaluations += 1;
        let [_, confinement] = theta;
        let mut evaluator = Evaluator::new(self.model, self.memory.workspace)?;
        evaluator.prepare(&query(theta)?)?;
        let mut instant = evaluator.at(self.t)?;
        let bound = f64::from(instant.error_bound()?) * confinement;
        let expected_error = f64::from(instant.expected_error()?) * confinement;
        let velocity = f64::from(instant.centroid_velocity()?);
        let mut points = [[0.0_f32; 2]; MAX_HALF];
        let mut section = Curve::EMPTY;
        let (count, rear_pole) = match self.observable {
            Observable::Midplane => {
                let count = instant.outline(MIDPLANE, Frame::Centroid, &mut points)?;
                let rear = points.get(count.saturating_sub(1)).copied().unwrap_or_default();
                (count, f64::from(rear[0]))
            }
            Observable::Silhouette => {
                instant.positions(&ALL, self.memory.positions)?;
                section = of_section(self.model, self.memory.positions);
                let rear = section.points().last().map_or(0.0, |[x, _]| *x);
                let mut rays = [[0.0; 2]; RAYS];
                let mesh = self.model.mesh();
                silhouette(&mesh, self.memory.positions, ALONG_Z, self.memory.normals, &mut rays)?;
                evenly(&rays, &[[]; RAYS], &mut points, &mut [[]; MAX_HALF]);
                (MAX_HALF, rear)
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
        Ok(Shape {
            curve,
            section,
            scalars,
            bound,
            expected_error,
        })
    }

    /// Derivatives of a shape by differences between two places on either side in each parameter, as `ends` gives them
    /// for the steps: at an edge of the domain one of them may be the place itself.
    pub(crate) fn secants(
        &mut self,
        shape: &Shape,
        ends: impl Fn([f64; 2]) -> [[f64; 2]; 2],
    ) -> Result<Sensitivity, EvaluateError> {
        let mut sensitivity = Sensitivity {
            curves: [Curve::EMPTY; 2],
            of_section: [[0.0; 2]; MAX_HALF],
            scalars: [[0.0; 2]; SCALARS],
        };
        for (d, step) in STEPS.into_iter().enumerate() {
            let mut along = [0.0; 2];
            along[d] = step;
            let [before, after] = ends(along);
            let width = after[d] - before[d];
            let [low, high] = [self.at(before)?, self.at(after)?];
            let share = if width > 0.0 { 1.0 / width } else { 0.0 };
            sensitivity.curves[d] = self.difference(shape, [&low, &high], share);
            for (i, point) in shape.section.points().iter().enumerate() {
                let [before, after] = [&low, &high].map(|end| end.section.nearest_from(i, *point).distance);
                sensitivity.of_section[i][d] = share * (before - after);
            }
            let scalars = low.scalars.iter().zip(&high.scalars);
            for (derivative, (low, high)) in sensitivity.scalars.iter_mut().zip(scalars) {
                derivative[d] = share * (high - low);
            }
        }
        Ok(sensitivity)
    }

    /// The difference of two shapes on either side of a third, times a factor, as movement of its curve's points.
    pub(crate) fn difference(&self, shape: &Shape, [low, high]: [&Shape; 2], factor: f64) -> Curve {
        if self.observable == Observable::Midplane {
            return moved([&low.curve, &high.curve], factor);
        }
        // Other points of the membrane, which may move far along a bent curve.
        let points = shape.curve.points().iter().enumerate().map(|(i, place)| {
            let distance = |shape: &Shape| shape.curve.nearest_from(i, *place).distance;
            let outward = factor * (distance(low) - distance(high));
            shape.curve.normal(i).map(|n| outward * n)
        });
        Curve::through(points).unwrap_or(Curve::EMPTY)
    }

    /// Derivatives of a shape of the model at its place, those of the interpolation; none of the section.
    pub(crate) fn derivatives(
        &mut self,
        shape: &Shape,
        [ca, confinement]: [f64; 2],
    ) -> Result<Sensitivity, EvaluateError> {
        self.evaluations += 1;
        // By ln Ca.
        let factors = [libm::exp(ca), 1.0];
        let query = query([ca, confinement])?;
        let mut evaluator = Evaluator::new(self.model, self.memory.workspace)?;
        let mut derivatives = evaluator.derivatives(&query, self.t)?;
        let mut points = [[[0.0; 2]; MAX_HALF]; 2];
        let mut rear_poles = [0.0; 2];
        let mut scalars = [[0.0; 2]; SCALARS];
        for d in 0..2 {
            scalars[VELOCITY][d] = factors[d] * f64::from(derivatives.centroid_velocity(d)?);
        }
        match self.observable {
            Observable::Midplane => {
                for d in 0..2 {
                    let mut singles = [[0.0_f32; 2]; MAX_HALF];
                    let count = derivatives.outline(d, MIDPLANE, Frame::Centroid, &mut singles)?;
                    points[d] = singles.map(|point| point.map(|x| factors[d] * f64::from(x)));
                    rear_poles[d] = points[d].get(count.saturating_sub(1)).map_or(0.0, |rear| rear[0]);
                }
            }
            Observable::Silhouette => {
                let [positions, fields @ ..] = split(self.memory.positions, self.model.mesh().nodes())?;
                for d in 0..2 {
                    derivatives.positions(d, &ALL, fields[d])?;
                    let section = of_section(self.model, fields[d]);
                    rear_poles[d] = section.points().last().map_or(0.0, |[x, _]| factors[d] * x);
                }
                // The positions are gone where other shapes came after this one.
                evaluator.prepare(&query)?;
                evaluator.at(self.t)?.positions(&ALL, positions)?;
                let (mut rays, mut movement) = ([[0.0; 2]; RAYS], [[[0.0; 2]; 2]; RAYS]);
                let mesh = self.model.mesh();
                let fields = fields.map(|field| &*field);
                let normals = &mut *self.memory.normals;
                silhouette_derivatives(&mesh, positions, fields, ALONG_Z, normals, &mut rays, &mut movement)?;
                let mut places = [[0.0; 2]; MAX_HALF];
                for d in 0..2 {
                    let mut singles = [[0.0; 2]; MAX_HALF];
                    evenly(&rays, &movement.map(|by| by[d]), &mut places, &mut singles);
                    points[d] = singles.map(|point| point.map(|x| factors[d] * f64::from(x)));
                }
            }
        }
        let count = shape.curve.count();
        let [by_ca, by_confinement] =
            points.map(|points| Curve::through(points.into_iter().take(count)).unwrap_or(Curve::EMPTY));
        let curves = [by_ca, by_confinement];
        // At an extreme of the outline what it moves along itself does not count.
        let [front, rear, widest] = shape.curve.extremes();
        for (d, curve) in curves.iter().enumerate() {
            let [front, rear] = [front, rear].map(|place| curve.at_place(place)[0]);
            scalars[LENGTH][d] = front - rear;
            scalars[HALF_WIDTH][d] = curve.at_place(widest)[1];
            if shape.scalars[REAR_DEPTH] > 0.0 {
                scalars[REAR_DEPTH][d] = rear_poles[d] - rear;
            }
        }
        scalars[RADIUS] = [0.0, 1.0];
        Ok(Sensitivity {
            curves,
            of_section: [[0.0; 2]; MAX_HALF],
            scalars,
        })
    }
}

/// Seen along z.
const ALONG_Z: [f32; 2] = [1.0, 0.0];

const ALL: Scene<'_> = Scene {
    nodes: Nodes::All,
    frame: Frame::Centroid,
};

/// The query at [ln Ca, a/l].
fn query([ca, confinement]: [f64; 2]) -> Result<Query<f32>, EvaluateError> {
    let parameters = Parameters::from_doubles(&[libm::exp(ca), confinement]).ok_or(EvaluateError::NotFinite)?;
    Ok(Query::new(parameters, Method::Direct))
}

/// Values at the nodes of the section through the axis, front to rear; empty without such nodes.
fn of_section(model: &Model<'_>, values: &[[f32; 3]]) -> Curve {
    let Some(nodes) = model.node_set(MIDPLANE) else {
        return Curve::EMPTY;
    };
    let value = |node: usize| values.get(node).copied().unwrap_or_default().map(f64::from);
    let points = nodes.iter().map(value).map(|[x, y, _]| [x, y]);
    let mut of_nodes = [[0.0; 2]; MAX_HALF];
    let count = of_nodes
        .iter_mut()
        .zip(points)
        .map(|(place, point)| *place = point)
        .count();
    Curve::through(of_nodes.into_iter().take(count)).unwrap_or(Curve::EMPTY)
}

/// The way of the same points of the membrane from one curve to another, times a factor.
fn moved([low, high]: [&Curve; 2], factor: f64) -> Curve {
    let pairs = low.points().iter().zip(high.points());
    let points = pairs.map(|([x0, y0], [x1, y1])| [factor * (x1 - x0), factor * (y1 - y0)]);
    Curve::through(points).unwrap_or(Curve::EMPTY)
}

/// Room for the positions, and for their derivatives by both parameters.
fn split(room: &mut [[f32; 3]], nodes: usize) -> Result<[&mut [[f32; 3]]; 3], EvaluateError> {
    let (required, found) = (NODES_ROOM * nodes, room.len());
    let mut parts = room.chunks_exact_mut(nodes.max(1));
    match (parts.next(), parts.next(), parts.next()) {
        (Some(a), Some(b), Some(c)) => Ok([a, b, c]),
        _ => Err(EvaluateError::BufferTooShort { required, found }),
    }
}

/// Points at equal distances along a chain of others, from its first to its last, and values known at these between
/// them.
fn evenly<const D: usize>(
    chain: &[[f32; 2]; RAYS],
    values: &[[f32; D]; RAYS],
    out: &mut [[f32; 2]; MAX_HALF],
    out_values: &mut [[f32; D]; MAX_HALF],
) {
    let length = |[x0, y0]: [f32; 2], [x1, y1]: [f32; 2]| libm::sqrtf((x1 - x0) * (x1 - x0) + (y1 - y0) * (y1 - y0));
    let whole: f32 = chain.windows(2).map(|pair| length(pair[0], pair[1])).sum();
    let step = whole / (MAX_HALF - 1) as f32;
    let (mut way, mut next) = (0.0, 0);
    for (i, pair) in chain.windows(2).enumerate() {
        let own = length(pair[0], pair[1]);
        // Rounding may leave out the last.
        let ends = i + 2 == RAYS;
        while next < MAX_HALF && (ends || next as f32 * step <= way + own) {
            let share = if own > 0.0 {
                ((next as f32 * step - way) / own).min(1.0)
            } else {
                0.0
            };
            out[next] = between(pair[0], pair[1], share);
            out_values[next] = between(values[i], values[i + 1], share);
            next += 1;
        }
        way += own;
    }
}

fn between<const D: usize>(a: [f32; D], b: [f32; D], share: f32) -> [f32; D] {
    core::array::from_fn(|d| a[d] + share * (b[d] - a[d]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_lie_at_equal_distances() {
        let chain: [[f32; 2]; RAYS] = core::array::from_fn(|i| {
            let share = i as f32 / (RAYS - 1) as f32;
            let angle = core::f32::consts::PI * share * share;
            [libm::cosf(angle), libm::sinf(angle)]
        });
        let mut out = [[0.0; 2]; MAX_HALF];
        let mut values = [[0.0; 1]; MAX_HALF];
        evenly(&chain, &chain.map(|[x, _]| [x]), &mut out, &mut values);
        for (i, [x, y]) in out.into_iter().enumerate() {
            let angle = core::f32::consts::PI * i as f32 / (MAX_HALF - 1) as f32;
            assert!(
                (x - libm::cosf(angle)).abs() < 1e-3 && (y - libm::sinf(angle)).abs() < 1e-3,
                "{i}"
            );
            assert_eq!(values[i], [x]);
        }
    }
}
