//! The style of a microcontroller: no heap, the model in the program's image, the workspace in a static, and buffers of
//! fixed size. `predict` needs `core` only; `main` and the mutex stand for the firmware around it.
//!
//!     cargo run -p capsule-rom-core --example static_workspace

use capsule_core::{EvaluateError, Evaluator, Frame, MIDPLANE, Method, Model, Query, Workspace, scratch_len};
use std::sync::{Mutex, PoisonError};

/// In flash. On a target with aligned loads, at a multiple of 16 bytes.
static FILE: &[u8] = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/../models/capsule.crom"));

/// Capacities of the shipped model, for direct evaluation alone: 12.6 kB.
type Direct = Workspace<f32, 129, 0, 32, { scratch_len(0, 32) }>;

/// In RAM, initialised at compile time.
static WORKSPACE: Mutex<Direct> = Mutex::new(Direct::new());

/// Length and outline of the capsule at an instant; returns the number of points.
fn predict(
    model: &Model<'_>,
    workspace: &mut Direct,
    parameters: [f32; 2],
    t: f32,
    outline: &mut [[f32; 2]],
) -> Result<(f32, usize), EvaluateError> {
    let mut evaluator = Evaluator::new(model, workspace)?;
    evaluator.prepare(&Query::new(parameters, Method::Direct))?;
    let mut instant = evaluator.at(t)?;
    let length = instant.observables()?.axial_length;
    let count = instant.outline(MIDPLANE, Frame::Centroid, outline)?;
    Ok((length, count))
}

fn main() {
    let mut workspace = WORKSPACE.lock().unwrap_or_else(PoisonError::into_inner);
    let mut outline = [[0.0; 2]; 128];
    match Model::open(FILE) {
        Err(error) => println!("the model does not open: {error}"),
        Ok(model) => match predict(&model, &mut workspace, [0.10, 0.90], 3.0, &mut outline) {
            Ok((length, count)) => println!("length {length:.4} l, {count} points of the outline"),
            Err(error) => println!("no answer: {}", model.describe(error)),
        },
    }
    println!("workspace of {} bytes", size_of::<Direct>());
}
