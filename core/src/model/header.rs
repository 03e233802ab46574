//! The header of a model file: 16 bytes before the payload.
//!
//! Magic `CROM`, format version, length of the payload, CRC-32 of the payload; the numbers are little-endian u32.

use super::checksum;
use super::error::OpenError;

const MAGIC: [u8; 4] = *b"CROM";
const VERSION: u32 = 10;
/// Bytes of the header.
pub(super) const HEADER_LENGTH: usize = 16;

/// The payload of a file and its CRC-32, if the header is right.
#[inline(never)]
pub(super) fn payload(file: &[u8]) -> Result<(&[u8], u32), OpenError> {
    let truncated = |expected| OpenError::Truncated {
        expected,
        found: file.len(),
    };
    let (header, body) = file
        .split_first_chunk::<HEADER_LENGTH>()
        .ok_or(truncated(HEADER_LENGTH))?;
    let &[magic, version, length, checksum] = header.as_chunks::<4>().0 else {
        return Err(truncated(HEADER_LENGTH));
    };
    if magic != MAGIC {
        return Err(OpenError::Magic { found: magic });
    }
    let (version, length) = (u32::from_le_bytes(version), u32::from_le_bytes(length));
    let checksum = u32::from_le_bytes(checksum);
    if version != VERSION {
        return Err(OpenError::Version {
            found: version,
            supported: VERSION,
        });
    }
    let length = length as usize;
    if body.len() < length {
        return Err(truncated(HEADER_LENGTH.saturating_add(length)));
    }
    if body.len() > length {
        return Err(OpenError::TrailingBytes {
            found: body.len() - length,
        });
    }
    let found = checksum::checksum(body);
    if found == checksum {
        Ok((body, found))
    } else {
        Err(OpenError::Checksum {
            expected: checksum,
            found,
        })
    }
}

/// The header of a payload, whose length fits into a u32.
#[cfg(feature = "write")]
pub(super) fn header(payload: &[u8], length: u32) -> [u8; HEADER_LENGTH] {
    let mut header = [0; HEADER_LENGTH];
    let words = [
        MAGIC,
        VERSION.to_le_bytes(),
        length.to_le_bytes(),
        checksum::checksum(payload).to_le_bytes(),
    ];
    for (bytes, word) in header.as_chunks_mut().0.iter_mut().zip(words) {
        *bytes = word;
    }
    header
}
