//! capsule-core in the browser: a model, and evaluations of it in single precision, as natively and on a
//! microcontroller, so that the same bits come out. Every failure is a JavaScript `Error` with the core's text.
//!
//! The page pays for what it asks: each method computes what it returns and nothing else.

mod batch;
mod evaluation;
mod model;
mod section;
mod surface;

pub use evaluation::{Curves, Evaluation, Readings};
pub use model::Model;
