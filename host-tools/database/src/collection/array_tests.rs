//! Each malformed array is named, with what was expected.

use std::io::Write;
use std::path::Path;

use ndarray::{Array1, Array2, Array4, ArrayD};

use super::dtype::tests::npy;
use super::{Collection, Elements, NamedArray};
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

    /// The outcome of reading it as NPZ, as HDF5 and from memory; all must agree but for the file's name.
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
            let read = Collection::read(path).map(|(collection, _)| collection);
            read.map_err(|e| e.to_string().replace(&path.display().to_string(), "data"))
        };
        let (from_npz, from_hdf5) = (words(&npz), words(&hdf5));
        assert_eq!(from_npz, from_hdf5);
        let named = |(name, array): &(&str, ArrayD<f64>)| NamedArray {
            name: (*name).to_owned(),
            descriptor: "<f8".to_owned(),
            elements: Elements::Numbers(array.clone()),
        };
        let from_memory = Collection::from_arrays(self.0.iter().map(named).collect());
        assert_eq!(from_npz, from_memory.map_err(|error| format!("data: {error}")));
        from_npz
    }

    fn refused(&self, words: &[&str]) {
        let error = self.read().expect_err("refused");
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
        let other = if name == "times" { "`parameters`" } else { "`times`" };
        good()
            .with(name, None)
            .refused(&[&format!("`{name}`"), shape, "missing; there are", other]);
        let flat = ArrayD::zeros(vec![7, 2, 5]);
        good()
            .with(name, Some(flat))
            .refused(&[&format!("`{name}`"), shape, "(7, 2, 5)"]);
    }
    let five = ArrayD::from_shape_fn(vec![4, 5], |i| i[0] as f64);
    good()
        .with("parameters", Some(five))
        .refused(&["`parameters`", "(N, 1 to 4)", "(4, 5)"]);
    let positions = good().get("positions");
    let fewer = positions.slice_axis(ndarray::Axis(1), (..2).into()).to_owned();
    good()
        .with("positions", Some(fewer))
        .refused(&["`positions`", "(4, 3, N, 3)", "(4, 2, 66, 3)"]);
    let reversed = positions.t().as_standard_layout().to_owned();
    good()
        .with("positions", Some(reversed))
        .refused(&["(3, 66, 3, 4)", "(4, 3, N, 3)", ".T"]);
    let velocities = ArrayD::zeros(vec![4, 3, 65, 3]);
    good()
        .with("velocities", Some(velocities))
        .refused(&["`velocities`", "(4, 3, 66, 3)", "(4, 3, 65, 3)"]);
}

#[test]
fn what_is_not_finite_is_named_with_its_index() {
    let good = Arrays::good;
    for (name, index) in [
        ("parameters", &[2, 0][..]),
        ("times", &[1]),
        ("positions", &[3, 2, 17, 0]),
    ] {
        for wrong in [f64::NAN, f64::NEG_INFINITY] {
            let mut array = good().get(name);
            array[index] = wrong;
            let index: Vec<String> = index.iter().map(usize::to_string).collect();
            let place = format!("data: `{name}[{}]`", index.join(", "));
            good()
                .with(name, Some(array))
                .refused(&[&place, &format!("is {wrong}, expected a finite number")]);
        }
    }
    let mut velocities = ArrayD::zeros(vec![4, 3, 66, 3]);
    velocities[[1, 2, 65, 2]] = f64::INFINITY;
    good()
        .with("velocities", Some(velocities))
        .refused(&["`velocities[1, 2, 65, 2]`", "inf"]);
}

#[test]
fn what_makes_no_sense_is_named() {
    let good = Arrays::good;
    let times = |times: [f64; 3]| Some(Array1::from(times.to_vec()).into_dyn());
    good()
        .with("times", times([0.1, 0.5, 1.0]))
        .refused(&["`times` must rise from 0", "0.1", "times - times[0]"]);
    good()
        .with("times", times([0.0, 1.0, 0.5]))
        .refused(&["`times[2]` is 0.5 after 1"]);
    good()
        .with("times", times([0.0, 1.0, 1.0]))
        .refused(&["`times[2]` is 1 after 1"]);
    for wrong in [66.0, -1.0, 3.5, f64::NAN] {
        let mut elements = good().get("elements");
        elements[[3, 1]] = wrong;
        let found = format!("`elements[3, 1]` is {wrong}");
        good().with("elements", Some(elements)).refused(&[&found, "0 to 65"]);
    }
    let from_one = good().get("elements").mapv_into(|node| node + 1.0);
    good()
        .with("elements", Some(from_one))
        .refused(&["is 66", "elements - 1"]);
    let same = ArrayD::from_shape_fn(vec![4, 1], |j| (j[0] % 3) as f64);
    good()
        .with("parameters", Some(same))
        .refused(&["`parameters`", "rows 0 and 3", "parameter_1 = 0"]);
    good()
        .with("parameters", Some(ArrayD::ones(vec![4, 1])))
        .refused(&["`parameter_1` is 1 in all"]);
    let error = Collection::read(Path::new("data.txt")).unwrap_err();
    assert!(matches!(error, DatabaseError::UnknownKind { .. }), "{error}");
}

#[test]
fn surfaces_that_are_open_or_inside_out_are_refused() {
    let good = Arrays::good;
    let mut inside_out = good().get("elements");
    for mut row in inside_out.rows_mut() {
        row.swap(1, 2);
        row.swap(3, 5);
    }
    let words = [
        "data: `elements`",
        "inside out",
        "configuration 0 (parameter_1 = 0)",
        "[:, [0, 2, 1, 5, 4, 3]]",
    ];
    good().with("elements", Some(inside_out)).refused(&words);
    let open = good()
        .get("elements")
        .slice_axis(ndarray::Axis(0), (1..).into())
        .to_owned();
    good()
        .with("elements", Some(open))
        .refused(&["data: `elements`", "not closed", "edge ("]);
}

#[test]
fn extensions_count_in_any_case() {
    let directory = tempfile::tempdir().unwrap();
    for name in ["DATA.NPZ", "data.Hdf5", "data.H5"] {
        let path = directory.path().join(name);
        std::fs::write(&path, "").unwrap();
        assert!(
            matches!(Collection::read(&path), Err(DatabaseError::Corrupt { .. })),
            "{name}"
        );
    }
}

/// An NPZ archive with the arrays of a good file and these NPY files.
fn with_files(path: &Path, files: &[(&str, Vec<u8>)]) {
    let mut writer = ndarray_npy::NpzWriter::new(std::fs::File::create(path).unwrap());
    for (name, array) in &Arrays::good().0 {
        writer.add_array(*name, array).unwrap();
    }
    drop(writer.finish().unwrap());
    let file = std::fs::OpenOptions::new().read(true).write(true).open(path).unwrap();
    let mut archive = zip::ZipWriter::new_append(file).unwrap();
    for (name, bytes) in files {
        archive
            .start_file(format!("{name}.npy"), zip::write::SimpleFileOptions::default())
            .unwrap();
        archive.write_all(bytes).unwrap();
    }
    archive.finish().unwrap();
}

fn text(shape: &str, word: &str) -> Vec<u8> {
    let codes = word.chars().map(|c| c as u32).chain(std::iter::repeat(0)).take(9);
    npy(
        "'<U9'",
        "False",
        shape,
        &codes.flat_map(u32::to_le_bytes).collect::<Vec<u8>>(),
    )
}

#[test]
fn names_and_units_are_read_as_numpy_writes_them() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("data.npz");
    let files = [
        ("parameter_names", text("(1,)", " Q, flow ")),
        ("length_unit", text("()", "µm")),
        ("time_unit", text("(1,)", "")),
    ];
    with_files(&path, &files);
    let (collection, _) = Collection::read(&path).unwrap();
    assert_eq!(collection.parameter_names, ["Q, flow"]);
    assert_eq!(
        (collection.length_unit.as_deref(), collection.time_unit),
        (Some("µm"), None)
    );
}

#[test]
fn arrays_of_other_types_are_named_with_the_remedy() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("data.npz");
    let refused = |name: &str, bytes: Vec<u8>, words: &[&str]| {
        with_files(&path, &[(name, bytes)]);
        let error = Collection::read(&path).map(|_| ()).unwrap_err().to_string();
        assert!(
            error.contains("data.npz: array `") && words.iter().all(|word| error.contains(word)),
            "{error}"
        );
    };
    let complex = npy("'<c16'", "False", "(4, 3, 66, 3)", &[0; 16 * 4 * 3 * 66 * 3]);
    refused(
        "velocities",
        complex,
        &["`velocities` holds complex numbers (`<c16`)", "`.real` converts"],
    );
    let objects = npy("'|O'", "False", "(1,)", b"pickle");
    refused(
        "parameter_names",
        objects,
        &["`parameter_names` holds Python objects", "`.astype(str)` converts"],
    );
    refused(
        "length_unit",
        npy("'|S2'", "False", "(2,)", b"umum"),
        &["`length_unit` holds 2 texts, expected 1"],
    );
}

#[test]
fn texts_and_other_types_in_memory_are_taken_and_refused_as_from_files() {
    let read = |name: &str, descriptor: &str, elements: Elements| {
        let array = |name: &str, descriptor: &str, elements: Elements| NamedArray {
            name: name.to_owned(),
            descriptor: descriptor.to_owned(),
            elements,
        };
        let mut arrays = vec![array(name, descriptor, elements)];
        for (name, numbers) in Arrays::good().0 {
            arrays.push(array(name, "<f8", Elements::Numbers(numbers)));
        }
        Collection::from_arrays(arrays).map_err(|error| error.to_string())
    };
    let names = || Elements::Texts(vec![" Q, flow ".to_owned()]);
    assert_eq!(
        read("parameter_names", "<U9", names()).unwrap().parameter_names,
        ["Q, flow"]
    );
    assert_eq!(
        read("velocities", "<U9", names()).unwrap_err(),
        "array `velocities` holds text (`<U9`), expected real numbers: `.astype(float)` converts them"
    );
    assert_eq!(
        read("velocities", "<c16", Elements::Others).unwrap_err(),
        "array `velocities` holds complex numbers (`<c16`), expected real numbers: `.real` converts them"
    );
    assert_eq!(
        read("length_unit", "|O", Elements::Others).unwrap_err(),
        "array `length_unit` holds Python objects (`|O`), expected text of fixed length: `.astype(str)` converts them"
    );
}

/// The good file's nodes move at 0.2 j x.
#[test]
fn velocities_in_another_unit_or_direction_are_refused() {
    let rates = |factor: f64| {
        let positions = Arrays::good().get("positions");
        let start = positions.clone();
        ArrayD::from_shape_fn(positions.raw_dim(), |at| {
            factor * 0.2 * at[0] as f64 * start[[at[0], 0, at[2], at[3]]]
        })
    };
    let read = Arrays::good().with("velocities", Some(rates(1.0))).read().unwrap();
    let derived = Arrays::good().read().unwrap();
    let (found, expected) = (read.velocities[3][2][7], derived.velocities[3][2][7]);
    assert!((0..3).all(|d| (found[d] - expected[d]).abs() < 1e-12));
    for (factor, far) in [
        (1e-3, "0.001 times"),
        (1e3, "1000 times"),
        (0.0, "0 times"),
        (-1.0, "1 times"),
    ] {
        let given = Arrays::good().with("velocities", Some(rates(factor)));
        given.refused(&["`velocities` are not the rates of `positions`", far]);
    }
}
