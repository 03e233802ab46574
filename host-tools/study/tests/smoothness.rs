//! Differences along rows whose answer is known.

#[path = "../../offline/tests/support/grid.rs"]
mod grid;
#[path = "../../offline/tests/support/mod.rs"]
mod support;

use capsule_database::{Database, Description, Status, Trajectory};
use capsule_study::smoothness::smoothness;

/// A translation that is a cubic of Ca, with a bump of `scatter` (l) in every second sample.
fn database(directory: &std::path::Path, scatter: f64) -> Database {
    let times = vec![0.0, 1.0, 2.0];
    let description = Description::new(times.clone(), serde_json::Value::Null);
    let database = Database::create(directory, description, support::octahedral(2)).unwrap();
    for i in 1..=9 {
        let ca = f64::from(i) / 100.0;
        let base = support::trajectory(database.mesh(), [0.05, 0.9], &times);
        let moved = |instant: usize| {
            let bump = if i % 2 == 0 { scatter } else { 0.0 };
            times[instant] * ca.powi(3) + if instant == 2 { bump } else { 0.0 }
        };
        let shift = |fields: &[Vec<[f64; 3]>]| -> Vec<Vec<[f64; 3]>> {
            let shifted = fields.iter().enumerate();
            shifted
                .map(|(instant, field)| field.iter().map(|&[x, y, z]| [x + moved(instant), y, z]).collect())
                .collect()
        };
        let trajectory = Trajectory {
            parameters: vec![ca, 0.9],
            status: Status::Steady { time: 2.0 },
            positions: shift(&base.positions),
            centroid: base.centroid.iter().enumerate().map(|(k, x)| x + moved(k)).collect(),
            ..base
        };
        database.write(&trajectory).unwrap();
    }
    database
}

#[test]
fn a_cubic_has_its_third_difference_and_none_beyond() {
    let directory = tempfile::tempdir().unwrap();
    let rows = smoothness(&database(directory.path(), 0.0), 0.01).unwrap();
    // The two samples next to the limit are left out.
    assert_eq!((rows.len(), rows[0].capillary_numbers), (1, [0.01, 0.07]));
    let [third, fourth, ..] = &rows[0].laboratory[..] else {
        panic!()
    };
    // 3! h³ t / a in one of three components.
    let exact = 6.0 * 1e-6 * 2.0 / 0.9;
    assert!((third.greatest - exact).abs() < 2e-6 && third.at[1] == 2.0, "{third:?}");
    assert!(fourth.greatest < 5e-6, "{fourth:?}");
    assert!(rows[0].shape.iter().all(|difference| difference.greatest < 1e-5));
}

#[test]
fn scatter_is_amplified() {
    let directory = tempfile::tempdir().unwrap();
    let rows = smoothness(&database(directory.path(), 1e-3), 0.01).unwrap();
    // Alternating scatter: sum of the binomials that meet it.
    for (difference, sum) in rows[0].laboratory.iter().zip([4.0, 8.0, 16.0, 32.0]) {
        let exact = sum * 1e-3 / 0.9;
        assert!(
            (difference.greatest / exact - 1.0).abs() < 0.05 && difference.at[1] == 2.0,
            "{difference:?}"
        );
        assert!(difference.scatter < difference.median);
    }
}

#[test]
fn rows_that_are_too_short_are_left_out() {
    let directory = tempfile::tempdir().unwrap();
    // Rows of five, of which the last two are next to the limit.
    let rows = smoothness(&grid::database(directory.path()), 0.03).unwrap();
    assert!(rows.is_empty());
}
