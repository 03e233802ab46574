//! Algorithm 2 against the exact answers and against direct evaluation.

use crate::common::{Family, distance};
use capsule_core::{Evaluator, Frame, Method, Model, Nodes, Query, Real, Scene, Scheme, Workspace};

const LABORATORY: Scene<'_> = Scene {
    nodes: Nodes::All,
    frame: Frame::Laboratory,
};

/// Greatest errors of positions and velocities at `t`.
fn errors<T: Real>(family: &Family, parameters: [f64; 2], step: f64, t: f64) -> [f64; 2] {
    let file = family.file();
    let model = Model::open(&file).unwrap();
    let mut workspace = Workspace::<T>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    let [ca, confinement] = parameters.map(T::from_f64);
    let query = Query {
        step: Some(T::from_f64(step)),
        ..Query::new([ca, confinement], Method::Paper)
    };
    evaluator.prepare(&query).unwrap();
    let mut instant = evaluator.at(T::from_f64(t)).unwrap();
    let exact = family.exact(parameters, t);
    let mut found = vec![[T::ZERO; 3]; family.nodes()];
    instant.positions(&LABORATORY, &mut found).unwrap();
    let position = distance(&found, &exact[0]);
    instant.velocities(&LABORATORY, &mut found).unwrap();
    [position, distance(&found, &exact[1])]
}

#[test]
fn converges_to_the_exact_motion_with_order_one_in_the_step() {
    let family = Family::new(3);
    for (parameters, t) in [([0.073, 0.82], 0.7), ([0.031, 1.13], 1.1)] {
        let steps = [0.1, 0.05, 0.025];
        let errors = steps.map(|step| errors::<f64>(&family, parameters, step, t)[0]);
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((0.8..1.8).contains(&order), "{parameters:?}: {errors:?}");
        }
    }
}

#[test]
fn schemes_of_higher_order_leave_less() {
    let family = Family::new(2);
    let file = family.file();
    let model = Model::open(&file).unwrap();
    let (parameters, t) = ([0.073, 0.82], 1.0);
    let exact = family.exact(parameters, t);
    let error = |scheme| {
        let mut workspace = Workspace::<f64>::new();
        let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
        let query = Query::new(parameters, Method::Paper);
        let query = Query {
            step: Some(0.1),
            scheme,
            ..query
        };
        evaluator.prepare(&query).unwrap();
        let mut found = vec![[0.0; 3]; family.nodes()];
        evaluator.at(t).unwrap().positions(&LABORATORY, &mut found).unwrap();
        distance(&found, &exact[0])
    };
    let [euler, heun, fourth] = [Scheme::Euler, Scheme::Heun, Scheme::RungeKutta4].map(error);
    assert!(
        heun < 0.2 * euler && fourth < 0.2 * euler,
        "{euler:e} {heun:e} {fourth:e}"
    );
}

#[test]
fn a_small_step_is_close_in_both_precisions() {
    let family = Family::new(3);
    for (parameters, t) in [([0.073, 0.82], 3.0), ([0.031, 1.13], 3.7), ([0.073, 0.82], 0.0)] {
        for [position, velocity] in [
            errors::<f64>(&family, parameters, 0.005, t),
            errors::<f32>(&family, parameters, 0.005, t),
        ] {
            assert!(
                position < 5e-4 && velocity < 5e-4,
                "{parameters:?}, t = {t}: {position:e}, {velocity:e}"
            );
        }
    }
}

#[test]
fn the_answer_does_not_depend_on_the_way_to_the_instant() {
    let family = Family::new(2);
    let file = family.file();
    let model = Model::open(&file).unwrap();
    let mut workspace = Workspace::<f32>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    evaluator.prepare(&Query::new([0.05, 0.9], Method::Paper)).unwrap();
    let mut at = |t: f32| {
        let mut instant = evaluator.at(t).unwrap();
        (instant.observables().unwrap(), instant.volume().unwrap())
    };
    let straight = at(1.337);
    let (_, _, later) = (at(0.0), at(0.4), at(3.1));
    // Back in time, and again.
    assert_eq!(at(1.337), straight);
    assert_eq!(at(3.1), later);
}

#[test]
fn a_membrane_that_relaxes_between_snapshots_stays_stable() {
    // The fastest coefficient falls by exp(-15) from one snapshot to the next: forward Euler with this step would grow
    // by a factor of 2 a step.
    let family = Family {
        rates: [150.0, 0.6, 1.7, 2.9],
        ..Family::new(3)
    };
    for t in [0.05, 0.5, 4.0] {
        let [position, _] = errors::<f32>(&family, [0.073, 0.82], 0.02, t);
        assert!(position < 0.05, "t = {t}: {position}");
    }
}
