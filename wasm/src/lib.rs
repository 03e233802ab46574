//! The core in the browser: a model, and its evaluations in single precision with the same bits as natively and on
//! a microcontroller. Every failure is a JavaScript `Error` with the core's text, and its name of the reason as `code`.
//!
//! Each method computes only its own result.

mod batch;
mod evaluation;
mod fields;
mod flow;
mod model;
mod nodes;
mod section;
mod shared;
mod surface;

pub use evaluation::{Curves, Evaluation, Readings};
pub use flow::undisturbed_velocity;
pub use model::Model;
