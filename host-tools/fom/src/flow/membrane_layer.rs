//! The single layer of the membrane, `int_C J(x - y) q(y) dS(y)`.
//!
//! Each element is first seen by all targets through 7 sources. Where a target is close, the element's share is taken
//! back and replaced by a better one: by 16 sources on parts of the element that are small beside their distance, or
//! by Duffy's rule if the target is a node of the element.

use rayon::prelude::*;

use super::Membrane;
use super::error::FlowError;
use super::near::NearTargets;
use super::patch::{Patch, PatchRule};
use super::quadrature::TriangleRule;
use super::stokeslet::{self, Sources};

/// How finely the layer of the membrane is integrated. Distances are from the centre of an element, or a part of one,
/// in units of the radius of the ball around it.
#[derive(Debug, Clone, PartialEq)]
pub struct MembraneQuadrature {
    /// Distance beyond which 7 points are enough.
    pub far: f64,
    /// Distance beyond which 16 points are enough; closer parts are divided.
    pub near: f64,
    /// Points of Duffy's rule in the radial and in the angular direction.
    pub duffy: [usize; 2],
}

impl Default for MembraneQuadrature {
    fn default() -> Self {
        Self {
            far: 2.5,
            near: 1.5,
            duffy: [4, 10],
        }
    }
}

impl MembraneQuadrature {
    pub(super) fn check(&self) -> Result<(), FlowError> {
        let reaches = [("membrane.far", self.far), ("membrane.near", self.near)];
        if let Some(&(name, value)) = reaches.iter().find(|(_, value)| !(1.2..=20.0).contains(value)) {
            return Err(FlowError::Setting {
                name,
                value,
                requirement: "1.2 to 20",
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
    far: PatchRule,
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
            far: PatchRule::new(&TriangleRule::seven()),
            near: PatchRule::new(&TriangleRule::sixteen()),
            duffy: [0, 1, 2, 3, 4, 5].map(|node| PatchRule::new(&TriangleRule::duffy(node, radial, angular))),
        }
    }
}

/// A division of an element stops here, whatever the distance: at 2^-12 of its size.
const DEEPEST: usize = 12;

/// The layer for one shape and load.
pub struct MembraneLayer<'a> {
    membrane: &'a Membrane<'a>,
    rules: &'a MembraneRules,
    far: Sources,
}

impl<'a> MembraneLayer<'a> {
    /// Prepares the far sources of all elements.
    pub fn new(membrane: &'a Membrane<'a>, rules: &'a MembraneRules) -> Self {
        let mut far = Sources::with_capacity(membrane.elements.len() * rules.far.len());
        for element in membrane.elements {
            Patch::new(element, membrane.nodes, membrane.load).add_sources(&rules.far, &mut far);
        }
        Self { membrane, rules, far }
    }

    /// Adds the layer's integral (no factor) at each of `targets` to `out`; the first `nodes.len()` targets are those
    /// nodes of the membrane.
    pub fn add_to(&self, nodes: &[u32], targets: &[[f64; 3]], out: &mut [[f64; 3]]) {
        stokeslet::add_all(&self.far, targets, out);
        // Collected in the order of the elements: the result does not depend on the number of threads.
        let corrections: Vec<NearTargets> = (0..self.membrane.elements.len())
            .into_par_iter()
            .map(|e| self.corrections(e, nodes, targets))
            .collect();
        for near in &corrections {
            near.add_to(out);
        }
    }

    /// What element `e` contributes to the targets close to it, less what its far sources do.
    fn corrections(&self, e: usize, nodes: &[u32], targets: &[[f64; 3]]) -> NearTargets {
        let element = &self.membrane.elements[e];
        let patch = Patch::new(element, self.membrane.nodes, self.membrane.load);
        let (centre, radius) = patch.ball();
        let mut near = NearTargets::within(targets, centre, self.rules.quadrature.far * radius);
        if near.is_empty() {
            return near;
        }
        let points = self.rules.far.len();
        near.subtract(self.far.range(points * e, points));

        // Nodes of the element go to the front.
        let mut sources = Sources::default();
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
