//! The single layer of the membrane, `int_C J(x - y) q(y) dS(y)`.
//!
//! Each element acts through 7 points. Targets that are far from all elements see a point force a node instead,
//! `int phi_k q dS` (the Stokeslet is interpolated by the elements' own shape functions): a quarter of the work. Its
//! errors cancel between neighbours, so it is for all elements or none. Close to a target, an element acts through 16
//! points on parts that are small beside their distance, or through Duffy's rule if the target is a node of the
//! element.

use rayon::prelude::*;

use super::Membrane;
use super::error::FlowError;
use super::far::Units;
use super::near::{Ball, NearTargets, TargetBlocks, transpose};
use super::patch::{Patch, PatchRule};
use super::precision::Precision;
use super::quadrature::TriangleRule;
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
    membrane: Membrane<'a>,
    rules: &'a MembraneRules,
    /// Balls around the elements.
    balls: Vec<Ball>,
    sources: FarSources,
}

/// The sources for the far sums in the precision of these.
enum FarSources {
    Mixed(Far<f32>),
    Double(Far<f64>),
}

struct Far<S> {
    /// [`POINTS`] an element.
    points: Sources<S>,
    /// A point force a node.
    nodal: Sources<S>,
}

impl<'a> MembraneLayer<'a> {
    /// Prepares the sources of all elements.
    pub fn new(membrane: &Membrane<'a>, rules: &'a MembraneRules) -> Self {
        let (balls, sources) = match rules.precision {
            Precision::Mixed => {
                let (balls, far) = Far::new(membrane, rules);
                (balls, FarSources::Mixed(far))
            }
            Precision::Double => {
                let (balls, far) = Far::new(membrane, rules);
                (balls, FarSources::Double(far))
            }
        };
        Self {
            membrane: *membrane,
            rules,
            balls,
            sources,
        }
    }

    /// Adds the layer's integral (no factor) at each of the targets to `out`; the first `nodes.len()` targets are those
    /// nodes of the membrane.
    pub fn add_to(&self, nodes: &[u32], blocks: &TargetBlocks, out: &mut [[f64; 3]]) {
        let close = match &self.sources {
            FarSources::Mixed(far) => self.add_far(far, blocks, out),
            FarSources::Double(far) => self.add_far(far, blocks, out),
        };
        // Collected in the order of the elements: the result does not depend on the number of threads.
        let near: Vec<NearTargets> = transpose(&close, self.balls.len())
            .par_iter()
            .enumerate()
            .filter(|(_, close)| !close.is_empty())
            .map_init(Sources::default, |scratch, (e, close)| {
                self.near(e, nodes, blocks.gather(close), scratch)
            })
            .collect();
        for near in &near {
            near.add_to(out);
        }
    }

    /// Adds what the elements do that are beyond `middle` of all targets of a block; returns the others for each block.
    fn add_far<S: StokesletSums>(&self, far: &Far<S>, blocks: &TargetBlocks, out: &mut [[f64; 3]]) -> Vec<Vec<u32>> {
        let units = Units {
            balls: &self.balls,
            sources: &far.points,
            reach: self.rules.quadrature.middle,
            coarse: Some((self.rules.quadrature.far, &far.nodal)),
        };
        units.add_far(blocks, out)
    }

    /// The velocity that element `e` induces at targets, some of which are close to it.
    fn near(&self, e: usize, nodes: &[u32], mut near: NearTargets, scratch: &mut Sources) -> NearTargets {
        let element = &self.membrane.elements[e];
        let patch = Patch::new(element, self.membrane.nodes, self.membrane.load);
        // Nodes of the element go to the front.
        let mut own = 0;
        for k in 0..near.len() {
            let node = nodes.get(near.index(k));
            if let Some(local) = node.and_then(|node| element.iter().position(|n| n == node)) {
                scratch.clear();
                patch.add_sources(&self.rules.duffy[local], scratch);
                near.add(scratch.all(), k..k + 1);
                near.swap(own, k);
                own += 1;
            }
        }
        self.add_near(&patch, &mut near, own, 0, scratch);
        near
    }

    /// Adds the contribution of a patch to the targets from `start` on; reorders them.
    fn add_near(&self, patch: &Patch, near: &mut NearTargets, start: usize, depth: usize, sources: &mut Sources) {
        let Ball { centre, radius } = patch.ball();
        let mut start = start;
        for (reach, rule) in [
            (self.rules.quadrature.middle, &self.rules.middle),
            (self.rules.quadrature.near, &self.rules.near),
        ] {
            let safe = if depth == DEEPEST { 0.0 } else { reach * radius };
            let close = near.move_outside_to_front(start, centre, safe);
            if close > start {
                sources.clear();
                patch.add_sources(rule, sources);
                near.add(sources.all(), start..close);
            }
            start = close;
        }
        if start < near.len() {
            for part in patch.split() {
                self.add_near(&part, near, start, depth + 1, sources);
            }
        }
    }
}

impl<S: StokesletSums> Far<S> {
    /// The sources of all elements, and the balls around these.
    fn new(membrane: &Membrane, rules: &MembraneRules) -> (Vec<Ball>, Self) {
        let mut balls = Vec::with_capacity(membrane.elements.len());
        let mut points = Sources::with_capacity(POINTS * membrane.elements.len());
        let mut forces = vec![[0.0; 3]; membrane.nodes.len()];
        let mut sources = Sources::<f64>::default();
        for element in membrane.elements {
            let patch = Patch::new(element, membrane.nodes, membrane.load);
            balls.push(patch.ball());
            sources.clear();
            patch.add_sources(&rules.middle, &mut sources);
            points.append(sources.range(0, POINTS));
            for p in 0..POINTS {
                let strength = sources.strength(p);
                for (k, &node) in element.iter().enumerate() {
                    let shape = rules.middle.shape(k, p);
                    for d in 0..3 {
                        forces[node as usize][d] += shape * strength[d];
                    }
                }
            }
        }
        let mut nodal = Sources::with_capacity(forces.len());
        for (&position, &force) in membrane.nodes.iter().zip(&forces) {
            nodal.push(position, force);
        }
        (balls, Self { points, nodal })
    }
}
