//! Errors, with what was found and what would be right.

use core::fmt;

/// Why a model file was refused.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum OpenError {
    /// Shorter than its header or than the payload that the header announces.
    Truncated {
        /// Bytes needed.
        expected: usize,
        /// Bytes given.
        found: usize,
    },
}

impl fmt::Display for OpenError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Truncated { expected, found } => {
                write!(
                    f,
                    "the model file is truncated: {expected} bytes expected, {found} found"
                )
            }
        }
    }
}

impl core::error::Error for OpenError {}

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
}

impl fmt::Display for EvaluateError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Capacity {
                limit,
                required,
                capacity,
            } => {
                write!(f, "the model needs {required} {limit}, the workspace holds {capacity}")
            }
        }
    }
}

impl core::error::Error for EvaluateError {}

/// Why a model file was not written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum EncodeError {
    /// The file does not fit into the buffer.
    BufferTooShort {
        /// Bytes given.
        found: usize,
    },
}

impl fmt::Display for EncodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BufferTooShort { found } => write!(f, "the model file does not fit into a buffer of {found} bytes"),
        }
    }
}

impl core::error::Error for EncodeError {}
