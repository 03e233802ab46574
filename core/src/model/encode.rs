//! Writing a model file: the header, and pads that align every blob.

use super::checksum::checksum;
use super::read::{Cursor, Part};
use super::wire::{Blob, Contents};
use super::{HEADER_LENGTH, MAGIC, VERSION};
use crate::error::EncodeError;

const ALIGNMENT: usize = 16;
static ZEROS: [u8; ALIGNMENT] = [0; ALIGNMENT];

/// Writes a model file into `buffer`, choosing the pads, and returns its length. A buffer of the summed length of all
/// arrays and texts plus 8 KiB is long enough. The contents are not judged; [`Model::open`](super::Model::open) does.
///
/// # Errors
/// [`EncodeError`] if the buffer is too short or the payload longer than a u32 can say.
pub fn encode(contents: &Contents<'_>, buffer: &mut [u8]) -> Result<usize, EncodeError> {
    let found = buffer.len();
    let too_short = EncodeError::BufferTooShort { found };
    let (header, payload) = buffer.split_at_mut_checked(HEADER_LENGTH).ok_or(too_short)?;

    let mut padded = contents.clone();
    padded.for_each_blob(&mut |blob| blob.pad = &[]);
    postcard::to_slice(&padded, payload).map_err(|_| too_short)?;

    let mut offsets = heapless::Vec::<usize, { Contents::MAX_BLOBS }>::new();
    {
        let origin = payload.as_ptr() as usize;
        let mut unpadded = Contents::default();
        unpadded.read(&mut Cursor::new(payload));
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
    header[..4].copy_from_slice(&MAGIC);
    header[4..8].copy_from_slice(&VERSION.to_le_bytes());
    header[8..12].copy_from_slice(&announced.to_le_bytes());
    header[12..].copy_from_slice(&checksum(&payload[..length]).to_le_bytes());
    Ok(HEADER_LENGTH + length)
}
