//! Direct evaluation against a family with exact answers.

use crate::common::{Family, distance};
use capsule_core::{Evaluator, Frame, Method, Model, Nodes, Query, Real, Scene, Workspace};

const ALL: Scene<'_> = Scene {
    nodes: Nodes::All,
    frame: Frame::Laboratory,
};
const QUERIES: [[f64; 2]; 4] = [[0.073, 0.82], [0.012, 0.9], [0.031, 1.13], [0.005, 0.75]];

fn errors<T: Real>(family: &Family, t: f64) -> [f64; 2] {
    let file = family.file();
    let model = Model::open(&file).unwrap();
    let mut workspace = Workspace::<T>::new();
    let mut worst = [0.0_f64; 2];
    for parameters in QUERIES {
        let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
        let [ca, confinement] = parameters.map(T::from_f64);
        evaluator
            .prepare(&Query::new([ca, confinement], Method::Direct))
            .unwrap();
        let mut instant = evaluator.at(T::from_f64(t)).unwrap();
        let mut found = vec![[T::ZERO; 3]; family.nodes()];
        let exact = family.exact(parameters, t);
        assert_eq!(instant.positions(&ALL, &mut found).unwrap(), family.nodes());
        worst[0] = worst[0].max(distance(&found, &exact[0]));
        instant.velocities(&ALL, &mut found).unwrap();
        worst[1] = worst[1].max(distance(&found, &exact[1]));
    }
    worst
}

#[test]
fn exact_at_stored_instants() {
    let family = Family::new(3);
    for t in [0.0, 1.0, 4.0] {
        // The velocity is a difference of stored singles over a third of an interval: 30 times their rounding.
        let [position, velocity] = errors::<f64>(&family, t);
        assert!(
            position < 2e-6 && velocity < 2e-5,
            "f64, t = {t}: {position:e}, {velocity:e}"
        );
        let [position, velocity] = errors::<f32>(&family, t);
        assert!(
            position < 1e-5 && velocity < 1e-4,
            "f32, t = {t}: {position:e}, {velocity:e}"
        );
    }
}

#[test]
fn smooth_between_instants() {
    let [position, velocity] = errors::<f64>(&Family::new(3), 1.234);
    assert!(position < 1e-5 && velocity < 1e-3, "{position:e}, {velocity:e}");
}
