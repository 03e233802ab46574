//! The outline of a capsule in a picture, and its scale.

use super::given::Given;
use anyhow::{Context, Result, bail, ensure};
use capsule_contour::{Capsule, Found, Picture, Settings};
use capsule_identify::Direction;
use serde::Serialize;
use std::fmt::Write;

/// By what share the scales of the pixel and of the walls may differ without a warning.
const SAME_SCALE: f64 = 0.01;

/// A picture and what was found in it.
pub struct Seen {
    pub picture: Picture,
    pub found: Found,
    /// Which of the capsules is identified.
    index: usize,
    /// The direction of the flow, in the coordinates of a contour.
    pub direction: Direction,
    /// The outline's origin, in words.
    pub note: String,
    pub summary: Summary,
}

/// Findings in a picture, for the answer.
#[derive(Clone, Serialize)]
pub struct Summary {
    edge: &'static str,
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
pub fn turned(direction: Direction) -> Direction {
    match direction {
        Direction::Up => Direction::Down,
        Direction::Down => Direction::Up,
        other => other,
    }
}

/// Finds the capsule in a picture.
pub fn read(bytes: &[u8], given: &Given, half_width_um: f64, warnings: &mut Vec<String>) -> Result<Seen> {
    ensure!(
        given.unit().is_none(),
        "--unit is for text files, and this is a picture"
    );
    let picture = Picture::read(bytes)?;
    let background = given.background.as_deref().map(|path| {
        let bytes = std::fs::read(path).with_context(|| format!("could not read {}", path.display()))?;
        Picture::read(&bytes).with_context(|| path.display().to_string())
    });
    let background = background.transpose()?;
    let settings = Settings {
        axis: given.axis(),
        edge: given.edge(),
    };
    let found = picture.capsules(background.as_ref(), &settings)?;
    let index = choose(&found, given.capsule)?;
    let (pixel_um, scale_from) = scale(&found, given.pixel_um, half_width_um, warnings)?;
    let capsule = &found.capsules[index];
    if !given.says_channel() {
        warnings.push(
            "a picture does not tell whether the channel is square, and in a round tube the numbers would be wrong: \
             say --channel square if it is"
                .to_owned(),
        );
    }
    if found.cut > 0 {
        warnings.push(format!(
            "{} capsule(s) are cut by the border of the picture and left out",
            found.cut
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
    let direction = match (given.direction(), capsule.flow) {
        (Direction::Found, Some(flow)) => match flow {
            capsule_contour::Flow::Right => Direction::Right,
            capsule_contour::Flow::Left => Direction::Left,
            capsule_contour::Flow::Up => Direction::Up,
            capsule_contour::Flow::Down => Direction::Down,
        },
        (given, _) => given,
    };
    Ok(Seen {
        picture,
        found,
        index,
        direction: turned(direction),
        note,
        summary,
    })
}

/// The capsule of a number, from 1; the only one where none is given.
fn choose(found: &Found, number: Option<usize>) -> Result<usize> {
    let count = found.capsules.len();
    match number {
        None if count == 1 => Ok(0),
        Some(number) if (1..=count).contains(&number) => Ok(number - 1),
        _ => {
            let places: Vec<String> = found
                .capsules
                .iter()
                .map(|capsule| {
                    let count = capsule.points.len() as f64;
                    let [x, y] = [0, 1].map(|d| capsule.points.iter().map(|point| point[d]).sum::<f64>() / count);
                    format!("({x:.0}, {y:.0})")
                })
                .collect();
            bail!(
                "the picture shows {count} whole capsule(s), at {} pixels: choose one by --capsule 1 to {count}",
                places.join(", ")
            )
        }
    }
}

/// Size of a pixel and its origin, in words.
fn scale(
    found: &Found,
    given: Option<f64>,
    half_width_um: f64,
    warnings: &mut Vec<String>,
) -> Result<(f64, &'static str)> {
    let walls = found.walls.map(|walls| 2.0 * half_width_um / walls.distance);
    match (given, walls) {
        (Some(given), _) if !(given.is_finite() && given > 0.0) => {
            bail!("--pixel-um {given}: it must be a positive number")
        }
        (Some(given), Some(walls)) if (given / walls - 1.0).abs() > SAME_SCALE => {
            warnings.push(format!(
                "the walls would be {:.2} um apart by --pixel-um, and are {:.2} um by --half-width-um",
                2.0 * half_width_um * given / walls,
                2.0 * half_width_um
            ));
            Ok((given, "--pixel-um"))
        }
        (Some(given), _) => Ok((given, "--pixel-um")),
        (None, Some(walls)) => Ok((walls, "the walls")),
        (None, None) => {
            bail!("the walls of the channel are not seen on both sides: give --pixel-um with the size of a pixel")
        }
    }
}
