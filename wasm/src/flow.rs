//! The flow without a capsule.

use wasm_bindgen::prelude::*;

/// Axial velocity of the undisturbed flow at (y, z), in V; y and z in l, the walls at 1.
#[wasm_bindgen(js_name = undisturbedVelocity)]
pub fn undisturbed_velocity(y: f64, z: f64) -> f64 {
    capsule_core::mechanics::undisturbed_velocity(y, z)
}
