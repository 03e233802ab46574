//! Scalar fields on the membrane: how far and how fast its nodes move, and its mechanics.

use crate::evaluation::Evaluation;
use capsule_core::mechanics::Deformation;
use capsule_core::{EvaluateError, Frame, Instant, Nodes, Scene};
use capsule_refusal::Refusal;
use wasm_bindgen::prelude::*;

const FIELDS: [&str; 8] = [
    "displacement",
    "velocity",
    "stretch_1",
    "stretch_2",
    "tension_1",
    "tension_2",
    "energy_density",
    "load",
];

#[wasm_bindgen]
impl Evaluation {
    /// A field at the nodes, by its name:
    ///
    /// - "displacement" since the instant 0, and "velocity": their magnitudes in the frame "laboratory" or "centroid";
    /// - "stretch_1" >= "stretch_2": principal extension ratios;
    /// - "tension_1" >= "tension_2": principal tensions, in G_s, negative where the membrane is compressed;
    /// - "energy_density": elastic energy per stress-free area, in G_s;
    /// - "load": magnitude of the load of the fluid on the membrane, in mu V / l.
    ///
    /// A model without mechanics ([`Model::has_mechanics`](crate::Model::has_mechanics)) has the first two.
    ///
    /// # Errors
    /// As [`Evaluation::readings`]; an unknown name; mechanics of a model without.
    pub fn field(&mut self, name: &str, frame: &str) -> Result<Vec<f32>, Refusal> {
        let frame = match frame {
            "laboratory" => Frame::Laboratory,
            "centroid" => Frame::Centroid,
            other => return Err(Refusal::unknown("frame", other, &["laboratory", "centroid"])),
        };
        let scene = Scene {
            nodes: Nodes::All,
            frame,
        };
        match name {
            "displacement" => self.displacement(&scene),
            "velocity" => {
                let velocities = self.vectors(|instant, out| instant.velocities(&scene, out))?;
                Ok(velocities.into_iter().map(length).collect())
            }
            "stretch_1" => self.mechanics(|at, _| Ok(at.stretches()[0])),
            "stretch_2" => self.mechanics(|at, _| Ok(at.stretches()[1])),
            "tension_1" => self.mechanics(|at, _| Ok(at.tensions()[0])),
            "tension_2" => self.mechanics(|at, _| Ok(at.tensions()[1])),
            "energy_density" => self.mechanics(|at, _| Ok(at.energy_density())),
            "load" => self.mechanics(|at, capillary_number| at.load(capillary_number).map(length)),
            other => Err(Refusal::unknown("field", other, &FIELDS)),
        }
    }

    /// The mechanics at the nodes: stretch_1, stretch_2, area_dilation, tension_1, tension_2 and energy_density of all
    /// nodes, one after another; then x, y, z of direction_1, direction_2 and load of all nodes.
    ///
    /// # Errors
    /// As [`Evaluation::readings`]; a model without mechanics.
    pub fn membrane(&mut self) -> Result<Vec<f32>, Refusal> {
        let nodes = self.mechanics(|at, capillary_number| {
            let ([stretch_1, stretch_2], [tension_1, tension_2]) = (at.stretches(), at.tensions());
            let scalars = [
                stretch_1,
                stretch_2,
                at.area_dilation(),
                tension_1,
                tension_2,
                at.energy_density(),
            ];
            let [direction_1, direction_2] = at.directions();
            Ok((scalars, [direction_1, direction_2, at.load(capillary_number)?]))
        })?;
        let scalars = (0..6).flat_map(|k| nodes.iter().map(move |(scalars, _)| scalars[k]));
        let vectors = (0..3).flat_map(|k| nodes.iter().flat_map(move |(_, vectors)| vectors[k]));
        Ok(scalars.chain(vectors).collect())
    }
}

impl Evaluation {
    fn displacement(&mut self, scene: &Scene<'_>) -> Result<Vec<f32>, Refusal> {
        let now = self.vectors(|instant, out| instant.positions(scene, out))?;
        let t = self.t;
        self.go_to(0.0);
        let start = self.vectors(|instant, out| instant.positions(scene, out));
        self.go_to(t);
        let moved = |(now, start): (&[f32; 3], &[f32; 3])| length([0, 1, 2].map(|axis| now[axis] - start[axis]));
        Ok(now.iter().zip(&start?).map(moved).collect())
    }

    /// Vectors at all nodes, by what writes them.
    pub(crate) fn vectors(
        &mut self,
        fill: impl FnOnce(&mut Instant<'_, '_, f32>, &mut [[f32; 3]]) -> Result<usize, EvaluateError>,
    ) -> Result<Vec<[f32; 3]>, Refusal> {
        let mut vectors = vec![[0.0; 3]; self.shared.nodes];
        self.ask(|instant| fill(instant, &mut vectors))?;
        Ok(vectors)
    }

    /// A quantity of the deformation at all nodes; it is given the capillary number too.
    fn mechanics<A>(
        &mut self,
        quantity: impl Fn(&Deformation<f32>, f32) -> Result<A, EvaluateError>,
    ) -> Result<Vec<A>, Refusal> {
        let shared = self.shared.clone();
        let mesh = shared.core().mesh();
        let mut sector = vec![[0.0; 3]; mesh.sector_nodes().len()];
        let stencils = shared.stencils()?;
        let capillary_number = self.query.as_ref().map_or(f32::NAN, |query| query.parameters.get(0));
        self.ask(|instant| {
            let membrane = instant.membrane(&mut sector)?;
            let deformations = stencils.iter().map(|stencil| membrane.deformation(stencil));
            let deformations: Vec<Deformation<f32>> = deformations.collect::<Result<_, _>>()?;
            let at = |node| {
                let (index, operation) = mesh.origin(node).ok_or(EvaluateError::UnknownNode {
                    node,
                    nodes: mesh.nodes(),
                })?;
                quantity(&deformations[index].transformed(operation), capillary_number)
            };
            (0..mesh.nodes()).map(at).collect()
        })
    }
}

fn length(vector: [f32; 3]) -> f32 {
    vector.iter().map(|x| x * x).sum::<f32>().sqrt()
}
