//! Each malformed input is named, with what was expected.

use std::io::Write;
use std::path::Path;

use ndarray::{Array1, Array2, Array4, ArrayD};

use super::Collection;
use crate::DatabaseError;
use crate::mesh::tests::octahedral;

/// The arrays of a good file, by name.
struct Arrays(Vec<(&'static str, ArrayD<f64>)>);

impl Arrays {
    fn good() -> Self {
        let mesh = octahedral(2);
        let positions = Array4::from_shape_fn((4, 3, mesh.nodes.len(), 3), |(j, i, n, d)| {
            mesh.nodes[n][d] * (1.0 + 0.1 * j as f64 * i as f64)
        });
        let parameters = Array2::from_shape_fn((4, 1), |(j, _)| j as f64);
        let elements = Array2::from_shape_fn((mesh.elements.len(), 6), |(e, k)| f64::from(mesh.elements[e][k]));
        Self(vec![
            ("parameters", parameters.into_dyn()),
            ("times", Array1::from(vec![0.0, 0.5, 1.0]).into_dyn()),
            ("positions", positions.into_dyn()),
            ("elements", elements.into_dyn()),
        ])
    }

    /// Without the array, or with another in its place.
    fn with(mut self, name: &'static str, array: Option<ArrayD<f64>>) -> Self {
        self.0.retain(|(known, _)| *known != name);
        self.0.extend(array.map(|array| (name, array)));
        self
    }

    fn get(&self, name: &str) -> ArrayD<f64> {
        self.0.iter().find(|(known, _)| *known == name).unwrap().1.clone()
    }

    /// What reading says of it, as NPZ and as HDF5; both must agree but for the file's name.
    fn read(&self) -> Result<Collection, String> {
        let directory = tempfile::tempdir().unwrap();
        let npz = directory.path().join("data.npz");
        let mut writer = crate::npz::Writer::new(&npz);
        let hdf5 = directory.path().join("data.h5");
        let mut builder = hdf5_pure::FileBuilder::new();
        for (name, array) in &self.0 {
            writer.add(name, array).unwrap();
            let shape: Vec<u64> = array.shape().iter().map(|n| *n as u64).collect();
            let values: Vec<f64> = array.iter().copied().collect();
            builder.create_dataset(name).with_f64_data(&values).with_shape(&shape);
        }
        writer.finish().unwrap();
        builder.write(&hdf5).unwrap();
        let words = |path: &Path| {
            let collection = Collection::read(path).map(|(collection, _)| collection);
            collection.map_err(|e| e.to_string().replace(&path.display().to_string(), "data"))
        };
        let (from_npz, from_hdf5) = (words(&npz), words(&hdf5));
        assert_eq!(from_npz, from_hdf5);
        from_npz
    }

    fn refused(&self, words: &[&str]) {
        let error = self.read().unwrap_err();
        assert!(words.iter().all(|word| error.contains(word)), "{error}");
    }
}

#[test]
fn a_good_file_is_read_and_velocities_follow() {
    let collection = Arrays::good().read().unwrap();
    assert_eq!((collection.parameters.len(), collection.parameter_names.len()), (4, 1));
    assert_eq!(collection.parameter_names, ["parameter_1"]);
    // x (1 + 0.2 t j) moves at 0.2 j x.
    let (node, rate) = (octahedral(2).nodes[5], collection.velocities[3][1][5]);
    assert!((0..3).all(|d| (rate[d] - 0.6 * node[d]).abs() < 1e-12), "{rate:?}");
}

#[test]
fn what_is_missing_or_misshapen_is_named_with_the_shape() {
    let good = Arrays::good;
    for (name, shape) in [
        ("parameters", "(N, 1 to 4)"),
        ("times", "(N,)"),
        ("positions", "(4, 3, N, 3)"),
        ("elements", "(N, 3 or 6)"),
    ] {
        good()
            .with(name, None)
            .refused(&[&format!("`{name}`"), shape, "missing"]);
        let flat = ArrayD::zeros(vec![7, 2, 5]);
        good()
            .with(name, Some(flat))
            .refused(&[&format!("`{name}`"), shape, "[7, 2, 5]"]);
    }
    let five = ArrayD::from_shape_fn(vec![4, 5], |i| i[0] as f64);
    good()
        .with("parameters", Some(five))
        .refused(&["`parameters`", "(N, 1 to 4)", "[4, 5]"]);
    let fewer = good()
        .get("positions")
        .slice_axis(ndarray::Axis(1), (..2).into())
        .to_owned();
    good()
        .with("positions", Some(fewer))
        .refused(&["`positions`", "(4, 3, N, 3)", "[4, 2, 66, 3]"]);
    let velocities = ArrayD::zeros(vec![4, 3, 65, 3]);
    good()
        .with("velocities", Some(velocities))
        .refused(&["`velocities`", "(4, 3, 66, 3)", "[4, 3, 65, 3]"]);
}

#[test]
fn what_is_not_finite_or_makes_no_sense_is_named() {
    let good = Arrays::good;
    for name in ["parameters", "times", "positions", "elements"] {
        let mut array = good().get(name);
        *array.iter_mut().nth(2).unwrap() = f64::NAN;
        good()
            .with(name, Some(array))
            .refused(&[&format!("`{name}`"), "value 2 is NaN"]);
    }
    let late = Array1::from(vec![0.1, 0.5, 1.0]).into_dyn();
    good()
        .with("times", Some(late))
        .refused(&["times must increase from 0", "0.1"]);
    let mut elements = good().get("elements");
    elements[[3, 1]] = 66.0;
    good()
        .with("elements", Some(elements))
        .refused(&["`elements`", "value 19 is 66", "0 to 65"]);
    let same = ArrayD::ones(vec![4, 1]);
    good()
        .with("parameters", Some(same))
        .refused(&["`parameters`", "rows 0 and 1"]);
    let mut inside_out = good().get("elements");
    for mut row in inside_out.rows_mut() {
        row.swap(1, 2);
        row.swap(3, 5);
    }
    let collection = good().with("elements", Some(inside_out)).read();
    let error = collection.unwrap().reference().unwrap_err().to_string();
    assert!(
        error.contains("`elements`") && error.contains("counter-clockwise"),
        "{error}"
    );
    let error = Collection::read(Path::new("data.txt")).unwrap_err();
    assert!(matches!(error, DatabaseError::UnknownKind { .. }), "{error}");
}

/// An NPY file of NumPy's text type.
fn text_array(words: &[&str]) -> Vec<u8> {
    let header = format!(
        "{{'descr': '<U9', 'fortran_order': False, 'shape': ({},), }}\n",
        words.len()
    );
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    for word in words {
        let codes = word.chars().map(|c| c as u32).chain(std::iter::repeat(0)).take(9);
        bytes.extend(codes.flat_map(u32::to_le_bytes));
    }
    bytes
}

#[test]
fn names_and_units_are_read_as_numpy_writes_them() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("data.npz");
    let mut writer = ndarray_npy::NpzWriter::new(std::fs::File::create(&path).unwrap());
    for (name, array) in &Arrays::good().0 {
        writer.add_array(*name, array).unwrap();
    }
    drop(writer.finish().unwrap());
    let file = std::fs::OpenOptions::new().read(true).write(true).open(&path).unwrap();
    let mut archive = zip::ZipWriter::new_append(file).unwrap();
    for (name, words) in [("parameter_names", ["stiffness"]), ("length_unit", ["µm"])] {
        archive
            .start_file(format!("{name}.npy"), zip::write::SimpleFileOptions::default())
            .unwrap();
        archive.write_all(&text_array(&words)).unwrap();
    }
    archive.finish().unwrap();
    let (collection, _) = Collection::read(&path).unwrap();
    assert_eq!(collection.parameter_names, ["stiffness"]);
    assert_eq!(
        (collection.length_unit.as_deref(), collection.time_unit),
        (Some("µm"), None)
    );
}
