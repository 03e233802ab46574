//! The compiled part of the Python package `capsule_rom`: models, and batches of queries written into NumPy arrays.
//!
//! The Python files beside this crate broadcast parameters, allocate arrays and document the interface; this module
//! fills arrays, without the global interpreter lock and on all cores. Numbers are single precision: the bits of the
//! command line, the browser and a microcontroller.

mod answers;
mod batch;
mod build;
mod fom;
mod identify;
mod model;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

pyo3::create_exception!(
    capsule_rom,
    ModelFileError,
    PyValueError,
    "A model file was not opened."
);
pyo3::create_exception!(
    capsule_rom,
    DataError,
    PyValueError,
    "No model was built from these data."
);
pyo3::create_exception!(capsule_rom, SolverError, PyValueError, "A run was refused or failed.");
pyo3::create_exception!(capsule_rom, QueryError, PyValueError, "A query was not answered.");
pyo3::create_exception!(
    capsule_rom,
    MeasurementError,
    PyValueError,
    "A measurement cannot be identified."
);

/// The compiled part of capsule_rom.
#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("ModelFileError", module.py().get_type::<ModelFileError>())?;
    module.add("DataError", module.py().get_type::<DataError>())?;
    module.add("SolverError", module.py().get_type::<SolverError>())?;
    module.add("QueryError", module.py().get_type::<QueryError>())?;
    module.add("MeasurementError", module.py().get_type::<MeasurementError>())?;
    module.add_class::<model::Model>()?;
    module.add_class::<identify::Identifier>()?;
    module.add_class::<answers::Batch>()?;
    module.add_class::<fom::Run>()?;
    module.add_function(wrap_pyfunction!(build::build, module)?)?;
    module.add_function(wrap_pyfunction!(fom::run, module)?)
}
