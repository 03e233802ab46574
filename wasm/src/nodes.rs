//! The membrane's nodes in the laboratory frame, and what is seen of them from the side.

use crate::evaluation::Evaluation;
use capsule_core::{EvaluateError, Frame, Nodes, Scene, silhouette};
use capsule_refusal::Refusal;
use std::ops::RangeInclusive;
use wasm_bindgen::prelude::*;

/// The points of a silhouette.
const POINTS: RangeInclusive<usize> = 3..=100_000;

const SCENE: Scene<'_> = Scene {
    nodes: Nodes::All,
    frame: Frame::Laboratory,
};

#[wasm_bindgen]
impl Evaluation {
    /// Positions of all nodes, x, y, z, ..., in l.
    ///
    /// # Errors
    /// As [`Evaluation::readings`].
    pub fn positions(&mut self) -> Result<Vec<f32>, Refusal> {
        let positions = self.vectors(|instant, out| instant.positions(&SCENE, out))?;
        Ok(positions.into_flattened())
    }

    /// Velocities of all nodes, x, y, z, ..., in V.
    ///
    /// # Errors
    /// As [`Evaluation::readings`].
    pub fn velocities(&mut self) -> Result<Vec<f32>, Refusal> {
        let velocities = self.vectors(|instant, out| instant.velocities(&SCENE, out))?;
        Ok(velocities.into_flattened())
    }

    /// The silhouette across the direction cos(angle) y + sin(angle) z, from the front to the rear: as many points x,
    /// w, x, w, ..., in l, as asked for.
    ///
    /// # Errors
    /// As [`Evaluation::readings`]; fewer than 3 points, or more than 100,000.
    pub fn silhouette(&mut self, angle: f64, points: usize) -> Result<Vec<f32>, Refusal> {
        if !POINTS.contains(&points) {
            return Err(EvaluateError::Value {
                what: "the number of points",
                value: points as f32,
                min: *POINTS.start() as f32,
                max: *POINTS.end() as f32,
            }
            .into());
        }
        let positions = self.vectors(|instant, out| instant.positions(&SCENE, out))?;
        let mesh = self.shared.core().mesh();
        let mut normals = vec![[0.0; 3]; mesh.sector_nodes().len()];
        let mut out = vec![[0.0; 2]; points];
        let across = [angle.cos() as f32, angle.sin() as f32];
        silhouette(&mesh, &positions, across, &mut normals, &mut out)?;
        Ok(out.into_flattened())
    }
}
