//! The stated bound of models of other people's data: families with known answers, asked at parameters and instants
//! that no snapshot has.

#[path = "support/collection.rs"]
mod support;

use capsule_core::{EvaluateError, Evaluator, Frame, Method, Model, Nodes, Parameters, Query, Scene, Workspace};
use capsule_database::Mesh;
use capsule_offline::{Settings, build};
use support::collection;

/// Stretch, dent and axial position at parameters in the unit square and t in [0, 2].
type Family = fn(f64, f64, f64) -> [f64; 3];

fn smooth(p: f64, q: f64, t: f64) -> [f64; 3] {
    [
        1.0 + 0.25 * (1.3 * t * (1.0 + 0.5 * p)).sin() + 0.05 * q * t,
        0.1 * (2.0 * p + t).cos() * q,
        (1.0 + 0.3 * (2.0 * p).sin() + 0.2 * q * q) * t,
    ]
}

/// Relaxes within one or two intervals of the instants.
fn stiff(p: f64, q: f64, t: f64) -> [f64; 3] {
    let relaxed = 1.0 - (-t / (0.08 + 0.1 * p)).exp();
    [
        1.0 + (0.2 + 0.1 * q) * relaxed,
        0.1 * (p + q).sin() * relaxed,
        (1.0 + 0.2 * p) * t + 0.05 * relaxed,
    ]
}

/// A dent that starts at an instant of its own.
fn kinked(p: f64, q: f64, t: f64) -> [f64; 3] {
    let start = 0.5 + 0.6 * p + 0.2 * q;
    [
        1.0 + 0.2 * (t * (1.0 + 0.3 * q)).sin(),
        0.15 * (t - start).max(0.0),
        (1.0 + 0.2 * p) * t - 0.1 * (t - start).max(0.0),
    ]
}

/// A node of a volume-preserving stretch with a dent behind.
fn node([x, y, z]: [f64; 3], [stretch, dent, position]: [f64; 3]) -> [f64; 3] {
    let across = 1.0 / stretch.sqrt();
    let dented = stretch * x - dent * (y * y + z * z) * (1.0 - x);
    [dented + position, across * y, across * z]
}

fn halton(index: usize, base: usize) -> f64 {
    let (mut index, mut share, mut value) = (index + 1, 1.0, 0.0);
    while index > 0 {
        share /= base as f64;
        value += share * (index % base) as f64;
        index /= base;
    }
    value
}

fn grid(n: usize) -> Vec<Vec<f64>> {
    let at = |i: usize| i as f64 / (n - 1) as f64;
    (0..n * n).map(|k| vec![at(k % n), at(k / n)]).collect()
}

fn scattered(n: usize) -> Vec<Vec<f64>> {
    (0..n).map(|i| vec![halton(i, 2), halton(i, 3)]).collect()
}

/// Errors in the bound, of queries at parameters and instants that are in no snapshot.
fn ratios(model: &Model<'_>, mesh: &Mesh, family: Family) -> Vec<f64> {
    let mut workspace = Box::new(Workspace::<f64>::new());
    let mut evaluator = Evaluator::new(model, &mut workspace).unwrap();
    let scene = Scene {
        nodes: Nodes::All,
        frame: Frame::Laboratory,
    };
    let mut found = vec![[0.0; 3]; mesh.nodes.len()];
    let mut ratios = Vec::new();
    for index in 1000..1600 {
        let ([p, q], t) = ([halton(index, 5), halton(index, 7)], 2.0 * halton(index, 11));
        match evaluator.prepare(&Query::new(Parameters::from([p, q]), Method::Direct)) {
            Err(EvaluateError::OutsideDomain { .. } | EvaluateError::FarFromSamples { .. }) => continue,
            other => other.unwrap(),
        };
        let mut instant = evaluator.at(t).unwrap();
        instant.positions(&scene, &mut found).unwrap();
        let motion = family(p, q, t);
        let exact: Vec<[f64; 3]> = mesh.nodes.iter().map(|reference| node(*reference, motion)).collect();
        let apart = |(a, b): (&[f64; 3], &[f64; 3])| (0..3).map(|d| (a[d] - b[d]).powi(2)).sum::<f64>().sqrt();
        let error = found.iter().zip(&exact).map(apart).sum::<f64>() / found.len() as f64;
        let radius = model.radius([p, q]);
        ratios.push(error / radius / instant.error_bound().unwrap());
    }
    ratios
}

/// The model of a family on a design, at so many instants.
fn built(mesh: &Mesh, family: Family, parameters: &[Vec<f64>], instants: usize) -> Vec<u8> {
    let times = (0..instants).map(|i| 2.0 * i as f64 / (instants - 1) as f64);
    let collection = collection(mesh, parameters.to_vec(), times.collect(), |reference, [p, q], t| {
        node(reference, family(p, q, t))
    });
    let settings = Settings::of_collection(&collection).unwrap();
    build(&collection, &settings, &|_, _, _| {}).unwrap().0
}

#[test]
fn the_bound_holds_at_parameters_and_instants_that_no_snapshot_has() {
    let mesh = support::octahedral(2);
    for (name, family) in [("smooth", smooth as Family), ("stiff", stiff), ("kinked", kinked)] {
        for (design, parameters) in [("grid", grid(6)), ("scattered", scattered(40))] {
            for instants in [9, 21, 41] {
                let bytes = built(&mesh, family, &parameters, instants);
                let model = Model::open(&bytes).unwrap();
                let mut ratios = ratios(&model, &mesh, family);
                ratios.sort_by(f64::total_cmp);
                let below = ratios.iter().filter(|ratio| **ratio <= 1.0).count() as f64 / ratios.len() as f64;
                let median = ratios[ratios.len() / 2];
                println!(
                    "{name} {design}, {instants} instants: {:.1} % of {} below the bound, median {median:.3} of it",
                    100.0 * below,
                    ratios.len()
                );
                assert!(below >= 0.93, "{name}, {design}, {instants} instants: {below}");
                // A bound that says nothing would hold too.
                assert!(median > 0.05, "{name}, {design}, {instants} instants: {median}");
            }
        }
    }
}

/// Nine samples say little: the bound is wide, but no query exceeds it.
#[test]
fn the_bound_of_a_few_samples_and_instants_holds_too() {
    let mesh = support::octahedral(2);
    for family in [smooth as Family, stiff, kinked] {
        for instants in [2, 3, 5, 7] {
            let bytes = built(&mesh, family, &grid(3), instants);
            let model = Model::open(&bytes).unwrap();
            let ratios = ratios(&model, &mesh, family);
            let below = ratios.iter().filter(|ratio| **ratio <= 1.0).count() as f64 / ratios.len() as f64;
            assert!(below >= 0.93, "{instants} instants: {below}");
        }
    }
}

/// Samples that lie dense along rows and sparse across them, as those of the channel do: a leave-one-out error asks
/// along a row, where all is well known, and says nothing of what is beyond the last row.
#[test]
fn a_guess_beyond_the_last_row_is_not_far_too_small() {
    let mesh = support::octahedral(2);
    let rows: Vec<Vec<f64>> = (0..4)
        .flat_map(|row| (0..17).map(move |k| vec![f64::from(k) / 16.0, f64::from(row) / 3.0]))
        .collect();
    let curved: Family = |p, q, t| {
        [
            1.0 + 0.1 * (q + p).sin() * t,
            0.05 * q,
            (1.0 + 0.6 * (-1.5 * q).exp()) * t,
        ]
    };
    let bytes = built(&mesh, curved, &rows, 21);
    let model = Model::open(&bytes).unwrap();
    let mut workspace = Box::new(Workspace::<f64>::new());
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    let scene = Scene {
        nodes: Nodes::All,
        frame: Frame::Laboratory,
    };
    let mut found = vec![[0.0; 3]; mesh.nodes.len()];
    for q in [-0.1, -0.3, 1.3] {
        let query = Query {
            extrapolate: true,
            ..Query::new(Parameters::from([0.52, q]), Method::Direct)
        };
        evaluator.prepare(&query).unwrap();
        for t in [0.4, 1.9] {
            let mut instant = evaluator.at(t).unwrap();
            instant.positions(&scene, &mut found).unwrap();
            let motion = curved(0.52, q, t);
            let exact: Vec<[f64; 3]> = mesh.nodes.iter().map(|reference| node(*reference, motion)).collect();
            let apart = |(a, b): (&[f64; 3], &[f64; 3])| (0..3).map(|d| (a[d] - b[d]).powi(2)).sum::<f64>().sqrt();
            let error =
                found.iter().zip(&exact).map(apart).sum::<f64>() / found.len() as f64 / model.radius([0.5, 0.5]);
            let guess = instant.expected_error().unwrap();
            println!("q = {q}, t = {t}: {error:.5}, guessed {guess:.5}");
            assert!(error < 5.0 * guess, "q = {q}, t = {t}: {error} {guess}");
        }
    }
}
