//! Online stage of the capsule reduced-order model: from a model file and (Ca, a/l) to the capsule's motion.
//!
//! No allocator, no unsafe code; all storage is in a caller-owned [`Workspace`]. Lengths are in l (half the channel's
//! side), velocities in V (mean velocity of the undisturbed flow), time in l/V.
//!
//! ```no_run
//! use capsule_core::{Evaluator, Method, Model, Query, Workspace};
//!
//! # fn main() -> Result<(), Box<dyn core::error::Error>> {
//! let file = std::fs::read("capsule.crom")?;
//! let model = Model::open(&file)?;
//! let mut workspace = Workspace::<f32>::new();
//! let mut evaluator = Evaluator::new(&model, &mut workspace)?;
//! evaluator.prepare(&Query::new([0.10, 0.90], Method::Direct))?;
//! let mut instant = evaluator.at(3.0)?;
//! println!("{:?}, expected error {}", instant.observables()?, instant.expected_error()?);
//! # Ok(())
//! # }
//! ```
//!
//! [`Model::open`] checks a file once; after it, and after [`Evaluator::new`] has found that the model fits, no input
//! leads to a panic, and what is not finite is an error. The same bits come out on every target, because only + - * /
//! and libm's functions are used, and every sum has its order.
#![no_std]
#![forbid(unsafe_code)]

pub mod error;
mod evaluator;
mod expected_error;
pub mod interpolate;
mod linalg;
pub mod mechanics;
pub mod model;
mod motion;
mod paper;
mod query;
mod real;
mod scene;
mod surface;
mod workspace;

pub use error::{EncodeError, EvaluateError, OpenError};
pub use evaluator::{Evaluator, Instant};
pub use model::{DIAGONAL, MIDPLANE, Model};
pub use query::{Domain, MAX_PARAMETERS, Method, Parameters, Query, Scheme};
pub use real::Real;
pub use scene::{Frame, Nodes, Scene};
pub use surface::observables::Observables;
pub use surface::playback::{Playback, playback_len};
pub use surface::section::{Segment, section};
pub use surface::silhouette::silhouette;
pub use workspace::{Parts, Workspace, scratch_len};
