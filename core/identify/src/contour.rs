//! From a contour as it was measured to points in the frame of the flow.

use crate::grid::FEATURES;
use crate::measurement::{Contour, Direction};
use crate::residuals::Point;
use crate::shapes::{HALF_WIDTH, LENGTH, SCALARS};

/// The fewest points of a contour.
pub const MIN_POINTS: usize = 12;
/// The greatest share of the way around that a contour may leave open.
pub const MAX_GAP: f64 = 0.25;
/// By what share a contour may be wider than the channel before it is refused: the scale is not better known.
const WIDER: f64 = 0.05;

/// The fault of a contour.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ContourError {
    /// Fewer than [`MIN_POINTS`].
    TooFewPoints {
        /// How many.
        found: usize,
    },
    /// More than there is room for.
    TooManyPoints {
        /// How many.
        found: usize,
        /// Room.
        capacity: usize,
    },
    /// A coordinate that is not a finite number.
    NotFinite {
        /// Of which point, from 0.
        index: usize,
    },
    /// It crosses itself.
    SelfCrossing {
        /// Point before the first of the crossing pieces, from 0.
        first: usize,
        /// Point before the second.
        second: usize,
    },
    /// It is wider than the channel.
    WiderThanChannel {
        /// Its width, in um.
        width_um: f64,
        /// The channel's, in um.
        channel_um: f64,
    },
    /// It leaves too much open.
    Open {
        /// The share of the way around that lies between its last point and its first.
        share: f64,
    },
    /// It encloses no area to speak of.
    NoArea,
}

impl core::fmt::Display for ContourError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match *self {
            Self::TooFewPoints { found } => {
                write!(
                    f,
                    "the contour has {found} points: at least {MIN_POINTS} are needed, around the whole capsule"
                )
            }
            Self::TooManyPoints { found, capacity } => {
                write!(f, "the contour has {found} points, there is room for {capacity}")
            }
            Self::NotFinite { index } => write!(f, "point {} of the contour is not a finite number", index + 1),
            Self::SelfCrossing { first, second } => write!(
                f,
                "the contour crosses itself, after its points {} and {}: the points must follow each other around the \
                 capsule, once",
                first + 1,
                second + 1
            ),
            Self::WiderThanChannel { width_um, channel_um } => write!(
                f,
                "the contour is {width_um:.4} um wide, the channel {channel_um:.4} um: one of scale, unit and half \
                 width is wrong"
            ),
            Self::Open { share } => write!(
                f,
                "the contour leaves {:.0} % of the way around open: at most {:.0} % may be missing",
                100.0 * share,
                100.0 * MAX_GAP
            ),
            Self::NoArea => write!(f, "the contour encloses no area: it is not the outline of a capsule"),
        }
    }
}

impl core::error::Error for ContourError {}

/// A contour's middle and features.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Framed {
    /// The middle of its extent, in l, in the frame of the flow.
    pub(crate) middle: [f64; 2],
    pub(crate) features: [Option<f64>; FEATURES],
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::hypot(a[0] - b[0], a[1] - b[1])
}

impl Contour<'_> {
    /// Checks the contour, but for crossings: see [`crossing`](Self::crossing).
    pub(crate) fn check(&self, half_width_um: f64, capacity: usize) -> Result<(), ContourError> {
        let points = self.points_um;
        if points.len() < MIN_POINTS {
            return Err(ContourError::TooFewPoints { found: points.len() });
        }
        if points.len() > capacity {
            return Err(ContourError::TooManyPoints {
                found: points.len(),
                capacity,
            });
        }
        if let Some(index) = points.iter().position(|point| !point.iter().all(|x| x.is_finite())) {
            return Err(ContourError::NotFinite { index });
        }
        let way: f64 = points.windows(2).map(|pair| distance(pair[0], pair[1])).sum();
        let gap = points.first().zip(points.last()).map_or(0.0, |(a, b)| distance(*a, *b));
        if gap > MAX_GAP * (way + gap) {
            return Err(ContourError::Open {
                share: gap / (way + gap),
            });
        }
        let framed = self.framed(Direction::Right, half_width_um);
        let [length, width] = [LENGTH, HALF_WIDTH].map(|i| framed.features[i].unwrap_or(0.0));
        let area = framed.features[SCALARS].unwrap_or(0.0);
        if !(area > 0.1 * 2.0 * length * width && area > 1e-6) {
            return Err(ContourError::NoArea);
        }
        let across = match self.direction {
            Direction::Right | Direction::Left => 2.0 * width,
            Direction::Up | Direction::Down => length,
            Direction::Found => length.min(2.0 * width),
        };
        if across > 2.0 * (1.0 + WIDER) {
            return Err(ContourError::WiderThanChannel {
                width_um: across * half_width_um,
                channel_um: 2.0 * half_width_um,
            });
        }
        Ok(())
    }

    /// The first place where the contour crosses itself, but for neighbours: points one pixel apart with an error of a
    /// pixel come in any order.
    ///
    /// # Errors
    /// [`ContourError::SelfCrossing`].
    pub fn crossing(&self) -> Result<(), ContourError> {
        let points = self.points_um;
        let n = points.len();
        let apart = (n / 10).max(4);
        let closed = |i: usize| points[i % n];
        let turn =
            |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        for first in 0..n {
            let (a, b) = (closed(first), closed(first + 1));
            for second in first + apart..n.min(first + n - apart.min(n) + 1) {
                let (c, d) = (closed(second), closed(second + 1));
                if turn(a, b, c) * turn(a, b, d) < 0.0 && turn(c, d, a) * turn(c, d, b) < 0.0 {
                    return Err(ContourError::SelfCrossing { first, second });
                }
            }
        }
        Ok(())
    }

    /// Middle and features of the contour for a direction of the flow.
    pub(crate) fn framed(&self, direction: Direction, half_width_um: f64) -> Framed {
        let at = |point: [f64; 2]| direction.turn(point).map(|x| x / half_width_um);
        let origin = self.points_um.first().map_or([0.0; 2], |point| at(*point));
        let mut extent = [origin; 2];
        let (mut double_area, mut moment) = (0.0, 0.0);
        let mut before = self.points_um.last().map_or(origin, |point| at(*point));
        for point in self.points_um {
            let point = at(*point);
            for d in 0..2 {
                extent[0][d] = extent[0][d].min(point[d]);
                extent[1][d] = extent[1][d].max(point[d]);
            }
            let [p, q] = [before, point].map(|[x, y]| [x - origin[0], y - origin[1]]);
            let triangle = p[0] * q[1] - p[1] * q[0];
            double_area += triangle;
            moment += triangle * (p[0] + q[0]) / 3.0;
            before = point;
        }
        let middle = [0, 1].map(|d| 0.5 * (extent[0][d] + extent[1][d]));
        let centroid = if double_area == 0.0 {
            0.0
        } else {
            origin[0] + moment / double_area
        };
        let mut features = [None; FEATURES];
        features[LENGTH] = Some(extent[1][0] - extent[0][0]);
        features[HALF_WIDTH] = Some(0.5 * (extent[1][1] - extent[0][1]));
        features[SCALARS] = Some(0.5 * double_area.abs());
        features[SCALARS + 1] = Some(centroid - middle[0]);
        Framed { middle, features }
    }

    /// The points in the frame of the flow, about the contour's middle, in l.
    pub(crate) fn fill(&self, direction: Direction, half_width_um: f64, middle: [f64; 2], out: &mut [Point]) {
        for (out, point) in out.iter_mut().zip(self.points_um) {
            let [x, y] = direction.turn(*point).map(|x| x / half_width_um);
            *out = Point {
                place: [x - middle[0], y - middle[1]],
                weight: 1.0,
                ..Point::default()
            };
        }
    }
}
