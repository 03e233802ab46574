//! Online stage of the capsule reduced-order model: from a model file and (Ca, a/l) to the capsule's motion.
//!
//! No allocator and no unsafe code: all storage is in a caller-owned [`Workspace`]. Lengths are in l (half the
//! channel's side), velocities in V (mean velocity of the undisturbed flow), time in l/V.
//!
//! ```
//! use capsule_core::{Evaluator, Method, Model, Query, Workspace};
//!
//! # fn main() -> Result<(), Box<dyn core::error::Error>> {
//! let file = std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../models/capsule.crom"))?;
//! let model = Model::open(&file)?;
//! let mut workspace = Workspace::<f32>::new();
//! let mut evaluator = Evaluator::new(&model, &mut workspace)?;
//! evaluator.prepare(&Query::new([0.10, 0.90], Method::Direct))?;
//! let mut instant = evaluator.at(3.0)?;
//! let observables = instant.observables()?;
//! assert!(observables.axial_length > 1.8);
//! println!("{observables:?}, expected error {}", instant.expected_error()?);
//! # Ok(())
//! # }
//! ```
//!
//! [`Model::open`] validates a file once, and [`Evaluator::new`] checks that the model fits the workspace. After that
//! no input leads to a panic, and a result that is not finite is an error. Every target computes the same bits, because
//! only + - * / and libm's functions are used and every sum has a fixed order.
//!
//! Modules depend on each other in one direction: `linalg` and `model` (the file) are the base; `interpolate` computes
//! the weights of the samples, `motion` and `paper` the coefficients of the modes, `surface` and `mechanics` the
//! answers. `solver` and `workspace` hold the storage; `evaluator`, `instant` and `derivatives` are the interface.
#![no_std]
#![forbid(unsafe_code)]

mod derivatives;
pub mod error;
mod evaluator;
mod expected_error;
mod instant;
pub mod interpolate;
mod linalg;
pub mod mechanics;
pub mod model;
mod motion;
mod nearest;
mod paper;
mod parts;
mod query;
mod scene;
mod solver;
mod surface;
mod workspace;

// A model, and a query of it.
pub use model::wire::{MAX_PARAMETERS, Method};
pub use model::{DIAGONAL, MIDPLANE, Model, Parameters};
pub use query::{Domain, Query, Scheme};
// Storage.
#[doc(hidden)]
pub use linalg::ProductScalar;
pub use linalg::Real;
pub use parts::Parts;
pub use solver::scratch_len;
pub use surface::playback::{Playback, playback_len};
pub use workspace::Workspace;
// Answers.
pub use derivatives::Derivatives;
pub use evaluator::{Capacities, Evaluator};
pub use instant::Instant;
pub use scene::{Frame, Nodes, Scene};
pub use surface::observables::Observables;
pub use surface::section::{Segment, section};
pub use surface::silhouette::{silhouette, silhouette_derivatives};
// Errors.
pub use error::EvaluateError;
#[cfg(feature = "write")]
pub use model::EncodeError;
pub use model::OpenError;
