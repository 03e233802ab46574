//! The header of a model against an independent reader of the same file, and against data whose dimensions are known.

mod common;

use common::{capsule_rom, fails, write_arrays};
use serde_json::Value;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The output of the command, in a folder.
fn header(folder: &Path, arguments: &[&str]) -> String {
    let output = capsule_rom(folder, ["header"].iter().chain(arguments));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// The value of a macro.
fn value<'a>(header: &'a str, name: &str) -> &'a str {
    let define = format!("#define CAPSULE_MODEL_{name} ");
    let mut lines = header.lines().filter_map(|line| line.strip_prefix(&define));
    let found = lines.next().unwrap_or_else(|| panic!("no {name} in:\n{header}"));
    assert_eq!(lines.next(), None, "{name} twice");
    found
}

#[test]
fn the_committed_header_is_that_of_the_shipped_model() {
    let committed = std::fs::read_to_string(root().join("core/capi/include/capsule_model.h")).unwrap();
    let found = header(&root(), &["models/capsule.crom"]);
    assert!(
        committed == found,
        "run `capsule-rom header models/capsule.crom > core/capi/include/capsule_model.h`"
    );
    assert_eq!(found, header(&root(), &[]));
}

/// docs/results/model.json is written by a reader that knows the specification alone.
#[test]
fn another_reader_finds_the_same_dimensions() {
    let text = std::fs::read_to_string(root().join("docs/results/model.json")).unwrap();
    let model: Value = serde_json::from_str(&text).unwrap();
    let header = header(&root(), &["models/capsule.crom"]);
    let clusters = model["clusters"].as_array().unwrap();
    let of = |key: &'static str| clusters.iter().map(move |cluster| cluster[key].as_u64().unwrap());
    for (name, expected) in [
        ("NODES", model["nodes"].as_u64().unwrap()),
        ("ELEMENTS", model["elements"].as_u64().unwrap()),
        ("INSTANTS", model["instants"].as_u64().unwrap()),
        ("MIDPLANE_POINTS", model["node_sets"]["midplane"].as_u64().unwrap()),
        ("DIAGONAL_POINTS", model["node_sets"]["diagonal"].as_u64().unwrap()),
        ("SAMPLES", of("samples").sum()),
        ("MODES", 1 + of("modes").max().unwrap()),
    ] {
        assert_eq!(value(&header, name), expected.to_string(), "{name}");
    }
    assert_eq!(
        value(&header, "DIGEST"),
        format!("0x{:08x}u", model["digest"].as_u64().unwrap())
    );
    assert_eq!(value(&header, "LAW"), "\"neo-Hookean\"");
}

#[test]
fn other_people_s_data_has_its_own_dimensions() {
    let folder = tempfile::tempdir().unwrap();
    write_arrays(&folder.path().join("octahedron.npz"));
    let built = capsule_rom(
        folder.path(),
        [
            "offline",
            "build",
            "--from",
            "octahedron.npz",
            "--out",
            "octahedron.crom",
        ],
    );
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    let header = header(folder.path(), &["octahedron.crom"]);
    for (name, expected) in [
        ("NODES", "6"),
        ("ELEMENTS", "8"),
        ("SAMPLES", "9"),
        ("PARAMETERS", "2"),
        ("END_TIME", "2.0f"),
    ] {
        assert_eq!(value(&header, name), expected, "{name}");
    }
    let bytes = std::fs::metadata(folder.path().join("octahedron.crom")).unwrap().len();
    assert_eq!(value(&header, "FILE_SIZE"), bytes.to_string());
}

#[test]
fn a_file_that_is_no_model_has_no_header() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("table.csv"),
        "capillary_number,confinement\n0.1,0.9\n",
    )
    .unwrap();
    fails(folder.path(), ["header", "table.csv"], 1, &["table.csv", "CROM"]);
    fails(folder.path(), ["header", "absent.crom"], 1, &["absent.crom"]);
}
