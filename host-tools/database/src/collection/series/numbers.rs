//! Numbers of VTK's types.

/// Numbers from text.
pub(super) fn from_text(text: &str, count: usize) -> Result<Vec<f64>, String> {
    let number = |word: &str| word.parse().map_err(|_| format!("`{word}`, expected a number"));
    let numbers: Vec<f64> = text.split_ascii_whitespace().map(number).collect::<Result<_, _>>()?;
    match numbers.len() == count {
        true => Ok(numbers),
        false => Err(format!("{} numbers, expected {count}", numbers.len())),
    }
}

/// Refuses what is not finite.
pub(super) fn finite(numbers: Vec<f64>) -> Result<Vec<f64>, String> {
    match numbers.iter().position(|number| !number.is_finite()) {
        None => Ok(numbers),
        Some(index) => Err(format!(
            "value {index} is {}, expected finite numbers only",
            numbers[index]
        )),
    }
}

/// Bytes of a number of a VTK type.
pub(super) fn size(kind: &str) -> Result<usize, String> {
    match kind {
        "Int8" | "UInt8" => Ok(1),
        "Int16" | "UInt16" => Ok(2),
        "Int32" | "UInt32" | "Float32" => Ok(4),
        "Int64" | "UInt64" | "Float64" => Ok(8),
        _ => Err(format!(
            "type `{kind}`, expected Int8 to Int64, UInt8 to UInt64, Float32 or Float64"
        )),
    }
}

/// Numbers of a VTK type that [`size`] knows.
pub(super) fn from_bytes(bytes: &[u8], kind: &str, big_endian: bool) -> Vec<f64> {
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
