//! Elements of NumPy's types: real numbers as `f64`, texts of fixed length.

use std::io::{ErrorKind, Read};

use half::f16;
use ndarray_npy::{ReadDataError, ReadableElement};
use py_literal::Value;

/// Bytes that are decoded at a time.
const BLOCK: usize = 1 << 16;

/// A number of any real or integer type, in either byte order.
#[derive(Debug, PartialEq)]
pub(crate) struct Real(pub(crate) f64);

/// A text of fixed length (`U` or `S`), without the zeros that fill it up.
#[derive(Debug, PartialEq)]
pub(crate) struct Text(pub(crate) String);

type Decoded<T> = Result<T, &'static str>;
type Decoder<T> = (usize, fn(&[u8]) -> Decoded<T>);

impl ReadableElement for Real {
    fn read_to_end_exact_vec<R: Read>(reader: R, kind: &Value, len: usize) -> Result<Vec<Self>, ReadDataError> {
        let wrong = || ReadDataError::WrongDescriptor(kind.clone());
        let (big_endian, name) = parts(kind).ok_or_else(wrong)?;
        let (width, decode) = real(name).ok_or_else(wrong)?;
        if name == "f16" && big_endian {
            return Err(wrong());
        }
        let swapped = if big_endian { width } else { 1 };
        decoded(reader, len, width, swapped, |bytes| decode(bytes).map(Self))
    }
}

impl ReadableElement for Text {
    fn read_to_end_exact_vec<R: Read>(reader: R, kind: &Value, len: usize) -> Result<Vec<Self>, ReadDataError> {
        let wrong = || ReadDataError::WrongDescriptor(kind.clone());
        let (big_endian, name) = parts(kind).ok_or_else(wrong)?;
        let (unit, decode): Decoder<String> = match name.get(..1) {
            Some("U") => (4, utf32),
            Some("S") => (1, utf8),
            _ => return Err(wrong()),
        };
        let characters: usize = name[1..].parse().map_err(|_| wrong())?;
        let width = characters.checked_mul(unit).ok_or_else(wrong)?;
        if width == 0 {
            return Ok((0..len).map(|_| Self(String::new())).collect());
        }
        let swapped = if big_endian { unit } else { 1 };
        decoded(reader, len, width, swapped, |bytes| {
            decode(bytes).map(|text| Self(text.trim_end_matches('\0').to_owned()))
        })
    }
}

/// Whether a type is big-endian, and its name without the sign of that.
fn parts(kind: &Value) -> Option<(bool, &str)> {
    let descriptor = kind.as_string()?;
    let name = descriptor.strip_prefix(['<', '>', '|', '='])?;
    Some((descriptor.starts_with('>'), name))
}

/// Width and decoder of a real type, from little-endian bytes.
fn real(name: &str) -> Option<Decoder<f64>> {
    macro_rules! number {
        ($kind:ty, $value:expr) => {
            (size_of::<$kind>(), |bytes| {
                let word = bytes.try_into().map_err(|_| "an element is cut short")?;
                Ok($value(<$kind>::from_le_bytes(word)))
            })
        };
    }
    Some(match name {
        "f2" => number!(f16, f64::from),
        "f4" => number!(f32, f64::from),
        "f8" => number!(f64, f64::from),
        "f16" => (16, extended),
        "i1" => number!(i8, f64::from),
        "i2" => number!(i16, f64::from),
        "i4" => number!(i32, f64::from),
        "i8" => number!(i64, |x| x as f64),
        "u1" => number!(u8, f64::from),
        "u2" => number!(u16, f64::from),
        "u4" => number!(u32, f64::from),
        "u8" => number!(u64, |x| x as f64),
        _ => return None,
    })
}

/// A long double of x86: 64 bits of significand with its leading one, 15 of exponent, the sign, and six bytes of zeros.
/// Other platforms keep other formats under the same name; their numbers do not look like this.
pub(crate) fn extended(bytes: &[u8]) -> Decoded<f64> {
    const OTHER: &str = "long doubles of another platform than x86; expected those or `.astype(float)`";
    let (significand, rest) = bytes.split_first_chunk::<8>().ok_or(OTHER)?;
    let (high, padding) = rest.split_first_chunk::<2>().ok_or(OTHER)?;
    let (significand, high) = (u64::from_le_bytes(*significand), u16::from_le_bytes(*high));
    let exponent = i32::from(high & 0x7fff);
    let normal = exponent == 0 || significand >> 63 == 1;
    if !normal || padding.iter().any(|byte| *byte != 0) {
        return Err(OTHER);
    }
    let magnitude = match (exponent, significand << 1) {
        (0x7fff, 0) => f64::INFINITY,
        (0x7fff, _) => f64::NAN,
        _ => {
            // Two factors: a single power of two may be beyond f64 where the number is not.
            let power = (exponent - 16383 - 63).clamp(-2200, 2200);
            significand as f64 * 2f64.powi(power / 2) * 2f64.powi(power - power / 2)
        }
    };
    Ok(if high >> 15 == 1 { -magnitude } else { magnitude })
}

fn utf32(bytes: &[u8]) -> Decoded<String> {
    let (codes, _) = bytes.as_chunks::<4>();
    let characters = codes.iter().map(|code| char::from_u32(u32::from_le_bytes(*code)));
    characters.collect::<Option<_>>().ok_or("the text is not Unicode")
}

fn utf8(bytes: &[u8]) -> Decoded<String> {
    String::from_utf8(bytes.to_vec()).map_err(|_| "the text is not UTF-8: `.astype(str)` with its encoding")
}

/// Decodes `len` elements of `width` bytes, after reversing each group of `swapped` bytes. Memory grows with the data that
/// are there, not with the length that a damaged header claims.
fn decoded<T>(
    mut reader: impl Read,
    len: usize,
    width: usize,
    swapped: usize,
    decode: impl Fn(&[u8]) -> Decoded<T>,
) -> Result<Vec<T>, ReadDataError> {
    let mut elements = Vec::new();
    let mut block = vec![0; BLOCK.div_ceil(width).min(len) * width];
    while elements.len() < len {
        let bytes = (len - elements.len()).saturating_mul(width).min(block.len());
        let bytes = &mut block[..bytes];
        reader.read_exact(bytes).map_err(|error| match error.kind() {
            ErrorKind::UnexpectedEof => ReadDataError::MissingData,
            _ => ReadDataError::Io(error),
        })?;
        bytes.chunks_exact_mut(swapped).for_each(<[u8]>::reverse);
        for element in bytes.chunks_exact(width) {
            elements.push(decode(element).map_err(|reason| ReadDataError::ParseData(reason.into()))?);
        }
    }
    let extra = std::io::copy(&mut reader, &mut std::io::sink()).map_err(ReadDataError::Io)?;
    match usize::try_from(extra) {
        Ok(0) => Ok(elements),
        extra => Err(ReadDataError::ExtraBytes(extra.unwrap_or(usize::MAX))),
    }
}

/// Elements that are no real numbers, in words, and the end of the NumPy expression that converts them.
pub(crate) fn described(kind: &Value) -> (String, &'static str) {
    let Some(descriptor) = kind.as_string() else {
        let remedy = "numpy.lib.recfunctions.structured_to_unstructured";
        return (format!("records (`{kind}`)"), remedy);
    };
    let (words, remedy) = match descriptor.trim_start_matches(['<', '>', '|', '=']).chars().next() {
        Some('c') => ("complex numbers", ".real"),
        Some('b') => ("booleans", ".astype(int)"),
        Some('O') => ("Python objects", ".astype(float)"),
        Some('U' | 'S' | 'T') => ("text", ".astype(float)"),
        Some('M' | 'm') => ("dates or durations", ".astype(float)"),
        Some('V') => ("raw bytes", ".astype(float)"),
        Some('f') => ("floating-point numbers of another platform", ".astype(float)"),
        _ => ("numbers", ".astype(float)"),
    };
    (format!("{words} (`{descriptor}`)"), remedy)
}
