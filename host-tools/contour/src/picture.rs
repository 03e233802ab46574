//! From a picture to the capsules in it.

use crate::background::Ends;
use crate::dent::{Dent, dent};
use crate::edge::{Edge, refine};
use crate::error::PictureError;
use crate::flow::{Axis, Flow, rightward};
use crate::grid::{Grey, Grid};
use crate::levels::{self, Unit};
use crate::rings::{Classes, LEAST, Rings, extent};
use crate::walls::Walls;
use image::ImageBuffer;

/// Standard deviation of the blur against the noise of pixels, in pixels.
const BLUR: f32 = 1.0;

/// A picture in shades of grey.
#[derive(Clone, Debug)]
pub struct Picture {
    pub(crate) grey: Grey,
    unit: Unit,
    /// Whether it has two levels only: a mask.
    mask: bool,
}

/// Options of the search in a picture.
#[derive(Clone, Copy, Debug, Default)]
pub struct Settings {
    /// The edge that the channel is parallel to; by default the one that the picture's ends tell.
    pub axis: Option<Axis>,
    /// Criterion for the edge; by default the half level for masks and the gradient for others.
    pub edge: Option<Edge>,
}

/// The result of a search in a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The capsules, along the channel.
    pub capsules: Vec<Capsule>,
    /// How many others the border of the picture cuts.
    pub cut: usize,
    /// The walls, where both are seen.
    pub walls: Option<Walls>,
    /// The edge that the channel is parallel to.
    pub axis: Axis,
    /// Criterion for the edge of a capsule that was used.
    pub edge: Edge,
}

/// A capsule in a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Capsule {
    /// Its contour, in pixels, about one point a pixel.
    pub points: Vec<[f64; 2]>,
    /// The direction of the flow, where rear and front look different.
    pub flow: Option<Flow>,
    /// The dent behind, where its line is seen.
    pub dent: Option<Dent>,
}

impl Picture {
    /// Reads a PNG, JPEG or TIFF, the last also of floating-point numbers; of a stack, the first picture. Colours
    /// become shades of grey.
    ///
    /// # Errors
    /// Bytes that are none of these, or too few pixels.
    pub fn read(bytes: &[u8]) -> Result<Self, PictureError> {
        let (grey, unit) = levels::read(bytes)?;
        large_enough(grey.width(), grey.height())?;
        let first = grey.as_raw()[0];
        let mut others = grey.as_raw().iter().filter(|value| **value != first);
        let mask = others.next().is_some_and(|second| others.all(|value| value == second));
        Ok(Self { grey, unit, mask })
    }

    /// A mask: white where `inside` says so, by column and row.
    ///
    /// # Errors
    /// Too few pixels.
    pub fn mask(width: u32, height: u32, inside: impl Fn(u32, u32) -> bool) -> Result<Self, PictureError> {
        large_enough(width, height)?;
        let grey = ImageBuffer::from_fn(width, height, |x, y| image::Luma([f32::from(u8::from(inside(x, y)))]));
        Ok(Self {
            grey,
            unit: Unit::Full,
            mask: true,
        })
    }

    /// Whether bytes begin like those of a picture.
    pub fn is_one(bytes: &[u8]) -> bool {
        image::guess_format(bytes).is_ok()
    }

    /// Width and height, in pixels.
    pub fn size(&self) -> [u32; 2] {
        [self.grey.width(), self.grey.height()]
    }

    /// Finds the capsules; `background` is a picture of the empty channel, of the same size.
    ///
    /// # Errors
    /// A background of another size or with other grey levels; no capsule, or none that the picture shows whole.
    pub fn capsules(&self, background: Option<&Self>, settings: &Settings) -> Result<Found, PictureError> {
        if let Some(background) = background
            && background.size() != self.size()
        {
            return Err(PictureError::Sizes {
                picture: self.size(),
                background: background.size(),
            });
        }
        // In this picture's unit.
        let share = match (self.unit, background.unwrap_or(self).unit) {
            (Unit::Full, Unit::Full) => 1.0,
            (Unit::Greatest(own), Unit::Greatest(other)) => other / own,
            _ => return Err(PictureError::Levels),
        };
        let channel = Grid::of(&background.unwrap_or(self).grey).times(share);
        let axis = settings.axis.unwrap_or_else(|| axis(&channel));
        let edge = settings.edge.unwrap_or(match self.mask {
            true => Edge::HalfLevel,
            false => Edge::Gradient,
        });
        // The blur is linear: of the difference it is the difference of the blurred.
        let picture = Grid::blurred(&self.grey, BLUR);
        let picture = match background {
            Some(background) => picture.minus(&Grid::blurred(&background.grey, BLUR).times(share)),
            None => picture,
        };
        let mut found = match axis {
            Axis::Horizontal => along_rows(picture, &channel, edge)?,
            Axis::Vertical => along_rows(picture.transposed(), &channel.transposed(), edge)?.transposed(),
        };
        let middle = |capsule: &Capsule| {
            let extent = extent(&capsule.points)[axis as usize];
            extent[0] + extent[1]
        };
        found.capsules.sort_by(|a, b| middle(a).total_cmp(&middle(b)));
        Ok(found)
    }
}

/// An error for a picture in which no capsule has room.
fn large_enough(width: u32, height: u32) -> Result<(), PictureError> {
    let least = 2 * LEAST;
    if width.min(height) < least {
        return Err(PictureError::TooSmall { width, height, least });
    }
    Ok(())
}

/// The edge that a channel is parallel to: along it, both ends show the same walls.
fn axis(channel: &Grid) -> Axis {
    if Ends::of(&channel.transposed()).common() > Ends::of(channel).common() {
        Axis::Vertical
    } else {
        Axis::Horizontal
    }
}

/// The capsules in a channel that is parallel to the rows: in a picture, blurred and perhaps without its background,
/// and its walls in one that shows them sharply.
fn along_rows(mut picture: Grid, channel: &Grid, edge: Edge) -> Result<Found, PictureError> {
    let ends = Ends::of(&picture);
    let mut standing_out = ends.taken_from(picture.clone());
    // Capsules are darker or brighter than the liquid: from here on, brighter.
    let signed: f64 = standing_out.values.iter().map(|value| value * value.abs()).sum();
    for value in standing_out.values.iter_mut().chain(&mut picture.values) {
        *value *= signed.signum();
    }
    if Classes::of(&standing_out.values).is_some_and(|classes| ends.differ(classes.contrast)) {
        return Err(PictureError::EndsDiffer);
    }
    let Rings { whole, cut, contrast } = Rings::of(&standing_out)?;
    // The gradient does without the light of the ends, whose noise is the same all along a row.
    let seen = match edge {
        Edge::Gradient => &picture,
        Edge::HalfLevel => &standing_out,
    };
    let capsules: Vec<Capsule> = whole
        .iter()
        .map(|ring| {
            let points = refine(seen, ring, edge);
            let rightward = rightward(&points);
            Capsule {
                flow: rightward.map(|right| if right { Flow::Right } else { Flow::Left }),
                dent: rightward.and_then(|right| dent(&standing_out, &points, right, contrast)),
                points,
            }
        })
        .collect();
    let rows = extent(&whole.concat())[1];
    let walls = Walls::around(0.5 * (rows[0] + rows[1]), &Ends::of(channel), contrast);
    Ok(Found {
        capsules,
        cut,
        walls,
        axis: Axis::Horizontal,
        edge,
    })
}

impl Found {
    /// The same in a picture whose rows are the columns of this one.
    fn transposed(self) -> Self {
        let turn = |[x, y]: [f64; 2]| [y, x];
        let capsules = self.capsules.into_iter().map(|capsule| Capsule {
            points: capsule.points.into_iter().map(turn).collect(),
            flow: capsule.flow.map(|flow| match flow {
                Flow::Right => Flow::Down,
                Flow::Left => Flow::Up,
                Flow::Up => Flow::Left,
                Flow::Down => Flow::Right,
            }),
            dent: capsule.dent.map(|dent| Dent {
                place: turn(dent.place),
                ..dent
            }),
        });
        Self {
            capsules: capsules.collect(),
            walls: self.walls.map(|walls| Walls {
                lines: walls.lines.map(|line| line.map(turn)),
                ..walls
            }),
            axis: Axis::Vertical,
            ..self
        }
    }
}
