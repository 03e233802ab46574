//! The answers of a batch, written into flat arrays: queries, instants, then the numbers of an answer.

use crate::batch::Queries;
use crate::model::Model;
use capsule_core::mechanics::Deformation;
use capsule_core::{EvaluateError, Frame, Instant, Nodes, Scene, silhouette};
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyReadwriteArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Times as the core takes them.
fn singles(times: &PyReadonlyArray1<'_, f64>) -> Vec<f32> {
    times.as_array().iter().map(|t| *t as f32).collect()
}

fn frame_of(name: &str) -> PyResult<Frame> {
    match name {
        "laboratory" => Ok(Frame::Laboratory),
        "centroid" => Ok(Frame::Centroid),
        other => Err(PyValueError::new_err(format!(
            "frame {other:?} is unknown: \"laboratory\" or \"centroid\""
        ))),
    }
}

/// Scalars of a deformation that `fields` returns, in its order.
fn scalars(at: &Deformation<f32>) -> [f32; 6] {
    let ([stretch_1, stretch_2], [tension_1, tension_2]) = (at.stretches(), at.tensions());
    [
        stretch_1,
        stretch_2,
        at.area_dilation(),
        tension_1,
        tension_2,
        at.energy_density(),
    ]
}

/// Queries of a model and their answers.
#[pyclass(frozen)]
pub struct Batch {
    queries: Queries,
}

#[pymethods]
impl Batch {
    /// Queries from rows of parameters. `method` is "direct" or "paper"; the model's if none is given.
    #[new]
    fn new(
        model: &Model,
        parameters: PyReadonlyArray2<'_, f64>,
        method: Option<&str>,
        extrapolate: bool,
        skip_refused: bool,
    ) -> PyResult<Self> {
        let queries = Queries::new(model, parameters, method, extrapolate, skip_refused)?;
        Ok(Self { queries })
    }

    /// Where the parameters of each query lie: inside, beyond-steady-limit, far-from-samples or outside.
    fn domains(&self, py: Python<'_>) -> Vec<&'static str> {
        self.queries.domains(py)
    }

    /// Axial length, half width, half diagonal, rear depth, velocity, centroid.
    fn observables(
        &self,
        py: Python<'_>,
        times: PyReadonlyArray1<'_, f64>,
        out: PyReadwriteArray1<'_, f32>,
    ) -> PyResult<()> {
        self.queries.fill(py, &singles(&times), 6, out, |instant, _, out| {
            let found = instant.observables()?;
            out.copy_from_slice(&[
                found.axial_length,
                found.half_width,
                found.half_diagonal,
                found.rear_depth,
                found.velocity,
                found.centroid,
            ]);
            Ok(())
        })
    }

    /// One number: "volume", "expected_error" or "error_bound" (NaN outside the sampled domain).
    fn number(
        &self,
        py: Python<'_>,
        kind: &str,
        times: PyReadonlyArray1<'_, f64>,
        out: PyReadwriteArray1<'_, f32>,
    ) -> PyResult<()> {
        let ask: fn(&mut Instant<'_, '_, f32>) -> Result<f32, EvaluateError> = match kind {
            "volume" => |instant| instant.volume(),
            "expected_error" => |instant| instant.expected_error(),
            "error_bound" => |instant| match instant.error_bound() {
                Err(EvaluateError::NoBound) => Ok(f32::NAN),
                bound => bound,
            },
            other => {
                return Err(PyValueError::new_err(format!(
                    "{other:?} is not a number of an instant"
                )));
            }
        };
        self.queries.fill(py, &singles(&times), 1, out, |instant, _, out| {
            out.copy_from_slice(&[ask(instant)?]);
            Ok(())
        })
    }

    /// Area, elastic energy and additional pressure drop of the membrane.
    fn totals(
        &self,
        py: Python<'_>,
        times: PyReadonlyArray1<'_, f64>,
        out: PyReadwriteArray1<'_, f32>,
    ) -> PyResult<()> {
        let sector = self.queries.shared.core().mesh().sector_nodes().len();
        self.queries.fill(py, &singles(&times), 3, out, |instant, _, out| {
            let mut sector = vec![[0.0; 3]; sector];
            let totals = instant.membrane(&mut sector)?.totals()?;
            out.copy_from_slice(&[totals.area, totals.energy, totals.pressure_drop]);
            Ok(())
        })
    }

    /// Positions or velocities of nodes (all if none are listed): x, y, z.
    fn vectors(
        &self,
        py: Python<'_>,
        kind: &str,
        times: PyReadonlyArray1<'_, f64>,
        nodes: Option<Vec<u16>>,
        frame: &str,
        out: PyReadwriteArray1<'_, f32>,
    ) -> PyResult<()> {
        let frame = frame_of(frame)?;
        let count = nodes
            .as_ref()
            .map_or(self.queries.shared.core().mesh().nodes(), Vec::len);
        let nodes = nodes.as_deref().map_or(Nodes::All, Nodes::List);
        let velocities = match kind {
            "positions" => false,
            "velocities" => true,
            other => return Err(PyValueError::new_err(format!("{other:?} are not vectors at the nodes"))),
        };
        self.queries
            .fill(py, &singles(&times), 3 * count, out, |instant, _, out| {
                let (scene, out) = (Scene { nodes, frame }, out.as_chunks_mut().0);
                if velocities {
                    instant.velocities(&scene, out)?;
                } else {
                    instant.positions(&scene, out)?;
                }
                Ok(())
            })
    }

    /// Points x, r of a named outline, front to rear.
    fn outline(
        &self,
        py: Python<'_>,
        plane: &str,
        times: PyReadonlyArray1<'_, f64>,
        frame: &str,
        out: PyReadwriteArray1<'_, f32>,
    ) -> PyResult<()> {
        let frame = frame_of(frame)?;
        let nodes = self.queries.shared.core().node_set(plane);
        let count = nodes.map_or(0, |nodes| nodes.len());
        self.queries
            .fill(py, &singles(&times), 2 * count, out, |instant, _, out| {
                instant.outline(plane, frame, out.as_chunks_mut().0)?;
                Ok(())
            })
    }

    /// Points x, w of the silhouette, front to rear, seen across the direction cos(angle) y + sin(angle) z.
    fn silhouette(
        &self,
        py: Python<'_>,
        angle: f64,
        points: usize,
        times: PyReadonlyArray1<'_, f64>,
        frame: &str,
        out: PyReadwriteArray1<'_, f32>,
    ) -> PyResult<()> {
        let frame = frame_of(frame)?;
        let across = [angle.cos() as f32, angle.sin() as f32];
        let mesh = self.queries.shared.core().mesh();
        self.queries
            .fill(py, &singles(&times), 2 * points, out, |instant, _, out| {
                let mut positions = vec![[0.0; 3]; mesh.nodes()];
                let mut normals = vec![[0.0; 3]; mesh.sector_nodes().len()];
                let nodes = Nodes::All;
                instant.positions(&Scene { nodes, frame }, &mut positions)?;
                silhouette(&mesh, &positions, across, &mut normals, out.as_chunks_mut().0)
            })
    }

    /// Mechanics at all nodes: six rows of scalars (stretch_1, stretch_2, area_dilation, tension_1, tension_2,
    /// energy_density), then three arrays of vectors (direction_1, direction_2, load). The load needs Ca, the first
    /// parameter of a capsule in the channel.
    fn fields(
        &self,
        py: Python<'_>,
        times: PyReadonlyArray1<'_, f64>,
        out: PyReadwriteArray1<'_, f32>,
    ) -> PyResult<()> {
        let mesh = self.queries.shared.core().mesh();
        let (nodes, sector) = (mesh.nodes(), mesh.sector_nodes().len());
        self.queries
            .fill(py, &singles(&times), 15 * nodes, out, |instant, query, out| {
                let stencils = self.queries.shared.stencils()?;
                let mut sector = vec![[0.0; 3]; sector];
                let capillary_number = query.parameters.get(0);
                let membrane = instant.membrane(&mut sector)?;
                let at_sector: Vec<Deformation<f32>> = stencils
                    .iter()
                    .map(|stencil| membrane.deformation(stencil))
                    .collect::<Result<_, _>>()?;
                let (rows, vectors) = out.split_at_mut(6 * nodes);
                let [first, second, load] = [0, 1, 2].map(|part| 3 * nodes * part);
                for node in 0..nodes {
                    let (index, operation) = mesh.origin(node).ok_or(EvaluateError::UnknownNode { node, nodes })?;
                    let at = at_sector[index].transformed(operation);
                    for (row, value) in rows.chunks_exact_mut(nodes).zip(scalars(&at)) {
                        row[node] = value;
                    }
                    let [direction_1, direction_2] = at.directions();
                    for (start, vector) in [
                        (first, direction_1),
                        (second, direction_2),
                        (load, at.load(capillary_number)?),
                    ] {
                        vectors[start + 3 * node..][..3].copy_from_slice(&vector);
                    }
                }
                Ok(())
            })
    }
}
