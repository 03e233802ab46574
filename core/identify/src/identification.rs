//! The answer: what was found, how sure it is, and in words whether it is an answer at all.

use crate::domain::Side;
use crate::measurement::Direction;
use crate::profile::Interval;
use core::fmt;

/// A quantity with its intervals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The best value.
    pub value: f64,
    /// Interval of the profile likelihood that holds the true value in 68 of 100 cases.
    pub interval_68: Interval,
    /// The same in 95 of 100 cases.
    pub interval_95: Interval,
}

/// The kind of answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// One answer, with an interval that is closed on both sides.
    Identified,
    /// The interval of Ca or a/l reaches the edge of the sampled domain: beyond it nothing is known.
    Bounded,
    /// Another place of the domain fits as well.
    SeveralSolutions,
    /// The best fit lies at the edge of the domain, and the data ask for more.
    OutsideDomain,
    /// The data do not determine both Ca and a/l.
    Undetermined,
    /// The outline differs from that of any such capsule, by more than noise and the model's error.
    NotSuchACapsule,
    /// The scale or the edge would have to be farther off than was said to be possible.
    ScaleInconsistent,
    /// Several frames differ by more than their noise.
    FramesDiffer,
}

impl Verdict {
    /// Its name in JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Identified => "identified",
            Self::Bounded => "bounded-on-one-side",
            Self::SeveralSolutions => "several-solutions",
            Self::OutsideDomain => "outside-domain",
            Self::Undetermined => "undetermined",
            Self::NotSuchACapsule => "not-such-a-capsule",
            Self::ScaleInconsistent => "scale-or-channel-inconsistent",
            Self::FramesDiffer => "frames-differ",
        }
    }

    /// The meaning and a remedy, in a sentence; `law` is the model's membrane law.
    pub fn text(self, law: &str) -> impl fmt::Display + use<'_> {
        fmt::from_fn(move |f| match self {
            Self::Identified => f.write_str("one answer, with closed intervals"),
            Self::Bounded => f.write_str(
                "the interval reaches the edge of the sampled domain, beyond which nothing is known: it is a bound",
            ),
            Self::SeveralSolutions => f.write_str(
                "another capsule fits as well, beyond the border at which the rear buckles: measure the rear's depth, \
                 the radius or the velocity too",
            ),
            Self::OutsideDomain => f.write_str(
                "the best fit lies at the edge of the sampled domain and the data ask for more: the numbers are no \
                 answer",
            ),
            Self::Undetermined => f.write_str("the data do not determine Ca and a/l: measure more"),
            Self::NotSuchACapsule => write!(
                f,
                "the outline differs from that of any capsule with a {law} membrane on the axis of a square channel \
                 by more than its noise and the model's error: the numbers are no answer"
            ),
            Self::ScaleInconsistent => f.write_str(
                "the scale or the edge would have to be three deviations off: check scale, half width and threshold",
            ),
            Self::FramesDiffer => f.write_str(
                "the frames differ by more than their noise: they do not show one capsule, or it is not steady",
            ),
        })
    }
}

/// Another solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alternative {
    /// Ca.
    pub capillary_number: f64,
    /// a/l.
    pub confinement: f64,
    /// By how much its sum of squares is greater.
    pub rise: f64,
}

/// Where the model's outline lies in the contour's coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    pub(crate) direction: Direction,
    pub(crate) half_width_um: f64,
    /// The middle of the contour, in l.
    pub(crate) middle: [f64; 2],
    pub(crate) shift: [f64; 2],
    pub(crate) tilt: f64,
    pub(crate) scale_error: f64,
}

impl Frame {
    /// A point of the frame of the capsule's centroid, in l, in the contour's coordinates, in um.
    pub fn place_um(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let grown = 1.0 + self.scale_error;
        let [x, y] = [(x + self.shift[0]) / grown, (y + self.shift[1]) / grown];
        let (cos, sin) = (libm::cos(self.tilt), libm::sin(self.tilt));
        let [u, v] = [cos * x - sin * y + self.middle[0], cos * y + sin * x + self.middle[1]];
        self.direction.back([u, v]).map(|x| x * self.half_width_um)
    }

    /// A point of the contour, in um, in the frame of the capsule's centroid, in l: the way back from
    /// [`place_um`](Self::place_um).
    pub fn place(&self, point_um: [f64; 2]) -> [f64; 2] {
        let [u, v] = self.direction.turn(point_um.map(|x| x / self.half_width_um));
        let [x, y] = [u - self.middle[0], v - self.middle[1]];
        let (cos, sin) = (libm::cos(self.tilt), libm::sin(self.tilt));
        let grown = 1.0 + self.scale_error;
        [
            grown * (cos * x + sin * y) - self.shift[0],
            grown * (cos * y - sin * x) - self.shift[1],
        ]
    }
}

/// The result of an identification.
#[derive(Clone, Copy, Debug)]
pub struct Identification {
    /// Capillary number mu V / G_s.
    pub capillary_number: Estimate,
    /// a/l.
    pub confinement: Estimate,
    /// Radius a, in um.
    pub radius_um: Estimate,
    /// Surface shear modulus G_s, in N/m.
    pub shear_modulus_n_per_m: Estimate,
    /// Mean velocity of the liquid, in m/s: as given, or as the model tells it from the capsule's.
    pub mean_velocity_m_s: f64,
    /// Standard deviations of ln Ca and a/l, from the curvature of the sum of squares at its least.
    pub deviations: [f64; 2],
    /// Correlation of the errors of ln Ca and a/l.
    pub correlation: f64,
    /// Sum of the squares of the points' residuals over their noise.
    pub chi_squared: f64,
    /// Points less what is fitted to them.
    pub degrees_of_freedom: f64,
    /// Root of the mean square of the residuals, in um.
    pub residual_um: f64,
    /// That of the points of a dent line, if there is one.
    pub dent_line_residual_um: Option<f64>,
    /// The noise of a point that the intervals count with, in um.
    pub noise_um: f64,
    /// How many neighbouring residuals count as one, because they err alike.
    pub correlated_points: f64,
    /// How far the edge seems to be drawn too far out, in um.
    pub edge_um: f64,
    /// Relative error of the scale that the outline asks for.
    pub scale_error: f64,
    /// Angle of the channel's axis, in radians.
    pub tilt: f64,
    /// The direction of the flow.
    pub direction: Direction,
    /// Where the model's outline lies in the contour's coordinates.
    pub frame: Frame,
    /// How much of the model's error the outline asks for: the sum of squares of its 24 cosines' coefficients, each in
    /// its standard deviation.
    pub structure: f64,
    /// The side of the border of buckling.
    pub side: Side,
    /// Another place that fits as well.
    pub alternative: Option<Alternative>,
    /// Kind of answer.
    pub verdict: Verdict,
    /// How many outlines of the model were computed.
    pub evaluations: u32,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_leads_there_and_back() {
        for direction in Direction::ALL {
            let frame = Frame {
                direction,
                half_width_um: 25.0,
                middle: [3.0, -1.0],
                shift: [0.04, 0.01],
                tilt: 0.03,
                scale_error: 0.004,
            };
            // To the front, seen in the contour's coordinates: the way of the flow, but for the tilt.
            let [from, to] = [0.0, 1.0].map(|x| frame.place_um([x, 0.0]));
            let [x, y] = [0, 1].map(|d| (to[d] - from[d]) / 25.0);
            let along = match direction {
                Direction::Right | Direction::Found => x,
                Direction::Left => -x,
                Direction::Up => y,
                Direction::Down => -y,
            };
            assert!((along - 0.03_f64.cos() / 1.004).abs() < 1e-12, "{direction:?} {along}");
            let place = [0.7, -0.4];
            let [x, y] = frame.place(frame.place_um(place));
            assert!(
                (x - place[0]).abs() < 1e-12 && (y - place[1]).abs() < 1e-12,
                "{direction:?}"
            );
        }
    }
}
