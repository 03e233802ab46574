//! `capsule-rom identify`: membrane properties from an outline, or from a few lengths.

use crate::identify_answer::Answer;
use crate::identify_contour::{self, Unit};
use crate::identify_plot::figure;
use crate::identify_sequence;
use crate::model::ModelFile;
use crate::outputs::Outputs;
use crate::print;
use anyhow::{Context, Result, bail, ensure};
use capsule_core::Model;
use capsule_identify::{
    Contour, Direction, Flow, Grid, Lengths, MAX_HALF, Measured, Measurement, Memory, NODES_ROOM, Observable, Point,
    Priors, Sequence, Setup, Shapes, Store, VELOCITY, identify,
};
use clap::{Args, ValueEnum};
use std::path::{Path, PathBuf};

#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Contour: a text file of points in order around the capsule, one a line
    #[arg(value_name = "CONTOUR")]
    contour: Option<PathBuf>,
    /// More contours of the same capsule, steady in all of them, as the first one is written
    #[arg(long, value_name = "FILE", num_args = 1.., requires = "contour", conflicts_with_all = ["plot", "exposure_ms"])]
    frames: Vec<PathBuf>,
    /// The frames show the capsule on its way to the steady state, at instants that are not known
    #[arg(long, requires = "frames")]
    transient: bool,
    /// Half the side of the square channel, in um; of both sides if they are known apart
    #[arg(long, value_delimiter = ',', required = true, value_name = "L[,L]")]
    half_width_um: Vec<f64>,
    #[command(flatten)]
    flow: FlowOptions,
    /// Viscosity of the liquid, in Pa s
    #[arg(long)]
    viscosity_pa_s: f64,
    /// The kind of the contour, or of the outline that the lengths belong to
    #[arg(short = 'o', long, value_enum)]
    observable: ObservableName,
    /// Unit of the contour's numbers [default: as its headings say]
    #[arg(long, value_enum)]
    unit: Option<Unit>,
    /// Size of a pixel, in um: the contour is in pixels unless --unit um
    #[arg(long)]
    pixel_um: Option<f64>,
    /// Direction of the flow in the contour's coordinates
    #[arg(long = "flow", value_enum, default_value = "found")]
    direction: DirectionName,
    /// Standard deviation of a point of the contour, in um [default: from the residuals]
    #[arg(long)]
    noise_um: Option<f64>,
    /// How well the edge is known, in pixels: standard deviation; 0 if it is exact
    #[arg(long, default_value_t = 0.25)]
    edge_px: f64,
    /// How well the scale is known: relative standard deviation
    #[arg(long, default_value_t = 0.005)]
    scale_error: f64,
    /// Exposure of the picture, in ms, to be told how far the capsule moves in it
    #[arg(long)]
    exposure_ms: Option<f64>,
    #[command(flatten)]
    lengths: LengthOptions,
    #[command(flatten)]
    model: ModelFile,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Plot the contour, the outline that was fitted and the residuals (.png or .svg)
    #[arg(long, value_name = "FILE", requires = "contour")]
    plot: Option<PathBuf>,
}

#[derive(Args)]
struct FlowOptions {
    /// Mean velocity of the liquid, in mm/s
    #[arg(long, required_unless_present_any = ["flow_rate_ul_min", "capsule_velocity_mm_s"])]
    velocity_mm_s: Option<f64>,
    /// Flow rate, in ul/min
    #[arg(long, conflicts_with = "velocity_mm_s")]
    flow_rate_ul_min: Option<f64>,
    /// Velocity of the capsule, in mm/s: beside that of the liquid it is a measurement more, alone it tells that
    #[arg(long)]
    capsule_velocity_mm_s: Option<f64>,
    /// Relative standard deviation of the ratio of both velocities
    #[arg(long, default_value_t = 0.02)]
    velocity_error: f64,
}

#[derive(Args)]
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

const EXAMPLES: &str = "\
Examples:
  capsule-rom identify o.csv --half-width-um 25 --velocity-mm-s 5 --viscosity-pa-s 1 -o midplane
  capsule-rom identify o.csv --half-width-um 25 --velocity-mm-s 5 --viscosity-pa-s 1 -o silhouette

Contours in pixels need --pixel-um. Lengths take the place of the file: --axial-length-um 49.2,0.2 \
--width-um 41.6,0.2 --rear-depth-um 8.5,0.3.

The capsule flows steadily along the axis of a square channel. Its membrane is neo-Hookean, the liquids inside and \
outside have the same viscosity. The answer is Ca = mu V / G_s, the confinement a/l, the radius a and the surface shear \
modulus G_s, each with the intervals that hold the true value in 68 and 95 of 100 cases, and a verdict: an answer \
without \"identified\" is none, or a bound. Nothing is extrapolated.";

#[derive(Clone, Copy, ValueEnum)]
enum ObservableName {
    /// The section through the axis, parallel to two walls
    Midplane,
    /// The outline of the projection, as bright field shows it
    Silhouette,
}

#[derive(Clone, Copy, ValueEnum)]
enum DirectionName {
    /// Rising x
    Right,
    /// Falling x
    Left,
    /// Rising y
    Up,
    /// Falling y
    Down,
    /// The one that fits best
    Found,
}

/// Sides that differ by more are no square: a share.
const SQUARE: f64 = 0.03;
/// Room for the points of a contour.
const MOST_POINTS: usize = 100_000;

pub fn run(options: &Options) -> Result<()> {
    let mut outputs = Outputs::default()
        .reads("CONTOUR", options.contour.as_deref())
        .reads("--model", options.model.path())
        .figure("--plot", options.plot.as_deref())
        .checked()?;
    let bytes = options.model.read()?;
    let model = options.model.open(&bytes)?;
    let half_width_um = half_width(&options.half_width_um)?;
    let contour = options.contour.as_deref().map(identify_contour::read).transpose()?;
    let mut pixel = options.pixel_um;
    let points = match &contour {
        Some(contour) => {
            let (points, known) =
                identify_contour::in_um(contour, options.unit, options.pixel_um).with_context(|| {
                    options
                        .contour
                        .as_deref()
                        .unwrap_or(Path::new(""))
                        .display()
                        .to_string()
                })?;
            pixel = known;
            points
        }
        None => Vec::new(),
    };
    // Where nothing is said of pixels, an edge to a four-hundredth of l.
    let pixel_um = pixel.unwrap_or(half_width_um / 100.0);
    let (flow, ratio) = options.flow.flow()?;
    let measurement = Measurement {
        setup: Setup {
            half_width_um,
            flow,
            viscosity_pa_s: options.viscosity_pa_s,
        },
        contour: contour.as_ref().map(|_| Contour {
            points_um: &points,
            direction: options.flow_direction(),
            noise_um: options.noise_um,
        }),
        lengths: options.lengths.lengths(ratio)?,
        priors: Priors {
            edge_um: options.edge_px * pixel_um,
            scale: options.scale_error,
            ..Priors::of_pixel(pixel_um)
        },
    };
    if let Some(contour) = &measurement.contour {
        ensure!(
            points.len() <= MOST_POINTS,
            "{} points: at most {MOST_POINTS} are taken",
            points.len()
        );
        contour.crossing()?;
    }
    let mut bench = Bench::new(&model, points.len());
    let (mut shapes, room) = bench.shapes(&model, options.observable());
    if let (Some(contour), false) = (measurement.contour, options.frames.is_empty()) {
        let more = options.frames.iter().map(|file| -> Result<_> {
            let read = identify_contour::read(file)?;
            let (points, _) = identify_contour::in_um(&read, options.unit, options.pixel_um)
                .with_context(|| file.display().to_string())?;
            Ok(points)
        });
        let more = more.collect::<Result<Vec<_>>>()?;
        let others = more.iter().map(|points_um| Contour { points_um, ..contour });
        let contours: Vec<Contour<'_>> = std::iter::once(contour).chain(others).collect();
        contours.iter().try_for_each(Contour::crossing)?;
        let sequence = Sequence {
            setup: measurement.setup,
            contours: &contours,
            priors: measurement.priors,
            steady: !options.transient,
        };
        return identify_sequence::run(&model, &mut shapes, &sequence, options.json);
    }
    let grid = Grid::new(&mut shapes)?;
    let found = identify(&mut shapes, &grid, &measurement, room)?;
    let shape = shapes.at([found.capillary_number.value.ln(), found.confinement.value])?;
    let blur_um = options
        .exposure_ms
        .map(|ms| shape.scalars[VELOCITY] * found.mean_velocity_m_s * 1e3 * ms);
    if let Some(blur) = blur_um.filter(|blur| *blur > pixel_um) {
        eprintln!(
            "warning: the capsule moves by {blur:.2} um in the exposure, more than a pixel ({pixel_um:.2} um): the \
             outline is blurred along the flow"
        );
    }
    let format = contour.as_ref().map(|contour| &*contour.format);
    let answer = Answer::new(&model, &found, blur_um, format);
    if let Some(file) = &options.plot {
        let curve: Vec<[f64; 2]> = (0..=8 * MAX_HALF)
            .map(|i| shape.curve.position(i as f64 / (8 * MAX_HALF) as f64))
            .collect();
        let figure = figure(&found, &points, &curve, half_width_um);
        outputs.write(file, |file| figure.save(file))?;
    }
    outputs.finish()?;
    if options.json {
        return print::json(&answer);
    }
    answer.print()
}

/// Half the side of a square that two sides are taken for.
fn half_width(sides: &[f64]) -> Result<f64> {
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
                eprintln!(
                    "warning: the sides of the channel differ by {:.1} %: the model's channel is square",
                    100.0 * apart
                );
            }
            Ok((a * b).sqrt())
        }
        _ => bail!("--half-width-um takes one number, or two for the two sides"),
    }
}

impl Options {
    fn observable(&self) -> Observable {
        match self.observable {
            ObservableName::Midplane => Observable::Midplane,
            ObservableName::Silhouette => Observable::Silhouette,
        }
    }

    fn flow_direction(&self) -> Direction {
        match self.direction {
            DirectionName::Right => Direction::Right,
            DirectionName::Left => Direction::Left,
            DirectionName::Up => Direction::Up,
            DirectionName::Down => Direction::Down,
            DirectionName::Found => Direction::Found,
        }
    }
}

impl FlowOptions {
    /// The flow, and the ratio of the velocities if both are given.
    fn flow(&self) -> Result<(Flow, Option<Measured>)> {
        let capsule = self.capsule_velocity_mm_s.map(|velocity| 1e-3 * velocity);
        let flow = match (self.velocity_mm_s, self.flow_rate_ul_min, capsule) {
            (Some(velocity), ..) => Flow::MeanVelocity(1e-3 * velocity),
            (None, Some(rate), _) => Flow::Rate(rate * 1e-9 / 60.0),
            (None, None, Some(capsule)) => return Ok((Flow::CapsuleVelocity(capsule), None)),
            (None, None, None) => bail!("the velocity of the flow is needed: --velocity-mm-s"),
        };
        let ratio = match (flow, capsule) {
            (Flow::MeanVelocity(velocity), Some(capsule)) => {
                let value = capsule / velocity;
                let deviation = self.velocity_error * value;
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

/// Memory of an identification.
struct Bench {
    workspace: Box<Store>,
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    points: Vec<Point>,
}

impl Bench {
    fn new(model: &Model<'_>, points: usize) -> Self {
        Self {
            workspace: Box::new(Store::new()),
            positions: vec![[0.0; 3]; NODES_ROOM * model.mesh().nodes()],
            normals: vec![[0.0; 3]; model.mesh().sector_nodes().len()],
            points: vec![Point::default(); points],
        }
    }

    fn shapes<'a, 'w>(&'w mut self, model: &'a Model<'a>, observable: Observable) -> (Shapes<'a, 'w>, &'w mut [Point]) {
        let memory = Memory {
            workspace: &mut self.workspace,
            positions: &mut self.positions,
            normals: &mut self.normals,
        };
        (
            Shapes::new(model, memory, observable, model.end_time()),
            &mut self.points,
        )
    }
}
