//! Two models and two methods with one workspace: the paper's method against direct evaluation.
//!
//! A workspace keeps the results of one query of one model; another model or query replaces them.
//!
//!     cargo run --release -p capsule-rom-core --example two_models -- [OTHER.crom]

use capsule_core::{Evaluator, Method, Model, Query, Workspace};
use std::error::Error;

const MODEL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/capsule.crom");

fn main() -> Result<(), Box<dyn Error>> {
    let other = std::env::args().nth(1).unwrap_or_else(|| MODEL.into());
    let files = [std::fs::read(MODEL)?, std::fs::read(&other)?];
    let models = [Model::open(&files[0])?, Model::open(&files[1])?];
    let mut workspace = Box::new(Workspace::<f32>::new());
    for (model, method) in models.iter().zip([Method::Direct, Method::Paper]) {
        let mut evaluator = Evaluator::new(model, &mut workspace)?;
        evaluator.prepare(&Query::new([0.10, 0.90], method))?;
        let mut instant = evaluator.at(3.0)?;
        let found = instant.observables()?;
        println!(
            "model {:08x}, {method:?}: length {:.4} l, velocity {:.4} V, expected error {:.5} a",
            model.digest(),
            found.axial_length,
            found.velocity,
            instant.expected_error()?,
        );
    }
    Ok(())
}
