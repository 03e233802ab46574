//! Capsule-like surfaces with smooth loads, for the tests of the flow.

use super::Membrane;
use super::quadrature::TriangleRule;
use crate::Mesh;
use crate::shape_functions::{Point, nodes_of};

/// A surface with a load and the force vector that belongs to it.
pub struct Loaded {
    pub mesh: Mesh,
    pub nodes: Vec<[f64; 3]>,
    pub load: Vec<[f64; 3]>,
    pub force: Vec<[f64; 3]>,
}

impl Loaded {
    /// The image of the unit sphere of mesh frequency `n` under `shape`, with `load` as a function of the point on the
    /// unit sphere.
    pub fn new(n: usize, shape: impl Fn([f64; 3]) -> [f64; 3], load: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        let mesh = Mesh::octahedral(n).unwrap();
        let nodes: Vec<_> = mesh.nodes.iter().map(|&p| shape(p)).collect();
        let load: Vec<_> = mesh.nodes.iter().map(|&p| load(p)).collect();
        let force = force(&mesh, &nodes, &load);
        Self {
            mesh,
            nodes,
            load,
            force,
        }
    }

    /// Another load, given at the nodes.
    pub fn set_load(&mut self, load: Vec<[f64; 3]>) {
        self.force = force(&self.mesh, &self.nodes, &load);
        self.load = load;
    }

    /// A capsule in the duct with a film of 0.1 l, a dented rear, and a load of the square's symmetry that has all
    /// components.
    pub fn capsule(n: usize) -> Self {
        Self::new(
            n,
            |[x, y, z]| {
                let round = 0.88 * (1.0 - 0.1 * x);
                [1.0 * x + 0.45 * (y * y + z * z) - 0.3, round * y, round * z]
            },
            |[x, y, z]| {
                [
                    3.0 + 4.0 * x + 2.0 * y * y * z * z,
                    (5.0 * x - 2.0 + 3.0 * z * z) * y,
                    (5.0 * x - 2.0 + 3.0 * y * y) * z,
                ]
            },
        )
    }

    pub fn membrane(&self) -> Membrane<'_> {
        Membrane {
            elements: &self.mesh.elements,
            nodes: &self.nodes,
            load: &self.load,
            force: &self.force,
        }
    }

    pub fn all(&self) -> Vec<u32> {
        (0..self.nodes.len() as u32).collect()
    }
}

/// The load's integral against each shape function.
fn force(mesh: &Mesh, nodes: &[[f64; 3]], load: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let mut force = vec![[0.0; 3]; nodes.len()];
    let rule = TriangleRule::sixteen();
    for element in &mesh.elements {
        let (x, q) = (nodes_of(element, nodes), nodes_of(element, load));
        for (&[xi, eta], &weight) in rule.points.iter().zip(&rule.weights) {
            let point = Point::at(xi, eta, weight);
            let strength = point.weight * point.area(&x) * point.interpolate(&q);
            for (&node, value) in element.iter().zip(point.value) {
                for d in 0..3 {
                    force[node as usize][d] += value * strength[d];
                }
            }
        }
    }
    force
}

/// Largest component of a difference.
pub fn difference<const N: usize>(a: &[[f64; N]], b: &[[f64; N]]) -> f64 {
    a.iter()
        .flatten()
        .zip(b.iter().flatten())
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}
