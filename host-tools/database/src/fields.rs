//! Quantities at the nodes at chosen instants: a table for any program (CSV), arrays for NumPy (NPZ).

use std::path::Path;

use ndarray::{Array1, Array2, Array3};

use crate::instant::Instant;
use crate::npz::{Writer, rows, triangles};
use crate::{DatabaseError, Mesh, atomic, table};

/// Writes one row an instant and node: `t`, `node`, `x`, `y`, `z`, then the quantities, vectors as `NAME_x`, `NAME_y`,
/// `NAME_z`. `title` becomes a comment in the first line.
///
/// # Errors
/// [`DatabaseError::WrongLength`] or [`DatabaseError::NotFinite`] for values that do not fit the first instant's nodes,
/// [`DatabaseError::Io`] when the file cannot be written.
pub fn write_csv(path: &Path, title: &str, instants: &[Instant]) -> Result<(), DatabaseError> {
    let nodes = instants.first().map_or(0, |instant| instant.positions.len());
    let mut heading = ["t", "node", "x", "y", "z"].map(str::to_owned).to_vec();
    for quantity in instants.iter().take(1).flat_map(|instant| &instant.data) {
        match quantity.parts() {
            (name, 1, _) => heading.push(name.to_owned()),
            (name, ..) => heading.extend(["x", "y", "z"].map(|axis| format!("{name}_{axis}"))),
        }
    }
    for instant in instants {
        instant.validate(nodes, &instants[0])?;
    }
    let row = |instant: &Instant, node: usize| {
        let values = instant.data.iter().flat_map(|quantity| {
            let (_, components, values) = quantity.parts();
            &values[node * components..(node + 1) * components]
        });
        let numbers = instant.positions[node].iter().chain(values).map(f64::to_string);
        let row = [instant.time.to_string(), node.to_string()].into_iter().chain(numbers);
        row.collect::<Vec<_>>()
    };
    let rows = instants
        .iter()
        .flat_map(|instant| (0..nodes).map(move |node| row(instant, node)));
    atomic::write(path, &table::csv(Some(title), heading, rows)?)
}

/// Writes arrays: `times` (N_t,), `positions` (N_t, N_x, 3), each quantity as (N_t, N_x) or (N_t, N_x, 3), the mesh as
/// `nodes` (N_x, 3) and `elements` (N_e, 6), or (N_e, 3) when all are flat.
///
/// # Errors
/// As [`write_csv`].
pub fn write_npz(path: &Path, mesh: &Mesh, instants: &[Instant]) -> Result<(), DatabaseError> {
    let (count, nodes) = (instants.len(), mesh.nodes.len());
    for instant in instants {
        instant.validate(nodes, &instants[0])?;
    }
    let mut writer = Writer::new(path);
    let times = instants.iter().map(|instant| instant.time);
    writer.add("times", &Array1::from_iter(times))?;
    let positions = Array3::from_shape_fn((count, nodes, 3), |(i, n, d)| instants[i].positions[n][d]);
    writer.add("positions", &positions)?;
    for (k, quantity) in instants.iter().take(1).flat_map(|instant| &instant.data).enumerate() {
        let value = |i: usize, place: usize| instants[i].data[k].parts().2[place];
        match quantity.parts() {
            (name, 1, _) => writer.add(name, &Array2::from_shape_fn((count, nodes), |(i, n)| value(i, n)))?,
            (name, ..) => {
                let vectors = Array3::from_shape_fn((count, nodes, 3), |(i, n, d)| value(i, 3 * n + d));
                writer.add(name, &vectors)?;
            }
        }
    }
    writer.add("nodes", &rows(&mesh.nodes))?;
    writer.add("elements", &triangles(mesh))?;
    writer.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PointData;
    use crate::mesh::tests::octahedral;
    use crate::npz::Reader;

    fn instants<'a>(mesh: &'a Mesh, radius: &'a [f64]) -> [Instant<'a>; 2] {
        [0.0, 0.2].map(|time| Instant {
            time,
            positions: &mesh.nodes,
            data: vec![
                PointData::Scalar("radius", radius),
                PointData::Vector("load", &mesh.nodes),
            ],
        })
    }

    #[test]
    fn a_table_has_a_row_an_instant_and_node() {
        let mesh = octahedral(2);
        let radius: Vec<f64> = mesh.nodes.iter().map(|n| n[0].hypot(n[1])).collect();
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("fields.csv");
        write_csv(&path, "a title", &instants(&mesh, &radius)).unwrap();
        let text = std::fs::read_to_string(path).unwrap();
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(lines[..2], ["# a title", "t,node,x,y,z,radius,load_x,load_y,load_z"]);
        assert_eq!(lines.len(), 2 + 2 * mesh.nodes.len());
        let row: Vec<f64> = lines[2 + mesh.nodes.len() + 7]
            .split(',')
            .map(|x| x.parse().unwrap())
            .collect();
        let [x, y, z] = mesh.nodes[7];
        assert_eq!(row, [0.2, 7.0, x, y, z, radius[7], x, y, z]);
    }

    #[test]
    fn arrays_have_an_axis_for_the_instants() {
        let mesh = octahedral(2);
        let n = mesh.nodes.len();
        let radius: Vec<f64> = mesh.nodes.iter().map(|n| n[0].hypot(n[1])).collect();
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("fields.npz");
        write_npz(&path, &mesh, &instants(&mesh, &radius)).unwrap();
        let mut reader = Reader::open(&path).unwrap();
        assert_eq!(reader.vector::<f64>("times", None).unwrap(), [0.0, 0.2]);
        let found = reader.array::<f64>("radius", &[Some(2), Some(n)]).unwrap();
        assert_eq!(found[[1, 7]], radius[7]);
        let found = reader.array::<f64>("load", &[Some(2), Some(n), Some(3)]).unwrap();
        assert_eq!(found[[1, 7, 2]], mesh.nodes[7][2]);
    }

    #[test]
    fn values_that_do_not_fit_are_named() {
        let mesh = octahedral(2);
        let path = Path::new("/nonexistent/fields.csv");
        let error = write_csv(path, "", &instants(&mesh, &[1.0])).unwrap_err().to_string();
        assert!(error.contains("`radius`") && error.contains("66"), "{error}");
        let bad = vec![f64::NAN; mesh.nodes.len()];
        let error = write_npz(path, &mesh, &instants(&mesh, &bad)).unwrap_err().to_string();
        assert!(error.contains("`radius`"), "{error}");
    }
}
