//! Models from arrays of other people's data.

use crate::DataError;
use crate::model::Model;
use capsule_database::Collection;
use capsule_database::collection::{Elements, NamedArray};
use capsule_offline::{Settings, Split, Truncation};
use numpy::{PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;
use std::fmt::Display;

/// The model of named arrays, as `capsule-rom offline build --from` makes it of a file with them.
#[pyfunction]
pub fn build(
    py: Python<'_>,
    arrays: Vec<(String, Bound<'_, PyAny>)>,
    split: Option<(String, f64)>,
    tolerance: Option<f64>,
    created_unix_s: u32,
) -> PyResult<Model> {
    let arrays: Vec<NamedArray> = arrays
        .into_iter()
        .map(|(name, array)| named(name, &array))
        .collect::<PyResult<_>>()?;
    let bytes = py.detach(|| model(arrays, split, tolerance, created_unix_s));
    Model::open(bytes.map_err(DataError::new_err)?)
}

/// An array of NumPy.
fn named(name: String, array: &Bound<'_, PyAny>) -> PyResult<NamedArray> {
    let kind = array.getattr("dtype")?;
    let elements = match kind.getattr("kind")?.extract::<char>()? {
        'f' | 'i' | 'u' => {
            let doubles = array.call_method1("astype", ("float64",))?;
            Elements::Numbers(doubles.cast::<PyArrayDyn<f64>>()?.to_owned_array())
        }
        'U' => Elements::Texts(texts(array)?),
        'S' => {
            let strings = array.py().import("numpy")?.getattr("char")?;
            Elements::Texts(texts(&strings.call_method1("decode", (array, "utf-8"))?)?)
        }
        _ => Elements::Others,
    };
    Ok(NamedArray {
        name,
        descriptor: kind.getattr("str")?.extract()?,
        elements,
    })
}

fn texts(array: &Bound<'_, PyAny>) -> PyResult<Vec<String>> {
    array.call_method0("ravel")?.call_method0("tolist")?.extract()
}

/// The bytes of the model, or why there is none.
fn model(
    arrays: Vec<NamedArray>,
    split: Option<(String, f64)>,
    tolerance: Option<f64>,
    created_unix_s: u32,
) -> Result<Vec<u8>, String> {
    let collection = Collection::from_arrays(arrays).map_err(text)?;
    let mut settings = Settings::of_collection(&collection).map_err(text)?;
    settings.created_unix_s = created_unix_s;
    if let Some((name, value)) = split {
        let names = &collection.parameter_names;
        let parameter = names.iter().position(|known| *known == name);
        let parameter = parameter.ok_or_else(|| {
            format!(
                "there is no parameter `{name}`: the parameters are {}",
                names.join(", ")
            )
        })?;
        settings.split = Some(Split::between(&collection, parameter, value).map_err(text)?);
    }
    if let Some(tolerance) = tolerance {
        settings.truncation = Truncation::Tolerance(tolerance);
    }
    let (bytes, _) = capsule_offline::build(&collection, &settings, &|_, _, _| {}).map_err(text)?;
    Ok(bytes)
}

fn text(error: impl Display) -> String {
    error.to_string()
}
