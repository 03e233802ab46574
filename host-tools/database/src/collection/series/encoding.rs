//! Numbers of VTK's arrays: as text, as base64 or as bytes, plain or compressed.

use std::io::Read;

use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use flate2::read::ZlibDecoder;
use lzma_rust2::XzReader;
use roxmltree::Node;

/// Writers differ in whether they pad.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);

/// The most memory for a block of LZMA, in KiB: twice the dictionary of its highest level.
const LZMA_MEMORY: u32 = 128 << 10;

/// No block of LZ4 grows by more than this.
const LZ4_GROWTH: usize = 255;

/// How a file writes its arrays.
pub(super) struct Encoding<'a> {
    /// Bytes of the numbers in the headers of arrays.
    header: usize,
    compressor: Option<Compressor>,
    big_endian: bool,
    appended: Option<Stream<'a>>,
}

#[derive(Clone, Copy)]
enum Compressor {
    Zlib,
    Lz4,
    Lzma,
}

impl<'a> Encoding<'a> {
    /// Of a file's markup and what it has appended.
    ///
    /// # Errors
    /// What is not supported, by its name.
    pub fn new(file: Node, appended: Option<&'a [u8]>) -> Result<Self, String> {
        let other = |name: &str, found: &str, expected: &str| Err(format!("{name} `{found}`, expected {expected}"));
        let header = match file.attribute("header_type").unwrap_or("UInt32") {
            "UInt32" => 4,
            "UInt64" => 8,
            found => return other("header_type", found, "UInt32 or UInt64"),
        };
        let big_endian = match file.attribute("byte_order").unwrap_or("LittleEndian") {
            "LittleEndian" => false,
            "BigEndian" => true,
            found => return other("byte_order", found, "LittleEndian or BigEndian"),
        };
        let compressor = match file.attribute("compressor").unwrap_or_default() {
            "" => None,
            "vtkZLibDataCompressor" => Some(Compressor::Zlib),
            "vtkLZ4DataCompressor" => Some(Compressor::Lz4),
            "vtkLZMADataCompressor" => Some(Compressor::Lzma),
            found => {
                let expected = "vtkZLibDataCompressor, vtkLZ4DataCompressor, vtkLZMADataCompressor or none";
                return other("compressor", found, expected);
            }
        };
        let node = file.children().find(|node| node.has_tag_name("AppendedData"));
        let appended = match (
            node.map(|node| node.attribute("encoding").unwrap_or("base64")),
            appended,
        ) {
            (Some("base64"), Some(data)) => Some(Stream::base64(data)),
            (Some("raw"), Some(data)) => Some(Stream::Raw(data)),
            (Some(found), _) => return other("encoding of AppendedData", found, "base64 or raw"),
            (None, _) => None,
        };
        Ok(Self {
            header,
            compressor,
            big_endian,
            appended,
        })
    }

    /// The numbers of an array, `count` of them.
    ///
    /// # Errors
    /// What is wrong with it: what was found, and what was expected.
    pub fn numbers(&self, array: Node, count: usize) -> Result<Vec<f64>, String> {
        let kind = array.attribute("type").unwrap_or_default();
        let size = size(kind)?;
        // Notes of the writer stand between the elements' text.
        let text: String = array
            .children()
            .filter_map(|child| child.text().filter(|_| child.is_text()))
            .collect();
        let mut stream = match array.attribute("format").unwrap_or("ascii") {
            "ascii" => return finite(words(&text, count)?),
            "binary" => Stream::base64(text.as_bytes()),
            "appended" => self.appended_at(array.attribute("offset"))?,
            found => return Err(format!("format `{found}`, expected ascii, binary or appended")),
        };
        if count == 0 {
            return Ok(Vec::new());
        }
        let length = count
            .checked_mul(size)
            .ok_or_else(|| format!("{count} numbers are too many"))?;
        let numbers = from_bytes(&self.content(&mut stream, length)?, kind, self.big_endian);
        finite(numbers)
    }

    fn appended_at(&self, offset: Option<&str>) -> Result<Stream<'a>, String> {
        let stream = self
            .appended
            .as_ref()
            .ok_or("is appended, but the file has no AppendedData")?;
        let offset = offset.ok_or("is appended, but has no `offset`")?;
        let place = offset
            .trim()
            .parse()
            .map_err(|_| format!("`offset` is `{offset}`, expected a whole number"))?;
        stream.at(place)
    }

    /// The bytes of an array, `length` of them: behind a header with the byte count, or with the number of compressed
    /// blocks, the size of each, that of the last (0: as the others), and their compressed sizes.
    fn content(&self, stream: &mut Stream, length: usize) -> Result<Vec<u8>, String> {
        let expect = |found: u64| match found == length as u64 {
            true => Ok(()),
            false => Err(format!("has {found} bytes, expected {length}")),
        };
        let Some(compressor) = self.compressor else {
            expect(self.words(stream, 1)?[0])?;
            return stream.take(length);
        };
        let blocks = self.words(stream, 1)?[0];
        if blocks == 0 || blocks > length as u64 {
            return Err(format!("has {blocks} compressed blocks, expected {length} bytes"));
        }
        let sizes = self.words(stream, 2 + blocks as usize)?;
        let last = if sizes[1] == 0 { sizes[0] } else { sizes[1] };
        let whole = (blocks - 1)
            .checked_mul(sizes[0])
            .and_then(|bytes| bytes.checked_add(last));
        expect(whole.unwrap_or(u64::MAX))?;
        let mut content = Vec::new();
        for (index, compressed) in sizes[2..].iter().enumerate() {
            let size = if index + 1 == blocks as usize { last } else { sizes[0] } as usize;
            let block = stream.take(usize::try_from(*compressed).unwrap_or(usize::MAX))?;
            let bytes = compressor.unpack(&block, size);
            let bytes = bytes.filter(|bytes| bytes.len() == size);
            let damaged = || {
                format!(
                    "compressed block {index} is damaged, expected {size} bytes of {}",
                    compressor.name()
                )
            };
            content.extend(bytes.ok_or_else(damaged)?);
        }
        Ok(content)
    }

    /// Numbers of a header.
    fn words(&self, stream: &mut Stream, count: usize) -> Result<Vec<u64>, String> {
        let bytes = stream.take(count.saturating_mul(self.header))?;
        let word = |bytes: &[u8]| {
            let number =
                |bytes: &mut dyn Iterator<Item = &u8>| bytes.fold(0, |word, byte| word << 8 | u64::from(*byte));
            match self.big_endian {
                true => number(&mut bytes.iter()),
                false => number(&mut bytes.iter().rev()),
            }
        };
        Ok(bytes.chunks_exact(self.header).map(word).collect())
    }
}

impl Compressor {
    fn name(self) -> &'static str {
        match self {
            Compressor::Zlib => "zlib",
            Compressor::Lz4 => "LZ4",
            Compressor::Lzma => "LZMA",
        }
    }

    /// The bytes of a block, about `size`, if it is sound.
    fn unpack(self, block: &[u8], size: usize) -> Option<Vec<u8>> {
        let mut bytes = Vec::new();
        let most = size as u64 + 1;
        match self {
            Compressor::Zlib => ZlibDecoder::new(block).take(most).read_to_end(&mut bytes).ok()?,
            Compressor::Lzma => {
                let reader = XzReader::new_mem_limit(block, false, LZMA_MEMORY);
                reader.take(most).read_to_end(&mut bytes).ok()?
            }
            Compressor::Lz4 if size / LZ4_GROWTH > block.len() => return None,
            Compressor::Lz4 => return lz4_flex::block::decompress(block, size).ok(),
        };
        Some(bytes)
    }
}

/// Bytes in sequence.
enum Stream<'a> {
    Raw(&'a [u8]),
    /// One or several runs of base64, each padded or not, with white space anywhere; `decoded` were read too far.
    Base64 {
        text: &'a [u8],
        decoded: Vec<u8>,
    },
}

impl<'a> Stream<'a> {
    fn base64(text: &'a [u8]) -> Self {
        let decoded = Vec::new();
        Stream::Base64 { text, decoded }
    }

    /// From another place on; white space counts, as VTK counts it.
    fn at(&self, offset: usize) -> Result<Self, String> {
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

    fn take(&mut self, count: usize) -> Result<Vec<u8>, String> {
        let short = |found: usize| format!("is cut short: {found} bytes, expected {count}");
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
                    decoded.extend(
                        BASE64
                            .decode(run)
                            .map_err(|error| format!("is no sound base64: {error}"))?,
                    );
                }
                let rest = decoded.split_off(count);
                Ok(std::mem::replace(decoded, rest))
            }
        }
    }
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

/// Numbers from text.
fn words(text: &str, count: usize) -> Result<Vec<f64>, String> {
    let number = |word: &str| word.parse().map_err(|_| format!("has `{word}`, expected a number"));
    let numbers: Vec<f64> = text.split_ascii_whitespace().map(number).collect::<Result<_, _>>()?;
    match numbers.len() == count {
        true => Ok(numbers),
        false => Err(format!("has {} numbers, expected {count}", numbers.len())),
    }
}

fn finite(numbers: Vec<f64>) -> Result<Vec<f64>, String> {
    match numbers.iter().position(|number| !number.is_finite()) {
        None => Ok(numbers),
        Some(index) => Err(format!(
            "value {index} is {}, expected finite numbers only",
            numbers[index]
        )),
    }
}

/// Bytes of a number of a VTK type.
fn size(kind: &str) -> Result<usize, String> {
    match kind {
        "Int8" | "UInt8" => Ok(1),
        "Int16" | "UInt16" => Ok(2),
        "Int32" | "UInt32" | "Float32" => Ok(4),
        "Int64" | "UInt64" | "Float64" => Ok(8),
        _ => Err(format!(
            "has the type `{kind}`, expected Int8 to Int64, UInt8 to UInt64, Float32 or Float64"
        )),
    }
}

/// Numbers of a VTK type.
fn from_bytes(bytes: &[u8], kind: &str, big_endian: bool) -> Vec<f64> {
    macro_rules! read {
        ($kind:ty) => {{
            let numbers = bytes.as_chunks::<{ size_of::<$kind>() }>().0.iter();
            let number = match big_endian {
                true => <$kind>::from_be_bytes,
                false => <$kind>::from_le_bytes,
            };
            numbers.map(|bytes| number(*bytes) as f64).collect()
        }};
    }
    match kind {
        "Int8" => read!(i8),
        "UInt8" => read!(u8),
        "Int16" => read!(i16),
        "UInt16" => read!(u16),
        "Int32" => read!(i32),
        "UInt32" => read!(u32),
        "Int64" => read!(i64),
        "UInt64" => read!(u64),
        "Float32" => read!(f32),
        _ => read!(f64),
    }
}
