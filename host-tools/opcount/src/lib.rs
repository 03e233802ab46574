//! The cost of work: by a number type that counts its operations, which repeats exactly, and by the peak rates of the
//! machine, to which measured times are compared.

mod counted;
mod peak;

pub use counted::{Counted, Counts, count};
pub use peak::{Arithmetic, least_time, peak, reading};
