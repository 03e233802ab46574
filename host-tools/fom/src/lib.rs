//! Full-order model of a microcapsule flowing in a square channel (Boubehziz et al., Entropy 2021, 23, 1193; "the
//! paper"): boundary integrals for the flow, finite elements for the neo-Hookean membrane.
//!
//! Lengths are in l (half the channel's side: y and z in [-1, 1], flow along x), velocities in the mean velocity V,
//! time in l/V, stress in mu V/l, tension in G_s.

pub mod flow;
pub mod initial;
pub mod integrator;
pub mod mass_matrix;
pub mod membrane;
pub mod mesh;
pub mod shape_functions;
pub mod surface;
pub mod symmetry;

pub use mesh::Mesh;
pub use symmetry::Symmetry;

/// What can go wrong in the full-order model.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FomError {
    /// The mesh frequency is out of range.
    #[error(
        "mesh frequency {frequency} is out of range: it must be {} to {}",
        mesh::MINIMUM_FREQUENCY,
        mesh::MAXIMUM_FREQUENCY
    )]
    MeshFrequency {
        /// The frequency asked for.
        frequency: usize,
    },
    /// The mesh lacks the symmetry of the square.
    #[error(
        "node {node} at {point:?} has no mirror image in the sector 0 <= z <= y: the mesh lacks the symmetry of the square"
    )]
    Asymmetric {
        /// Index of the node.
        node: usize,
        /// Its reference position.
        point: [f64; 3],
    },
}

/// Why the velocity of a surface cannot be found.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EvaluationError {
    /// An element has lost its area.
    #[error("element with nodes {element:?} has collapsed: its area is {area_ratio} times the undeformed one")]
    Collapsed {
        /// The element's nodes.
        element: [u32; 6],
        /// Deformed over undeformed area.
        area_ratio: f64,
    },
    /// The mass matrix could not be inverted.
    #[error(
        "the mass matrix of the surface was not inverted in {iterations} iterations: the elements are too distorted"
    )]
    MassMatrix {
        /// The limit on the iterations.
        iterations: usize,
    },
}
