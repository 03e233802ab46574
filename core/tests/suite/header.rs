//! The header of a model file.

/// Puts a right header before a payload.
pub fn with_header(payload: &[u8]) -> Vec<u8> {
    let checksum = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(payload);
    let words = [u32::from_le_bytes(*b"CROM"), 10, payload.len() as u32, checksum];
    words
        .into_iter()
        .flat_map(u32::to_le_bytes)
        .chain(payload.iter().copied())
        .collect()
}
