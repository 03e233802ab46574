//! From the file of an outline to an identified capsule.
//!
//! [`Outline::read`] takes a text or a picture, [`Bench::identify`] fits the model to it, and the [`Answer`] has values,
//! intervals and units. The command `capsule-rom identify` and the page identify by the same calls.
#![forbid(unsafe_code)]

mod answer;
mod bench;
mod error;
mod outline;
mod seen;

pub use answer::{Answer, Ends, Other, ends};
pub use bench::{Bench, Request, Solved};
pub use error::{Input, MeasurementError};
pub use outline::{Outline, Said, is_picture};
pub use seen::{Seen, Summary};
