//! Writing a model file: the header, and pads that align every blob.

use super::error::EncodeError;
use super::header::{HEADER_LENGTH, header};
use super::read::{Decode, Reader};
use super::wire::{Blob, Contents, MAX_CLUSTERS, MAX_NODE_SETS, MAX_SPANS};

const ALIGNMENT: usize = 16;
/// The most blobs that a message can hold.
const MAX_BLOBS: usize = 10 + MAX_NODE_SETS + (16 + 3 * MAX_SPANS) * MAX_CLUSTERS;
static ZEROS: [u8; ALIGNMENT] = [0; ALIGNMENT];

/// Writes a model file into `buffer`, choosing the pads, and returns its length. A buffer of the summed length of all
/// arrays and texts plus 8 KiB is long enough. The contents are not checked; [`Model::open`](super::Model::open) checks
/// them.
///
/// # Errors
/// [`EncodeError`] if the buffer is too short or the length of the payload does not fit into a u32.
pub fn encode(contents: &Contents<'_>, buffer: &mut [u8]) -> Result<usize, EncodeError> {
    let found = buffer.len();
    let too_short = EncodeError::BufferTooShort { found };
    let (start, payload) = buffer.split_at_mut_checked(HEADER_LENGTH).ok_or(too_short)?;

    let mut padded = contents.clone();
    padded.for_each_blob(&mut |blob| blob.pad = &[]);
    postcard::to_slice(&padded, payload).map_err(|_| too_short)?;

    let mut offsets = heapless::Vec::<usize, MAX_BLOBS>::new();
    {
        let origin = payload.as_ptr() as usize;
        let mut unpadded = Contents::default();
        unpadded.read(&mut Reader::new(payload));
        unpadded.for_each_blob(&mut |blob| {
            // Cannot fail: MAX_BLOBS counts them all.
            let _ = offsets.push(blob.data.as_ptr() as usize - origin);
        });
    }

    // Every pad moves all that follows it; its own length always takes one byte.
    let mut shift = 0;
    let mut offsets = offsets.iter();
    padded.for_each_blob(&mut |blob: &mut Blob<'_>| {
        let pad = offsets
            .next()
            .map_or(0, |offset| (offset + shift).wrapping_neg() % ALIGNMENT);
        blob.pad = &ZEROS[..pad];
        shift += pad;
    });

    let length = postcard::to_slice(&padded, payload).map_err(|_| too_short)?.len();
    let announced = u32::try_from(length).map_err(|_| EncodeError::TooLong { length })?;
    start.copy_from_slice(&header(&payload[..length], announced));
    Ok(HEADER_LENGTH + length)
}
