//! Collections of a motion over two parameters, for tests.

#[path = "mesh.rs"]
mod mesh;

use capsule_database::{Collection, Mesh};
pub use mesh::octahedral;

/// The snapshots of a motion: `position(node, parameters, t)` is the position of a node of the mesh.
pub fn collection(
    mesh: &Mesh,
    parameters: Vec<Vec<f64>>,
    times: Vec<f64>,
    position: impl Fn([f64; 3], [f64; 2], f64) -> [f64; 3],
) -> Collection {
    let at = |row: &[f64], t: f64| {
        mesh.nodes
            .iter()
            .map(|node| position(*node, [row[0], row[1]], t))
            .collect()
    };
    let run = |row: &Vec<f64>| times.iter().map(|t| at(row, *t)).collect();
    Collection::new(Collection {
        parameter_names: vec!["p".to_owned(), "q".to_owned()],
        length_unit: None,
        time_unit: None,
        positions: parameters.iter().map(run).collect(),
        velocities: Vec::new(),
        elements: mesh.elements.clone(),
        parameters,
        times,
    })
    .unwrap()
}
