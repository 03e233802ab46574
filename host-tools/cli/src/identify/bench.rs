//! One identification: from what is given to an answer.

use super::answer::Answer;
use super::given::Given;
use super::outline::Outline;
use anyhow::{Result, ensure};
use capsule_core::Model;
use capsule_identify::{
    Contour, Grid, Identification, Measurement, Memory, NODES_ROOM, Observable, Point, Shape, Shapes, Store, VELOCITY,
    identify,
};

/// Room for the points of a contour.
const MOST_POINTS: usize = 100_000;

/// The result of an identification.
pub struct Solved {
    pub found: Identification,
    /// The model's shape there.
    pub shape: Shape,
    pub answer: Answer,
}

/// Memory of an identification.
pub struct Bench {
    workspace: Box<Store>,
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    points: Vec<Point>,
}

impl Bench {
    pub fn new(model: &Model<'_>) -> Self {
        Self {
            workspace: Box::new(Store::new()),
            positions: vec![[0.0; 3]; NODES_ROOM * model.mesh().nodes()],
            normals: vec![[0.0; 3]; model.mesh().sector_nodes().len()],
            points: Vec::new(),
        }
    }

    /// The starts of all identifications from one kind of outline.
    pub fn grid(&mut self, model: &Model<'_>, observable: Observable) -> Result<Grid> {
        let (mut shapes, _) = self.shapes(model, observable);
        Ok(Grid::new(&mut shapes)?)
    }

    /// Identifies a capsule. `warnings` are those that are known already.
    pub fn identify(
        &mut self,
        model: &Model<'_>,
        grid: &Grid,
        given: &Given,
        outline: Option<&Outline>,
        mut warnings: Vec<String>,
    ) -> Result<Solved> {
        let (setup, lengths) = given.setup(&mut warnings)?;
        // Where nothing is said of pixels, an edge to a four-hundredth of l.
        let pixel_um = outline.and_then(|outline| outline.pixel_um).or(given.pixel_um);
        let pixel_um = pixel_um.unwrap_or(setup.half_width_um / 100.0);
        let measurement = Measurement {
            setup,
            contour: outline.map(|outline| Contour {
                points_um: &outline.points_um,
                direction: outline.direction,
                noise_um: given.noise_um,
            }),
            lengths,
            priors: given.priors(pixel_um),
        };
        if let Some(contour) = &measurement.contour {
            let count = contour.points_um.len();
            ensure!(count <= MOST_POINTS, "{count} points: at most {MOST_POINTS} are taken");
            contour.crossing()?;
            self.points.resize(count, Point::default());
        }
        let (mut shapes, room) = self.shapes(model, given.observable());
        let found = identify(&mut shapes, grid, &measurement, room)?;
        let shape = shapes.at([found.capillary_number.value.ln(), found.confinement.value])?;
        let blur_um = given
            .exposure_ms
            .map(|ms| shape.scalars[VELOCITY] * found.mean_velocity_m_s * 1e3 * ms);
        if let Some(blur) = blur_um.filter(|blur| *blur > pixel_um) {
            warnings.push(format!(
                "the capsule moves by {blur:.2} um in the exposure, more than a pixel ({pixel_um:.2} um): the outline \
                 is blurred along the flow"
            ));
        }
        let answer = Answer::new(model, &found, outline, blur_um, warnings);
        Ok(Solved { found, shape, answer })
    }

    /// The model's outlines, and memory for points.
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
