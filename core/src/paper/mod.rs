//! The published method (Boubehziz et al., Entropy 2021): `basis` finds the local POD bases of a query (section 3.4.2),
//! `manifold` the learned equilibrium xi = M(alpha, t) (section 3.4.4) from a `window` of snapshots around an instant,
//! and `dynamics` steps alpha in time (Algorithm 2). All of it works in the coefficients of the global modes.

pub(crate) mod basis;
pub(crate) mod dynamics;
mod manifold;
mod snapshot;
pub(crate) mod times;
mod window;

use crate::linalg::LANES;

/// Leading coefficients, the translation's among them, that the method works in. The others are below its error, and
/// would fill the few local modes.
pub(crate) const PAPER_MODES: usize = 41;
/// Length of a row of them, padded so that zeros fill the lanes of a product that starts at any of them.
pub(crate) const PAPER_ROW: usize = PAPER_MODES + LANES - 1;
/// Rows of a factor: stored instants whose snapshots fit.
pub(crate) const SNAPSHOTS: usize = 64;

/// Snapshots of a field, and their factorisation in place.
pub(crate) type Factor<T> = [[T; PAPER_ROW]; SNAPSHOTS];

/// Numbers of scratch that a query with so many local modes needs.
pub(crate) const fn scratch_len(local_modes: usize) -> usize {
    if local_modes > 0 { PAPER_ROW * SNAPSHOTS } else { 0 }
}
