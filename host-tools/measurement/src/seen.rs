//! The outline of a capsule in a picture, and its scale.

use crate::error::MeasurementError;
use crate::said::Said;
use capsule_contour::{Axis, Capsule, Found, Picture, Settings};
use capsule_identify::Direction;
use serde::Serialize;
use std::fmt::Write;

/// By what share the scales of the pixel and of the walls may differ without a warning.
const SAME_SCALE: f64 = 0.01;

/// Pixels in a half width below which neighbouring points of a contour err alike, more than a fit counts: see
/// `docs/reports/identification.md`.
const FEW_PIXELS: f64 = 50.0;

/// A picture and what was found in it.
#[derive(Debug)]
pub struct Seen {
    /// The picture.
    pub picture: Picture,
    /// All that was found.
    pub found: Found,
    /// Which of the capsules is identified.
    index: usize,
    /// The direction of the flow, in the coordinates of a contour.
    pub direction: Direction,
    /// The outline's origin, in words.
    pub note: String,
    /// Findings, for the answer.
    pub summary: Summary,
}

/// Findings in a picture, for the answer.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    edge: &'static str,
    /// Size of a pixel, in um.
    pub pixel_um: f64,
    scale_from: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    walls_px: Option<f64>,
    capsules: usize,
    capsules_cut_by_border: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    flow_from_shape: Option<&'static str>,
    /// Depth of the dent on the axis, as its line is seen.
    #[serde(skip_serializing_if = "Option::is_none")]
    rear_depth_um: Option<f64>,
}

impl Seen {
    fn capsule(&self) -> &Capsule {
        &self.found.capsules[self.index]
    }

    /// The contour of the capsule, in um.
    pub fn points_um(&self) -> Vec<[f64; 2]> {
        let points = self.capsule().points.iter();
        points.map(|point| point.map(|x| x * self.summary.pixel_um)).collect()
    }

    /// The contour as a text that can be read again.
    pub fn contour(&self) -> String {
        let mut text = "x_px,y_px\n".to_owned();
        for [x, y] in &self.capsule().points {
            let _ = writeln!(text, "{x:.4},{y:.4}");
        }
        text
    }
}

/// The flow in a picture, where y points down, from the direction in coordinates; or the other way round.
pub(crate) fn turned(direction: Direction) -> Direction {
    match direction {
        Direction::Up => Direction::Down,
        Direction::Down => Direction::Up,
        other => other,
    }
}

impl Seen {
    /// Finds the capsule in a picture. `warnings` gets what is to be known of it, in words.
    ///
    /// # Errors
    /// A picture without a capsule, or without a scale.
    pub fn find(picture: Picture, said: &Said, warnings: &mut Vec<String>) -> Result<Self, MeasurementError> {
        let settings = Settings {
            axis: match said.direction {
                Direction::Right | Direction::Left => Some(Axis::Horizontal),
                Direction::Up | Direction::Down => Some(Axis::Vertical),
                Direction::Found => None,
            },
            edge: said.edge,
        };
        let found = picture.capsules(said.background.as_ref(), &settings)?;
        let index = choose(&found, said.capsule)?;
        let (pixel_um, scale_from) = scale(&found, said, warnings)?;
        let capsule = &found.capsules[index];
        if found.cut > 0 {
            warnings.push(format!(
                "{} capsule(s) are cut by the border of the picture and left out",
                found.cut
            ));
        }
        let pixels = said.half_width_um / pixel_um;
        if pixels < FEW_PIXELS {
            warnings.push(format!(
                "the half width of the channel has {pixels:.0} pixels: with fewer than {FEW_PIXELS:.0} the intervals \
                 are too narrow"
            ));
        }
        let [width, height] = picture.size();
        let note = format!(
            "{} points of a picture of {width} x {height} pixels, edge by {}, {pixel_um:.4} um a pixel by {scale_from}",
            capsule.points.len(),
            found.edge.name()
        );
        let summary = Summary {
            edge: found.edge.name(),
            pixel_um,
            scale_from,
            walls_px: found.walls.map(|walls| walls.distance),
            capsules: found.capsules.len(),
            capsules_cut_by_border: found.cut,
            flow_from_shape: capsule.flow.map(|flow| flow.name()),
            rear_depth_um: capsule.dent.map(|dent| dent.depth * pixel_um),
        };
        let direction = match (said.direction, capsule.flow) {
            (Direction::Found, Some(flow)) => match flow {
                capsule_contour::Flow::Right => Direction::Right,
                capsule_contour::Flow::Left => Direction::Left,
                capsule_contour::Flow::Up => Direction::Up,
                capsule_contour::Flow::Down => Direction::Down,
            },
            (said, _) => said,
        };
        Ok(Self {
            picture,
            found,
            index,
            direction: turned(direction),
            note,
            summary,
        })
    }
}

/// The capsule of a number, from 1; the only one where none is given.
fn choose(found: &Found, number: Option<usize>) -> Result<usize, MeasurementError> {
    let count = found.capsules.len();
    match number {
        None if count == 1 => Ok(0),
        Some(number) if (1..=count).contains(&number) => Ok(number - 1),
        _ => {
            let place = |capsule: &Capsule| {
                let count = capsule.points.len() as f64;
                let [x, y] = [0, 1].map(|d| capsule.points.iter().map(|point| point[d]).sum::<f64>() / count);
                format!("({x:.0}, {y:.0})")
            };
            let places = found.capsules.iter().map(place).collect();
            Err(MeasurementError::Capsule { count, places })
        }
    }
}

/// Size of a pixel and its origin, in words.
fn scale(found: &Found, said: &Said, warnings: &mut Vec<String>) -> Result<(f64, &'static str), MeasurementError> {
    const GIVEN: &str = "its given size";
    let channel_um = 2.0 * said.half_width_um;
    let walls = found.walls.map(|walls| channel_um / walls.distance);
    match (said.pixel_um, walls) {
        (Some(given), _) if !(given.is_finite() && given > 0.0) => Err(MeasurementError::Pixel(given)),
        (Some(given), Some(walls)) if (given / walls - 1.0).abs() > SAME_SCALE => {
            warnings.push(format!(
                "the walls would be {:.2} um apart by the size of a pixel, and are {channel_um:.2} um by the half \
                 width of the channel",
                channel_um * given / walls
            ));
            Ok((given, GIVEN))
        }
        (Some(given), _) => Ok((given, GIVEN)),
        (None, Some(walls)) => Ok((walls, "the walls")),
        (None, None) => Err(MeasurementError::NoScale),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_pixels_in_a_half_width_are_warned_of() {
        let mask = || Picture::mask(120, 60, |x, y| (f64::from(x) - 60.0).hypot(f64::from(y) - 30.0) < 20.0);
        let said = |half_width_um| Said {
            half_width_um,
            unit: None,
            pixel_um: Some(0.5),
            direction: Direction::Right,
            capsule: None,
            edge: None,
            background: None,
        };
        let warned = |half_width_um: f64| {
            let mut warnings = Vec::new();
            Seen::find(mask().unwrap(), &said(half_width_um), &mut warnings).unwrap();
            warnings
        };
        assert!(warned(26.0).is_empty());
        assert!(warned(13.0)[0].contains("26 pixels"), "{:?}", warned(13.0));
    }
}
