//! Elements of NumPy's types: real numbers as `f64`, texts of fixed length.

use std::io::{ErrorKind, Read};

use half::f16;
use ndarray_npy::{ReadDataError, ReadableElement};
use py_literal::Value;

use crate::DatabaseError;

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
        // A damaged header may claim any width and count; no memory is taken for what is not there.
        if characters > BLOCK || (characters == 0 && len > BLOCK) {
            return Err(wrong());
        }
        let width = characters * unit;
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

/// A long double of x86: 64 bits of significand with its leading one, 15 of exponent, the sign, and six bytes of
/// anything. Other platforms keep other formats under the same name: IEEE quadruple precision (ARM), pairs of doubles
/// (PowerPC). But for a few round numbers those lack the leading one here, or are beyond all `f64`, so nearly every
/// array shows it.
fn extended(bytes: &[u8]) -> Decoded<f64> {
    const OTHER: &str = "long doubles of another platform than x86: `.astype(float)` there converts them";
    let (significand, rest) = bytes.split_first_chunk::<8>().ok_or(OTHER)?;
    let (high, _) = rest.split_first_chunk::<2>().ok_or(OTHER)?;
    let (significand, high) = (u64::from_le_bytes(*significand), u16::from_le_bytes(*high));
    let exponent = i32::from(high & 0x7fff);
    let magnitude = match (exponent, significand >> 63) {
        (0, _) if significand == 0 => 0.0,
        (0x7fff, 1) if significand << 1 == 0 => f64::INFINITY,
        (0x7fff, 1) => f64::NAN,
        // The exponents of f64 with those of its subnormal numbers; two factors, as a power of two may be beyond f64
        // where the number is not.
        (15300..=17406, 1) => {
            let power = exponent - 16383 - 63;
            significand as f64 * 2f64.powi(power / 2) * 2f64.powi(power - power / 2)
        }
        _ => return Err(OTHER),
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

/// Decodes `len` elements of `width` bytes, after reversing each group of `swapped` bytes. Memory grows with the data
/// that are there, not with the length that a damaged header claims.
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

/// The elements of arrays of numbers, in words, and the remedy for others, if it is always the same.
pub(crate) const NUMBERS: (&str, Option<&str>) = ("real numbers", None);

/// The same of texts.
pub(crate) const TEXTS: (&str, Option<&str>) = ("text of fixed length", Some(".astype(str)"));

/// The error of an array with elements of another type than `expected`.
pub(crate) fn refused(name: &str, kind: &Value, expected: &str, remedy: Option<&str>) -> DatabaseError {
    let (found, conversion) = described(kind);
    let remedy = remedy.unwrap_or(conversion);
    DatabaseError::collection(format!(
        "array `{name}` holds {found}, expected {expected}: `{remedy}` converts them"
    ))
}

/// Elements that are no real numbers, in words, and the end of the NumPy expression that converts them.
fn described(kind: &Value) -> (String, &'static str) {
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

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use ndarray::ArrayD;
    use ndarray_npy::{ReadNpyError, ReadNpyExt};

    /// An NPY file.
    pub(crate) fn npy(kind: &str, order: &str, shape: &str, data: &[u8]) -> Vec<u8> {
        let header = format!("{{'descr': {kind}, 'fortran_order': {order}, 'shape': {shape}, }}\n");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(data);
        bytes
    }

    fn read<T: ReadableElement>(kind: &str, shape: &str, data: &[u8]) -> Result<Vec<T>, ReadNpyError> {
        Ok(ArrayD::<T>::read_npy(&npy(kind, "False", shape, data)[..])?
            .into_iter()
            .collect())
    }

    fn numbers(kind: &str, data: &[u8]) -> Vec<f64> {
        let read: Vec<Real> = read(&format!("'{kind}'"), "(2,)", data).unwrap();
        read.into_iter().map(|Real(x)| x).collect()
    }

    #[test]
    fn integers_and_floats_are_read_in_both_byte_orders() {
        assert_eq!(numbers("|i1", &[0xff, 0x7f]), [-1.0, 127.0]);
        assert_eq!(numbers("|u1", &[0xff, 0x7f]), [255.0, 127.0]);
        assert_eq!(numbers("<i2", &[0xfe, 0xff, 0x00, 0x01]), [-2.0, 256.0]);
        assert_eq!(numbers(">i2", &[0xff, 0xfe, 0x01, 0x00]), [-2.0, 256.0]);
        assert_eq!(numbers(">u2", &[0xff, 0xfe, 0x01, 0x00]), [65534.0, 256.0]);
        assert_eq!(numbers("<u4", &[0, 0, 0, 0x80, 1, 0, 0, 0]), [2_147_483_648.0, 1.0]);
        assert_eq!(numbers(">i4", &[0x80, 0, 0, 0, 0, 0, 0, 1]), [-2_147_483_648.0, 1.0]);
        let words = [i64::MIN, 5].map(i64::to_be_bytes).concat();
        assert_eq!(numbers(">i8", &words), [-9_223_372_036_854_775_808.0, 5.0]);
        assert_eq!(numbers(">u8", &words), [9_223_372_036_854_775_808.0, 5.0]);
        // 1/3 to the nearest half, the least half.
        assert_eq!(
            numbers("<f2", &[0x55, 0x35, 0x01, 0x00]),
            [0.333_251_953_125, 2f64.powi(-24)]
        );
        assert_eq!(numbers(">f2", &[0x35, 0x55, 0xc0, 0x00]), [0.333_251_953_125, -2.0]);
        assert_eq!(numbers("<f4", &[0, 0, 0x20, 0x40, 0, 0, 0, 0x80]), [2.5, 0.0]);
        assert_eq!(
            numbers(">f8", &[0.1, -1e300].map(f64::to_be_bytes).concat()),
            [0.1, -1e300]
        );
    }

    #[test]
    fn long_doubles_of_x86_are_read_and_others_refused() {
        let word = |text: &str| -> [u8; 16] {
            let digits = format!("{text}3767f07f0000");
            std::array::from_fn(|k| u8::from_str_radix(&digits[2 * k..2 * k + 2], 16).unwrap())
        };
        // As numpy.longdouble writes 0.1, -2.5, 1e-310, the greatest f64, 0, nan.
        let words = [
            "cdccccccccccccccfb3f",
            "00000000000000a000c0",
            "a37e5831875b4493f93b",
            "00f8fffffffffffffe43",
        ];
        assert_eq!(
            words.map(|text| extended(&word(text)).unwrap()),
            [0.1, -2.5, 1e-310, f64::MAX]
        );
        assert_eq!(extended(&word("00000000000000000000")).unwrap(), 0.0);
        assert!(extended(&word("00000000000000c0ff7f")).unwrap().is_nan());
        // 0.1 and 1/3 as IEEE quadruple precision of ARM, and 0.1 as a pair of doubles of PowerPC.
        let others = [
            "00000000000000a0999999999999fb3f",
            "0000000000000050555555555555fd3f",
            "9a9999999999b93f0000000000000000",
        ];
        for other in others {
            let other: [u8; 16] = std::array::from_fn(|k| u8::from_str_radix(&other[2 * k..2 * k + 2], 16).unwrap());
            assert!(extended(&other).unwrap_err().contains("another platform"));
        }
    }

    #[test]
    fn fortran_order_gives_the_same_array() {
        let rows = npy("'|u1'", "False", "(2, 3)", &[1, 2, 3, 4, 5, 6]);
        let columns = npy("'|u1'", "True", "(2, 3)", &[1, 4, 2, 5, 3, 6]);
        let [rows, columns] = [rows, columns].map(|bytes| ArrayD::<Real>::read_npy(&bytes[..]).unwrap());
        assert_eq!(rows, columns);
    }

    #[test]
    fn texts_are_read_as_numpy_writes_them() {
        let utf32 = |swap: bool| -> Vec<u8> {
            let codes = ['ß', 'µ', '\0', 'a', '流', 'b'].map(|c| c as u32);
            codes
                .iter()
                .flat_map(|c| if swap { c.to_be_bytes() } else { c.to_le_bytes() })
                .collect()
        };
        let texts = |kind: &str, shape: &str, data: &[u8]| {
            let read = read::<Text>(kind, shape, data).map_err(|error| error.to_string())?;
            Ok::<_, String>(read.into_iter().map(|Text(text)| text).collect::<Vec<_>>())
        };
        assert_eq!(texts("'<U3'", "(2,)", &utf32(false)).unwrap(), ["ßµ", "a流b"]);
        assert_eq!(texts("'>U3'", "(2,)", &utf32(true)).unwrap(), ["ßµ", "a流b"]);
        assert_eq!(texts("'|S3'", "()", b"um\0").unwrap(), ["um"]);
        assert_eq!(texts("'<U0'", "(1,)", b"").unwrap(), [""]);
        assert!(texts("'|S3'", "(1,)", b"\xb5m\0").unwrap_err().contains("UTF-8"));
        assert!(texts("'<U0'", "(9999999999999,)", b"").is_err());
        assert!(texts("'<U9999999999999'", "(1,)", b"").is_err());
        assert!(
            texts("'<U1'", "(1,)", &[0, 0, 0xff, 0])
                .unwrap_err()
                .contains("Unicode")
        );
    }

    #[test]
    fn other_types_are_named_with_a_remedy() {
        for (kind, words, remedy) in [
            ("'<c16'", "complex numbers (`<c16`)", ".real"),
            ("'|b1'", "booleans", ".astype(int)"),
            ("'|O'", "Python objects", ".astype(float)"),
            ("'<M8[s]'", "dates", ".astype(float)"),
            ("'>f16'", "another platform", ".astype(float)"),
            (
                "[('x', '<f8'), ('y', '<f8')]",
                "records (`[('x', '<f8'), ('y', '<f8')]`)",
                "structured_to_unstructured",
            ),
        ] {
            let Err(ReadNpyError::WrongDescriptor(found)) = read::<Real>(kind, "(1,)", &[0; 16]) else {
                panic!("{kind}");
            };
            let (description, found) = described(&found);
            assert!(
                description.contains(words) && found.contains(remedy),
                "{description} {found}"
            );
        }
        assert!(matches!(
            read::<Text>("'<f8'", "(1,)", &[0; 8]),
            Err(ReadNpyError::WrongDescriptor(_))
        ));
    }

    #[test]
    fn missing_and_extra_bytes_are_found() {
        assert!(matches!(
            read::<Real>("'<f8'", "(2,)", &[0; 15]),
            Err(ReadNpyError::MissingData)
        ));
        assert!(matches!(
            read::<Real>("'<f8'", "(99999999999999,)", &[0; 80]),
            Err(ReadNpyError::MissingData)
        ));
        assert!(matches!(
            read::<Real>("'<f8'", "(2,)", &[0; 17]),
            Err(ReadNpyError::ExtraBytes(1))
        ));
    }
}
