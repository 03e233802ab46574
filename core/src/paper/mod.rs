//! The published method (Boubehziz et al. 2021): a local basis, a learned manifold and steps in time.

pub(crate) mod basis;
pub(crate) mod dynamics;
pub(crate) mod manifold;
