//! The command with arguments that hold anything, and small data of other people's.
#![allow(dead_code, reason = "each test takes what it needs")]

use capsule_database::vtu::Series;
use capsule_database::{Mesh, table};
use ndarray::{Array1, Array2, Array4};
use ndarray_npy::NpzWriter;
use serde_json::Value;
use std::ffi::OsStr;
use std::path::Path;
use std::process::{Command, Output};

/// The triangles of an octahedron, counter-clockwise from outside. They start at different corners, so that any
/// reordering would show.
pub const ELEMENTS: [[i64; 3]; 8] = [
    [0, 2, 4],
    [4, 2, 1],
    [1, 3, 4],
    [3, 0, 4],
    [5, 2, 0],
    [2, 5, 1],
    [1, 5, 3],
    [0, 3, 5],
];
const NODES: [[f64; 3]; 6] = [
    [1.0, 0.0, 0.0],
    [-1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, -1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.0, 0.0, -1.0],
];

const TIMES: [f64; 5] = [0.0, 0.5, 1.0, 1.5, 2.0];

/// The parameters of nine configurations: a grid over [0.1, 0.3] and [1, 3].
fn configurations() -> Vec<[f64; 2]> {
    let pair = |k: i32| [0.1 + 0.1 * f64::from(k / 3), 1.0 + f64::from(k % 3)];
    (0..9).map(pair).collect()
}

/// A node of an octahedron that stretches and moves along.
fn position([p, q]: [f64; 2], t: f64, node: usize) -> [f64; 3] {
    let stretch = |rate: f64| 1.0 + rate * p * t * (1.0 + 0.1 * q * t);
    let [x, y, z] = NODES[node];
    [x * stretch(0.2) + 1.2 * t, y * stretch(-0.1), z * stretch(-0.08)]
}

/// Writes the configurations as arrays, their parameters without names.
pub fn write_arrays(path: &Path) {
    let configurations = configurations();
    let mut file = NpzWriter::new(std::fs::File::create(path).unwrap());
    let parameters = Array2::from_shape_fn((9, 2), |(c, p)| configurations[c][p]);
    file.add_array("parameters", &parameters).unwrap();
    file.add_array("times", &Array1::from(TIMES.to_vec())).unwrap();
    let positions = Array4::from_shape_fn((9, 5, 6, 3), |(c, t, n, d)| position(configurations[c], TIMES[t], n)[d]);
    file.add_array("positions", &positions).unwrap();
    let elements = Array2::from_shape_fn((8, 3), |(e, k)| ELEMENTS[e][k]);
    file.add_array("elements", &elements).unwrap();
    file.finish().unwrap();
}

/// Writes the configurations as series, their parameters under these names.
pub fn write_series(folder: &Path, names: [&str; 2]) {
    let elements = ELEMENTS.map(|element| element.map(|node| node as u32));
    let mesh = Mesh {
        nodes: NODES.to_vec(),
        elements: elements.map(|[a, b, c]| [a, b, c, a, b, c]).to_vec(),
    };
    let mut rows = Vec::new();
    for (index, parameters) in configurations().into_iter().enumerate() {
        let mut series = Series::create(&folder.join(index.to_string()), "capsule").unwrap();
        for t in TIMES {
            let nodes: Vec<_> = (0..6).map(|node| position(parameters, t, node)).collect();
            series.add(t, &mesh, &nodes, &[]).unwrap();
        }
        series.finish().unwrap();
        rows.push([
            format!("{index}/capsule.pvd"),
            parameters[0].to_string(),
            parameters[1].to_string(),
        ]);
    }
    let text = table::csv(None, ["series", names[0], names[1]], rows).unwrap();
    std::fs::write(folder.join("parameters.csv"), text).unwrap();
}

/// Runs the command in `folder`.
pub fn capsule_rom<I: AsRef<OsStr>>(folder: &Path, arguments: impl IntoIterator<Item = I>) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_capsule-rom"));
    command.args(arguments).current_dir(folder).output().unwrap()
}

/// Its one JSON object.
pub fn json<I: AsRef<OsStr>>(folder: &Path, arguments: impl IntoIterator<Item = I>) -> Value {
    let output = capsule_rom(folder, arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

/// Asserts the exit code, that the standard error, one line of a failure, holds all of `words`, and that nothing is
/// printed.
pub fn fails<I: AsRef<OsStr>>(folder: &Path, arguments: impl IntoIterator<Item = I>, code: i32, words: &[&str]) {
    let output = capsule_rom(folder, arguments);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{message}");
    assert!(output.stdout.is_empty() && message.starts_with("error: "), "{message}");
    assert!(code == 2 || message.lines().count() == 1, "{message}");
    for word in words {
        assert!(message.contains(word), "\"{word}\" is not in: {message}");
    }
}
