//! Accuracy and speed of a model: leave-one-out errors as in the paper's Fig. 13, errors on a test set, run times, and
//! the limits of its stability.

mod error;
mod leave_one_out;
mod random;
mod report;
pub mod scenes;
pub mod smoothness;
pub mod speed;
pub mod stability;
pub mod suggest;
pub mod task;
mod test_set;
pub mod touched;

pub use error::StudyError;
pub use leave_one_out::{InstantErrors, Report, SampleErrors, leave_one_out};
pub use report::report;
pub use test_set::{InstantStated, Stated, TEST_TIMES, TestSetErrors, test_set};

use capsule_core::Method;

/// The name of a method in reports and on the command line.
#[must_use]
pub fn name(method: Method) -> &'static str {
    match method {
        Method::Direct => "direct",
        Method::Paper => "paper",
    }
}
