//! Inputs and outputs in C's layout.

use capsule_core as rom;
use core::ffi::c_char;

/// Method that answers a query.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// As the model's author chose.
    Default = 0,
    /// Interpolated coefficients evaluated at the instant: fast.
    Direct = 1,
    /// The published algorithm: a local basis, a learned manifold, steps in time.
    Paper = 2,
}

/// Where parameters lie.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    /// Within the sampled ranges and below the steady limit.
    Inside = 0,
    /// Within the sampled ranges, where no steady state exists.
    BeyondSteadyLimit = 1,
    /// Outside the sampled ranges.
    Outside = 2,
    /// Within the ranges of scattered samples, but far from all of them.
    FarFromSamples = 3,
    /// Not found, as the call failed before it looked.
    Unknown = 4,
}

impl From<rom::Domain> for Domain {
    fn from(found: rom::Domain) -> Self {
        match found {
            rom::Domain::Inside => Self::Inside,
            rom::Domain::BeyondSteadyLimit => Self::BeyondSteadyLimit,
            rom::Domain::FarFromSamples => Self::FarFromSamples,
            rom::Domain::Outside => Self::Outside,
        }
    }
}

/// Frame of reference.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frame {
    /// At rest with the duct; the capsule starts at x = 0.
    Laboratory = 0,
    /// Moving with the capsule's centroid.
    Centroid = 1,
}

/// A section of the capsule.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outline {
    /// z = 0, y >= 0: parallel to two walls.
    Midplane = 0,
    /// y = z >= 0: through two corners.
    Diagonal = 1,
}

/// A query. Zeros stand for the defaults.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Query {
    /// The parameters, in the model's order: for a capsule in the channel Ca, then a/l.
    pub parameters: *const f32,
    /// Number of parameters.
    pub parameter_count: usize,
    /// A `capsule_method`.
    pub method: u32,
    /// Not zero: answer outside the sampled domain too.
    pub extrapolate: u32,
    /// Step of the paper's method; 0 for a thousandth of the end time.
    pub step: f32,
}

/// Description of a model.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Description {
    /// CRC-32 of the file's content: identifies the model.
    pub digest: u32,
    /// Number of parameters.
    pub parameter_count: usize,
    /// Nodes of the surface.
    pub nodes: usize,
    /// Nodes that are stored; symmetry gives the others.
    pub sector_nodes: usize,
    /// Points of the outline `CAPSULE_OUTLINE_MIDPLANE`.
    pub midplane_points: usize,
    /// Points of the outline `CAPSULE_OUTLINE_DIAGONAL`.
    pub diagonal_points: usize,
    /// The last instant that can be asked for, in l/V; the first is 0.
    pub end_time: f32,
    /// The method that `CAPSULE_METHOD_DEFAULT` stands for.
    pub method: Method,
    /// Constitutive law of the membrane in the full-order model that errors are measured against: `law_length`
    /// characters without a terminating zero, in the file's bytes.
    pub law: *const c_char,
    /// Length of `law`.
    pub law_length: usize,
    /// Bending stiffness of that model, in G_s a^2; negative where it is not known.
    pub bending_stiffness: f32,
}

/// A parameter and the range in which it was sampled.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Name: `name_length` characters without a terminating zero, in the file's bytes.
    pub name: *const c_char,
    /// Length of `name`.
    pub name_length: usize,
    /// Least sampled value.
    pub least: f64,
    /// Greatest sampled value.
    pub greatest: f64,
}

/// Scalars of an instant: lengths in l, velocity in V.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observables {
    /// Extent along the channel.
    pub axial_length: f32,
    /// Greatest distance from the axis towards a wall.
    pub half_width: f32,
    /// Greatest distance from the axis towards a corner.
    pub half_diagonal: f32,
    /// Depth of the cavity at the rear.
    pub rear_depth: f32,
    /// Velocity of the centroid.
    pub velocity: f32,
    /// Position of the centroid in the laboratory frame.
    pub centroid: f32,
}

/// Totals of the membrane.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Membrane {
    /// Area, in l^2.
    pub area: f32,
    /// Elastic energy, in G_s l^2.
    pub energy: f32,
    /// Additional pressure drop that the capsule causes, in mu V/l.
    pub pressure_drop: f32,
}
