//! The outline of a capsule, from a text file or from a picture.

use super::given::Given;
use super::picture::{self, Seen};
use anyhow::{Context, Result, bail};
use capsule_contour::{Picture, text};
use capsule_identify::Direction;
use std::path::Path;

/// Points in order around a capsule.
pub struct Outline {
    pub points_um: Vec<[f64; 2]>,
    /// Size of a pixel, if it is known.
    pub pixel_um: Option<f64>,
    pub direction: Direction,
    /// The outline's origin, in words.
    pub note: String,
    /// The picture that it comes from, and all that was found there.
    pub seen: Option<Seen>,
}

impl From<Seen> for Outline {
    fn from(seen: Seen) -> Self {
        Self {
            points_um: seen.points_um(),
            pixel_um: Some(seen.summary.pixel_um),
            direction: seen.direction,
            note: seen.note.clone(),
            seen: Some(seen),
        }
    }
}

/// Reads a file: a picture if it begins like one or is named like one, else a text.
pub fn read(path: &Path, given: &Given, half_width_um: f64, warnings: &mut Vec<String>) -> Result<Outline> {
    let bytes = std::fs::read(path).with_context(|| format!("could not read {}", path.display()))?;
    let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
    let named = ending.is_some_and(|ending| ["png", "jpg", "jpeg", "tif", "tiff"].iter().any(|name| *name == ending));
    let outline = if named || Picture::is_one(&bytes) {
        picture::read(&bytes, given, half_width_um, warnings).map(Outline::from)
    } else {
        from_text(&bytes, given)
    };
    outline.with_context(|| path.display().to_string())
}

fn from_text(bytes: &[u8], given: &Given) -> Result<Outline> {
    if let Some(option) = given.of_pictures() {
        bail!("{option} is for pictures, and this is a text");
    }
    let contour = text::read(bytes)?;
    Ok(Outline {
        points_um: contour.in_um(given.unit(), given.pixel_um)?,
        pixel_um: given.pixel_um,
        direction: given.direction(),
        note: contour.format,
        seen: None,
    })
}
