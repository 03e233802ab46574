//! Predicts the capsule at some instants: lengths, velocity, and their expected error.
//!
//!     cargo run -p capsule-rom-core --example predict -- 0.10 0.90

use capsule_core::{Evaluator, MAX_PARAMETERS, Method, Model, Parameters, Query, Workspace};
use std::error::Error;

const MODEL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/capsule.crom");

fn main() -> Result<(), Box<dyn Error>> {
    let mut values = Vec::new();
    for argument in std::env::args().skip(1) {
        values.push(argument.parse()?);
    }
    if values.is_empty() {
        values = vec![0.10, 0.90];
    }
    let parameters: Parameters<f32> = Parameters::new(&values)
        .ok_or_else(|| format!("1 to {MAX_PARAMETERS} parameters expected: the capillary number and a/l"))?;

    let file = std::fs::read(MODEL)?;
    let model = Model::open(&file)?;
    let mut workspace = Workspace::<f32>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace)?;
    // The model names the parameters of an error.
    evaluator
        .prepare(&Query::new(parameters, Method::Direct))
        .map_err(|error| model.describe(error).to_string())?;

    println!("    t   length   width   depth  velocity  expected error / a   bound / a");
    for share in [0.0, 0.1, 0.3, 1.0] {
        let mut instant = evaluator.at(share * model.end_time())?;
        let found = instant.observables()?;
        println!(
            "{:5.2}  {:7.4} {:7.4} {:7.4}  {:8.4}  {:18.5}   {:9.5}",
            instant.t(),
            found.axial_length,
            2.0 * found.half_width,
            found.rear_depth,
            found.velocity,
            instant.expected_error()?,
            instant.error_bound()?,
        );
    }
    Ok(())
}
