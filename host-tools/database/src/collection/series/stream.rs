//! Bytes in sequence, as they are or from base64.

use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};

/// Writers differ in whether they pad.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);

/// Bytes in sequence.
pub(super) enum Stream<'a> {
    Raw(&'a [u8]),
    /// One or several runs of base64, each padded or not, with white space anywhere; `decoded` were read too far.
    Base64 {
        text: &'a [u8],
        decoded: Vec<u8>,
    },
}

impl<'a> Stream<'a> {
    pub fn base64(text: &'a [u8]) -> Self {
        let decoded = Vec::new();
        Stream::Base64 { text, decoded }
    }

    /// From another place on; white space counts, as VTK counts it.
    pub fn at(&self, offset: usize) -> Result<Self, String> {
        let (Stream::Raw(data) | Stream::Base64 { text: data, .. }) = self;
        let from = |data: &'a [u8]| match data.get(offset..) {
            Some([_, ..]) => Ok(&data[offset..]),
            _ => Err(format!(
                "`offset` {offset} is beyond the appended data, {} long",
                data.len()
            )),
        };
        match self {
            Stream::Raw(_) => from(data).map(Stream::Raw),
            Stream::Base64 { .. } => from(data).map(Stream::base64),
        }
    }

    pub fn take(&mut self, count: usize) -> Result<Vec<u8>, String> {
        let short = |found: usize| format!("cut short: {found} bytes, expected {count}");
        match self {
            Stream::Raw(data) => {
                let (taken, rest) = data.split_at_checked(count).ok_or_else(|| short(data.len()))?;
                *data = rest;
                Ok(taken.to_vec())
            }
            Stream::Base64 { text, decoded } => {
                while decoded.len() < count {
                    let run = run(text, (count - decoded.len()).div_ceil(3).saturating_mul(4));
                    if run.is_empty() {
                        return Err(short(decoded.len()));
                    }
                    decoded.extend(decode(run)?);
                }
                let rest = decoded.split_off(count);
                Ok(std::mem::replace(decoded, rest))
            }
        }
    }

    /// Refuses more than padding by zeros.
    pub fn end(mut self) -> Result<(), String> {
        let Stream::Base64 { text, decoded } = &mut self else {
            return Ok(());
        };
        loop {
            let run = run(text, usize::MAX);
            if run.is_empty() {
                break;
            }
            decoded.extend(decode(run)?);
        }
        match decoded.iter().all(|byte| *byte == 0) {
            true => Ok(()),
            false => Err(format!("{} bytes more than its header says", decoded.len())),
        }
    }
}

fn decode(run: Vec<u8>) -> Result<Vec<u8>, String> {
    BASE64.decode(run).map_err(|error| format!("no sound base64: {error}"))
}

/// The next characters of base64, up to `most`, or up to padding.
fn run(text: &mut &[u8], most: usize) -> Vec<u8> {
    let mut run = Vec::new();
    while run.len() < most {
        let Some((character, rest)) = text.split_first() else {
            break;
        };
        *text = rest;
        if !character.is_ascii_whitespace() {
            run.push(*character);
            if *character == b'=' && run.len() % 4 == 0 {
                break;
            }
        }
    }
    run
}
