//! How good a model is, and how fast: leave-one-out errors as in the paper's Fig. 13, run times, and
//! where it stops to be stable.

mod error;
mod fresh;
pub mod identify;
mod leave_one_out;
mod random;
mod report;
pub mod sample;
pub mod scenes;
pub mod smoothness;
pub mod speed;
pub mod stability;
pub mod task;
pub mod touched;

pub use error::StudyError;
pub use fresh::{FRESH_TIMES, Fresh, InstantStated, Stated, fresh};
pub use leave_one_out::{InstantErrors, Report, SampleErrors, leave_one_out};
pub use report::report;

use capsule_core::Method;

/// The name of a method in reports and on the command line.
#[must_use]
pub fn name(method: Method) -> &'static str {
    match method {
        Method::Direct => "direct",
        Method::Paper => "paper",
    }
}
