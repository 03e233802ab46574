//! The single layer of the membrane, `int_C J(x - y) q(y) dS(y)`.
//!
//! Each element acts through 7 points. Targets that are far from all elements see a point force a node instead,
//! `int phi_k q dS` (the Stokeslet is interpolated by the elements' own shape functions): a quarter of the work. Its
//! errors cancel between neighbours, so it is for all elements or none. Close to a target, an element acts through 16
//! points on parts that are small beside their distance, or through Duffy's rule if the target is a node of the element.

use rayon::prelude::*;

use super::Membrane;
use super::error::FlowError;
use super::far::Units;
use super::near::{Ball, NearTargets, TargetBlocks, transpose};
use super::patch::{Patch, PatchRule};
use super::quadrature::TriangleRule;
use super::settings::Precision;
use super::stokeslet::{Sources, StokesletSums};

/// How finely the layer of the membrane is integrated. Distances are from the centre of an element, or a part of one,
/// in units of the radius of the ball around it.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct MembraneQuadrature {
    /// Distance from every element beyond which nodal forces are enough.
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
            far: 4.0,
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
    precision: Precision,
    middle: PatchRule,
    near: PatchRule,
    /// Duffy's rule about each node.
    duffy: [PatchRule; 6],
}

impl MembraneRules {
    /// Tabulates the rules.
    pub fn new(quadrature: &MembraneQuadrature, precision: Precision) -> Self {
        let [radial, angular] = quadrature.duffy;
        Self {
            quadrature: quadrature.clone(),
            precision,
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
    elements: &'a [[u32; 6]],
    rules: &'a MembraneRules,
    patches: Vec<Patch>,
    balls: Vec<Ball>,
    /// [`POINTS`] an element.
    points: Sources,
    /// A point force a node.
    nodal: Sources,
}

impl<'a> MembraneLayer<'a> {
    /// Prepares the sources of all elements.
    pub fn new(membrane: &Membrane<'a>, rules: &'a MembraneRules) -> Self {
        let elements = membrane.elements;
        let patches: Vec<Patch> = elements
            .iter()
            .map(|element| Patch::new(element, membrane.nodes, membrane.load))
            .collect();
        let mut points = Sources::with_capacity(POINTS * elements.len());
        let mut nodal = Sources::with_capacity(membrane.nodes.len());
        membrane.nodes.iter().for_each(|&node| nodal.push(node, [0.0; 3]));
        for (e, (element, patch)) in elements.iter().zip(&patches).enumerate() {
            patch.add_sources(&rules.middle, &mut points);
            points.truncate(POINTS * (e + 1));
            let strengths: [_; POINTS] = std::array::from_fn(|p| points.strength(POINTS * e + p));
            for (k, &node) in element.iter().enumerate() {
                let share = [0, 1, 2].map(|d| (0..POINTS).map(|p| rules.middle.shape(k, p) * strengths[p][d]).sum());
                nodal.strengthen(node as usize, share);
            }
        }
        Self {
            elements,
            rules,
            balls: patches.iter().map(Patch::ball).collect(),
            patches,
            points,
            nodal,
        }
    }

    /// Adds the layer's integral (no factor) at each of the targets to `out`; the first `nodes.len()` targets are those
    /// nodes of the membrane.
    pub fn add_to(&self, nodes: &[u32], blocks: &TargetBlocks, out: &mut [[f64; 3]]) {
        let close = match self.rules.precision {
            Precision::Mixed => self.add_far::<f32>(blocks, out),
            Precision::Double => self.add_far::<f64>(blocks, out),
        };
        // Collected in the order of the elements: the result does not depend on the number of threads.
        let near: Vec<NearTargets> = transpose(&close, self.elements.len())
            .par_iter()
            .enumerate()
            .filter(|(_, close)| !close.is_empty())
            .map(|(e, close)| self.near(e, nodes, blocks.gather(close)))
            .collect();
        for near in &near {
            near.add_to(out);
        }
    }

    fn add_far<S: StokesletSums>(&self, blocks: &TargetBlocks, out: &mut [[f64; 3]]) -> Vec<Vec<u32>> {
        let units = Units::<S> {
            balls: &self.balls,
            sources: &self.points.rounded(),
            reach: self.rules.quadrature.middle,
            coarse: Some((self.rules.quadrature.far, &self.nodal.rounded())),
        };
        units.add_far(blocks, out)
    }

    /// What element `e` does to targets of which some are within `middle` of it.
    fn near(&self, e: usize, nodes: &[u32], mut near: NearTargets) -> NearTargets {
        let Ball { centre, radius } = self.balls[e];
        let middle = near.move_outside_to_front(0, centre, self.rules.quadrature.middle * radius);
        near.add(self.points.range(POINTS * e, POINTS), 0..middle);
        let mut sources = Sources::default();
        let mut start = middle;
        for k in middle..near.len() {
            let node = nodes.get(near.index(k));
            if let Some(local) = node.and_then(|node| self.elements[e].iter().position(|n| n == node)) {
                sources.clear();
                self.patches[e].add_sources(&self.rules.duffy[local], &mut sources);
                near.add(sources.all(), k..k + 1);
                near.swap(start, k);
                start += 1;
            }
        }
        self.add_near(&self.patches[e], &mut near, start, 0, &mut sources);
        near
    }

    /// Adds the contribution of a patch to the targets from `start` on; reorders them.
    fn add_near(&self, patch: &Patch, near: &mut NearTargets, start: usize, depth: usize, sources: &mut Sources) {
        let Ball { centre, radius } = patch.ball();
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
