//! Errors of a query, with the value found and the range allowed.

use crate::Real;
use core::error::Error;
use core::fmt::{self, Display, Formatter, Result};

/// Reason that a query was not answered.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum EvaluateError {
    /// The model does not fit into the workspace.
    Capacity {
        /// Name of the limit.
        limit: &'static str,
        /// The model's figure.
        required: usize,
        /// The workspace's figure.
        capacity: usize,
    },
    /// A step or instant out of range.
    Value {
        /// Its name.
        what: &'static str,
        /// Its value.
        value: f32,
        /// Least value allowed.
        min: f32,
        /// Greatest value allowed.
        max: f32,
    },
    /// The query's number of parameters is not the model's.
    ParameterCount {
        /// Number of the model.
        expected: usize,
        /// Number of the query.
        found: usize,
    },
    /// A parameter is not finite, or physically impossible.
    Parameter {
        /// Its index among the model's parameters, from 0.
        index: usize,
        /// Its value.
        value: f32,
        /// Least value allowed.
        min: f32,
        /// Greatest value allowed.
        max: f32,
    },
    /// The model has no such parameter.
    UnknownParameter {
        /// Index asked for, from 0.
        index: usize,
        /// Number of the model's parameters.
        count: usize,
    },
    /// Derivatives are those of direct evaluation: the query names another method.
    NoDerivatives,
    /// A parameter lies outside its sampled range.
    OutsideDomain {
        /// Its index among the model's parameters, from 0.
        index: usize,
        /// Its value.
        value: f32,
        /// Its sampled range.
        range: [f32; 2],
    },
    /// The query lies farther from all samples than any sample from the others.
    FarFromSamples {
        /// Ratio of the interpolation error's standard deviation to the greatest one of a sample left out.
        ratio: f32,
    },
    /// The query is too far from its samples to extrapolate.
    BeyondExtrapolation {
        /// Distance from the centroid of the samples used, in their spread.
        distance: f32,
        /// Maximum distance that is answered.
        limit: f32,
    },
    /// No steady state exists at these parameters.
    BeyondSteadyLimit {
        /// Ca.
        capillary_number: f32,
        /// a/l.
        confinement: f32,
        /// Greatest Ca with a steady state at this a/l.
        limit: f32,
    },
    /// The query lies outside the sampled domain, where no error bound is calibrated.
    NoBound,
    /// An extrapolated shape encloses a volume that no capsule of the model has.
    WrongVolume {
        /// Its volume, in that of the sphere of radius a.
        volume: f32,
        /// Least volume allowed.
        min: f32,
        /// Greatest volume allowed.
        max: f32,
    },
    /// An extrapolated shape reaches through a wall of the channel.
    BeyondWall {
        /// Greatest |y| or |z| of its nodes, in l: the wall is at 1.
        reach: f32,
    },
    /// The weights of the samples do not sum to 1: the samples near the query are too close to each other.
    Weights {
        /// Their sum.
        sum: f32,
    },
    /// An instant was asked for before a query was prepared.
    NotPrepared,
    /// The model has no such node.
    UnknownNode {
        /// Index asked for.
        node: usize,
        /// Number of nodes.
        nodes: usize,
    },
    /// The model has no spherical stress-free state or another law than the neo-Hookean one, which the mechanics needs.
    UnsupportedReference,
    /// The nodes near a node do not determine derivatives there: the mesh is too coarse.
    StencilTooSmall {
        /// Its index.
        node: usize,
    },
    /// The model has no node set of that name.
    UnknownNodeSet,
    /// The caller's buffer is too short.
    BufferTooShort {
        /// Entries needed.
        required: usize,
        /// Entries given.
        found: usize,
    },
    /// The result is not finite: the parameters are too far from all samples, or the model's numbers are too large.
    NotFinite,
}

/// The results, if all are finite: the check of every number that leaves the core.
pub(crate) fn finite<T: Real, const D: usize>(numbers: [T; D]) -> core::result::Result<[T; D], EvaluateError> {
    if numbers.iter().all(|number| number.is_finite()) {
        Ok(numbers)
    } else {
        Err(EvaluateError::NotFinite)
    }
}

impl EvaluateError {
    /// Its name in JavaScript.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Capacity { .. } => "capacity",
            Self::Value { .. } => "value",
            Self::ParameterCount { .. } => "parameter-count",
            Self::Parameter { .. } => "parameter",
            Self::UnknownParameter { .. } => "unknown-parameter",
            Self::NoDerivatives => "no-derivatives",
            Self::OutsideDomain { .. } => "outside-domain",
            Self::FarFromSamples { .. } => "far-from-samples",
            Self::BeyondExtrapolation { .. } => "beyond-extrapolation",
            Self::BeyondSteadyLimit { .. } => "beyond-steady-limit",
            Self::NoBound => "no-bound",
            Self::WrongVolume { .. } => "wrong-volume",
            Self::BeyondWall { .. } => "beyond-wall",
            Self::Weights { .. } => "weights",
            Self::NotPrepared => "not-prepared",
            Self::UnknownNode { .. } => "unknown-node",
            Self::UnsupportedReference => "unsupported-reference",
            Self::StencilTooSmall { .. } => "stencil-too-small",
            Self::UnknownNodeSet => "unknown-node-set",
            Self::BufferTooShort { .. } => "buffer-too-short",
            Self::NotFinite => "not-finite",
        }
    }

    /// Writes the error with the names of the parameters; their numbers stand for names that are missing.
    pub(crate) fn write(&self, f: &mut Formatter<'_>, names: &[&str]) -> Result {
        let name = |index: usize| {
            fmt::from_fn(move |f| match names.get(index) {
                Some(name) => f.write_str(name),
                None => write!(f, "parameter {}", index + 1),
            })
        };
        match *self {
            Self::Capacity {
                limit,
                required,
                capacity,
            } => {
                write!(f, "the model has {required} {limit}, the workspace holds {capacity}")
            }
            Self::Value { what, value, min, max } => write!(f, "{what} is {value}, it must be in [{min}, {max}]"),
            Self::Parameter { index, value, min, max } => {
                write!(f, "{} is {value}, it must be in [{min}, {max}]", name(index))
            }
            Self::OutsideDomain { index, value, range } => {
                let [min, max] = range;
                write!(
                    f,
                    "{} = {value} lies outside its sampled range [{min}, {max}]",
                    name(index)
                )
            }
            Self::ParameterCount { expected, found } => {
                write!(f, "the model has {expected} parameters, the query {found}")
            }
            Self::UnknownParameter { index, count } => {
                write!(
                    f,
                    "parameter {index}, counted from 0, does not exist: the model has {count}"
                )
            }
            Self::NoDerivatives => write!(
                f,
                "derivatives are those of direct evaluation: ask for the direct method"
            ),
            Self::FarFromSamples { ratio } => write!(
                f,
                "no sample is near: the interpolation is {ratio:.1} times as uncertain as at any sample that was left \
                 out"
            ),
            Self::BeyondExtrapolation { distance, limit } => write!(
                f,
                "the query is {distance:.1} spreads from its samples; the limit is {limit}"
            ),
            Self::BeyondSteadyLimit {
                capillary_number,
                confinement,
                limit,
            } => write!(
                f,
                "no steady state at Ca = {capillary_number}, a/l = {confinement}: the limit there is Ca = {limit}"
            ),
            Self::NoBound => write!(
                f,
                "no bound of the error is known outside the sampled domain: the answer is extrapolated"
            ),
            Self::WrongVolume { volume, min, max } => write!(
                f,
                "no capsule has the extrapolated shape: its volume is {volume} of that of a sphere of radius a, it \
                 must be in [{min}, {max}]; ask nearer to the sampled domain"
            ),
            Self::BeyondWall { reach } => write!(
                f,
                "no capsule has the extrapolated shape: a node lies at {reach} from the axis, beyond the wall at 1; \
                 ask nearer to the sampled domain"
            ),
            Self::Weights { sum } => write!(
                f,
                "the samples near the query are too close to each other: their \
                weights sum to {sum} instead of 1"
            ),
            Self::NotPrepared => write!(f, "an instant was asked for before a query was prepared"),
            Self::UnknownNode { node, nodes } => write!(f, "node {node} does not exist: the mesh has {nodes} nodes"),
            Self::UnsupportedReference => write!(
                f,
                "the mechanics of the membrane is known only for the neo-Hookean law, and where the stress-free state \
                 is a sphere of radius a/l"
            ),
            Self::StencilTooSmall { node } => write!(
                f,
                "the nodes around node {node} do not determine derivatives: the mesh is too coarse"
            ),
            Self::UnknownNodeSet => write!(f, "the model has no node set of that name"),
            Self::BufferTooShort { required, found } => {
                write!(f, "the buffer holds {found} entries, {required} are needed")
            }
            Self::NotFinite => write!(
                f,
                "the result is not finite: the parameters are too far from all samples"
            ),
        }
    }
}

impl Display for EvaluateError {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        self.write(f, &[])
    }
}

impl Error for EvaluateError {}
