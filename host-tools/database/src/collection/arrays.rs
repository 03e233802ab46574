//! A collection from named arrays, whatever kind of file holds them.

use ndarray::ArrayD;
use std::path::Path;

use super::{Collection, MAX_PARAMETERS, check_times, elements, numbered};
use crate::DatabaseError;
use crate::error::{finite, length};

/// Named arrays in a file.
pub(crate) trait Arrays {
    /// The file.
    fn path(&self) -> &Path;
    /// Whether there is an array of that name.
    fn has(&self, name: &str) -> bool;
    /// The numbers of an array of any numeric type, if there is one.
    fn numbers(&mut self, name: &str) -> Result<ArrayD<f64>, DatabaseError>;
    /// The texts of an array.
    fn texts(&mut self, name: &str) -> Result<Vec<String>, DatabaseError>;
}

/// Reads a collection.
pub(crate) fn collection(arrays: &mut impl Arrays) -> Result<Collection, DatabaseError> {
    let parameters = required(arrays, "parameters", &["N", "1 to 4"])?;
    let [configurations, dimensions] = [0, 1].map(|axis| parameters.shape()[axis]);
    let times = required(arrays, "times", &["N"])?;
    let counts = [configurations, times.len()].map(|count| count.to_string());
    let shape = [&counts[0], &counts[1], "N", "3"];
    let positions = required(arrays, "positions", &shape)?;
    let nodes = positions.shape()[2];
    let triangles = required(arrays, "elements", &["N", "3 or 6"])?;

    let times: Vec<f64> = times.iter().copied().collect();
    check_times(&times)?;
    let velocities = if arrays.has("velocities") {
        let nodes = nodes.to_string();
        fields(&required(arrays, "velocities", &[&counts[0], &counts[1], &nodes, "3"])?)
    } else {
        Vec::new()
    };
    let parameter_names = if arrays.has("parameter_names") {
        let names = arrays.texts("parameter_names")?;
        length("texts in `parameter_names`", dimensions, names.len())?;
        names
    } else {
        numbered(dimensions)
    };
    let [length_unit, time_unit] = ["length_unit", "time_unit"].map(|name| unit(arrays, name));
    let indices: Vec<f64> = triangles.iter().copied().collect();
    Collection::new(Collection {
        parameter_names,
        length_unit: length_unit?,
        time_unit: time_unit?,
        parameters: parameters.rows().into_iter().map(|row| row.to_vec()).collect(),
        times,
        elements: elements(&indices, triangles.shape()[1], nodes)?,
        positions: fields(&positions),
        velocities,
    })
}

fn unit(arrays: &mut impl Arrays, name: &str) -> Result<Option<String>, DatabaseError> {
    if !arrays.has(name) {
        return Ok(None);
    }
    let texts = arrays.texts(name)?;
    length(&format!("texts in `{name}`"), 1, texts.len())?;
    Ok(texts.into_iter().next())
}

/// An array of finite numbers with a shape: each length is a number, `N` for any but 0, or a choice in words.
fn required(arrays: &mut impl Arrays, name: &str, shape: &[&str]) -> Result<ArrayD<f64>, DatabaseError> {
    let comma = if shape.len() == 1 { "," } else { "" };
    let expected = format!("({}{comma})", shape.join(", "));
    let (path, name) = (arrays.path().to_path_buf(), name.to_owned());
    if !arrays.has(&name) {
        return Err(DatabaseError::MissingArray { path, name, expected });
    }
    let array = arrays.numbers(&name)?;
    let fits = |(found, expected): (&usize, &&str)| match *expected {
        "N" => *found > 0,
        "1 to 4" => (1..=MAX_PARAMETERS).contains(found),
        "3 or 6" => [3, 6].contains(found),
        other => other == found.to_string(),
    };
    if array.ndim() != shape.len() || !array.shape().iter().zip(shape).all(fits) {
        return Err(DatabaseError::WrongShape {
            path,
            name,
            expected,
            found: array.shape().to_vec(),
        });
    }
    finite(&format!("`{name}`"), array.iter())?;
    Ok(array)
}

/// `[N_c][N_t][N_x]` vectors of an array of shape (Nc, Nt, Nx, 3).
fn fields(array: &ArrayD<f64>) -> Vec<Vec<Vec<[f64; 3]>>> {
    let nodes = |snapshot: ndarray::ArrayViewD<f64>| -> Vec<[f64; 3]> {
        let rows = snapshot.rows().into_iter();
        rows.map(|row| [row[0], row[1], row[2]]).collect()
    };
    let instants = |configuration: ndarray::ArrayViewD<f64>| configuration.outer_iter().map(nodes).collect();
    array.outer_iter().map(instants).collect()
}
