//! Grey levels of a picture file, between 0 and 1.

use crate::error::PictureError;
use crate::grid::Grey;
use image::io::Reader;
use image::{ImageBuffer, ImageFormat, Luma};
use std::io::Cursor;
use tiff::ColorType;
use tiff::decoder::{Decoder, DecodingResult};

/// The unit of a picture's grey levels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Unit {
    /// The greatest that its whole numbers can have.
    Full,
    /// The greatest size of its floating-point numbers, which know no other.
    Greatest(f64),
}

/// The grey levels of a PNG, JPEG or TIFF, and their unit; of a stack, those of the first picture. Colours become
/// shades of grey.
pub(crate) fn read(bytes: &[u8]) -> Result<(Grey, Unit), PictureError> {
    let reader = Reader::new(Cursor::new(bytes)).with_guessed_format();
    let reader = reader.map_err(|error| unreadable(error.to_string()))?;
    if reader.format() == Some(ImageFormat::Tiff)
        && let Some(found) = read_floats(bytes)?
    {
        return Ok(found);
    }
    let decoded = reader
        .decode()
        .map_err(|error| unreadable(error.to_string()))?
        .into_luma16();
    let (width, height) = decoded.dimensions();
    let grey = ImageBuffer::from_fn(width, height, |x, y| {
        Luma([f32::from(decoded.get_pixel(x, y).0[0]) / f32::from(u16::MAX)])
    });
    Ok((grey, Unit::Full))
}

/// Those of a TIFF of floating-point numbers in one channel, as ImageJ writes what it has computed; none of others.
fn read_floats(bytes: &[u8]) -> Result<Option<(Grey, Unit)>, PictureError> {
    let of_decoder = |error: tiff::TiffError| unreadable(error.to_string());
    let mut decoder = Decoder::new(Cursor::new(bytes)).map_err(of_decoder)?;
    if !matches!(decoder.colortype(), Ok(ColorType::Gray(32 | 64))) {
        return Ok(None);
    }
    let (width, height) = decoder.dimensions().map_err(of_decoder)?;
    let levels: Vec<f64> = match decoder.read_image().map_err(of_decoder)? {
        DecodingResult::F32(levels) => levels.into_iter().map(f64::from).collect(),
        DecodingResult::F64(levels) => levels,
        _ => return Ok(None),
    };
    if let Some(place) = levels.iter().position(|level| !level.is_finite()) {
        let width = width as usize;
        return Err(unreadable(format!(
            "the pixel in column {} and row {} is not a finite number",
            place % width + 1,
            place / width + 1
        )));
    }
    let greatest = levels.iter().fold(0.0_f64, |greatest, level| greatest.max(level.abs()));
    let unit = if greatest > 0.0 { greatest } else { 1.0 };
    let levels = levels.into_iter().map(|level| (level / unit) as f32).collect();
    let grey = ImageBuffer::from_raw(width, height, levels);
    let grey = grey.ok_or_else(|| unreadable("it has fewer pixels than it says".to_owned()))?;
    Ok(Some((grey, Unit::Greatest(unit))))
}

fn unreadable(reason: String) -> PictureError {
    PictureError::Unreadable { reason }
}
