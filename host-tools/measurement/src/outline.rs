//! The outline of a capsule, from a text or from a picture.

use crate::error::MeasurementError;
use crate::said::Said;
use crate::seen::Seen;
use capsule_contour::Picture;
use capsule_contour::text::{self, Unit};
use capsule_identify::Direction;
use std::path::Path;

/// Points in order around a capsule.
#[derive(Debug)]
pub struct Outline {
    /// The points, in um.
    pub points_um: Vec<[f64; 2]>,
    /// Points along the line of a dent behind, in um; empty if there is none.
    pub dent_line_um: Vec<[f64; 2]>,
    /// Size of a pixel, if it is known.
    pub pixel_um: Option<f64>,
    /// Direction of the flow in the points' coordinates.
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
            dent_line_um: Vec::new(),
            pixel_um: Some(seen.summary.pixel_um),
            direction: seen.direction,
            note: seen.note.clone(),
            seen: Some(seen),
        }
    }
}

/// Whether a file is a picture: it begins like one or is named like one.
pub fn is_picture(name: &Path, bytes: &[u8]) -> bool {
    let ending = name.extension().map(|ending| ending.to_ascii_lowercase());
    let named = ending.is_some_and(|ending| ["png", "jpg", "jpeg", "tif", "tiff"].iter().any(|name| *name == ending));
    named || Picture::is_one(bytes)
}

impl Outline {
    /// Reads a file: a picture or a text, as [`is_picture`] has it. `warnings` gets what is to be known of it, in
    /// words.
    ///
    /// # Errors
    /// A file that holds no outline, or lacks its scale.
    pub fn read(name: &Path, bytes: &[u8], said: &Said, warnings: &mut Vec<String>) -> Result<Self, MeasurementError> {
        if is_picture(name, bytes) {
            return Seen::find(Picture::read(bytes)?, said, warnings).map(Self::from);
        }
        let contour = text::read(bytes)?;
        Ok(Self {
            points_um: contour.in_um(said.unit, said.pixel_um)?,
            dent_line_um: Vec::new(),
            pixel_um: said.pixel_um,
            direction: said.direction,
            note: contour.format,
            seen: None,
        })
    }

    /// Reads the points along the line of a dent behind from a text, in the coordinates of this outline.
    ///
    /// # Errors
    /// A text without two columns of numbers, or of an unknown unit.
    pub fn read_dent_line(&mut self, bytes: &[u8], unit: Option<Unit>) -> Result<(), MeasurementError> {
        self.dent_line_um = text::read(bytes)?.in_um(unit, self.pixel_um)?;
        Ok(())
    }
}
