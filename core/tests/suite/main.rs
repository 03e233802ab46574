//! Behaviour of the core, on small models with exact answers. One program: each further one would compile the
//! evaluator again.

mod common;
mod derivatives;
mod direct;
mod flips;
mod format;
mod golden;
mod header;
mod laziness;
mod limits;
mod mechanics;
mod names;
mod paper;
mod queries;
mod scenes;
mod silhouette;
