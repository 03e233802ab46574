//! Algorithm 2 against the exact answers and against direct evaluation.

mod common;

use capsule_core::{Evaluator, Frame, Method, Model, Nodes, Query, Real, Scene, Workspace};
use common::{Family, distance};

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
        step: T::from_f64(step),
        ..Query::new(ca, confinement, Method::Paper)
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
fn print_errors() {
    let family = Family::new(3);
    for step in [0.1, 0.05, 0.025, 0.0125, 0.00625] {
        println!(
            "f64 {step} {:?} {:?}",
            errors::<f64>(&family, [0.073, 0.82], step, 3.0),
            errors::<f64>(&family, [0.073, 0.82], step, 0.7)
        );
        println!(
            "f32 {step} {:?} {:?}",
            errors::<f32>(&family, [0.073, 0.82], step, 3.0),
            errors::<f32>(&family, [0.031, 1.13], step, 3.7)
        );
    }
}
