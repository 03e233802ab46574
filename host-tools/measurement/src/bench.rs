//! One identification: from what is given to an answer.

use crate::answer::Answer;
use crate::error::MeasurementError;
use crate::outline::Outline;
use capsule_core::Model;
use capsule_identify::{
    Contour, Grid, Identification, Lengths, Measurement, Memory, Misfit, NODES_ROOM, Observable, Point, Priors, Setup,
    Shape, Shapes, Store, VELOCITY, identify_with_misfit,
};

/// Room for the points of a contour.
const MOST_POINTS: usize = 100_000;

/// All that is given beside an outline.
#[derive(Clone, Debug)]
pub struct Request {
    /// The kind of the outline, or of the one that the lengths belong to.
    pub observable: Observable,
    /// Channel and flow.
    pub setup: Setup,
    /// Numbers.
    pub lengths: Lengths,
    /// Standard deviation of a point of the contour, in um; none: from the residuals.
    pub noise_um: Option<f64>,
    /// Size of a pixel, in um, where the outline does not say it.
    pub pixel_um: Option<f64>,
    /// How well the edge is known, in pixels; none: as usual.
    pub edge_px: Option<f64>,
    /// How well the scale is known; none: as usual.
    pub scale_error: Option<f64>,
    /// Exposure of the picture, in ms.
    pub exposure_ms: Option<f64>,
}

impl Request {
    /// Size of a pixel, in um; where nothing is said of pixels, one for an edge to a four-hundredth of l.
    pub fn pixel_um(&self, outline: Option<&Outline>) -> f64 {
        let pixel_um = outline.and_then(|outline| outline.pixel_um).or(self.pixel_um);
        pixel_um.unwrap_or(self.setup.half_width_um / 100.0)
    }

    /// Priors of a picture's or contour's errors.
    pub fn priors(&self, pixel_um: f64) -> Priors {
        let usual = Priors::of_pixel(pixel_um);
        Priors {
            edge_um: self.edge_px.map_or(usual.edge_um, |edge| edge * pixel_um),
            scale: self.scale_error.unwrap_or(usual.scale),
            ..usual
        }
    }
}

/// The result of an identification.
#[derive(Debug)]
pub struct Solved {
    /// The best fit.
    pub found: Identification,
    /// The model's shape there.
    pub shape: Shape,
    /// How badly all others fit.
    pub misfit: Misfit,
    /// The same for people and programs.
    pub answer: Answer,
}

/// Memory of an identification.
#[derive(Debug)]
pub struct Bench {
    workspace: Box<Store>,
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    points: Vec<Point>,
}

impl Bench {
    /// Memory for a model's shapes.
    pub fn new(model: &Model<'_>) -> Self {
        Self {
            workspace: Box::new(Store::new()),
            positions: vec![[0.0; 3]; NODES_ROOM * model.mesh().nodes()],
            normals: vec![[0.0; 3]; model.mesh().sector_nodes().len()],
            points: Vec::new(),
        }
    }

    /// The starts of all identifications from one kind of outline.
    ///
    /// # Errors
    /// Those of the model, which must be one of capsules in the channel.
    pub fn grid(&mut self, model: &Model<'_>, observable: Observable) -> Result<Grid, MeasurementError> {
        let (mut shapes, _) = self.shapes(model, observable);
        Ok(Grid::new(&mut shapes)?)
    }

    /// Identifies a capsule. `warnings` are those that are known already.
    ///
    /// # Errors
    /// A measurement that cannot be.
    pub fn identify(
        &mut self,
        model: &Model<'_>,
        grid: &Grid,
        request: &Request,
        outline: Option<&Outline>,
        mut warnings: Vec<String>,
    ) -> Result<Solved, MeasurementError> {
        let pixel_um = request.pixel_um(outline);
        let measurement = Measurement {
            setup: request.setup,
            contour: outline.map(|outline| Contour {
                points_um: &outline.points_um,
                direction: outline.direction,
                noise_um: request.noise_um,
            }),
            dent_line_um: outline.map_or(&[], |outline| &outline.dent_line_um),
            lengths: request.lengths,
            priors: request.priors(pixel_um),
        };
        if let Some(contour) = &measurement.contour {
            let found = contour.points_um.len() + measurement.dent_line_um.len();
            if found > MOST_POINTS {
                let most = MOST_POINTS;
                return Err(MeasurementError::TooManyPoints { found, most });
            }
            contour.crossing()?;
            self.make_room(found);
        }
        let (mut shapes, room) = self.shapes(model, request.observable);
        let (found, misfit) = identify_with_misfit(&mut shapes, grid, &measurement, room)?;
        let shape = shapes.at([found.capillary_number.value.ln(), found.confinement.value])?;
        let blur_um = request
            .exposure_ms
            .map(|ms| shape.scalars[VELOCITY] * found.mean_velocity_m_s * 1e3 * ms);
        if let Some(blur) = blur_um.filter(|blur| *blur > pixel_um) {
            warnings.push(format!(
                "the capsule moves by {blur:.2} um in the exposure, more than a pixel ({pixel_um:.2} um): the outline \
                 is blurred along the flow"
            ));
        }
        let answer = Answer::new(model, &found, outline, blur_um, warnings);
        Ok(Solved {
            found,
            shape,
            misfit,
            answer,
        })
    }

    /// Makes room for the points of a contour.
    pub fn make_room(&mut self, points: usize) {
        self.points.resize(points, Point::default());
    }

    /// The model's outlines, and the room for points.
    pub fn shapes<'a, 'w>(
        &'w mut self,
        model: &'a Model<'a>,
        observable: Observable,
    ) -> (Shapes<'a, 'w>, &'w mut [Point]) {
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
