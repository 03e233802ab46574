//! Measurements with their uncertainties.

use crate::shapes::{HALF_WIDTH, LENGTH, RADIUS, REAR_DEPTH, SCALARS, VELOCITY};

/// The channel and the flow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup {
    /// Half the side of the square channel, in um.
    pub half_width_um: f64,
    /// How fast the liquid flows.
    pub flow: Flow,
    /// Viscosity of the liquid, in Pa s.
    pub viscosity_pa_s: f64,
}

/// How fast the liquid flows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Flow {
    /// Its mean velocity V, in m/s.
    MeanVelocity(f64),
    /// Its flow rate 4 l^2 V, in m^3/s.
    Rate(f64),
    /// The capsule's velocity, in m/s, from which the model tells V.
    CapsuleVelocity(f64),
}

/// The direction in which the liquid flows in the contour's coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Rising first coordinate.
    Right,
    /// Falling first coordinate.
    Left,
    /// Rising second coordinate.
    Up,
    /// Falling second coordinate.
    Down,
    /// The one of the four that fits best.
    Found,
}

impl Direction {
    /// The four.
    pub(crate) const ALL: [Self; 4] = [Self::Right, Self::Left, Self::Up, Self::Down];

    /// A vector of the contour's coordinates in those along and across the flow. A mirror image is as good: the outline
    /// is symmetric.
    pub(crate) fn turn(self, [x, y]: [f64; 2]) -> [f64; 2] {
        match self {
            Self::Right | Self::Found => [x, y],
            Self::Left => [-x, y],
            Self::Up => [y, x],
            Self::Down => [-y, x],
        }
    }

    /// The way back from [`turn`](Self::turn).
    pub(crate) fn back(self, [x, y]: [f64; 2]) -> [f64; 2] {
        match self {
            Self::Right | Self::Found => [x, y],
            Self::Left => [-x, y],
            Self::Up => [y, x],
            Self::Down => [y, -x],
        }
    }

    /// Its name in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Left => "left",
            Self::Up => "up",
            Self::Down => "down",
            Self::Found => "found",
        }
    }
}

/// A contour: points in order around the capsule, closed or open over at most a quarter of the way.
#[derive(Clone, Copy, Debug)]
pub struct Contour<'a> {
    /// The points, in um.
    pub points_um: &'a [[f64; 2]],
    /// Which way the liquid flows.
    pub direction: Direction,
    /// Standard deviation of a point's distance from the true outline, in um; estimated from the residuals if unknown.
    pub noise_um: Option<f64>,
}

/// A measured number and its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The number.
    pub value: f64,
    /// Its standard deviation, > 0.
    pub deviation: f64,
}

/// Numbers measured beside a contour, or instead of one, each if it is known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lengths {
    /// Axial length of the outline, in um.
    pub axial_length_um: Option<Measured>,
    /// Half the greatest width of the outline, in um.
    pub half_width_um: Option<Measured>,
    /// Depth of the dent behind, in um: 0 where there is none.
    pub rear_depth_um: Option<Measured>,
    /// Velocity of the capsule in the mean velocity of the liquid.
    pub velocity_ratio: Option<Measured>,
    /// Radius of the capsule at rest, in um.
    pub radius_um: Option<Measured>,
}

impl Lengths {
    /// The numbers in l, in the order of a shape's scalars.
    pub(crate) fn scaled(&self, half_width_um: f64) -> [Option<Measured>; SCALARS] {
        let length = |measured: Option<Measured>| {
            measured.map(|Measured { value, deviation }| Measured {
                value: value / half_width_um,
                deviation: deviation / half_width_um,
            })
        };
        let mut scaled = [None; SCALARS];
        scaled[LENGTH] = length(self.axial_length_um);
        scaled[HALF_WIDTH] = length(self.half_width_um);
        scaled[REAR_DEPTH] = length(self.rear_depth_um);
        scaled[VELOCITY] = self.velocity_ratio;
        scaled[RADIUS] = length(self.radius_um);
        scaled
    }

    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        self.scaled(1.0).iter().flatten().count()
    }
}

/// Priors of the systematic errors of the measurement: standard deviations around 0; 0 for an exact quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Priors {
    /// By how much the edge is drawn too far out, in um.
    pub edge_um: f64,
    /// Relative error of the scale (um per pixel) against the channel.
    pub scale: f64,
    /// Angle between the channel's axis and the contour's, in radians.
    pub tilt: f64,
    /// Factor of the model's own 95 % bound, 1 unless the model is to count as exact (0).
    pub model: f64,
}

impl Priors {
    /// An edge to a quarter of a pixel, a scale to 0.5 %, a tilt to 3 degrees.
    pub fn of_pixel(pixel_um: f64) -> Self {
        Self {
            edge_um: 0.25 * pixel_um,
            scale: 0.005,
            tilt: 0.05,
            model: 1.0,
        }
    }
}

/// All that was measured.
#[derive(Clone, Copy, Debug)]
pub struct Measurement<'a> {
    /// Channel and flow.
    pub setup: Setup,
    /// A contour, if there is one.
    pub contour: Option<Contour<'a>>,
    /// Points along the line at which the dent behind is seen through the capsule, in um, in the coordinates of the
    /// contour of a silhouette; empty if there is none.
    pub dent_line_um: &'a [[f64; 2]],
    /// Numbers.
    pub lengths: Lengths,
    /// Systematic errors.
    pub priors: Priors,
}

/// The most frames.
pub const MAX_FRAMES: usize = 8;

/// Contours of one capsule.
#[derive(Clone, Copy, Debug)]
pub struct Sequence<'a> {
    /// Channel and flow.
    pub setup: Setup,
    /// A contour for each frame, at most [`MAX_FRAMES`], with the direction of the flow.
    pub contours: &'a [Contour<'a>],
    /// Systematic errors.
    pub priors: Priors,
    /// Whether the capsule is steady in all frames; else the instant of each is fitted.
    pub steady: bool,
}
