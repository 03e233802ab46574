//! The single layer of the membrane, `int_C J(x - y) q(y) dS(y)`.
//!
//! Each element acts through 7 points. A target that is far from all elements sees a point force a node instead,
//! `int phi_k q dS` (the Stokeslet is interpolated by the elements' own shape functions): a quarter of the work. Where
//! a target is close, the element's 7 points are taken back and replaced: by 16 points on parts of the element that
//! are small beside their distance, or by Duffy's rule if the target is a node of the element.

use rayon::prelude::*;

use super::Membrane;
use super::error::FlowError;
use super::near::{NearTargets, TargetBlocks};
use super::patch::{Patch, PatchRule};
use super::quadrature::TriangleRule;
use super::stokeslet::{self, Sources};

/// How finely the layer of the membrane is integrated. Distances are from the centre of an element, or a part of one,
/// in units of the radius of the ball around it.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct MembraneQuadrature {
    /// Distance from the box around the membrane, in units of the largest radius, beyond which nodal forces are enough.
    pub far: f64,
    /// Distance beyond which 7 points are enough.
    pub middle: f64,
    /// Distance beyond which 16 points are enough; closer parts are divided.
    pub near: f64,
    /// Points of Duffy's rule in the radial and in the angular direction.
    pub duffy: [usize; 2],
}

impl Default for MembraneQuadrature {
    fn default() -> Self {
        Self {
            far: 3.0,
            middle: 2.2,
            near: 1.3,
            duffy: [4, 10],
        }
    }
}

impl MembraneQuadrature {
    pub(super) fn check(&self) -> Result<(), FlowError> {
        let reaches = [
            ("membrane.far", self.far),
            ("membrane.middle", self.middle),
            ("membrane.near", self.near),
        ];
        if let Some(&(name, value)) = reaches.iter().find(|(_, value)| !(1.2..=50.0).contains(value)) {
            return Err(FlowError::Setting {
                name,
                value,
                requirement: "1.2 to 50",
            });
        }
        match self.duffy.iter().find(|points| !(1..=64).contains(*points)) {
            Some(&points) => Err(FlowError::Setting {
                name: "membrane.duffy",
                value: points as f64,
                requirement: "1 to 64",
            }),
            None => Ok(()),
        }
    }
}

/// The rules of a [`MembraneQuadrature`], tabulated.
#[derive(Debug, Clone)]
pub struct MembraneRules {
    quadrature: MembraneQuadrature,
    middle: PatchRule,
    near: PatchRule,
    /// Duffy's rule about each node.
    duffy: [PatchRule; 6],
}

impl MembraneRules {
    /// Tabulates the rules.
    pub fn new(quadrature: &MembraneQuadrature) -> Self {
        let [radial, angular] = quadrature.duffy;
        Self {
            quadrature: quadrature.clone(),
            middle: PatchRule::new(&TriangleRule::seven()),
            near: PatchRule::new(&TriangleRule::sixteen()),
            duffy: [0, 1, 2, 3, 4, 5].map(|node| PatchRule::new(&TriangleRule::duffy(node, radial, angular))),
        }
    }
}

/// A division of an element stops here, whatever the distance: at 2^-12 of its size.
const DEEPEST: usize = 12;
/// Points of the middle rule.
const POINTS: usize = 7;

/// The layer for one shape and load.
pub struct MembraneLayer<'a> {
    membrane: &'a Membrane<'a>,
    rules: &'a MembraneRules,
    /// 7 points an element.
    points: Sources,
    /// A point force a node.
    nodal: Sources,
    /// Balls around the elements.
    balls: Vec<([f64; 3], f64)>,
    /// Corners of the box around the membrane.
    low: [f64; 3],
    high: [f64; 3],
    /// Distance from the box beyond which nodal forces are enough.
    far: f64,
}

impl<'a> MembraneLayer<'a> {
    /// Prepares the sources of all elements.
    pub fn new(membrane: &'a Membrane<'a>, rules: &'a MembraneRules) -> Self {
        let mut points = Sources::with_capacity(POINTS * membrane.elements.len() + 1);
        let mut forces = vec![[0.0; 3]; membrane.nodes.len()];
        let mut balls = Vec::with_capacity(membrane.elements.len());
        for element in membrane.elements {
            let patch = Patch::new(element, membrane.nodes, membrane.load);
            balls.push(patch.ball());
            let first = points.len();
            patch.add_sources(&rules.middle, &mut points);
            points.truncate(first + POINTS);
            let strengths: [_; POINTS] = std::array::from_fn(|p| points.get(first + p).1);
            for (k, &node) in element.iter().enumerate() {
                for d in 0..3 {
                    let shares = (0..POINTS).map(|p| rules.middle.shape(k, p) * strengths[p][d]);
                    forces[node as usize][d] += shares.sum::<f64>();
                }
            }
        }
        let mut nodal = Sources::with_capacity(forces.len());
        for (&position, &force) in membrane.nodes.iter().zip(&forces) {
            nodal.push(position, force);
        }
        Self {
            membrane,
            rules,
            points,
            nodal,
            low: [0, 1, 2].map(|d| membrane.nodes.iter().map(|p| p[d]).fold(f64::MAX, f64::min)),
            high: [0, 1, 2].map(|d| membrane.nodes.iter().map(|p| p[d]).fold(f64::MIN, f64::max)),
            far: rules.quadrature.far * balls.iter().map(|ball| ball.1).fold(0.0, f64::max),
            balls,
        }
    }

    /// Adds the layer's integral (no factor) at each of `targets` to `out`; the first `nodes.len()` targets are those
    /// nodes of the membrane.
    pub fn add_to(&self, nodes: &[u32], targets: &[[f64; 3]], out: &mut [[f64; 3]]) {
        let is_far: Vec<bool> = targets.iter().map(|&target| self.is_far(target)).collect();
        for (far, sources) in [(true, &self.nodal), (false, &self.points)] {
            let indices: Vec<usize> = (0..targets.len()).filter(|&i| is_far[i] == far).collect();
            let positions: Vec<[f64; 3]> = indices.iter().map(|&i| targets[i]).collect();
            let mut sums = vec![[0.0; 3]; positions.len()];
            stokeslet::add_all(sources, &positions, &mut sums);
            for (&i, sum) in indices.iter().zip(sums) {
                for d in 0..3 {
                    out[i][d] += sum[d];
                }
            }
        }
        let blocks = TargetBlocks::new(targets);
        // Collected in the order of the elements: the result does not depend on the number of threads.
        let corrections: Vec<NearTargets> = (0..self.membrane.elements.len())
            .into_par_iter()
            .map(|e| self.corrections(e, nodes, &blocks))
            .collect();
        for near in &corrections {
            near.add_to(out);
        }
    }

    fn is_far(&self, target: [f64; 3]) -> bool {
        let outside = [0, 1, 2].map(|d| (self.low[d] - target[d]).max(target[d] - self.high[d]).max(0.0));
        outside.iter().map(|c| c * c).sum::<f64>() > self.far * self.far
    }

    /// What element `e` contributes to the targets close to it, less what its 7 points do.
    fn corrections(&self, e: usize, nodes: &[u32], targets: &TargetBlocks) -> NearTargets {
        let (centre, radius) = self.balls[e];
        let mut near = targets.within(centre, self.rules.quadrature.middle * radius);
        if near.is_empty() {
            return near;
        }
        near.subtract(self.points.range(POINTS * e, POINTS));

        // Nodes of the element go to the front.
        let mut sources = Sources::default();
        let element = &self.membrane.elements[e];
        let patch = Patch::new(element, self.membrane.nodes, self.membrane.load);
        let mut own = 0;
        for k in 0..near.len() {
            let node = nodes.get(near.index(k));
            if let Some(local) = node.and_then(|node| element.iter().position(|n| n == node)) {
                sources.clear();
                patch.add_sources(&self.rules.duffy[local], &mut sources);
                near.add(sources.all(), k..k + 1);
                near.swap(own, k);
                own += 1;
            }
        }
        self.add_near(&patch, &mut near, own, 0, &mut sources);
        near
    }

    /// Adds the contribution of a patch to the targets from `start` on; reorders them.
    fn add_near(&self, patch: &Patch, near: &mut NearTargets, start: usize, depth: usize, sources: &mut Sources) {
        let (centre, radius) = patch.ball();
        let safe = if depth == DEEPEST {
            0.0
        } else {
            self.rules.quadrature.near * radius
        };
        let close = near.move_outside_to_front(start, centre, safe);
        if close > start {
            sources.clear();
            patch.add_sources(&self.rules.near, sources);
            near.add(sources.all(), start..close);
        }
        if close < near.len() {
            for part in patch.split() {
                self.add_near(&part, near, close, depth + 1, sources);
            }
        }
    }
}
