use std::path::PathBuf;

use super::*;
use crate::mesh::tests::octahedral;
use crate::trajectory::tests::relaxing;
use crate::{Collection, Description, Status};

const CONTINUE: ControlFlow<()> = ControlFlow::Continue(());

/// Four configurations over five instants: one steady after three, one to the end, one unsteady to the end, one
/// unsteady whose snapshots end early.
fn database(folder: &Path) -> Database {
    let times: Vec<f64> = (0..5).map(|i| 0.2 * f64::from(i)).collect();
    let mesh = octahedral(2);
    let database = Database::create(folder, Description::new(times.clone(), serde_json::json!({})), mesh).unwrap();
    let unsteady = Status::Unsteady;
    let steady = Status::Steady { time: 0.4 };
    for (parameters, status, snapshots) in [
        ([0.05, 0.8], steady.clone(), 3),
        ([0.1, 0.9], steady, 5),
        ([0.15, 1.0], unsteady.clone(), 5),
        ([0.2, 1.1], unsteady, 3),
    ] {
        let trajectory = relaxing(database.mesh(), &times[..snapshots]);
        let parameters = parameters.to_vec();
        database
            .write(&Trajectory {
                parameters,
                status,
                ..trajectory
            })
            .unwrap();
    }
    database
}

/// Writes an export in all formats.
fn written(export: &Export, folder: &Path) -> [PathBuf; 3] {
    let paths = ["a.npz", "a.h5", "series"].map(|name| folder.join(name));
    let mut progress = |_, _| CONTINUE;
    export.write_npz(&paths[0], &mut progress).unwrap();
    export.write_hdf5(&paths[1], &mut progress).unwrap();
    std::fs::create_dir(&paths[2]).unwrap();
    export.write_series(&paths[2], &mut progress).unwrap();
    paths
}

#[test]
fn an_export_is_read_again_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let database = database(&folder.path().join("database"));
    let times = vec![0.0, 0.2, 0.8];
    let export = Export::new(&database, times.clone()).unwrap();
    for path in written(&export, folder.path()) {
        let (collection, notes) = Collection::read(&path).unwrap();
        assert_eq!(notes, Vec::<String>::new());
        assert_eq!(collection.parameter_names, ["capillary_number", "confinement"]);
        if !path.is_dir() {
            let units = [collection.length_unit, collection.time_unit];
            assert_eq!(units, ["l", "l/V"].map(|unit| Some(unit.to_owned())));
        }
        assert_eq!(collection.times, times);
        assert_eq!(collection.elements, database.mesh().elements);
        assert_eq!(collection.parameters, [[0.05, 0.8], [0.1, 0.9], [0.15, 1.0]]);
        for (j, parameters) in collection.parameters.iter().enumerate() {
            let stored = database.read(parameters).unwrap();
            for (i, instant) in [0, 1].into_iter().enumerate() {
                assert_eq!(collection.positions[j][i], stored.positions[instant]);
                assert_eq!(collection.velocities[j][i], stored.velocities[instant]);
            }
            let last = stored.times.len() - 1;
            let [front, end] = [collection.positions[j][2][0], stored.positions[last][0]];
            let rest = 0.8 - stored.times[last];
            // The speed of a node of the steady capsule, nearly.
            let expected = end[0] + rest * stored.velocities[last][0][0];
            assert!((front[0] - expected).abs() <= 0.05 * rest, "{front:?} {end:?}");
            assert_eq!(front[1..], end[1..]);
        }
    }
}

#[test]
fn configurations_that_end_too_early_are_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let database = database(folder.path());
    let left_out = |end: f64| -> Vec<Vec<f64>> {
        let export = Export::new(&database, vec![0.0, end]).unwrap();
        assert_eq!(export.entries().len() + export.left_out().len(), 4);
        export.left_out().iter().map(|entry| entry.parameters.clone()).collect()
    };
    assert_eq!(left_out(0.4), Vec::<Vec<f64>>::new());
    assert_eq!(left_out(0.8), [[0.2, 1.1]]);
}

#[test]
fn instants_without_snapshots_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let database = database(folder.path());
    let refused = |times: &[f64]| Export::new(&database, times.to_vec()).unwrap_err().to_string();
    let error = refused(&[0.0, 0.3]);
    assert!(error.contains("0.3") && error.contains("(0.2, 0.4)"), "{error}");
    let error = refused(&[0.0, 1.0]);
    assert!(error.contains("t = 1") && error.contains("(0.8,)"), "{error}");
    assert!(refused(&[0.2, 0.4]).contains("rise from 0"));
    let empty = tempfile::tempdir().unwrap();
    let description = Description::new(vec![0.0, 0.2], serde_json::json!({}));
    let empty = Database::create(empty.path(), description, octahedral(2)).unwrap();
    let error = Export::new(&empty, vec![0.0, 0.2]).unwrap_err().to_string();
    assert!(error.contains("nothing to export"), "{error}");
}

#[test]
fn an_export_ends_when_it_is_asked_to() {
    let folder = tempfile::tempdir().unwrap();
    let database = database(&folder.path().join("database"));
    let export = Export::new(&database, database.times().to_vec()).unwrap();
    let mut calls = Vec::new();
    let mut progress = |done, of| {
        calls.push((done, of));
        if done == 4 { ControlFlow::Break(()) } else { CONTINUE }
    };
    let error = export
        .write_npz(&folder.path().join("a.npz"), &mut progress)
        .unwrap_err();
    assert!(matches!(error, DatabaseError::Interrupted), "{error}");
    // Positions and velocities of three configurations.
    assert_eq!(calls, [(1, 6), (2, 6), (3, 6), (4, 6)]);
}
