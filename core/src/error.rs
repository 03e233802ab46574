//! Errors, with what was found and what would be right.

use crate::Real;
use crate::model::Model;
use crate::model::wire::Parameter;
use core::error::Error;
use core::fmt::{self, Display, Formatter, Result};

/// Why a model file was refused.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum OpenError {
    /// Shorter than its header, or than the payload that the header announces.
    Truncated {
        /// Bytes needed.
        expected: usize,
        /// Bytes given.
        found: usize,
    },
    /// Does not start with `CROM`.
    Magic {
        /// The first four bytes.
        found: [u8; 4],
    },
    /// A format that this reader does not know.
    Version {
        /// The file's format.
        found: u32,
        /// The newest format that this reader knows.
        supported: u32,
    },
    /// The payload is not what was written.
    Checksum {
        /// CRC-32 in the header.
        expected: u32,
        /// CRC-32 of the payload.
        found: u32,
    },
    /// The payload is not a message of this format.
    Undecodable,
    /// Bytes after the end of the file's message.
    TrailingBytes {
        /// How many.
        found: usize,
    },
    /// An array has the wrong number of rows.
    Rows {
        /// The array.
        what: &'static str,
        /// The number that the rest of the file asks for.
        expected: usize,
        /// The file's number.
        found: usize,
    },
    /// An array has the wrong number of columns.
    Columns {
        /// The array.
        what: &'static str,
        /// The number that the rest of the file asks for.
        expected: usize,
        /// The file's number.
        found: usize,
    },
    /// There are too many or too few of something.
    Dimension {
        /// What was counted.
        what: &'static str,
        /// The count that the rest of the file asks for (the least, or the bound, where several would do).
        expected: usize,
        /// The file's count.
        found: usize,
    },
    /// An array's bytes do not fit its dimensions.
    Length {
        /// The array.
        what: &'static str,
        /// Bytes that its dimensions ask for.
        expected: usize,
        /// Bytes in the file.
        found: usize,
    },
    /// An index points outside of what it numbers.
    Index {
        /// The array.
        what: &'static str,
        /// Position in the array.
        index: usize,
        /// The index found there.
        value: usize,
        /// What it must be below.
        bound: usize,
    },
    /// A number that cannot stand where it stands.
    Number {
        /// The array.
        what: &'static str,
        /// Position in the array.
        index: usize,
        /// The number found there.
        value: f32,
        /// The right value.
        expected: &'static str,
    },
    /// A setting outside its range.
    Setting {
        /// The setting.
        what: &'static str,
        /// Its value.
        value: f64,
        /// Least value allowed.
        min: f64,
        /// Greatest value allowed.
        max: f64,
    },
    /// A node that is not at its place among the sector's images.
    NoImage {
        /// Full index of the node.
        node: usize,
    },
    /// An outline has fewer than three nodes.
    ShortOutline {
        /// Its name.
        name: &'static str,
    },
    /// Two samples of a cluster have the same parameters.
    DuplicateSample {
        /// Row of the one.
        first: usize,
        /// Row of the other.
        second: usize,
    },
}

impl Display for OpenError {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match *self {
            Self::Truncated { expected, found } => {
                write!(
                    f,
                    "the model file is truncated: {expected} bytes expected, {found} found"
                )
            }
            Self::Magic { found } => write!(f, "not a model file: it starts with {found:02x?} instead of \"CROM\""),
            Self::Version { found, supported } if found > supported => write!(
                f,
                "the model file has format version {found}, newer than {supported}, the newest that this reader knows; update \
                 the reader"
            ),
            Self::Version { found, supported } => {
                write!(
                    f,
                    "the model file has format version {found}, older than {supported}, the only one that this reader knows; build \
                     the model again"
                )
            }
            Self::Checksum { expected, found } => {
                write!(
                    f,
                    "the model file is damaged: CRC-32 {expected:08x} expected, {found:08x} found"
                )
            }
            Self::Undecodable => write!(f, "the model file's message does not decode as its format says"),
            Self::TrailingBytes { found } => write!(f, "{found} bytes follow the end of the model file's message"),
            Self::Rows { what, expected, found } => write!(f, "{what}: {expected} rows expected, {found} found"),
            Self::Columns { what, expected, found } => write!(f, "{what}: {expected} columns expected, {found} found"),
            Self::Dimension { what, expected, found } => write!(f, "{what}: {expected} expected, {found} found"),
            Self::Length { what, expected, found } => {
                write!(
                    f,
                    "{what}: {expected} bytes expected from the dimensions, {found} found"
                )
            }
            Self::Index {
                what,
                index,
                value,
                bound,
            } => {
                write!(f, "{what}: entry {index} is {value}, it must be below {bound}")
            }
            Self::Number {
                what,
                index,
                value,
                expected,
            } => {
                write!(f, "{what}: entry {index} is {value}, expected: {expected}")
            }
            Self::Setting { what, value, min, max } => write!(f, "{what} is {value}, it must be in [{min}, {max}]"),
            Self::NoImage { node } => write!(f, "node {node} is not at its place among the images of the sector"),
            Self::ShortOutline { name } => write!(f, "the node set \"{name}\" has fewer than 3 nodes"),
            Self::DuplicateSample { first, second } => {
                write!(f, "samples {first} and {second} of a cluster have the same parameters")
            }
        }
    }
}

impl Error for OpenError {}

/// Why a model file was not written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum EncodeError {
    /// The file does not fit into the buffer.
    BufferTooShort {
        /// Bytes given.
        found: usize,
    },
    /// The payload's length does not fit into the header.
    TooLong {
        /// Bytes of the payload.
        length: usize,
    },
}

impl Display for EncodeError {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match *self {
            Self::BufferTooShort { found } => write!(f, "the model file does not fit into a buffer of {found} bytes"),
            Self::TooLong { length } => write!(f, "a payload of {length} bytes is longer than the header can say"),
        }
    }
}

impl Error for EncodeError {}

/// Why a question was not answered.
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
    /// A step or instant that is not a number in its range.
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
    /// A query has not as many parameters as the model.
    ParameterCount {
        /// The model's.
        expected: usize,
        /// The query's.
        found: usize,
    },
    /// A parameter that is not a number in the range that it can have at all.
    Parameter {
        /// Its place among the model's parameters, from 0.
        index: usize,
        /// Its value.
        value: f32,
        /// Least value allowed.
        min: f32,
        /// Greatest value allowed.
        max: f32,
    },
    /// A parameter lies outside its sampled range.
    OutsideDomain {
        /// Its place among the model's parameters, from 0.
        index: usize,
        /// Its value.
        value: f32,
        /// Its sampled range.
        range: [f32; 2],
    },
    /// The query lies farther from all samples than any sample from the others.
    FarFromSamples {
        /// How much farther, in units of the interpolation error's deviation.
        ratio: f32,
    },
    /// The query lies so far from the samples that these are one point to it: nothing can be extrapolated.
    BeyondExtrapolation {
        /// Distance from the centroid of the samples that take part, in their spread.
        distance: f32,
        /// The greatest that is answered.
        limit: f32,
    },
    /// No steady state exists at these parameters.
    BeyondSteadyLimit {
        /// Ca.
        capillary_number: f32,
        /// a/l.
        confinement: f32,
        /// The largest Ca at this a/l that has a steady state.
        limit: f32,
    },
    /// The query lies outside the sampled domain, where no bound of the error is calibrated.
    NoBound,
    /// An extrapolated shape encloses a volume that no capsule of the model has.
    WrongVolume {
        /// In the volume of the sphere of radius a.
        volume: f32,
        /// Least volume allowed.
        min: f32,
        /// Greatest volume allowed.
        max: f32,
    },
    /// An extrapolated shape reaches through a wall of the channel.
    BeyondWall {
        /// |y| or |z| of its farthest node, in l: the wall is at 1.
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
    /// The model does not know the stress-free state, from which the mechanics follows.
    UnsupportedReference,
    /// The nodes near one do not determine derivatives there: the mesh is too coarse.
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
    /// The result is not finite: the parameters are too far from all samples, or the model's numbers are absurd.
    NotFinite,
}

/// The one check of what leaves the core.
pub(crate) fn finite<T: Real, const D: usize>(numbers: [T; D]) -> core::result::Result<[T; D], EvaluateError> {
    if numbers.iter().all(|number| number.is_finite()) {
        Ok(numbers)
    } else {
        Err(EvaluateError::NotFinite)
    }
}

impl EvaluateError {
    /// The error in words, in which parameters bear the names that `model` gives them instead of their numbers.
    pub fn named<'a>(&'a self, model: &'a Model<'_>) -> impl Display + 'a {
        fmt::from_fn(|f| self.write(f, &model.contents().metadata.parameters))
    }

    fn write(&self, f: &mut Formatter<'_>, parameters: &[Parameter<'_>]) -> Result {
        let name = |index: usize| {
            fmt::from_fn(move |f| match parameters.get(index) {
                Some(parameter) => f.write_str(parameter.name),
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
            Self::FarFromSamples { ratio } => write!(
                f,
                "no sample is near: the interpolation is {ratio:.1} times as uncertain as at any sample that was left out"
            ),
            Self::BeyondExtrapolation { distance, limit } => write!(
                f,
                "the samples are {distance:.1} times as far as they are spread: up to {limit} times can be extrapolated"
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
                "the mechanics of the membrane is known only where the stress-free state is a sphere of radius a/l"
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
