//! A collection from named arrays, of any file format or in memory.

use ndarray::ArrayD;

use super::{Collection, MAX_PARAMETERS, elements, numbered};
use crate::DatabaseError;
use crate::error::tuple;

/// Named arrays.
pub(crate) trait Arrays {
    /// The names of all arrays.
    fn names(&self) -> &[String];
    /// The numbers of an array of any numeric type.
    fn numbers(&mut self, name: &str) -> Result<ArrayD<f64>, DatabaseError>;
    /// The texts of an array.
    fn texts(&mut self, name: &str) -> Result<Vec<String>, DatabaseError>;

    /// Whether there is an array of that name.
    fn has(&self, name: &str) -> bool {
        self.names().iter().any(|known| known == name)
    }
}

/// Reads a collection.
pub(crate) fn collection(arrays: &mut impl Arrays) -> Result<Collection, DatabaseError> {
    let parameters = required(arrays, "parameters", &["N", "1 to 4"])?;
    let [configurations, dimensions] = [0, 1].map(|axis| parameters.shape()[axis]);
    let times = required(arrays, "times", &["N"])?;
    let [configurations, instants] = [configurations, times.len()].map(|count| count.to_string());
    let triangles = required(arrays, "elements", &["N", "3 or 6"])?;
    let positions = fields(&required(arrays, "positions", &[&configurations, &instants, "N", "3"])?);
    let nodes = positions[0][0].len();
    let velocities = if arrays.has("velocities") {
        let nodes = nodes.to_string();
        fields(&required(
            arrays,
            "velocities",
            &[&configurations, &instants, &nodes, "3"],
        )?)
    } else {
        Vec::new()
    };
    let parameter_names = if arrays.has("parameter_names") {
        texts(arrays, "parameter_names", dimensions)?
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
        times: times.iter().copied().collect(),
        elements: elements(&indices, triangles.shape()[1], nodes)?,
        positions,
        velocities,
    })
}

fn unit(arrays: &mut impl Arrays, name: &str) -> Result<Option<String>, DatabaseError> {
    if !arrays.has(name) {
        return Ok(None);
    }
    Ok(texts(arrays, name, 1)?.pop())
}

fn texts(arrays: &mut impl Arrays, name: &str, expected: usize) -> Result<Vec<String>, DatabaseError> {
    let texts = arrays.texts(name)?;
    match texts.len() {
        found if found == expected => Ok(texts),
        found => Err(DatabaseError::collection(format!(
            "array `{name}` holds {found} texts, expected {expected}"
        ))),
    }
}

/// An array of numbers with a shape: each length is a number, `N` for any but 0, or a choice in words.
fn required(arrays: &mut impl Arrays, name: &str, shape: &[&str]) -> Result<ArrayD<f64>, DatabaseError> {
    let comma = if shape.len() == 1 { "," } else { "" };
    let expected = format!("({}{comma})", shape.join(", "));
    if !arrays.has(name) {
        let held: Vec<String> = arrays.names().iter().take(12).map(|name| format!("`{name}`")).collect();
        let held = if held.is_empty() {
            "there is no array".to_owned()
        } else {
            format!("there are {}", held.join(", "))
        };
        return Err(DatabaseError::collection(format!(
            "array `{name}` of shape {expected} is missing; {held}"
        )));
    }
    let array = arrays.numbers(name)?;
    let fits = |(found, expected): (&usize, &&str)| match *expected {
        "N" => *found > 0,
        "1 to 4" => (1..=MAX_PARAMETERS).contains(found),
        "3 or 6" => [3, 6].contains(found),
        other => other == found.to_string(),
    };
    let found = array.shape();
    if found.len() == shape.len() && found.iter().zip(shape).all(fits) {
        return Ok(array);
    }
    // MATLAB and Fortran write the axes the other way round.
    let reversed = found.len() == shape.len() && found.iter().rev().zip(shape).all(fits);
    let hint = if reversed { ": transpose it by `.T`" } else { "" };
    let found = tuple(found);
    Err(DatabaseError::collection(format!(
        "array `{name}` has shape {found}, expected {expected}{hint}"
    )))
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
