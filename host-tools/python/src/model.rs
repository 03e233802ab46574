//! An opened model file and its description.

use crate::ModelFileError;
use capsule_core::mechanics::Stencil;
use capsule_core::{EvaluateError, Method};
use capsule_database::{DatabaseError, write_whole};
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use self_cell::self_cell;
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

type CoreModel<'a> = capsule_core::Model<'a>;

self_cell!(
    /// The file's bytes with the model that reads them in place.
    struct File {
        owner: Vec<u8>,
        #[covariant]
        dependent: CoreModel,
    }
);

/// A model and the stencils of its mesh, shared by all batches.
pub struct Shared {
    file: File,
    stencils: OnceLock<Result<Vec<Stencil<f32>>, EvaluateError>>,
}

impl Shared {
    pub fn core(&self) -> &CoreModel<'_> {
        self.file.borrow_dependent()
    }

    /// The stencils at the sector's nodes, computed at the first call.
    pub fn stencils(&self) -> Result<&[Stencil<f32>], EvaluateError> {
        let make = || {
            let mesh = self.core().mesh();
            mesh.sector_nodes()
                .iter()
                .map(|node| Stencil::at(&mesh, node))
                .collect()
        };
        self.stencils.get_or_init(make).as_deref().map_err(|error| *error)
    }
}

/// A model file (.crom), opened and validated.
#[pyclass(frozen)]
pub struct Model {
    pub shared: Arc<Shared>,
}

#[pymethods]
impl Model {
    /// Opens the bytes of a file.
    #[staticmethod]
    pub fn open(bytes: Vec<u8>) -> PyResult<Self> {
        let file = File::try_new(bytes, |bytes| CoreModel::open(bytes));
        let file = file.map_err(|error| ModelFileError::new_err(error.to_string()))?;
        let stencils = OnceLock::new();
        Ok(Self {
            shared: Arc::new(Shared { file, stencils }),
        })
    }

    /// Writes the file whole or not at all.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let bytes = self.shared.file.borrow_owner();
        py.detach(|| write_whole(&path, bytes)).map_err(|error| match &error {
            DatabaseError::Io { source, .. } => std::io::Error::new(source.kind(), error.to_string()).into(),
            _ => PyOSError::new_err(error.to_string()),
        })
    }

    #[getter]
    fn title(&self) -> &str {
        self.shared.core().title()
    }

    #[getter]
    fn membrane_law(&self) -> &str {
        self.shared.core().membrane_law()
    }

    #[getter]
    fn bending_stiffness(&self) -> Option<f64> {
        self.shared.core().bending_stiffness()
    }

    #[getter]
    fn errors_against(&self) -> String {
        self.shared.core().errors_against().to_string()
    }

    #[getter]
    fn digest(&self) -> String {
        format!("{:08x}", self.shared.core().digest())
    }

    #[getter]
    fn end_time(&self) -> f32 {
        self.shared.core().end_time()
    }

    #[getter]
    fn method(&self) -> &'static str {
        match self.shared.core().default_method() {
            Method::Direct => "direct",
            Method::Paper => "paper",
        }
    }

    #[getter]
    fn node_count(&self) -> usize {
        self.shared.core().mesh().nodes()
    }

    /// Names of the units of length, velocity and time.
    #[getter]
    fn units(&self) -> (&str, &str, &str) {
        let units = self.shared.core().units();
        (units.length, units.velocity, units.time)
    }

    /// Name, least and greatest sampled value of each parameter.
    #[getter]
    fn parameters(&self) -> Vec<(&str, f64, f64)> {
        let parameters = self.shared.core().parameters();
        parameters
            .iter()
            .map(|range| (range.name, range.min, range.max))
            .collect()
    }

    /// Elements as rows of node numbers.
    fn elements<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u16>>> {
        let mesh = self.shared.core().mesh();
        let count = mesh.element_nodes();
        let rows: Vec<Vec<u16>> = mesh.elements().map(|element| element[..count].to_vec()).collect();
        Ok(PyArray2::from_vec2(py, &rows)?)
    }

    /// Node numbers of a named outline, front to rear.
    fn node_set<'py>(&self, py: Python<'py>, name: &str) -> Option<Bound<'py, PyArray1<u16>>> {
        let nodes = self.shared.core().node_set(name)?;
        Some(PyArray1::from_iter(py, nodes.iter().map(|node| node as u16)))
    }

    /// Sampled parameters, a row each; a sample that clusters share is given once.
    fn samples<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let model = self.shared.core();
        let ranges = model.parameters();
        let mut samples: Vec<Vec<f64>> = Vec::new();
        for cluster in model.clusters() {
            let rows = cluster.parameters();
            for row in 0..rows.rows() {
                let columns = (0..rows.columns()).zip(ranges);
                let sample = columns
                    .map(|(column, range)| range.value(rows.get(row, column).into()))
                    .collect();
                if !samples.contains(&sample) {
                    samples.push(sample);
                }
            }
        }
        Ok(PyArray2::from_vec2(py, &samples)?)
    }

    /// The largest Ca with a steady state at each confinement; none where the model has no steady limit.
    fn steady_limit<'py>(&self, py: Python<'py>, confinements: Vec<f64>) -> Option<Bound<'py, PyArray1<f64>>> {
        let limits: Option<Vec<f64>> = confinements
            .into_iter()
            .map(|confinement| self.shared.core().steady_limit(confinement))
            .collect();
        limits.map(|limits| PyArray1::from_vec(py, limits))
    }
}
