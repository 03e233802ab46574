//! Identifications whose answers the firmware and the host must agree on, bit for bit.

use capsule_core::Model;
use capsule_identify::{
    Contour, Direction, Flow, Grid, Identification, IdentifyError, Lengths, Measured, Measurement, Memory, Observable,
    Point, Priors, Setup, Shapes, Store, identify,
};

/// Half the side of the channel, in um, and the size of a pixel.
const HALF_WIDTH_UM: f64 = 25.0;
const PIXEL_UM: f64 = 0.25;

/// Points of an outline.
pub const POINTS: usize = 64;

/// A measurement.
#[derive(Clone, Copy)]
pub enum Task {
    /// Length, width and depth of the dent.
    Lengths,
    /// The outline.
    Outline,
}

/// The tasks, with their names in the figures.
pub const TASKS: [(&str, Task); 2] = [("identify_lengths", Task::Lengths), ("identify_outline", Task::Outline)];

/// The storage of an identification: static on the board.
pub struct Storage {
    workspace: Store,
    points: [Point; POINTS],
    outline_um: [[f64; 2]; POINTS],
}

impl Storage {
    pub fn new() -> Self {
        Self {
            workspace: Store::new(),
            points: [Point::default(); POINTS],
            outline_um: [[0.0; 2]; POINTS],
        }
    }

    /// The table of outlines from which fits start.
    pub fn grid(&mut self, model: &Model<'_>) -> Result<Grid, IdentifyError> {
        Ok(Grid::new(&mut shapes(model, &mut self.workspace))?)
    }

    /// Puts the outline of the model's capsule at (0.06, 0.85) into the storage, as a camera sees it.
    pub fn draw(&mut self, model: &Model<'_>) -> Result<(), IdentifyError> {
        let shape = shapes(model, &mut self.workspace).at([libm::log(0.06), 0.85])?;
        let half = POINTS / 2;
        for (i, point) in self.outline_um.iter_mut().enumerate() {
            // Around the capsule: along one half, and back along its mirror image.
            let (place, side) = if i < half { (i, 1.0) } else { (POINTS - i, -1.0) };
            let [x, y] = shape.curve.position(place as f64 / half as f64);
            *point = [HALF_WIDTH_UM * x, side * HALF_WIDTH_UM * y];
        }
        Ok(())
    }

    /// Answers a task.
    pub fn identify(&mut self, model: &Model<'_>, grid: &Grid, task: Task) -> Result<Identification, IdentifyError> {
        let setup = Setup {
            half_width_um: HALF_WIDTH_UM,
            flow: Flow::MeanVelocity(5e-3),
            viscosity_pa_s: 0.8,
        };
        let length = |value| Some(Measured { value, deviation: 0.2 });
        let (contour, lengths) = match task {
            Task::Lengths => {
                let lengths = Lengths {
                    axial_length_um: length(49.2),
                    half_width_um: length(20.8),
                    rear_depth_um: length(8.5),
                    ..Lengths::default()
                };
                (None, lengths)
            }
            Task::Outline => {
                let contour = Contour {
                    points_um: &self.outline_um,
                    direction: Direction::Right,
                    noise_um: None,
                };
                (Some(contour), Lengths::default())
            }
        };
        let measurement = Measurement {
            setup,
            contour,
            dent_line_um: &[],
            lengths,
            priors: Priors::of_pixel(PIXEL_UM),
        };
        identify(
            &mut shapes(model, &mut self.workspace),
            grid,
            &measurement,
            &mut self.points,
        )
    }
}

fn shapes<'a, 'w>(model: &'a Model<'a>, workspace: &'w mut Store) -> Shapes<'a, 'w> {
    let memory = Memory {
        workspace,
        positions: &mut [],
        normals: &mut [],
    };
    Shapes::new(model, memory, Observable::Midplane, model.end_time())
}
