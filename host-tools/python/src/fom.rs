//! Runs of the full-order model.

use crate::SolverError;
use capsule_fom::{Configuration, FomError, Integrator, MembraneDiscretisation, Outcome, Settings, Solver, Status};
use numpy::ndarray::{Array2, Array3};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArray3, ToPyArray};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::ops::ControlFlow;

/// A run's outcome.
#[pyclass(frozen)]
pub struct Run {
    solver: Solver,
    outcome: Outcome,
}

/// Runs one configuration with the settings of `capsule-rom fom run`. A signal's exception ends it.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "keywords of one Python function")]
pub fn run(
    py: Python<'_>,
    ca: f64,
    confinement: f64,
    mesh: usize,
    membrane: &str,
    degree: Option<usize>,
    bending: f64,
    integrator: &str,
    step: f64,
    tolerance: f64,
    end_time: f64,
    snapshot_interval: f64,
    unreduced: bool,
) -> PyResult<Run> {
    let mut settings = Settings {
        mesh_frequency: mesh,
        membrane: match membrane {
            "harmonics" => MembraneDiscretisation::Harmonics { degree, bending },
            "p2" => MembraneDiscretisation::QuadraticElements,
            other => return Err(unknown("membrane", other, "\"harmonics\" or \"p2\"")),
        },
        integrator: match integrator {
            "rkc2" => Integrator::Rkc2 { tolerance },
            "euler" => Integrator::ForwardEuler { step },
            "ralston" => Integrator::Ralston { step },
            other => return Err(unknown("integrator", other, "\"rkc2\", \"euler\" or \"ralston\"")),
        },
        end_time,
        snapshot_interval,
        symmetric: !unreduced,
        ..Settings::default()
    };
    settings.duct.symmetric = !unreduced;
    let configuration = Configuration {
        capillary_number: ca,
        confinement,
    };
    let mut signal = Ok(());
    let run = py.detach(|| -> Result<Run, FomError> {
        configuration.validate()?;
        let solver = Solver::new(settings)?;
        let outcome = solver.run(&configuration, &mut |_| {
            signal = Python::attach(|py| py.check_signals());
            if signal.is_ok() {
                ControlFlow::Continue(())
            } else {
                ControlFlow::Break(())
            }
        })?;
        Ok(Run { solver, outcome })
    });
    signal?;
    run.map_err(|error| SolverError::new_err(error.to_string()))
}

fn unknown(what: &str, found: &str, expected: &str) -> PyErr {
    PyValueError::new_err(format!("{what} {found:?} is unknown: {expected}"))
}

#[pymethods]
impl Run {
    /// "steady", "unsteady" or "stopped".
    #[getter]
    fn status(&self) -> &'static str {
        match self.outcome.status {
            Status::Steady { .. } => "steady",
            Status::Unsteady => "unsteady",
            Status::Stopped { .. } => "stopped",
        }
    }

    /// From when the shape is steady.
    #[getter]
    fn steady_time(&self) -> Option<f64> {
        match self.outcome.status {
            Status::Steady { time } => Some(time),
            Status::Unsteady | Status::Stopped { .. } => None,
        }
    }

    /// Why the run could not continue, and where its film is too thin for the solver.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        let stopped = match &self.outcome.status {
            Status::Stopped { time, reason } => Some(format!("stopped at t = {time:.2}: {reason}")),
            Status::Steady { .. } | Status::Unsteady => None,
        };
        let film = self.solver.film_warning(&self.outcome);
        stopped.into_iter().chain(film).collect()
    }

    #[getter]
    fn volume_drift(&self) -> f64 {
        self.outcome.volume_drift
    }

    #[getter]
    fn velocity_evaluations(&self) -> usize {
        self.outcome.velocity_evaluations
    }

    /// Instants, and a row of observables for each: centroid, its velocity, axial length, half width, half diagonal,
    /// rear depth, pressure drop.
    fn history<'py>(&self, py: Python<'py>) -> (Bound<'py, PyArray1<f64>>, Vec<Bound<'py, PyArray1<f64>>>) {
        let history = &self.outcome.history;
        let columns = [
            &self.outcome.centroid,
            &history.centroid_velocity,
            &history.axial_length,
            &history.half_width,
            &history.half_diagonal,
            &history.rear_depth,
            &history.pressure_drop,
        ];
        let columns = columns.map(|column| column.to_pyarray(py));
        (self.outcome.times.to_pyarray(py), columns.to_vec())
    }

    /// (instants, nodes, 3)
    fn positions<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray3<f64>> {
        cube(py, &self.outcome.positions)
    }

    /// (instants, nodes, 3)
    fn velocities<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray3<f64>> {
        cube(py, &self.outcome.velocities)
    }

    /// (elements, 6)
    fn elements<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<u32>> {
        let elements = &self.solver.mesh().elements;
        Array2::from_shape_fn((elements.len(), 6), |(e, k)| elements[e][k]).into_pyarray(py)
    }
}

fn cube<'py>(py: Python<'py>, fields: &[Vec<[f64; 3]>]) -> Bound<'py, PyArray3<f64>> {
    let nodes = fields.first().map_or(0, Vec::len);
    Array3::from_shape_fn((fields.len(), nodes, 3), |(i, n, d)| fields[i][n][d]).into_pyarray(py)
}
