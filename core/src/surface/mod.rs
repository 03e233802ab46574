//! From reduced coordinates to what is seen: nodes, outlines, silhouettes, sections, volume, lengths.

pub(crate) mod observables;
pub(crate) mod playback;
pub(crate) mod quadrature;
pub(crate) mod reconstruct;
pub(crate) mod section;
pub(crate) mod silhouette;
