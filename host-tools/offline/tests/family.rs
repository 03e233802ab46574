//! Whole builds on a family of which every answer is known.

#[path = "support/grid.rs"]
mod grid;
mod support;

use capsule_core::Method;
use capsule_core::{Domain, Evaluator, Frame, Model, Nodes, Query, Scene, Workspace};
use capsule_database::{Database, Description, Status};
use capsule_offline::{
    Design, OfflineError, Ranks, Settings, Split, Storage, Truncation, build, leave_one_out, modified_hausdorff,
    one_minus_ric,
};
use grid::database;
use support::{octahedral, trajectory};

fn settings() -> Settings {
    Settings {
        // Snapshots are 0.2 apart, up to t = 2.
        error_times: vec![0.1, 1.0, 2.0, 8.0],
        truncation: Truncation::Tolerance(1e-6),
        storage: Storage::Single,
        ..Settings::default()
    }
}

fn quiet(_: &str, _: usize, _: usize) {}

fn predicted(model: &Model, [ca, a]: [f64; 2], t: f64, method: Method) -> Vec<[f64; 3]> {
    let mut workspace = Box::new(Workspace::<f64>::new());
    let mut evaluator = Evaluator::new(model, &mut workspace).unwrap();
    assert_eq!(
        evaluator
            .prepare(&Query {
                step: Some(0.002),
                ..Query::new([ca, a], method)
            })
            .unwrap(),
        Domain::Inside
    );
    let mut nodes = vec![[0.0; 3]; model.mesh().nodes()];
    let scene = Scene {
        nodes: Nodes::All,
        frame: Frame::Laboratory,
    };
    evaluator.at(t).unwrap().positions(&scene, &mut nodes).unwrap();
    nodes
}

#[test]
fn the_model_returns_the_family_between_its_samples() {
    let directory = tempfile::tempdir().unwrap();
    let database = database(directory.path());
    let (bytes, report) = build(&database, &settings(), &quiet).unwrap();
    let model = Model::open(&bytes).unwrap();
    assert_eq!(
        (report.samples, report.bytes, report.digest),
        (25, bytes.len(), model.digest())
    );

    // Two shape modes, as many as make a multiple of eight, and the translation; 1, Ca, a/l and its square in the
    // parameters.
    for cluster in &report.clusters {
        assert_eq!(cluster.samples, 15);
        assert!(cluster.field.space_rank <= 9, "{cluster:?}");
        assert!(
            cluster.field.parameter_ranks.iter().all(|rank| *rank <= 8),
            "{cluster:?}"
        );
        assert!(
            cluster.field.space_error < 1e-6 && cluster.field.parameter_error < 1e-6,
            "{cluster:?}"
        );
    }
    for query in [[0.065, 0.87], [0.02, 0.9], [0.1, 0.98], [0.14, 1.0]] {
        for (t, bound) in [(0.0f64, 5e-6), (1.0, 5e-6), (1.1, 3e-5), (2.0, 5e-6)] {
            let exact = trajectory(database.mesh(), query, &[0.0, t.max(0.1)]);
            let exact = &exact.positions[usize::from(t > 0.0)];
            let direct = predicted(&model, query, t, Method::Direct);
            let error = modified_hausdorff(&direct, exact);
            assert!(error < bound, "direct, {query:?}, t = {t}: {error:e}");
            // Forward Euler with a step of 0.002.
            let error = modified_hausdorff(&predicted(&model, query, t, Method::Paper), exact);
            assert!(error < 2e-3, "paper, {query:?}, t = {t}: {error:e}");
        }
    }
}

#[test]
fn a_model_has_the_law_of_its_database() {
    let directory = tempfile::tempdir().unwrap();
    let law = "Skalak, C = 1";
    let database = grid::of_law(directory.path(), law);
    // Never silently that of the settings.
    let Err(error) = build(&database, &settings(), &quiet) else {
        panic!("another law was accepted");
    };
    let text = error.to_string();
    assert!(text.contains("neo-Hookean") && text.contains(law), "{text}");
    let settings = Settings {
        membrane_law: Settings::of_database(&database).membrane_law,
        ..settings()
    };
    let (bytes, _) = build(&database, &settings, &quiet).unwrap();
    let model = Model::open(&bytes).unwrap();
    assert_eq!(model.membrane_law(), law);
    assert!(!model.has_mechanics());
}

#[test]
fn leaving_a_sample_out_changes_nothing_for_the_family() {
    let directory = tempfile::tempdir().unwrap();
    let database = database(directory.path());
    let (times, errors) = leave_one_out(&database, &settings(), &quiet).unwrap();
    assert_eq!(times, [1.0, 2.0]);
    // The shared row belongs to both clusters; two methods.
    assert_eq!(errors.len(), 2 * (15 + 15));
    assert_eq!(errors.iter().filter(|e| e.answers).count(), 2 * 25);
    for error in errors {
        let bound = if error.method == Method::Direct { 5e-5 } else { 2e-2 };
        for (lab, shape) in error.laboratory.iter().zip(&error.shape) {
            assert!(*lab < bound && *shape < bound, "{error:?}");
        }
        assert!(error.deviation > 0.0);
    }
}

#[test]
fn the_ring_around_the_domain_takes_part_and_is_not_answered_for() {
    let directory = tempfile::tempdir().unwrap();
    let database = database(directory.path());
    for ca in [0.12, 0.15, 0.17] {
        let mut unsteady = trajectory(database.mesh(), [ca, 0.85], database.times());
        unsteady.status = Status::Unsteady;
        database.write(&unsteady).unwrap();
    }
    let mut without_snapshots = trajectory(database.mesh(), [0.128, 0.95], &[]);
    without_snapshots.status = Status::Unsteady;
    database.write(&without_snapshots).unwrap();
    let settings = Settings {
        domain: vec![[0.03, 0.2], [0.85, 0.97]],
        beyond: 0.015,
        ..settings()
    };
    let (bytes, report) = build(&database, &settings, &quiet).unwrap();
    // 0.12 lies below the limit of its row, 0.15 little beyond it, 0.17 too far, and 0.128 has no snapshots.
    assert_eq!((report.samples, report.unsteady_samples), (27, 2));
    assert_eq!(report.error_times, [1.0, 2.0]);
    assert!(report.left_out.iter().filter(|e| e.answers && e.inside).all(|e| {
        let [ca, a] = [e.parameters[0], e.parameters[1]];
        (0.03..0.15).contains(&ca) && (0.84..0.97).contains(&a)
    }));
    let model = Model::open(&bytes).unwrap();
    assert_eq!(model.domain([0.05, 0.9]), Ok(Domain::Inside));
    assert_eq!(model.domain([0.02, 0.9]), Ok(Domain::Outside));
    assert_eq!(model.domain([0.05, 1.0]), Ok(Domain::Outside));
    assert_eq!(model.domain([0.145, 0.9]), Ok(Domain::Outside));

    let nothing = Settings {
        domain: vec![[0.3, 0.4], [0.75, 1.2]],
        ..settings
    };
    let error = build(&database, &nothing, &quiet).unwrap_err();
    assert!(matches!(error, OfflineError::Unsampled { .. }), "{error}");
}

#[test]
fn the_papers_design_alone_leaves_the_rest_out() {
    let directory = tempfile::tempdir().unwrap();
    let database = database(directory.path());
    for parameters in [[0.055, 0.9], [0.21, 0.9], [0.08, 0.7], [0.08, 0.92]] {
        let other = trajectory(database.mesh(), parameters, database.times());
        database.write(&other).unwrap();
    }
    let samples = |design| {
        let settings = Settings { design, ..settings() };
        build(&database, &settings, &quiet).unwrap().1.samples
    };
    assert_eq!((samples(Design::All), samples(Design::Paper)), (29, 25));
}

#[test]
fn equal_input_gives_equal_bytes() {
    let directory = tempfile::tempdir().unwrap();
    let database = database(directory.path());
    let settings = Settings {
        created_unix_s: 1_700_000_000,
        ..settings()
    };
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let (a, _) = build(&database, &settings, &quiet).unwrap();
    let (b, _) = one.install(|| build(&database, &settings, &quiet).unwrap());
    assert_eq!(a, b);
}

#[test]
fn ranks_are_kept_as_asked() {
    let directory = tempfile::tempdir().unwrap();
    let database = database(directory.path());
    let truncation = Truncation::Ranks(Ranks { space: 2, parameter: 3 });
    let (_, report) = build(
        &database,
        &Settings {
            truncation,
            ..settings()
        },
        &quiet,
    )
    .unwrap();
    let cluster = &report.clusters[0];
    assert_eq!(
        (cluster.field.space_rank, &cluster.field.parameter_ranks[..]),
        (2, &[3][..])
    );
    let spectrum = report
        .spectra
        .iter()
        .find(|s| s.matrix == "T_u" && s.cluster.is_none())
        .unwrap();
    assert!(
        one_minus_ric(&spectrum.singular_values)
            .windows(2)
            .all(|w| w[1] <= w[0])
    );
}

#[test]
fn a_steady_stop_is_extended_by_translation() {
    // The same family, stored up to t = 1 only, as if it had become steady there: it must go on at its end velocity.
    let directory = tempfile::tempdir().unwrap();
    let database = database(directory.path());
    for entry in database.entries().unwrap() {
        let mut whole = database.read(&entry.parameters).unwrap();
        whole.status = Status::Steady { time: 1.0 };
        whole.times.truncate(6);
        whole.positions.truncate(6);
        whole.velocities.truncate(6);
        whole.centroid.truncate(6);
        whole.pressure_drop.truncate(6);
        database.write(&whole).unwrap();
    }
    let (bytes, _) = build(&database, &settings(), &quiet).unwrap();
    let model = Model::open(&bytes).unwrap();
    let query = [0.05, 0.85];
    let end = trajectory(database.mesh(), query, &[0.0, 1.0]);
    let velocity = database
        .mesh()
        .centroid_velocity(&end.positions[1], &end.velocities[1])
        .unwrap();
    let expected: Vec<_> = end.positions[1]
        .iter()
        .map(|[x, y, z]| [x + velocity, *y, *z])
        .collect();
    let error = modified_hausdorff(&predicted(&model, query, 2.0, Method::Direct), &expected);
    assert!(error < 5e-6, "{error:e}");
}

#[test]
fn what_cannot_be_built_is_named() {
    let directory = tempfile::tempdir().unwrap();
    let database = database(directory.path());
    let mut skew = trajectory(database.mesh(), [0.08, 0.85], database.times());
    skew.positions[2][9][1] += 1e-4;
    database.write(&skew).unwrap();
    let error = build(&database, &settings(), &quiet).unwrap_err();
    assert!(matches!(error, OfflineError::NotSymmetric { .. }), "{error}");

    let bad = Settings {
        split: Some(Split {
            parameter: 1,
            value: f64::NAN,
        }),
        ..settings()
    };
    assert!(matches!(
        build(&database, &bad, &quiet),
        Err(OfflineError::BadSetting { name: "split", .. })
    ));
    let bad = Settings {
        domain: vec![[0.2, 0.1], [0.75, 1.2]],
        ..settings()
    };
    assert!(matches!(
        build(&database, &bad, &quiet),
        Err(OfflineError::BadSetting { name: "domain", .. })
    ));
    let bad = Settings {
        error_times: vec![2.0, 1.0],
        ..settings()
    };
    assert!(matches!(
        build(&database, &bad, &quiet),
        Err(OfflineError::BadSetting { .. })
    ));

    let directory = tempfile::tempdir().unwrap();
    let description = Description::new((0..=10).map(|i| 0.2 * f64::from(i)).collect(), serde_json::Value::Null);
    let empty = Database::create(directory.path(), description.clone(), octahedral(2)).unwrap();
    let mut without_snapshots = trajectory(empty.mesh(), [0.2, 1.2], &[]);
    without_snapshots.status = Status::Unsteady;
    empty.write(&without_snapshots).unwrap();
    let error = build(&empty, &settings(), &quiet).unwrap_err();
    assert!(matches!(error, OfflineError::TooFewSamples { found: 0, .. }), "{error}");

    let directory = tempfile::tempdir().unwrap();
    let mut other = description;
    other.parameters.pop();
    let other = Database::create(directory.path(), other, octahedral(2)).unwrap();
    assert!(matches!(
        build(&other, &settings(), &quiet),
        Err(OfflineError::WrongParameters { .. })
    ));
}
