//! Membrane properties of a capsule from its outline, or from a few lengths.
//!
//! An experimentalist has the outline of a capsule that flows steadily in a square channel, the half width of the
//! channel, the flow's velocity and the liquid's viscosity. [`identify`] fits the model's outline to it and gives the
//! radius a, the capillary number Ca and the surface shear modulus G_s = mu V / Ca, each with intervals of the profile
//! likelihood, and a [`Verdict`]. Beside Ca and a/l it fits what no measurement is free of: shift and tilt, an edge
//! that is drawn too far out, an error of the scale, and the model's own error. [`identify_sequence`] does so for
//! several frames of one capsule, steady or at unknown instants of its transient.
//!
//! No allocator and no I/O: all storage is the caller's, so the same code runs in a browser and on a microcontroller.
//! Nothing is extrapolated: an answer outside the sampled domain of the model is none.
#![no_std]
#![forbid(unsafe_code)]

mod algebra;
mod contour;
mod curve;
mod domain;
mod error;
mod fit;
mod frames;
mod grid;
mod identification;
mod local;
mod measurement;
mod misfit;
mod model_error;
mod noise;
mod products;
mod profile;
mod residuals;
mod sequence;
mod shapes;
mod solve;
mod solver;
mod starts;

pub use contour::{ContourError, MAX_GAP, MIN_POINTS};
pub use curve::{Curve, Foot, MAX_HALF};
pub use domain::Side;
pub use error::{DentLineError, IdentifyError, MIN_LINE_POINTS};
pub use grid::Grid;
pub use identification::{Alternative, Estimate, Frame, Identification, Verdict};
pub use measurement::{Contour, Direction, Flow, Lengths, MAX_FRAMES, Measured, Measurement, Priors, Sequence, Setup};
pub use misfit::Misfit;
pub use profile::Interval;
pub use residuals::Point;
pub use sequence::{SequenceIdentification, identify_sequence};
pub use shapes::{
    HALF_WIDTH, LENGTH, Memory, NODES_ROOM, Observable, RADIUS, REAR_DEPTH, SCALARS, Shape, Shapes, Store, VELOCITY,
};
pub use solve::{identify, identify_with_misfit};
