//! From coefficients of the modes to the surface: `reconstruct` computes nodes and outlines, `playback` successive
//! frames of all nodes, `quadrature` integrals over the elements, `observables` the lengths, `section` a cut by a
//! plane, and `silhouette` the outline of a projection.

pub(crate) mod observables;
pub(crate) mod playback;
pub(crate) mod quadrature;
pub(crate) mod reconstruct;
pub(crate) mod section;
pub(crate) mod silhouette;
