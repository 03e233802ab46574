//! Databases as arrays for other programs, and models of them.

mod common;

use common::{capsule_rom, fails, json};
use std::path::{Path, PathBuf};

fn models() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models")
}

/// A database of nine shipped configurations on one side of the kink at a/l = 0.9.
fn database(folder: &Path) {
    std::fs::create_dir(folder).unwrap();
    let mut files = vec!["database.json".to_owned(), "mesh.npz".to_owned()];
    for ca in ["0.0400", "0.0600", "0.0800"] {
        files.extend(["0.9500", "1.0000", "1.0500"].map(|al| format!("ca{ca}_al{al}.npz")));
    }
    for file in files {
        std::fs::copy(models().join("database").join(&file), folder.join(&file)).unwrap();
    }
}

fn words(text: &str) -> std::str::Split<'_, char> {
    text.split(' ')
}

/// A model of the export has another reference shape, mean of the initial ones, other units and other instants. Its
/// answers differ from those of a model of the database by less than both err.
#[test]
fn a_model_of_an_export_answers_like_one_of_the_database() {
    let root = tempfile::tempdir().unwrap();
    database(&root.path().join("database"));
    let run = |text: &str| json(root.path(), words(text));
    let report = run("database export database --t 0:2:0.2,3:8:1,12,20 --hdf5 data.h5 --json");
    assert_eq!(
        (&report["configurations"], &report["instants"]),
        (&9.into(), &19.into())
    );
    assert!(report["extended"].as_u64() > Some(0), "all are stored to t = 20");
    run("offline build --from data.h5 --out export.crom --quiet --json");
    run("offline build --database database --out database.crom --quiet --json");
    let own = run("predict --model database.crom --ca 0.05 --confinement 0.97 --t 1,3,8,20 --json");
    let other =
        run("predict --model export.crom --parameters capillary_number=0.05,confinement=0.97 --t 1,3,8,20 --json");
    assert_eq!(other["units"]["length"], "l");
    for (own, other) in own["instants"]
        .as_array()
        .unwrap()
        .iter()
        .zip(other["instants"].as_array().unwrap())
    {
        // Fractions of a = 0.97 l; a length has two ends.
        let [a, b] = [own, other].map(|instant| instant["error_bound"].as_f64().unwrap());
        let allowed = 2.0 * 0.97 * (a + b);
        for name in ["axial_length", "half_width", "half_diagonal"] {
            let [own, other] = [own, other].map(|instant| instant[name].as_f64().unwrap());
            // The bound of so small a model of foreign data is wide, its answers are not.
            assert!((own - other).abs() < allowed.min(0.01 * own), "{name}: {own} {other}");
        }
    }
}

#[test]
fn exports_that_cannot_be_are_refused() {
    let root = tempfile::tempdir().unwrap();
    database(&root.path().join("database"));
    let refused = |text: &str, code, said: &[&str]| {
        fails(root.path(), words(text), code, said);
        assert!(
            std::fs::read_dir(root.path()).unwrap().count() == 1,
            "`{text}` left something"
        );
    };
    refused(
        "database export database",
        2,
        &["--npz <FILE>|--hdf5 <FILE>|--vtu <DIR>"],
    );
    refused(
        "database export database --npz a.npz --vtu b",
        2,
        &["cannot be used with"],
    );
    refused("database export nowhere --npz a.npz", 1, &["nowhere", "database.json"]);
    refused(
        "database export database --t 0,0.5 --npz a.npz",
        1,
        &["t = 0.5", "(0.4, 0.6"],
    );
    refused(
        "database export database --t 1,2 --hdf5 a.h5",
        1,
        &["--t 1,2", "expected 0"],
    );
    refused(
        "database export database --vtu database/mesh.npz",
        1,
        &["would overwrite"],
    );
    // The fault is met when half is written.
    let damaged = root.path().join("database/ca0.0600_al1.0000.npz");
    let mut bytes = std::fs::read(&damaged).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 0xff;
    std::fs::write(&damaged, &bytes).unwrap();
    refused(
        "database export database --t 0,8 --npz a.npz",
        1,
        &["ca0.0600_al1.0000.npz"],
    );
}

#[test]
fn a_surface_is_written_for_one_instant() {
    let root = tempfile::tempdir().unwrap();
    let model = models().join("capsule.crom");
    let predict = |rest: &str| {
        let mut arguments = vec![
            "predict",
            "--ca",
            "0.1",
            "--confinement",
            "0.9",
            "--model",
            model.to_str().unwrap(),
        ];
        arguments.extend(rest.split(' '));
        capsule_rom(root.path(), arguments)
    };
    assert!(predict("--t 8 --stl capsule.stl").status.success());
    // A header, and four triangles for each of the elements.
    assert_eq!(
        root.path().join("capsule.stl").metadata().unwrap().len(),
        84 + 50 * 4 * 1352
    );
    let two = predict("--t 7,8 --stl two.stl");
    let message = String::from_utf8_lossy(&two.stderr).into_owned();
    assert!(!two.status.success() && message.contains("one instant"), "{message}");
    assert!(!root.path().join("two.stl").exists());
}
