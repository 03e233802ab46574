//! Contours of capsules in a channel, from pictures and from text files.
//!
//! A picture shows a channel along one of its edges, and capsules in it that are darker or brighter than the liquid.
//! [`Picture::capsules`] takes the background away, finds the outlines with sub-pixel edges, the walls, the direction
//! of the flow and the line of a dent. [`text::read`] reads contours that other programs have found.
//!
//! Places are in pixels: x to the right, y down, and the centre of the first pixel is at (0.5, 0.5).
#![forbid(unsafe_code)]

mod background;
mod dent;
mod edge;
mod error;
mod flow;
mod grid;
mod levels;
mod overlay;
mod picture;
mod rings;
pub mod text;
mod walls;

pub use dent::Dent;
pub use edge::Edge;
pub use error::PictureError;
pub use flow::{Axis, Flow};
pub use overlay::overlay;
pub use picture::{Capsule, Found, Picture, Settings};
pub use walls::Walls;
