//! Identification of a capsule from an outline or a few lengths.

use crate::MeasurementError;
use crate::model::Model;
use capsule_contour::text::Unit;
use capsule_identify::{Direction, Flow, Grid, Lengths, MAX_HALF, Measured, Observable, Setup};
use capsule_measurement::{Bench, Outline, Request, Said};
use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::fmt::Display;
use std::path::PathBuf;

/// The starts of the fits to one kind of outline: made once for a model.
#[pyclass(frozen)]
pub struct Identifier {
    model: Py<Model>,
    observable: Observable,
    grid: Grid,
}

/// The measured outline.
#[derive(FromPyObject)]
enum Contour<'py> {
    /// Points, in um or in pixels.
    Points(PyReadonlyArray2<'py, f64>),
    /// A text or a picture: its name and its bytes.
    File(PathBuf, Vec<u8>),
}

/// Value and standard deviation.
type Number = Option<(f64, f64)>;

#[pymethods]
impl Identifier {
    /// For "midplane" or "silhouette".
    #[new]
    fn new(py: Python<'_>, model: Py<Model>, observable: &str) -> PyResult<Self> {
        let observable = match observable {
            "midplane" => Observable::Midplane,
            "silhouette" => Observable::Silhouette,
            other => return Err(unknown("observable", other, "\"midplane\" or \"silhouette\"")),
        };
        let shared = model.get().shared.clone();
        let grid = py.detach(|| Bench::new(shared.core()).grid(shared.core(), observable));
        Ok(Self {
            model,
            observable,
            grid: grid.map_err(refused)?,
        })
    }

    /// The answer as JSON, as the command writes it, and the outline of the best fit, in um, closed. `flow` is a kind
    /// and a number: ("mean_velocity", mm/s), ("rate", ul/min) or ("capsule_velocity", mm/s).
    #[expect(clippy::too_many_arguments, reason = "keywords of one Python function")]
    fn identify<'py>(
        &self,
        py: Python<'py>,
        contour: Option<Contour<'py>>,
        dent_line: Option<Contour<'py>>,
        half_width_um: f64,
        flow: (&str, f64),
        viscosity_pa_s: f64,
        unit: Option<&str>,
        pixel_um: Option<f64>,
        direction: &str,
        capsule: Option<usize>,
        noise_um: Option<f64>,
        edge_px: Option<f64>,
        scale_error: Option<f64>,
        lengths: [Number; 5],
    ) -> PyResult<(String, Bound<'py, PyArray2<f64>>)> {
        let setup = Setup {
            half_width_um,
            flow: match flow {
                ("mean_velocity", velocity) => Flow::MeanVelocity(1e-3 * velocity),
                ("rate", rate) => Flow::Rate(rate * 1e-9 / 60.0),
                (_, velocity) => Flow::CapsuleVelocity(1e-3 * velocity),
            },
            viscosity_pa_s,
        };
        let said = Said {
            half_width_um,
            unit: match unit {
                None => None,
                Some("um") => Some(Unit::Um),
                Some("px") => Some(Unit::Px),
                Some(other) => return Err(unknown("unit", other, "\"um\" or \"px\"")),
            },
            pixel_um,
            direction: direction_of(direction)?,
            capsule,
            edge: None,
            background: None,
        };
        let [axial_length_um, half_width, rear_depth_um, radius_um, velocity_ratio] =
            lengths.map(|number| number.map(|(value, deviation)| Measured { value, deviation }));
        let request = Request {
            observable: self.observable,
            setup,
            lengths: Lengths {
                axial_length_um,
                half_width_um: half_width,
                rear_depth_um,
                radius_um,
                velocity_ratio,
            },
            noise_um,
            pixel_um,
            edge_px,
            scale_error,
            exposure_ms: None,
        };
        let mut warnings = Vec::new();
        let mut outline = match contour {
            None => None,
            Some(Contour::File(name, bytes)) => {
                Some(Outline::read(&name, &bytes, &said, &mut warnings).map_err(refused)?)
            }
            Some(Contour::Points(points)) => Some(Outline {
                points_um: in_um(&points, &said)?,
                dent_line_um: Vec::new(),
                pixel_um: said.pixel_um,
                direction: said.direction,
                note: format!("{} points of an array", points.as_array().nrows()),
                seen: None,
            }),
        };
        match (&mut outline, dent_line) {
            (_, None) => {}
            (None, Some(_)) => return Err(refused("a dent line goes with a contour")),
            (Some(outline), Some(Contour::File(_, bytes))) => {
                outline.read_dent_line(&bytes, said.unit).map_err(refused)?;
            }
            (Some(outline), Some(Contour::Points(points))) => outline.dent_line_um = in_um(&points, &said)?,
        }
        let shared = &self.model.get().shared;
        let solved = py.detach(|| {
            Bench::new(shared.core()).identify(shared.core(), &self.grid, &request, outline.as_ref(), warnings)
        });
        let solved = solved.map_err(refused)?;
        let half: Vec<[f64; 2]> = (0..=8 * MAX_HALF)
            .map(|i| solved.shape.curve.position(i as f64 / (8 * MAX_HALF) as f64))
            .collect();
        let mirrored = half.iter().rev().map(|[x, y]| [*x, -y]);
        let closed = half.iter().copied().chain(mirrored);
        let fit: Vec<Vec<f64>> = closed
            .map(|point| solved.found.frame.place_um(point).to_vec())
            .collect();
        let answer = serde_json::to_string(&solved.answer).map_err(|error| PyValueError::new_err(error.to_string()))?;
        Ok((answer, PyArray2::from_vec2(py, &fit)?))
    }
}

/// Points that are given in um or in pixels, in um.
fn in_um(points: &PyReadonlyArray2<'_, f64>, said: &Said) -> PyResult<Vec<[f64; 2]>> {
    let points = points.as_array();
    let scale = match (said.unit, said.pixel_um) {
        (Some(Unit::Um), _) | (None, None) => 1.0,
        (_, Some(pixel_um)) => pixel_um,
        (Some(Unit::Px), None) => return Err(refused("points in pixels need pixel_um, the size of a pixel in um")),
    };
    if points.ncols() != 2 {
        let (rows, columns) = points.dim();
        return Err(refused(format!(
            "the points have the shape ({rows}, {columns}), they must be (points, 2)"
        )));
    }
    let rows = points.rows().into_iter();
    Ok(rows.map(|row| [scale * row[0], scale * row[1]]).collect())
}

fn direction_of(name: &str) -> PyResult<Direction> {
    Ok(match name {
        "right" => Direction::Right,
        "left" => Direction::Left,
        "up" => Direction::Up,
        "down" => Direction::Down,
        "found" => Direction::Found,
        other => {
            return Err(unknown(
                "flow",
                other,
                "\"right\", \"left\", \"up\", \"down\" or \"found\"",
            ));
        }
    })
}

fn unknown(what: &str, found: &str, expected: &str) -> PyErr {
    PyValueError::new_err(format!("{what} {found:?} is unknown: {expected}"))
}

fn refused(error: impl Display) -> PyErr {
    MeasurementError::new_err(error.to_string())
}
