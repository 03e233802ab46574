//! Studies of a family of which every answer is known.

#[path = "../../offline/tests/support/grid.rs"]
mod grid;
#[path = "../../offline/tests/support/mod.rs"]
mod support;

use capsule_core::{Method, Model};
use capsule_database::{Database, Description};
use capsule_offline::{Settings, Storage, Truncation, build};
use capsule_study::{
    SampleErrors, StudyError, TEST_TIMES, leave_one_out, speed,
    suggest::{Suggestion, suggest},
    task, test_set, touched,
};

fn quiet(_: &str, _: usize, _: usize) {}

/// Without truncation to speak of.
fn settings() -> Settings {
    let truncation = Truncation::Tolerance(1e-6);
    Settings {
        truncation,
        storage: Storage::Single,
        ..Settings::default()
    }
}

#[test]
fn a_family_that_the_model_contains_has_no_error() {
    let directory = tempfile::tempdir().unwrap();
    let description = Description::new((0..=16).map(|i| 0.5 * f64::from(i)).collect(), serde_json::Value::Null);
    let database = Database::create(directory.path(), description, support::octahedral(2)).unwrap();
    for ca in [0.02, 0.05, 0.08, 0.11, 0.14] {
        for a in [0.8, 0.85, 0.9, 0.95, 1.0] {
            database
                .write(&support::trajectory(database.mesh(), [ca, a], database.times()))
                .unwrap();
        }
    }
    let report = leave_one_out(&database, &settings(), &quiet).unwrap();
    assert_eq!((report.samples, report.default), (25, "direct"));
    assert_eq!(
        report.methods["direct"].iter().map(|i| i.t).collect::<Vec<_>>(),
        [1.0, 2.0, 4.0, 8.0]
    );
    for instant in &report.methods["direct"] {
        assert!(
            instant.lab_max_percent < 0.02 && instant.shape_max_percent < 0.02,
            "{instant:?}"
        );
        assert!(instant.lab_mean_percent <= instant.lab_max_percent);
    }
    // 25 samples, 4 instants, 2 methods.
    let csv = String::from_utf8(report.csv().unwrap()).unwrap();
    assert_eq!(csv.lines().count(), 1 + 25 * 4 * 2);

    // A sample that does not belong to the family.
    let mut stranger = support::trajectory(database.mesh(), [0.08, 0.9], database.times());
    for positions in &mut stranger.positions[1..] {
        for p in positions {
            p[0] += 0.01;
        }
    }
    for centroid in &mut stranger.centroid[1..] {
        *centroid += 0.01;
    }
    database.write(&stranger).unwrap();
    let report = leave_one_out(&database, &settings(), &quiet).unwrap();
    // It is predicted from the family alone, 0.01 l behind where it is, in the shape that it has.
    let itself = |e: &&SampleErrors| e.parameters == [0.08, 0.9];
    let stranger = report.values["direct"].iter().find(itself).unwrap();
    assert!(
        (stranger.lab_percent[0] - 100.0 * 0.01 / 0.9).abs() < 0.05,
        "{stranger:?}"
    );
    assert!(stranger.shape_percent[0] < 0.02, "{stranger:?}");
}

#[test]
fn without_truncation_the_interpolation_errs_as_the_model_does() {
    let [samples, tests, coarse] = [2, 2, 1].map(|n| {
        let directory = tempfile::tempdir().unwrap();
        let description = Description::new((0..=16).map(|i| 0.5 * f64::from(i)).collect(), serde_json::Value::Null);
        let database = Database::create(directory.path(), description, support::octahedral(n)).unwrap();
        (directory, database)
    });
    let family =
        |database: &Database, [ca, a]: [f64; 2]| support::trajectory(database.mesh(), [ca, a], database.times());
    for ca in [0.02, 0.05, 0.08, 0.11, 0.14] {
        for a in [0.8, 0.85, 0.9, 0.95, 1.0] {
            let mut sample = family(&samples.1, [ca, a]);
            // One does not belong to the family, so that there is an error.
            if (ca, a) == (0.08, 0.85) {
                let fields = sample.positions.iter_mut().chain(&mut sample.velocities);
                fields.flatten().for_each(|[_, y, z]| (*y, *z) = (1.01 * *y, 1.01 * *z));
            }
            samples.1.write(&sample).unwrap();
            coarse.1.write(&family(&coarse.1, [ca, a])).unwrap();
        }
    }
    for parameters in [[0.07, 0.86], [0.09, 0.84], [0.06, 0.97]] {
        tests.1.write(&family(&tests.1, parameters)).unwrap();
    }
    let (bytes, _) = build(&samples.1, &settings(), &quiet).unwrap();
    let model = Model::open(&bytes).unwrap();
    let found = test_set(&model, &tests.1, Some(&samples.1), &TEST_TIMES, &quiet).unwrap();
    assert_eq!(found.interpolation.len(), found.methods["direct"].len());
    for (alone, direct) in found.interpolation.iter().zip(&found.methods["direct"]) {
        assert!(alone.lab_max_percent > 0.1, "{alone:?}");
        for (a, b) in [
            (alone.lab_mean_percent, direct.lab_mean_percent),
            (alone.lab_max_percent, direct.lab_max_percent),
            (alone.shape_mean_percent, direct.shape_mean_percent),
            (alone.shape_max_percent, direct.shape_max_percent),
        ] {
            assert!((a - b).abs() < 5e-3, "{alone:?} {direct:?}");
        }
    }
    // Snapshots on another mesh are refused.
    assert!(test_set(&model, &tests.1, Some(&coarse.1), &TEST_TIMES, &quiet).is_err());
}

/// A model of a small grid of the family.
fn model_file() -> Vec<u8> {
    let directory = tempfile::tempdir().unwrap();
    let settings = Settings {
        error_times: vec![1.0],
        ..Settings::default()
    };
    build(&grid::database(directory.path()), &settings, &quiet).unwrap().0
}

#[test]
fn suggestions_spread_and_leave_less_to_expect() {
    let file = model_file();
    let model = Model::open(&file).unwrap();
    let found = suggest(&model, 120, 2.0).unwrap();
    for (i, suggestion) in found.iter().enumerate() {
        let before = found[..i].iter().any(|other| other.parameters == suggestion.parameters);
        assert!(!before, "{suggestion:?} comes twice");
    }
    // They spread: no two of the first ones are neighbours on the lattice of candidates, 1/31 of the domain apart.
    let ranges = &model.contents().metadata.parameters;
    let distance = |a: &[f64], b: &[f64]| -> f64 {
        let shares = a
            .iter()
            .zip(b)
            .zip(ranges)
            .map(|((a, b), r)| ((a - b) / (r.max - r.min)).powi(2));
        shares.sum::<f64>().sqrt()
    };
    let closest = (1..12).flat_map(|i| (0..i).map(move |j| (i, j)));
    let closest = closest.map(|(i, j)| distance(&found[i].parameters, &found[j].parameters));
    let closest = closest.fold(f64::INFINITY, f64::min);
    assert!(
        closest > 1.5 / 31.0,
        "two suggestions are {closest} of the domain apart"
    );
    // They leave less to expect: the greatest expected error falls from each twenty to the next.
    let greatest = |group: &[Suggestion]| group.iter().map(|s| s.expected_percent).fold(0.0, f64::max);
    let falling: Vec<f64> = found.chunks(20).map(greatest).collect();
    assert!(falling.windows(2).all(|pair| pair[1] < pair[0]), "{falling:?}");
    let [first, last] = [&found[0], &found[119]].map(|suggestion| suggestion.expected_percent);
    assert!(last < 0.2 * first, "{first} to {last}");
}

#[test]
fn times_are_positive_and_ordered() {
    let bytes = model_file();
    let model = Model::open(&bytes).unwrap();
    let questions = task::questions(&model, 12).unwrap();
    for task in task::tasks(&model) {
        let timing = speed::time::<f32>(&model, Method::Direct, &task, &questions).unwrap();
        assert!(
            0.0 < timing.lower_quartile_us && timing.lower_quartile_us <= timing.median_us,
            "{timing:?}"
        );
        assert!(
            timing.median_us <= timing.upper_quartile_us && timing.bits == 32,
            "{timing:?}"
        );
        let error = speed::time::<f64>(&model, Method::Direct, &task, &[]).unwrap_err();
        assert!(
            matches!(error, StudyError::NothingToMeasure { queries: 0, .. }),
            "{error}"
        );
    }
}

#[test]
fn an_answer_depends_on_what_it_shows_alone() {
    const BLOCK: usize = 16;
    let bytes = model_file();
    let model = Model::open(&bytes).unwrap();
    let question = task::questions(&model, 1).unwrap()[0];
    let touched = |name: &str| {
        let task = task::tasks(&model).find(|task| task.name == name).unwrap();
        touched::touched(&bytes, BLOCK, &task, &question).unwrap()
    };
    let (outline, surface, next) = (
        touched("scene_outline"),
        touched("scene_surface"),
        touched("next_frame"),
    );
    let within = |few: &[usize], many: &[usize]| few.iter().all(|block| many.contains(block));
    assert!(!outline.is_empty() && within(&outline, &surface) && outline.len() < surface.len());
    assert!(within(&touched("observables"), &surface));
    // New parameters, and then the same.
    let new = touched("surface");
    assert!(within(&surface, &new) && within(&touched("prepare"), &new));
    // Nothing that belongs to the other instants or to the velocities' nodes.
    assert!(next.len() <= surface.len() && new.len() * BLOCK < bytes.len() / 2);
}
