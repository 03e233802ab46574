//! Errors of opening and writing a model file.

use core::error::Error;
use core::fmt::{Display, Formatter, Result};

/// Reason why a model file is refused.
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
    /// A count is wrong.
    Dimension {
        /// The things counted.
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
        /// Exclusive upper bound.
        bound: usize,
    },
    /// A number is outside its range.
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

impl OpenError {
    /// Its name in JavaScript.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Truncated { .. } => "truncated",
            Self::Magic { .. } => "magic",
            Self::Version { .. } => "version",
            Self::Checksum { .. } => "checksum",
            Self::Undecodable => "undecodable",
            Self::TrailingBytes { .. } => "trailing-bytes",
            Self::Rows { .. } => "rows",
            Self::Columns { .. } => "columns",
            Self::Dimension { .. } => "dimension",
            Self::Length { .. } => "length",
            Self::Index { .. } => "index",
            Self::Number { .. } => "number",
            Self::Setting { .. } => "setting",
            Self::NoImage { .. } => "no-image",
            Self::ShortOutline { .. } => "short-outline",
            Self::DuplicateSample { .. } => "duplicate-sample",
        }
    }
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
                "the model file has format version {found}; this reader knows up to {supported}; update \
                 the reader"
            ),
            Self::Version { found, supported } => {
                write!(
                    f,
                    "the model file has format version {found}; this reader knows only {supported}; build \
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

/// Reason why a model file is not written.
#[cfg(feature = "write")]
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

#[cfg(feature = "write")]
impl Display for EncodeError {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match *self {
            Self::BufferTooShort { found } => write!(f, "the model file does not fit into a buffer of {found} bytes"),
            Self::TooLong { length } => write!(
                f,
                "a payload of {length} bytes is longer than the 4-byte length of the header allows"
            ),
        }
    }
}

#[cfg(feature = "write")]
impl Error for EncodeError {}
