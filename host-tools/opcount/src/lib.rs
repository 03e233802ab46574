//! The cost of work: by a number that counts what is done with it, which repeats exactly, and by the machine's peaks,
//! which tell how near to its limit a measured time is.

mod counted;
mod peak;

pub use counted::{Counted, Counts, count};
pub use peak::{Arithmetic, least_time, peak, reading};
