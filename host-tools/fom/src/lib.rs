//! Full-order model of a microcapsule flowing in a square channel (Boubehziz et al., Entropy 2021, 23, 1193; "the
//! paper"): boundary integrals for the flow, finite elements or harmonics for the membrane.
//!
//! Lengths are in l (half the channel's side: y and z in [-1, 1], flow along x), velocities in the mean velocity V,
//! time in l/V, stress in mu V/l, tension in G_s.

pub mod flow;
pub mod harmonic_membrane;
pub mod harmonics;
pub mod initial;
pub mod integrator;
mod law;
pub mod mass_matrix;
pub mod measures;
pub mod mechanics;
pub mod membrane;
pub mod mesh;
mod outcome;
mod parameters;
pub mod shape_functions;
pub mod shear;
mod simulation;
pub mod surface;
pub mod symmetry;
pub mod system;
pub mod vectors;

pub use law::MembraneLaw;
pub use mesh::Mesh;
pub use outcome::{Film, History, Outcome, Status};
pub use parameters::{Configuration, Integrator, MembraneDiscretisation, Settings, SteadyCriteria};
pub use simulation::{Progress, Run, RunState, Solver};
pub use symmetry::Symmetry;

use flow::FlowError;

/// Errors of the full-order model.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FomError {
    /// A parameter or setting is not a positive number.
    #[error("{name} is {value}: it must be a positive, finite number")]
    NotPositive {
        /// Which.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A membrane that does not resist a change of its area.
    #[error("the law of the membrane, Skalak's with C = {area}, is unstable: C must be a finite number above -1/2")]
    Law {
        /// C.
        area: f64,
    },
    /// The mesh frequency is out of range.
    #[error(
        "mesh frequency {frequency} is out of range: it must be {} to {}",
        mesh::MINIMUM_FREQUENCY,
        mesh::MAX_FREQUENCY
    )]
    MeshFrequency {
        /// The requested frequency.
        frequency: usize,
    },
    /// The harmonics are too many for the mesh.
    #[error(
        "harmonics of degree {degree} are too fine for the mesh: the degree must be at least 1 and about three times \
         the mesh frequency at most"
    )]
    Degree {
        /// The requested degree.
        degree: usize,
    },
    /// The snapshots are too many to keep.
    #[error(
        "snapshots every {interval:e} up to {end_time} are too many: there may be {} at most",
        parameters::MAX_SNAPSHOTS
    )]
    TooManySnapshots {
        /// The end time.
        end_time: f64,
        /// The time between snapshots.
        interval: f64,
    },
    /// The mesh lacks the symmetry of the square.
    #[error(
        "node {node} at {point:?} has no image in the sector 0 <= z <= y: the mesh lacks the symmetry of the square"
    )]
    Asymmetric {
        /// Index of the node.
        node: usize,
        /// Its reference position.
        point: [f64; 3],
    },
    /// The duct cannot be set up.
    #[error("the duct cannot be set up: {0}")]
    Duct(#[source] FlowError),
    /// The initial shape is too long for the duct.
    #[error("a capsule of confinement a/l = {confinement} does not fit in the duct: a/l must be below {limit:.4}")]
    TooLong {
        /// The confinement.
        confinement: f64,
        /// The least confinement that is too great.
        limit: f64,
    },
    /// The initial shape is refused.
    #[error("a capsule of confinement a/l = {confinement} cannot start: {source}")]
    Start {
        /// The confinement.
        confinement: f64,
        /// Why.
        source: EvaluationError,
    },
    /// A saved run is one of another mesh.
    #[error("the saved run has {found} unknowns, but this solver's mesh has {expected}")]
    AnotherRun {
        /// The unknowns it has.
        found: usize,
        /// The unknowns it should have.
        expected: usize,
    },
    /// A fixed step is beyond the integrator's stability.
    #[error(
        "a fixed step of {step:e} l/V is unstable (found at t = {time:.4}): the limit is about {limit:.1e} l/V; take a \
         smaller step or the stabilised integrator"
    )]
    UnstableStep {
        /// The step.
        step: f64,
        /// An estimate of the greatest stable step.
        limit: f64,
        /// When it was found.
        time: f64,
    },
    /// A flow without walls failed.
    #[error("the run ended at t = {time:.4}: {reason}")]
    Shear {
        /// When.
        time: f64,
        /// Why.
        reason: String,
    },
}

/// Errors of evaluating the velocity of a surface.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EvaluationError {
    /// The membrane has lost its area somewhere.
    #[error("the membrane has collapsed: its area is {area_ratio} times the undeformed one at a point")]
    Collapsed {
        /// Deformed over undeformed area.
        area_ratio: f64,
    },
    /// The surface encloses no volume.
    #[error("the surface is inverted: it encloses a volume of {volume}")]
    Inverted {
        /// The signed volume.
        volume: f64,
    },
    /// The mass matrix could not be inverted.
    #[error("the mass matrix was not inverted in {iterations} iterations: the elements are too distorted")]
    MassMatrix {
        /// The limit on the iterations.
        iterations: usize,
    },
    /// The membrane moves impossibly fast.
    #[error("a node moves at {speed:e} V: the surface is unstable")]
    Speed {
        /// The greatest velocity component.
        speed: f64,
    },
    /// The flow refuses the surface.
    #[error(transparent)]
    Flow(#[from] FlowError),
}

/// Runs the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
