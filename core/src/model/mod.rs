//! The model file: wire format, validation, views that read in place.

pub mod wire;

use crate::error::{EncodeError, OpenError};
use wire::Contents;

/// Name of the node set of the outline z = 0, y >= 0, front pole to rear pole.
pub const MIDPLANE: &str = "midplane";
/// Name of the node set of the outline y = z >= 0, front pole to rear pole.
pub const DIAGONAL: &str = "diagonal";

/// A validated model, reading the file's bytes where they lie.
#[derive(Clone, Debug)]
pub struct Model<'a> {
    contents: Contents<'a>,
    digest: u32,
}

impl<'a> Model<'a> {
    /// Opens a model file: checks header, CRC-32, every dimension, index and number.
    ///
    /// # Errors
    /// What is wrong with the file, see [`OpenError`].
    pub fn open(file: &'a [u8]) -> Result<Self, OpenError> {
        Err(OpenError::Truncated {
            expected: 16,
            found: file.len(),
        })
    }

    /// CRC-32 of the payload: identifies the model.
    pub fn digest(&self) -> u32 {
        self.digest
    }

    /// The decoded message.
    pub fn contents(&self) -> &Contents<'a> {
        &self.contents
    }
}

/// Writes a model file into `buffer`, choosing the pads, and returns its length.
///
/// # Errors
/// [`EncodeError`] if the buffer is too short.
pub fn encode(contents: &Contents<'_>, buffer: &mut [u8]) -> Result<usize, EncodeError> {
    let _ = contents;
    Err(EncodeError::BufferTooShort { found: buffer.len() })
}
