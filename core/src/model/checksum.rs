//! CRC-32 as of zip and PNG, by four bits: in a table for eight bits, as crates have it, there is 1 KiB of a
//! microcontroller's flash, and bit by bit it takes five times as long.

/// The polynomial, its highest power last.
const POLYNOMIAL: u32 = 0xedb8_8320;

/// The remainders of four bits.
static REMAINDERS: [u32; 16] = {
    let mut remainders = [0; 16];
    let mut four = 0;
    while four < 16 {
        let (mut rest, mut bit) = (four as u32, 0);
        while bit < 4 {
            rest = (rest >> 1) ^ (POLYNOMIAL * (rest & 1));
            bit += 1;
        }
        remainders[four] = rest;
        four += 1;
    }
    remainders
};

/// The checksum of some bytes.
pub(super) fn checksum(bytes: &[u8]) -> u32 {
    let step = |rest: u32| (rest >> 4) ^ REMAINDERS[(rest & 15) as usize];
    !bytes.iter().fold(!0, |rest, byte| step(step(rest ^ u32::from(*byte))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crc::{CRC_32_ISO_HDLC, Crc};

    #[test]
    fn it_equals_the_standard_checksum() {
        let bytes: [u8; 1000] = core::array::from_fn(|i| (i * i / 7) as u8);
        for length in [0, 1, 2, 255, 1000] {
            let expected = Crc::<u32>::new(&CRC_32_ISO_HDLC).checksum(&bytes[..length]);
            assert_eq!(checksum(&bytes[..length]), expected);
        }
        assert_eq!(checksum(b"123456789"), 0xcbf4_3926);
    }
}
