//! The offline stage: from a database of snapshots, or from other people's data, to one model file.
//!
//! [`build`] reads the steady configurations of a database, splits them into two clusters that share a row of
//! confinements, reduces each by the double POD of the paper (Boubehziz et al., Entropy 2021, 23, 1193, eqs. 15 to 22),
//! measures what the model errs at each sample when it is built without it, and writes all of that as the file that
//! capsule-rom-core reads. [`leave_one_out`] gives those errors alone.
//!
//! The paper's snapshots are displacements in the laboratory frame. Here the axial translation is a coordinate of its
//! own: a state is the axial position of the volume centroid, times sqrt(N_x), and the displacement of the nodes in the
//! centroid's frame from the stress-free sphere. Shape and translation differ a hundredfold in size, and the shape's
//! modes need not carry the translation.
//!
//! Lengths are in l, velocities in V, times in l/V.

mod assembled;
mod bending;
mod border;
mod bound;
mod build;
mod changes;
mod compare;
mod dense;
mod distance;
mod error;
mod hausdorff;
mod interpolated;
mod intervals;
mod leave_one_out;
mod limit;
mod placed;
mod plan;
mod pod;
mod samples;
mod scaling;
mod settings;
mod source;
mod spectra;
mod splines;
mod subsets;
mod surfaces;
mod svd;
mod tolerances;
mod writer;

pub use bending::bending_effect;
pub use border::Jump;
pub use build::{BuildReport, ClusterReport, FieldReport, build};
pub use compare::{Comparison, compare};
pub use error::OfflineError;
pub use hausdorff::modified_hausdorff;
pub use interpolated::{Interpolated, interpolated};
pub use leave_one_out::{LeftOut, leave_one_out};
pub use limit::{SteadyLimit, steady_limits};
pub use placed::PlacedSamples;
pub use settings::{Design, Ranks, Settings, Split, Storage, Truncation};
pub use source::Source;
pub use spectra::{Spectrum, one_minus_ric};
pub use subsets::Subsets;

/// Progress of a long task: what is done, how many steps of it are finished, and of how many.
pub type Progress<'a> = &'a (dyn Fn(&str, usize, usize) + Sync);
