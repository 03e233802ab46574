//! Online stage of the capsule reduced-order model: from a model file and (Ca, a/l) to the capsule's motion.
//!
//! No allocator, no unsafe code; all storage is in a caller-owned [`Workspace`]. Lengths are in l (half the channel's
//! side), velocities in V (mean velocity of the undisturbed flow), time in l/V.
#![no_std]
#![forbid(unsafe_code)]

mod basis;
mod direct;
mod dynamics;
pub mod error;
mod evaluator;
mod expected_error;
pub mod interpolate;
mod linalg;
mod manifold;
pub mod model;
mod motion;
mod observables;
mod query;
mod real;
mod reconstruct;
mod scene;
mod section;
mod workspace;

pub use error::{EncodeError, EvaluateError, OpenError};
pub use evaluator::{Evaluator, Instant};
pub use model::{DIAGONAL, MIDPLANE, Model};
pub use observables::Observables;
pub use query::{Domain, Method, Query};
pub use real::Real;
pub use scene::{Frame, Nodes, Scene};
pub use section::{Segment, section};
pub use workspace::Workspace;
