//! Inputs of a measurement: options of the command, columns of a batch's table.

use anyhow::{Result, bail, ensure};
use capsule_contour::text::Unit;
use capsule_identify::{Direction, Flow, Lengths, Measured, Observable, Setup};
use capsule_measurement::Request;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Options that a batch takes for all its rows; a row may say otherwise.
#[derive(Args, Clone, Debug, Default)]
pub struct Given {
    /// Half the side of the square channel, in um; of both sides if they are known apart
    #[arg(long, value_delimiter = ',', value_name = "L[,L]")]
    half_width_um: Vec<f64>,
    #[command(flatten)]
    flow: FlowOptions,
    /// Viscosity of the liquid, in Pa s
    #[arg(long)]
    viscosity_pa_s: Option<f64>,
    /// The kind of the contour, or of the outline that the lengths belong to
    #[arg(short = 'o', long, value_enum)]
    observable: Option<ObservableName>,
    /// Unit of the contour's numbers [default: as its headings say]
    #[arg(long, value_enum)]
    unit: Option<UnitName>,
    /// Size of a pixel, in um: a contour is in pixels unless --unit um [default for pictures: as the walls tell]
    #[arg(long)]
    pub pixel_um: Option<f64>,
    /// Picture of the empty channel, by the same camera, to be taken away from the picture
    #[arg(long, value_name = "PICTURE")]
    pub background: Option<PathBuf>,
    /// Which of several capsules in a picture: 1 is the leftmost, or the uppermost in a vertical channel. Which event
    /// of an RT-DC file
    #[arg(long, value_name = "NUMBER")]
    pub capsule: Option<usize>,
    /// Criterion for the edge in a picture [default: gradient, half-level in masks]
    #[arg(long, value_enum)]
    edge: Option<EdgeName>,
    /// Cross-section of the channel: the model's is square
    #[arg(long, value_enum)]
    channel: Option<ChannelName>,
    /// Direction of the flow [default: the one that fits best]
    #[arg(long = "flow", value_enum)]
    direction: Option<DirectionName>,
    /// Standard deviation of a point of the contour, in um [default: from the residuals]
    #[arg(long)]
    pub noise_um: Option<f64>,
    /// How well the edge is known, in pixels: standard deviation; 0 if it is exact [default: 0.25]
    #[arg(long)]
    edge_px: Option<f64>,
    /// How well the scale is known: relative standard deviation [default: 0.005]
    #[arg(long)]
    scale_error: Option<f64>,
    /// Exposure of the picture, in ms, to be told how far the capsule moves in it
    #[arg(long)]
    pub exposure_ms: Option<f64>,
    #[command(flatten)]
    lengths: LengthOptions,
}

#[derive(Args, Clone, Debug, Default)]
struct FlowOptions {
    /// Mean velocity of the liquid, in mm/s
    #[arg(long)]
    velocity_mm_s: Option<f64>,
    /// Flow rate, in ul/min
    #[arg(long)]
    flow_rate_ul_min: Option<f64>,
    /// Velocity of the capsule, in mm/s: beside that of the liquid it is a measurement more, alone it tells that
    #[arg(long)]
    capsule_velocity_mm_s: Option<f64>,
    /// Relative standard deviation of the ratio of both velocities [default: 0.02]
    #[arg(long)]
    velocity_error: Option<f64>,
}

#[derive(Args, Clone, Debug, Default)]
struct LengthOptions {
    /// Axial length of the outline and its standard deviation, in um
    #[arg(long, value_name = "VALUE,DEVIATION", value_delimiter = ',', num_args = 1)]
    axial_length_um: Vec<f64>,
    /// Greatest width of the outline (both sides) and its standard deviation, in um
    #[arg(long, value_name = "VALUE,DEVIATION", value_delimiter = ',', num_args = 1)]
    width_um: Vec<f64>,
    /// Depth of the dent behind, from the rearmost place to the membrane on the axis, and its standard deviation, in um
    #[arg(long, value_name = "VALUE,DEVIATION", value_delimiter = ',', num_args = 1)]
    rear_depth_um: Vec<f64>,
    /// Radius of the capsule at rest, if it is known, and its standard deviation, in um
    #[arg(long, value_name = "VALUE,DEVIATION", value_delimiter = ',', num_args = 1)]
    radius_um: Vec<f64>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ObservableName {
    /// The section through the axis, parallel to two walls
    Midplane,
    /// The outline of the projection, as bright field shows it
    Silhouette,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum UnitName {
    /// Micrometres
    Um,
    /// Pixels
    Px,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum EdgeName {
    /// Where the brightness changes most
    Gradient,
    /// Half way between the levels on both sides
    HalfLevel,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum ChannelName {
    /// A square
    Square,
    /// A tube: nothing is identified
    Round,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum DirectionName {
    /// To the right in a picture, rising x in a contour
    Right,
    /// To the left; falling x
    Left,
    /// Upward in a picture; rising y in a contour
    Up,
    /// Downward; falling y
    Down,
    /// The one that fits best
    Found,
}

/// Sides that differ by more are no square: a share.
const SQUARE: f64 = 0.03;

impl Given {
    /// The first required input that is missing.
    pub fn missing(&self) -> Option<&'static str> {
        let flow = &self.flow;
        let flows = [flow.velocity_mm_s, flow.flow_rate_ul_min, flow.capsule_velocity_mm_s];
        [
            ("--half-width-um", self.half_width_um.is_empty()),
            (
                "--velocity-mm-s, --flow-rate-ul-min or --capsule-velocity-mm-s",
                flows.iter().all(Option::is_none),
            ),
            ("--viscosity-pa-s", self.viscosity_pa_s.is_none()),
            ("--observable", self.observable.is_none()),
        ]
        .into_iter()
        .find_map(|(name, missing)| missing.then_some(name))
    }

    /// Channel, flow, liquid and lengths, with warnings in words.
    pub fn setup(&self, warnings: &mut Vec<String>) -> Result<(Setup, Lengths)> {
        if let Some(missing) = self.missing() {
            bail!("{missing} is not given");
        }
        ensure!(
            self.channel != Some(ChannelName::Round),
            "the channel is round and the model's is square: in a tube a capsule of the same Ca and a/l differs"
        );
        let half_width_um = half_width(&self.half_width_um, warnings)?;
        let (flow, ratio) = self.flow.flow()?;
        let setup = Setup {
            half_width_um,
            flow,
            viscosity_pa_s: self.viscosity_pa_s.unwrap_or(f64::NAN),
        };
        Ok((setup, self.lengths.lengths(ratio)?))
    }

    /// Whether the cross-section of the channel is stated.
    pub fn says_channel(&self) -> bool {
        self.channel.is_some()
    }

    /// All that is given beside an outline, with warnings in words.
    pub fn request(&self, warnings: &mut Vec<String>) -> Result<Request> {
        let (setup, lengths) = self.setup(warnings)?;
        Ok(Request {
            observable: self.observable(),
            setup,
            lengths,
            noise_um: self.noise_um,
            pixel_um: self.pixel_um,
            edge_px: self.edge_px,
            scale_error: self.scale_error,
            exposure_ms: self.exposure_ms,
        })
    }

    /// The kind of the outline.
    pub fn observable(&self) -> Observable {
        match self.observable {
            Some(ObservableName::Midplane) => Observable::Midplane,
            Some(ObservableName::Silhouette) | None => Observable::Silhouette,
        }
    }

    /// The unit of a contour.
    pub fn unit(&self) -> Option<Unit> {
        self.unit.map(|unit| match unit {
            UnitName::Um => Unit::Um,
            UnitName::Px => Unit::Px,
        })
    }

    /// Criterion for the edge in a picture.
    pub fn edge(&self) -> Option<capsule_contour::Edge> {
        self.edge.map(|edge| match edge {
            EdgeName::Gradient => capsule_contour::Edge::Gradient,
            EdgeName::HalfLevel => capsule_contour::Edge::HalfLevel,
        })
    }

    /// The direction of the flow, upward as in a contour.
    pub fn direction(&self) -> Direction {
        match self.direction {
            Some(DirectionName::Right) => Direction::Right,
            Some(DirectionName::Left) => Direction::Left,
            Some(DirectionName::Up) => Direction::Up,
            Some(DirectionName::Down) => Direction::Down,
            Some(DirectionName::Found) | None => Direction::Found,
        }
    }

    /// The first option that is for pictures alone.
    pub fn of_pictures(&self) -> Option<&'static str> {
        [
            ("--background", self.background.is_some()),
            ("--capsule", self.capsule.is_some()),
            ("--edge", self.edge.is_some()),
        ]
        .into_iter()
        .find_map(|(name, given)| given.then_some(name))
    }
}

/// Half the side of a square that two sides are taken for.
fn half_width(sides: &[f64], warnings: &mut Vec<String>) -> Result<f64> {
    for side in sides {
        ensure!(
            side.is_finite() && *side > 0.0,
            "--half-width-um {side}: it must be a positive number"
        );
    }
    match *sides {
        [side] => Ok(side),
        [a, b] => {
            let apart = (a - b).abs() / a.max(b);
            if apart > SQUARE {
                warnings.push(format!(
                    "the sides of the channel differ by {:.1} %: the model's channel is square",
                    100.0 * apart
                ));
            }
            Ok((a * b).sqrt())
        }
        _ => bail!("--half-width-um takes one number, or two for the two sides"),
    }
}

impl FlowOptions {
    /// The flow, and the ratio of the velocities if both are given.
    fn flow(&self) -> Result<(Flow, Option<Measured>)> {
        let capsule = self.capsule_velocity_mm_s.map(|velocity| 1e-3 * velocity);
        let flow = match (self.velocity_mm_s, self.flow_rate_ul_min, capsule) {
            (Some(_), Some(_), _) => bail!("--velocity-mm-s and --flow-rate-ul-min are given: one of them is enough"),
            (Some(velocity), ..) => Flow::MeanVelocity(1e-3 * velocity),
            (None, Some(rate), _) => Flow::Rate(rate * 1e-9 / 60.0),
            (None, None, Some(capsule)) => return Ok((Flow::CapsuleVelocity(capsule), None)),
            (None, None, None) => bail!("the velocity of the flow is needed: --velocity-mm-s"),
        };
        let ratio = match (flow, capsule) {
            (Flow::MeanVelocity(velocity), Some(capsule)) => {
                let value = capsule / velocity;
                let deviation = self.velocity_error.unwrap_or(0.02) * value;
                Some(Measured { value, deviation })
            }
            (_, Some(_)) => bail!("--capsule-velocity-mm-s beside a flow rate: give --velocity-mm-s in its place"),
            _ => None,
        };
        Ok((flow, ratio))
    }
}

impl LengthOptions {
    fn lengths(&self, velocity_ratio: Option<Measured>) -> Result<Lengths> {
        let one = |name: &str, given: &[f64]| match *given {
            [] => Ok(None),
            [value, deviation] => Ok(Some(Measured { value, deviation })),
            _ => bail!("--{name} takes a value and its standard deviation, such as 31.2,0.2"),
        };
        let half = |width: Measured| Measured {
            value: 0.5 * width.value,
            deviation: 0.5 * width.deviation,
        };
        Ok(Lengths {
            axial_length_um: one("axial-length-um", &self.axial_length_um)?,
            half_width_um: one("width-um", &self.width_um)?.map(half),
            rear_depth_um: one("rear-depth-um", &self.rear_depth_um)?,
            radius_um: one("radius-um", &self.radius_um)?,
            velocity_ratio,
        })
    }
}
