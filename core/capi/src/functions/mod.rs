//! The functions of the interface: models, queries, answers at an instant.
//!
//! # What every caller keeps
//! Pointers are null, or point to memory of the size that their type or their length says, which nobody else writes
//! during the call. A file's bytes stay where they are, unchanged, as long as its model is used. Models and workspaces
//! are as these functions left them; they may be moved with all their bytes. Calls that share a model only may run at
//! the same time; calls that share a workspace may not.

// In the order of the header.
mod model;

mod query;

mod answers;

pub use answers::*;
pub use model::*;
pub use query::*;
