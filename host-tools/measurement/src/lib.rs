//! From the file of an outline to an identified capsule.
//!
//! [`Outline::read`] takes a text or a picture, [`Bench::identify`] fits the model to it, and the [`Answer`] has
//! values, intervals and units. The command `capsule-rom identify` and the page identify by the same calls.
//!
//! ```
//! use capsule_core::Model;
//! use capsule_identify::{Direction, Flow, Lengths, Observable, Setup};
//! use capsule_measurement::{Bench, Outline, Request, Said};
//! # use std::fmt::Write;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let file = std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/capsule.crom"))?;
//! let model = Model::open(&file)?;
//! let mut bench = Bench::new(&model);
//! # let (mut shapes, _) = bench.shapes(&model, Observable::Midplane);
//! # let shape = shapes.at([0.06_f64.ln(), 0.95])?;
//! # let half = shape.curve.points();
//! # let mirrored = half[1..half.len() - 1].iter().rev().map(|[x, r]| [*x, -r]);
//! # let mut text = "x_um,y_um\n".to_owned();
//! # for [x, y] in half.iter().copied().chain(mirrored) {
//! #     writeln!(text, "{},{}", 25.0 * x, 25.0 * y)?;
//! # }
//! // `text` holds the points around a capsule, one a line, with headings that say um.
//! let half_width_um = 25.0;
//! let said = Said {
//!     half_width_um,
//!     unit: None,
//!     pixel_um: None,
//!     direction: Direction::Found,
//!     capsule: None,
//!     edge: None,
//!     background: None,
//! };
//! let mut warnings = Vec::new();
//! let outline = Outline::read("outline.csv".as_ref(), text.as_bytes(), &said, &mut warnings)?;
//! let request = Request {
//!     observable: Observable::Midplane,
//!     setup: Setup { half_width_um, flow: Flow::MeanVelocity(5e-3), viscosity_pa_s: 0.8 },
//!     lengths: Lengths::default(),
//!     noise_um: None,
//!     pixel_um: None,
//!     edge_px: None,
//!     scale_error: None,
//!     exposure_ms: None,
//! };
//! let grid = bench.grid(&model, request.observable)?;
//! let solved = bench.identify(&model, &grid, &request, Some(&outline), warnings)?;
//! assert_eq!(solved.answer.verdict, "identified");
//! // G_s = mu V / Ca
//! assert!((solved.answer.gs_n_per_m / (0.8 * 5e-3 / 0.06) - 1.0).abs() < 0.01);
//! # Ok(())
//! # }
//! ```
#![forbid(unsafe_code)]

mod answer;
mod bench;
mod error;
mod outline;
mod said;
mod seen;

pub use answer::{Answer, Ends, Other, ends};
pub use bench::{Bench, Request, Solved};
pub use error::{Input, MeasurementError};
pub use outline::{Outline, is_picture};
pub use said::Said;
pub use seen::{Seen, Summary};
