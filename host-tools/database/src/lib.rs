//! Snapshots on disk: of the full-order model in a [`Database`], and other people's in a [`Collection`].
//!
//! A database is a directory:
//!
//! - `database.json`: format version, names of the parameters, units, instants of the snapshots, solver settings;
//! - `mesh.npz`: the reference nodes on the unit sphere, the quadratic triangles and the symmetry tables;
//! - `bending.csv`, where it has been computed: the effect of the bending stiffness at some configurations;
//! - `ca0.1000_al0.9000.npz` and the like: one file a configuration, written whole or not at all.
//!
//! [`Database`] reads and writes it and may be shared by the threads of a sweep. [`Trajectory`] is one configuration in
//! memory, at all the nodes of the mesh, in the laboratory frame. On disk it takes a few per cent of that: the symmetry
//! of the square is found in it and only one sector of the nodes is kept ([`Symmetry`]), and the numbers are predicted
//! from their past and kept as small integers ([`compact`]). The files are plain NPZ, which NumPy opens.
//!
//! [`Export`] writes a database as plain arrays, [`vtu`] an instant or a motion for ParaView, [`stl`] a surface,
//! [`export_npz`] a trajectory for NumPy, [`fields`] quantities at the nodes, [`table`] other tables. What belongs
//! together appears together: [`Staging`].
//!
//! Lengths are in l (half the duct's side), velocities in V, times in l/V.

mod atomic;
mod bending;
pub mod collection;
pub mod compact;
mod database;
mod description;
mod error;
pub mod export;
pub mod fields;
mod instant;
mod merge;
mod mesh;
mod mesh_file;
mod npz;
mod predictor;
pub mod stl;
mod symmetry;
pub mod table;
mod trajectory;
pub mod vtu;

pub use atomic::{Staging, followed, write as write_whole};
pub use bending::BendingEffect;
pub use collection::Collection;
pub use database::{Database, Entry};
pub use description::{Description, Difference, Parameter};
pub use error::DatabaseError;
pub use export::Export;
pub use instant::{Instant, PointData};
pub use merge::Merge;
pub use mesh::Mesh;
pub use npz::export as export_npz;
pub use symmetry::{Symmetry, apply};
pub use trajectory::{Status, Trajectory};

/// Runs the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
