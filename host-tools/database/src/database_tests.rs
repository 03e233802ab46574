//! The database on disk: reading back, damage, several threads.

use super::*;
use crate::mesh::tests::octahedral;
use crate::trajectory::tests::relaxing;

fn times(interval: f64) -> Vec<f64> {
    (0..6).map(|i| interval * f64::from(i)).collect()
}

fn description() -> Description {
    Description::new(times(0.2), serde_json::json!({ "tolerance": 1e-5 }))
}

fn new_database(directory: &tempfile::TempDir) -> Database {
    Database::create(directory.path(), description(), octahedral(3)).unwrap()
}

fn worst(a: &Snapshots, b: &Snapshots) -> f64 {
    let pairs = a.iter().flatten().flatten().zip(b.iter().flatten().flatten());
    pairs.map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

#[test]
fn what_is_written_is_read_again() {
    let directory = tempfile::tempdir().unwrap();
    let database = new_database(&directory);
    let original = relaxing(database.mesh(), database.times());
    assert!(!database.contains(&original.parameters));
    database.write(&original).unwrap();
    assert!(database.contains(&original.parameters));

    let database = Database::open(directory.path()).unwrap();
    assert_eq!(database.description(), &description());
    let copy = database.read(&[0.1, 0.9]).unwrap();
    assert_eq!(
        (&copy.times, &copy.status, &copy.centroid),
        (&original.times, &original.status, &original.centroid)
    );
    assert!(worst(&copy.positions, &original.positions) <= 0.52 * compact::POSITION_STEP);
    assert!(worst(&copy.velocities, &original.velocities) <= 0.52 * compact::VELOCITY_STEP);
    assert_eq!(database.trajectories().unwrap().count(), 1);
    let files: Vec<_> = database.files().unwrap();
    assert_eq!(files, ["ca0.1000_al0.9000.npz", "database.json", "mesh.npz"]);
}

#[test]
fn an_asymmetric_trajectory_keeps_all_its_nodes() {
    let directory = tempfile::tempdir().unwrap();
    let database = new_database(&directory);
    let mut original = relaxing(database.mesh(), database.times());
    let kept = |d: &Database| {
        let mut reader = Reader::open(&directory.path().join(d.file_name(&[0.1, 0.9]))).unwrap();
        reader.array::<u8>("velocities", &[None; 4]).unwrap().shape()[2]
    };
    database.write(&original).unwrap();
    assert_eq!(kept(&database), database.symmetry().sector.len());
    original.positions[3][7][2] += 1e-5;
    database.write(&original).unwrap();
    assert_eq!(kept(&database), database.mesh().nodes.len());
    let copy = database.read(&original.parameters).unwrap();
    assert!(worst(&copy.positions, &original.positions) <= 0.52 * compact::POSITION_STEP);
}

/// How a configuration ended, without snapshots.
fn ended(parameters: &[f64], status: Status) -> Trajectory {
    Trajectory {
        parameters: parameters.to_vec(),
        status,
        times: vec![],
        positions: vec![],
        velocities: vec![],
        centroid: vec![],
        pressure_drop: vec![],
    }
}

#[test]
fn a_status_is_recorded_without_snapshots() {
    let directory = tempfile::tempdir().unwrap();
    let database = new_database(&directory);
    let status = Status::Stopped {
        time: 3.4,
        reason: "a node touched the wall".to_owned(),
    };
    database.write(&ended(&[0.2, 1.2], status.clone())).unwrap();
    database.write(&ended(&[0.15, 0.95], Status::Unsteady)).unwrap();
    assert!(database.contains(&[0.2, 1.2]));
    let entries = database.entries().unwrap();
    assert_eq!(entries[0].parameters, [0.15, 0.95]);
    assert_eq!((entries[1].status.clone(), entries[1].snapshots), (status, 0));
    assert!(matches!(
        database.read(&[0.2, 1.2]),
        Err(DatabaseError::UnknownConfiguration { .. })
    ));
    assert!(matches!(
        database.read(&[0.3, 1.2]),
        Err(DatabaseError::UnknownConfiguration { .. })
    ));
}

#[test]
fn threads_may_write_at_once() {
    let directory = tempfile::tempdir().unwrap();
    let database = new_database(&directory);
    let trajectory = relaxing(database.mesh(), &[0.0, 0.2]);
    std::thread::scope(|scope| {
        for k in 0..4 {
            let (database, mut trajectory) = (&database, trajectory.clone());
            scope.spawn(move || {
                for i in 0..5 {
                    trajectory.parameters = vec![0.01 * f64::from(k), 0.8 + 0.05 * f64::from(i)];
                    database.write(&trajectory).unwrap();
                }
            });
        }
    });
    assert_eq!(database.entries().unwrap().len(), 20);
    // Each file is complete, and holds the configuration of its name.
    for entry in database.entries().unwrap() {
        let copy = database.read(&entry.parameters).unwrap();
        assert_eq!(copy.parameters, entry.parameters);
        assert_eq!(copy.centroid, trajectory.centroid);
        assert!(worst(&copy.positions, &trajectory.positions) <= 0.52 * compact::POSITION_STEP);
        assert!(worst(&copy.velocities, &trajectory.velocities) <= 0.52 * compact::VELOCITY_STEP);
    }
}

#[test]
fn a_sweep_goes_on_but_only_with_the_same_settings() {
    let directory = tempfile::tempdir().unwrap();
    new_database(&directory)
        .write(&ended(&[0.1, 0.9], Status::Unsteady))
        .unwrap();
    assert!(new_database(&directory).contains(&[0.1, 0.9]));
    let error = Database::create(directory.path(), description(), octahedral(2)).unwrap_err();
    assert!(error.to_string().contains("differ in mesh"), "{error}");
    let other = Description::new(times(0.2), serde_json::json!({ "tolerance": 1e-4 }));
    let error = Database::create(directory.path(), other, octahedral(3)).unwrap_err();
    assert!(
        error.to_string().contains("solver.tolerance (0.00001 and 0.0001)"),
        "{error}"
    );
}

#[test]
fn equal_contents_have_equal_digests() {
    let directories = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
    let [a, b] = directories.each_ref().map(new_database);
    for database in [&a, &b] {
        database.write(&relaxing(database.mesh(), &[0.0, 0.2])).unwrap();
    }
    std::fs::write(directories[0].path().join(".tmp123"), "part of a file").unwrap();
    assert_eq!(a.digest().unwrap(), b.digest().unwrap());
    b.write(&ended(&[0.2, 1.2], Status::Unsteady)).unwrap();
    assert_ne!(a.digest().unwrap(), b.digest().unwrap());
}

#[test]
fn damage_is_named() {
    let directory = tempfile::tempdir().unwrap();
    assert!(matches!(
        Database::open(directory.path()),
        Err(DatabaseError::NotADatabase { .. })
    ));
    let database = new_database(&directory);
    database.write(&relaxing(database.mesh(), &[0.0, 0.2])).unwrap();

    let file = directory.path().join("ca0.1000_al0.9000.npz");
    let bytes = std::fs::read(&file).unwrap();
    std::fs::write(&file, &bytes[..bytes.len() - 100]).unwrap();
    let error = database.read(&[0.1, 0.9]).unwrap_err();
    assert!(matches!(error, DatabaseError::Corrupt { .. }), "{error}");
    assert!(error.to_string().contains("ca0.1000_al0.9000.npz"), "{error}");

    let mut writer = Writer::new(&file);
    writer.add("parameters", &Array1::from(vec![0.1, 0.9])).unwrap();
    writer.add("status", &Array1::from(br#""unsteady""#.to_vec())).unwrap();
    writer.add("times", &Array1::from(vec![0.0, 0.2])).unwrap();
    writer.finish().unwrap();
    let error = database.read(&[0.1, 0.9]).unwrap_err().to_string();
    assert!(error.contains("array `centroid` of shape (2,) is missing"), "{error}");

    let json = directory.path().join("database.json");
    let text = std::fs::read_to_string(&json).unwrap();
    std::fs::write(&json, text.replace("\"version\": 2", "\"version\": 7")).unwrap();
    let error = Database::open(directory.path()).unwrap_err();
    assert!(
        matches!(
            error,
            DatabaseError::WrongVersion {
                found: 7,
                supported: 2,
                ..
            }
        ),
        "{error}"
    );
    std::fs::write(&json, "{").unwrap();
    assert!(matches!(
        Database::open(directory.path()),
        Err(DatabaseError::Json { .. })
    ));
}

#[test]
fn an_unwritable_directory_is_named() {
    let path = Path::new("/proc/no-such-directory");
    let error = Database::create(path, description(), octahedral(2)).unwrap_err();
    assert!(
        matches!(error, DatabaseError::Io { .. }) && error.to_string().contains("/proc"),
        "{error}"
    );
}
