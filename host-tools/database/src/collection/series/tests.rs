//! Series in folders: their numbers, warnings, and what is named when something is wrong.

use std::fmt::Write;
use std::path::Path;

use super::super::Collection;
use crate::Mesh;
use crate::mesh::tests::octahedral;

/// A cell: its VTK type and its nodes.
type Cell = (u8, Vec<u32>);

/// A surface that grows and moves.
fn moved(nodes: &[[f64; 3]], series: usize, instant: usize) -> Vec<[f64; 3]> {
    let (growth, shift) = (1.0 + 0.125 * (instant * series) as f64, 0.25 * instant as f64);
    let at = |x: &[f64; 3]| [growth * x[0] + shift, growth * x[1], growth * x[2]];
    nodes.iter().map(at).collect()
}

/// About how it moves, by the place alone.
fn rate([x, y, z]: &[f64; 3]) -> [f64; 3] {
    [0.5 + 0.125 * x, 0.125 * y, 0.125 * z]
}

/// A piece as text.
fn piece(nodes: &[[f64; 3]], cells: &[Cell], velocity: bool) -> String {
    let words = |values: &mut dyn Iterator<Item = f64>| values.map(|x| format!("{x} ")).collect::<String>();
    let mut text = format!(
        "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
        nodes.len(),
        cells.len()
    );
    let mut group = |group: &str, name: &str, kind: &str, values: String| {
        let array = format!("<DataArray type=\"{kind}\" Name=\"{name}\" format=\"ascii\">{values}</DataArray>");
        let _ = writeln!(text, "<{group}>{array}</{group}>");
    };
    if velocity {
        let rates = nodes.iter().flat_map(rate);
        group("PointData", "velocity", "Float64", words(&mut rates.into_iter()));
    }
    group(
        "Points",
        "Points",
        "Float64",
        words(&mut nodes.as_flattened().iter().copied()),
    );
    let mut ends = cells.iter().scan(0, |end, (_, members)| {
        *end += members.len();
        Some(*end as f64)
    });
    let ends = words(&mut ends);
    let members = words(&mut cells.iter().flat_map(|(_, members)| members).map(|n| f64::from(*n)));
    group("Cells", "connectivity", "Int64", members);
    group("Cells", "offsets", "Int64", ends);
    group(
        "Cells",
        "types",
        "UInt8",
        words(&mut cells.iter().map(|(kind, _)| f64::from(*kind))),
    );
    text + "</Piece>\n"
}

fn file(pieces: &[String]) -> String {
    format!(
        "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid>{}</UnstructuredGrid></VTKFile>",
        pieces.concat()
    )
}

fn cells(elements: &[[u32; 6]]) -> Vec<Cell> {
    elements.iter().map(|element| (22, element.to_vec())).collect()
}

/// A folder with two series of three instants; `write` makes the parts of each.
fn folder(write: impl Fn(usize, usize) -> Vec<String>) -> tempfile::TempDir {
    let directory = tempfile::tempdir().unwrap();
    let mut table = "series,flow\n".to_owned();
    for series in 0..2 {
        let place = directory.path().join(format!("run{series}"));
        std::fs::create_dir(&place).unwrap();
        let mut list = "<VTKFile type=\"Collection\"><Collection>\n".to_owned();
        for instant in 0..3 {
            for (part, text) in write(series, instant).iter().enumerate() {
                let (time, name) = (0.5 * instant as f64, format!("c{instant}_{part}.vtu"));
                std::fs::write(place.join(&name), text).unwrap();
                let _ = writeln!(list, "<DataSet timestep=\"{time}\" part=\"{part}\" file=\"{name}\"/>");
            }
        }
        std::fs::write(place.join("c.pvd"), list + "</Collection></VTKFile>").unwrap();
        let _ = writeln!(table, "run{series}/c.pvd,{series}");
    }
    std::fs::write(directory.path().join("parameters.csv"), table).unwrap();
    directory
}

fn whole(velocity: impl Fn(usize, usize) -> bool) -> tempfile::TempDir {
    let mesh = octahedral(2);
    folder(|j, i| {
        vec![file(&[piece(
            &moved(&mesh.nodes, j, i),
            &cells(&mesh.elements),
            velocity(j, i),
        )])]
    })
}

fn read(directory: &Path) -> (Collection, Vec<String>) {
    Collection::read(directory).unwrap()
}

fn refused(directory: &Path, words: &[&str]) {
    let error = Collection::read(directory).unwrap_err().to_string();
    assert!(words.iter().all(|word| error.contains(word)), "{words:?}: {error}");
}

/// Replaces text in one file.
fn edit(directory: &Path, name: &str, old: &str, new: &str) {
    let path = directory.join(name);
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains(old), "{old}: {text}");
    std::fs::write(&path, text.replacen(old, new, 1)).unwrap();
}

#[test]
fn series_are_read_with_their_velocities() {
    let mesh = octahedral(2);
    let (collection, notes) = read(whole(|_, _| true).path());
    assert_eq!(notes, [""; 0]);
    assert_eq!(
        (collection.parameter_names, collection.parameters),
        (vec!["flow".to_owned()], vec![vec![0.0], vec![1.0]])
    );
    assert_eq!(
        (collection.times, collection.elements),
        (vec![0.0, 0.5, 1.0], mesh.elements.clone())
    );
    let nodes = moved(&mesh.nodes, 1, 2);
    assert_eq!(collection.positions[1][2], nodes);
    assert_eq!(collection.velocities[1][2], nodes.iter().map(rate).collect::<Vec<_>>());
}

#[test]
fn velocities_that_some_files_lack_are_derived_with_a_warning() {
    let directory = whole(|series, instant| (series, instant) != (1, 1));
    let (collection, notes) = read(directory.path());
    assert_eq!(notes.len(), 1, "{notes:?}");
    let words = ["`velocity`", "5 of 6 files", "run1/c1_0.vtu"];
    assert!(words.iter().all(|word| notes[0].contains(word)), "{notes:?}");
    let rate = collection.velocities[0][1][7];
    assert!((0..3).all(|d| (rate[d] - [0.5, 0.0, 0.0][d]).abs() < 1e-12), "{rate:?}");
}

/// Halves of the surface, each with nodes of its own.
fn halves(mesh: &Mesh, nodes: &[[f64; 3]]) -> Vec<String> {
    let half = |elements: &[[u32; 6]]| {
        let mut used: Vec<u32> = elements.as_flattened().to_vec();
        used.sort_unstable();
        used.dedup();
        used.reverse();
        let own = |node: &u32| used.iter().position(|other| other == node).unwrap() as u32;
        let elements: Vec<_> = elements
            .iter()
            .map(|element| (22, element.iter().map(own).collect()))
            .collect();
        let nodes: Vec<_> = used.iter().map(|node| nodes[*node as usize]).collect();
        piece(&nodes, &elements, true)
    };
    let (first, second) = mesh.elements.split_at(mesh.elements.len() / 2);
    vec![half(first), half(second)]
}

#[test]
fn pieces_and_parts_make_one_closed_surface() {
    let mesh = octahedral(2);
    let empty = piece(&[], &[], true);
    let pieces = folder(|j, i| {
        let halves = halves(&mesh, &moved(&mesh.nodes, j, i));
        vec![file(&[empty.clone(), halves[0].clone(), halves[1].clone()])]
    });
    let parts = folder(|j, i| {
        halves(&mesh, &moved(&mesh.nodes, j, i))
            .into_iter()
            .map(|half| file(&[half]))
            .collect()
    });
    let (collection, notes) = read(pieces.path());
    assert_eq!(notes, [""; 0]);
    assert_eq!(read(parts.path()), (collection.clone(), notes));
    let nodes = moved(&mesh.nodes, 1, 2);
    assert_eq!(collection.positions[1][2].len(), nodes.len());
    for (found, expected) in collection.elements.iter().zip(&mesh.elements) {
        let places = |element: &[u32; 6], nodes: &[[f64; 3]]| element.map(|node| nodes[node as usize]);
        assert_eq!(places(found, &collection.positions[1][2]), places(expected, &nodes));
        let rates = places(expected, &nodes).map(|x| rate(&x));
        assert_eq!(places(found, &collection.velocities[1][2]), rates);
    }
}

#[test]
fn pieces_that_do_not_fit_are_named() {
    let mesh = octahedral(2);
    let place = "run1/c2_0.vtu";
    let pieces = || folder(|j, i| vec![file(&halves(&mesh, &moved(&mesh.nodes, j, i)))]);
    let torn = pieces();
    let path = torn.path().join(place);
    let apart = moved(&mesh.nodes, 1, 1);
    std::fs::write(
        &path,
        file(&[
            halves(&mesh, &moved(&mesh.nodes, 1, 2))[0].clone(),
            halves(&mesh, &apart)[1].clone(),
        ]),
    )
    .unwrap();
    refused(torn.path(), &[place, "run0/c0_0.vtu", "share a node", "apart"]);
    let bare = pieces();
    edit(bare.path(), place, "Name=\"velocity\"", "Name=\"speed\"");
    refused(bare.path(), &[place, "piece 1", "`velocity`", "all or none"]);
    let flat = pieces();
    let path = flat.path().join(place);
    let text = std::fs::read_to_string(&path).unwrap();
    let other = piece(&mesh.nodes, &[(5, vec![0, 1, 2])], true);
    std::fs::write(
        &path,
        text.replacen("<UnstructuredGrid>", &format!("<UnstructuredGrid>{other}"), 1),
    )
    .unwrap();
    refused(
        flat.path(),
        &[place, "piece 1", "quadratic triangles (22)", "triangles (5)"],
    );
}

#[test]
fn points_and_lines_are_left_out_with_a_warning() {
    let mesh = octahedral(2);
    let expected = read(whole(|_, _| true).path()).0;
    let mut all = cells(&mesh.elements);
    all.insert(0, (1, vec![4]));
    all.insert(5, (3, vec![4, 5]));
    let (collection, notes) = read(folder(|j, i| vec![file(&[piece(&moved(&mesh.nodes, j, i), &all, true)])]).path());
    assert_eq!(collection, expected);
    assert!(
        notes.len() == 1 && notes[0].contains("run0/c0_0.vtu: 2 points and lines"),
        "{notes:?}"
    );
}

#[test]
fn what_is_wrong_with_a_file_is_named_with_the_array() {
    let place = "run1/c2_0.vtu";
    for (old, new, words) in [
        ("NumberOfPoints=\"66\"", "", &["`NumberOfPoints`"][..]),
        (
            "NumberOfCells=\"32\"",
            "NumberOfCells=\"-1\"",
            &["`NumberOfCells` is `-1`"],
        ),
        (
            "NumberOfPoints=\"66\"",
            "NumberOfPoints=\"67\"",
            &["`Points`", "198 numbers, expected 201"],
        ),
        (
            "Name=\"connectivity\"",
            "Name=\"other\"",
            &["`connectivity`", "missing"],
        ),
        ("Name=\"connectivity\"", "Name=\"types\"", &["2 arrays `types`"]),
        (
            "Name=\"velocity\"",
            "Name=\"velocity\" NumberOfComponents=\"2\"",
            &["`velocity`: 2 components, expected 3"],
        ),
        (
            "Name=\"velocity\" format=\"ascii\">",
            "Name=\"velocity\" format=\"ascii\">7 ",
            &["`velocity`: 199 numbers"],
        ),
        (
            "Name=\"types\" format=\"ascii\">22",
            "Name=\"types\" format=\"ascii\">5",
            &["`types`", "cell 1", "type 22"],
        ),
        (
            "Name=\"types\" format=\"ascii\">22",
            "Name=\"types\" format=\"ascii\">9",
            &["`types`", "cell 0", "quadrilateral"],
        ),
        (
            "Name=\"offsets\" format=\"ascii\">6",
            "Name=\"offsets\" format=\"ascii\">5",
            &["`offsets`", "cell 0", "expected 6"],
        ),
        ("12 18", "18 12", &["`offsets`", "cell 1", "6 to 18"]),
        ("<UnstructuredGrid>", "<UnstructuredGrid><!--", &["cut short"]),
        (
            "type=\"UnstructuredGrid\"",
            "type=\"PolyData\"",
            &["`PolyData`", "save"],
        ),
        (
            "<Points>",
            "<Points><DataArray type=\"Int8\"/>",
            &["2 arrays in Points"],
        ),
        (
            "</Piece>",
            "<CellData><DataArray type=\"Int8\" Name=\"vtkGhostType\">1</DataArray></CellData></Piece>",
            &["`vtkGhostType`"],
        ),
    ] {
        let directory = whole(|_, _| true);
        edit(directory.path(), place, old, new);
        refused(directory.path(), &[&[place][..], words].concat());
    }
    let ghosts = whole(|_, _| true);
    let array = format!(
        "<DataArray type=\"Int8\" Name=\"vtkGhostType\">{}1</DataArray>",
        "0 ".repeat(31)
    );
    edit(
        ghosts.path(),
        place,
        "</Piece>",
        &format!("<CellData>{array}</CellData></Piece>"),
    );
    refused(ghosts.path(), &[place, "`vtkGhostType`", "cell 31", "ghost"]);
}

#[test]
fn another_mesh_is_named_with_its_file() {
    let mesh = octahedral(2);
    let place = "run1/c2_0.vtu";
    let nodes = moved(&mesh.nodes, 1, 2);
    let mut turned = mesh.elements.clone();
    turned[3] = [1, 2, 0, 4, 5, 3].map(|k| turned[3][k]);
    let [found, expected] = [&turned, &mesh.elements].map(|elements| elements[3].map(|n| n.to_string()).join(" "));
    let more = [&nodes[..], &[[0.0; 3]]].concat();
    let mut outside = mesh.elements.clone();
    outside[2][1] = 66;
    for (nodes, elements, words) in [
        (&nodes, &turned[..], &["triangle 3", &found, &expected][..]),
        (&nodes, &mesh.elements[..31], &["31 triangles, expected 32"]),
        (&more, &mesh.elements, &["67 nodes, expected 66"]),
        (
            &nodes,
            &outside,
            &["`connectivity`", "cell 2 has the node 66, expected 0 to 65"],
        ),
    ] {
        let directory = whole(|_, _| true);
        std::fs::write(
            directory.path().join(place),
            file(&[piece(nodes, &cells(elements), true)]),
        )
        .unwrap();
        refused(directory.path(), &[&[place][..], words].concat());
    }
}

#[test]
fn files_that_are_missing_are_named_with_their_place() {
    let directory = tempfile::tempdir().unwrap();
    refused(directory.path(), &["parameters.csv", "cannot read"]);
    let directory = whole(|_, _| true);
    std::fs::remove_file(directory.path().join("run1/c1_0.vtu")).unwrap();
    refused(
        directory.path(),
        &["run1/c.pvd: timestep 0.5", "cannot read", "c1_0.vtu"],
    );
    edit(directory.path(), "parameters.csv", "run1/c.pvd", "run7/c.pvd");
    refused(
        directory.path(),
        &["parameters.csv: line 3", "`run7/c.pvd`", "cannot read"],
    );
    edit(directory.path(), "parameters.csv", "run7/c.pvd", "run1/c0_0.vtu");
    refused(
        directory.path(),
        &["run1/c0_0.vtu", "`UnstructuredGrid`", "expected Collection", "PVD"],
    );
}

#[test]
fn a_series_of_our_own_writer_is_read() {
    let directory = tempfile::tempdir().unwrap();
    let mesh = octahedral(2);
    let mut series = crate::vtu::Series::create(&directory.path().join("run"), "capsule").unwrap();
    for instant in 0..3 {
        series
            .add(0.5 * instant as f64, &mesh, &moved(&mesh.nodes, 1, instant), &[])
            .unwrap();
    }
    series.finish().unwrap();
    std::fs::write(
        directory.path().join("parameters.csv"),
        "series,flow\nrun/capsule.pvd,1\n",
    )
    .unwrap();
    let (collection, _) = read(directory.path());
    assert_eq!((&collection.elements, collection.times.len()), (&mesh.elements, 3));
    assert_eq!(collection.positions[0][2], moved(&mesh.nodes, 1, 2));
}
