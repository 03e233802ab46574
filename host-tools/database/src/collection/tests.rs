//! Each malformed series is named, with what was expected.

use std::io::Write;
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::prelude::BASE64_STANDARD;

use super::Collection;
use crate::Mesh;
use crate::mesh::tests::octahedral;
use crate::vtu::Series;

/// A folder with series of the capsule at three values of a parameter.
fn series(directory: &Path) -> (Mesh, PathBuf) {
    let mesh = octahedral(2);
    let mut table = "series,flow\n".to_owned();
    for j in 0..3 {
        let mut series = Series::create(&directory.join(format!("run{j}")), "capsule").unwrap();
        for i in 0..4 {
            let nodes: Vec<_> = mesh
                .nodes
                .iter()
                .map(|n| n.map(|x| x * (1.0 + 0.1 * f64::from(i * j))))
                .collect();
            series.add(0.5 * f64::from(i), &mesh, &nodes, &[]).unwrap();
        }
        series.finish().unwrap();
        table += &format!("run{j}/capsule.pvd, {j}\n");
    }
    let path = directory.join("parameters.csv");
    std::fs::write(&path, table).unwrap();
    (mesh, path)
}

#[test]
fn series_are_read_in_all_their_encodings() {
    let directory = tempfile::tempdir().unwrap();
    let (mesh, _) = series(directory.path());
    let binary = Collection::read(directory.path()).unwrap();
    assert_eq!((binary.times.len(), &binary.elements), (4, &mesh.elements));
    assert_eq!(binary.parameter_names, ["flow"]);
    // The same snapshot as text, and compressed as ParaView does.
    let place = directory.path().join("run1/capsule_0002.vtu");
    let text = std::fs::read_to_string(&place).unwrap();
    let head = r#"<DataArray type="Float64" Name="positions" NumberOfComponents="3" format="binary">"#;
    let (before, rest) = text.split_once(head).unwrap();
    let (_, after) = rest.split_once('<').unwrap();
    let numbers: Vec<String> = binary.positions[1][2]
        .as_flattened()
        .iter()
        .map(f64::to_string)
        .collect();
    let head = head.replace("binary", "ascii");
    std::fs::write(&place, format!("{before}{head}{}<{after}", numbers.join(" "))).unwrap();
    assert_eq!(Collection::read(directory.path()).unwrap(), binary);
    std::fs::write(&place, compressed(&text)).unwrap();
    assert_eq!(Collection::read(directory.path()).unwrap(), binary);
}

/// A VTU file with every array in two blocks of zlib.
fn compressed(text: &str) -> String {
    let mut parts = text.split("format=\"binary\">");
    let mut result = parts
        .next()
        .unwrap()
        .replace("header_type", "compressor=\"vtkZLibDataCompressor\" header_type");
    for part in parts {
        let (content, after) = part.split_once('<').unwrap();
        let bytes = &BASE64_STANDARD.decode(content).unwrap()[8..];
        let block = bytes.len().div_ceil(2);
        let blocks: Vec<Vec<u8>> = bytes.chunks(block).map(deflated).collect();
        let last = bytes.len() - block * (blocks.len() - 1);
        let sizes = blocks.iter().map(Vec::len);
        let words = [blocks.len(), block, last].into_iter().chain(sizes);
        let header: Vec<u8> = words.flat_map(|word| (word as u64).to_le_bytes()).collect();
        let [header, data] = [header, blocks.concat()].map(|bytes| BASE64_STANDARD.encode(bytes));
        result += &format!("format=\"binary\">{header}{data}<{after}");
    }
    result
}

fn deflated(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn what_is_wrong_with_series_is_named() {
    let directory = tempfile::tempdir().unwrap();
    let refused = |words: &[&str]| {
        let error = Collection::read(directory.path()).unwrap_err().to_string();
        assert!(words.iter().all(|word| error.contains(word)), "{error}");
    };
    refused(&["parameters.csv"]);
    let (_, table) = series(directory.path());
    let good = std::fs::read_to_string(&table).unwrap();
    std::fs::write(&table, good.replace("series,flow", "file,flow")).unwrap();
    refused(&["parameters.csv", "file,flow", "series"]);
    std::fs::write(&table, good.replace(", 2", ", inf")).unwrap();
    refused(&["row 2", "`flow`", "inf"]);
    std::fs::write(&table, good.replace("run2", "run7")).unwrap();
    refused(&["run7"]);
    std::fs::write(&table, &good).unwrap();
    let place = directory.path().join("run1/capsule_0002.vtu");
    let text = std::fs::read_to_string(&place).unwrap();
    std::fs::write(&place, text.replace("Name=\"connectivity\"", "Name=\"other\"")).unwrap();
    refused(&["capsule_0002.vtu", "`connectivity`", "missing"]);
    std::fs::write(&place, text.replace("format=\"binary\"", "format=\"appended\"")).unwrap();
    refused(&["capsule_0002.vtu", "appended", "inline"]);
}
