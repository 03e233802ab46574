//! Queries: domain, errors, what is computed again and what is not.

mod common;

use capsule_core::{
    DIAGONAL, Domain, EvaluateError, Evaluator, Frame, MIDPLANE, Method, Model, Nodes, Query, Scene, Workspace,
};
use common::Family;
use proptest::prelude::*;

const METHODS: [Method; 2] = [Method::Direct, Method::Paper];

#[test]
fn parameters_are_judged() {
    let file = Family::new(2).file();
    let model = Model::open(&file).unwrap();
    let mut workspace = Workspace::<f64>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    for method in METHODS {
        let mut prepare = |ca, confinement, extrapolate| {
            evaluator.prepare(&Query {
                extrapolate,
                ..Query::new([ca, confinement], method)
            })
        };
        assert_eq!(prepare(0.05, 0.9, false), Ok(Domain::Inside));
        // The corners as singles and as doubles.
        assert_eq!(prepare(0.005, 0.75, false), Ok(Domain::Inside));
        assert_eq!(
            prepare(f64::from(0.005_f32), f64::from(1.2_f32), false),
            Ok(Domain::Inside)
        );
        let error = prepare(0.3, 0.9, false).unwrap_err();
        assert!(
            matches!(
                error,
                EvaluateError::OutsideDomain {
                    range: [0.005, 0.2],
                    ..
                }
            ),
            "{error}"
        );
        assert_eq!(
            error.to_string(),
            "parameter 1 = 0.3 lies outside its sampled range [0.005, 0.2]"
        );
        assert_eq!(prepare(0.3, 0.9, true), Ok(Domain::Outside));
        assert_eq!(prepare(0.05, 0.6, true), Ok(Domain::Outside));
        let error = prepare(0.15, 1.15, false).unwrap_err();
        assert!(matches!(error, EvaluateError::BeyondSteadyLimit { .. }), "{error}");
        assert_eq!(prepare(0.15, 1.15, true), Ok(Domain::BeyondSteadyLimit));
        for bad in [f64::NAN, f64::INFINITY, 0.0, -0.1] {
            for extrapolate in [false, true] {
                for (name, error) in [
                    ("capillary_number", prepare(bad, 0.9, extrapolate).unwrap_err()),
                    ("confinement", prepare(0.05, bad, extrapolate).unwrap_err()),
                ] {
                    assert!(matches!(error, EvaluateError::Parameter { .. }), "{error}");
                    assert!(error.named(&model).to_string().starts_with(name), "{error}");
                }
            }
        }
    }
    let error = evaluator.prepare(&Query::new([0.05], Method::Direct)).unwrap_err();
    assert_eq!(error, EvaluateError::ParameterCount { expected: 2, found: 1 });
}

#[test]
fn instants_and_steps_are_judged() {
    let file = Family::new(2).file();
    let model = Model::open(&file).unwrap();
    let mut workspace = Workspace::<f32>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    assert_eq!(evaluator.at(1.0).unwrap_err(), EvaluateError::NotPrepared);
    let query = Query::new([0.05, 0.9], Method::Paper);
    for step in [0.0, -0.1, f32::NAN, 1e-9, 5.0] {
        let error = evaluator
            .prepare(&Query {
                step: Some(step),
                ..query
            })
            .unwrap_err();
        assert!(
            matches!(error, EvaluateError::Value { what: "the step", .. }),
            "{error}"
        );
    }
    evaluator.prepare(&query).unwrap();
    for t in [-0.1, 4.01, f32::NAN, f32::INFINITY] {
        let error = evaluator.at(t).unwrap_err();
        assert!(
            matches!(
                error,
                EvaluateError::Value {
                    what: "the instant",
                    min: 0.0,
                    max: 4.0,
                    ..
                }
            ),
            "{error}"
        );
    }
    assert!(evaluator.at(4.0).is_ok());
    // A query that fails leaves nothing that could be taken for its answer.
    assert!(evaluator.prepare(&Query::new([1.0, 0.9], Method::Direct)).is_err());
    assert!(evaluator.at(1.0).is_ok(), "the query before it is still there");
}

#[test]
fn a_model_that_does_not_fit_is_refused_with_the_figures() {
    let file = Family::new(2).file();
    let model = Model::open(&file).unwrap();
    let mut small = Workspace::<f32, 32, 4, 32>::new();
    let mut evaluator = Evaluator::new(&model, &mut small).unwrap();
    let error = evaluator.prepare(&Query::new([0.05, 0.8], Method::Paper)).unwrap_err();
    assert_eq!(
        error,
        EvaluateError::Capacity {
            limit: "local displacement modes",
            required: 10,
            capacity: 4
        }
    );
    let mut small = Workspace::<f32, 20, 16, 20>::new();
    let error = Evaluator::new(&model, &mut small).unwrap_err();
    assert_eq!(
        error,
        EvaluateError::Capacity {
            limit: "neighbours of the kernel",
            required: 24,
            capacity: 20
        }
    );
    assert!(
        error
            .to_string()
            .contains("24 neighbours of the kernel, the workspace holds 20")
    );
    let mut fitting = Workspace::<f32, 24, 10, 24>::new();
    let mut evaluator = Evaluator::new(&model, &mut fitting).unwrap();
    for method in [Method::Direct, Method::Paper] {
        assert!(evaluator.prepare(&Query::new([0.05, 0.8], method)).is_ok());
    }
}

#[test]
fn a_workspace_serves_two_models() {
    let (first, second) = (Family::new(2).file(), Family::new(3).file());
    let (first, second) = (Model::open(&first).unwrap(), Model::open(&second).unwrap());
    let mut workspace = Workspace::<f32>::new();
    let query = Query::new([0.05, 0.8], Method::Paper);
    let mut answer = |model: &Model<'_>| {
        let mut evaluator = Evaluator::new(model, &mut workspace).unwrap();
        let unprepared = evaluator.at(1.0).is_err();
        evaluator.prepare(&query).unwrap();
        (unprepared, evaluator.at(1.0).unwrap().observables().unwrap())
    };
    let alone = answer(&first);
    assert!(alone.0);
    assert_ne!(answer(&second).1, alone.1);
    assert_eq!(answer(&first), alone);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn answers_are_errors_or_finite(
        ca in prop_oneof![0.0..0.3_f32, any::<f32>()],
        confinement in prop_oneof![0.6..1.4_f32, any::<f32>()],
        t in prop_oneof![0.0..4.0_f32, any::<f32>()],
        step in 0.05..1.0_f32,
        paper in any::<bool>(),
    ) {
        thread_local!(static FILE: Vec<u8> = Family::new(2).file());
        FILE.with(|file| {
            let model = Model::open(file).unwrap();
            let mut workspace = Workspace::<f32>::new();
            let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
            let query = Query { extrapolate: true, step: Some(step), ..Query::new([ca, confinement], METHODS[usize::from(paper)]) };
            if evaluator.prepare(&query).is_err() {
                return;
            }
            let Ok(mut instant) = evaluator.at(t) else { return };
            let finite = |points: &[[f32; 3]]| points.iter().flatten().all(|x| x.is_finite());
            let mut points = vec![[0.0; 3]; model.mesh().nodes()];
            let scene = Scene { nodes: Nodes::All, frame: Frame::Laboratory };
            assert!(instant.positions(&scene, &mut points).is_err() || finite(&points));
            assert!(instant.velocities(&scene, &mut points).is_err() || finite(&points));
            assert!(instant.observables().is_err() || instant.centroid().is_finite());
            assert!(instant.volume().map_or(true, f32::is_finite));
            assert!(!instant.expected_error().is_nan());
            let mut outline = vec![[0.0; 2]; 100];
            for name in [MIDPLANE, DIAGONAL] {
                let _ = instant.outline(name, Frame::Laboratory, &mut outline);
            }
        });
    }
}

/// A mode that grows: forward Euler along the learned law (1 + 1.5 h)^n falls behind exp(1.5 t) by a third. Deviations that
/// are only added up leave 1.5 h / 2.
#[test]
fn the_papers_steps_do_not_amplify_deviations() {
    let mut family = Family::new(2);
    family.rates[0] = -1.5;
    let (file, parameters) = (family.file(), [0.05, 0.9]);
    let model = Model::open(&file).unwrap();
    let mut workspace = Workspace::<f64>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    let query = Query::new(parameters, Method::Paper);
    evaluator
        .prepare(&Query {
            step: Some(0.1),
            ..query
        })
        .unwrap();
    let mut found = vec![[0.0; 3]; family.nodes()];
    let scene = Scene {
        nodes: Nodes::All,
        frame: Frame::Centroid,
    };
    evaluator.at(4.0).unwrap().positions(&scene, &mut found).unwrap();
    let [start, end] = [0.0, 4.0].map(|t| {
        let mut nodes = family.exact(parameters, t)[0].clone();
        let centroid = family.state(parameters, t)[0][0] / (family.nodes() as f64).sqrt();
        nodes.iter_mut().for_each(|node| node[0] -= centroid);
        nodes
    });
    let share = common::distance(&found, &end) / common::distance(&start, &end);
    assert!(share < 0.1, "{share}");
}
