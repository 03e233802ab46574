//! Queries: domain, errors, what is computed again and what is not.

use crate::common::{self, Family};
use capsule_core::model::wire::Matrix;
use capsule_core::{
    DIAGONAL, Domain, EvaluateError, Evaluator, Frame, MIDPLANE, Method, Model, Nodes, Playback, Query, Scene,
    Workspace, playback_len, scratch_len,
};
use proptest::prelude::*;

const METHODS: [Method; 2] = [Method::Direct, Method::Paper];

#[test]
fn parameters_are_validated() {
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
                    assert!(model.describe(error).to_string().starts_with(name), "{error}");
                }
            }
        }
    }
    let error = evaluator.prepare(&Query::new([0.05], Method::Direct)).unwrap_err();
    assert_eq!(error, EvaluateError::ParameterCount { expected: 2, found: 1 });
}

#[test]
fn instants_and_steps_are_validated() {
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

/// Checks that all numbers of an answer are finite, or that its error is one of those of an extrapolated shape.
fn assert_finite_or_refused<A>(what: &str, answer: Result<A, EvaluateError>, numbers: impl FnOnce(A) -> Vec<f32>) {
    match answer {
        Ok(answer) => {
            let numbers = numbers(answer);
            assert!(
                !numbers.is_empty() && numbers.iter().all(|number| number.is_finite()),
                "{what}: {numbers:?}"
            );
        }
        Err(error) => assert!(
            matches!(
                error,
                EvaluateError::NotFinite | EvaluateError::WrongVolume { .. } | EvaluateError::BeyondWall { .. }
            ),
            "{what}: {error}"
        ),
    }
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
            let query = Query {
                extrapolate: true,
                step: Some(step),
                ..Query::new([ca, confinement], METHODS[usize::from(paper)])
            };
            let Ok(domain) = evaluator.prepare(&query) else {
                assert_eq!(evaluator.at(1.0).unwrap_err(), EvaluateError::NotPrepared);
                return;
            };
            let mut instant = match evaluator.at(t) {
                Ok(instant) => instant,
                Err(error) => {
                    assert!(!(0.0..=4.0).contains(&t) && matches!(error, EvaluateError::Value { .. }), "{t}: {error}");
                    return;
                }
            };
            let mut points = vec![[0.0; 3]; model.mesh().nodes()];
            let scene = Scene { nodes: Nodes::All, frame: Frame::Laboratory };
            let positions = instant.positions(&scene, &mut points);
            assert_finite_or_refused("positions", positions, |count| points[..count].as_flattened().to_vec());
            let velocities = instant.velocities(&scene, &mut points);
            assert_finite_or_refused("velocities", velocities, |count| points[..count].as_flattened().to_vec());
            assert_finite_or_refused("observables", instant.observables(), |found| {
                vec![
                    found.axial_length,
                    found.half_width,
                    found.half_diagonal,
                    found.rear_depth,
                    found.velocity,
                    found.centroid,
                ]
            });
            assert_finite_or_refused("centroid", instant.centroid(), |found| vec![found]);
            assert_finite_or_refused("centroid velocity", instant.centroid_velocity(), |found| vec![found]);
            assert_finite_or_refused("volume", instant.volume(), |found| vec![found]);
            assert_finite_or_refused("expected error", instant.expected_error(), |found| vec![found]);
            if domain == Domain::Inside {
                assert_finite_or_refused("error bound", instant.error_bound(), |found| vec![found]);
            } else {
                assert_eq!(instant.error_bound(), Err(EvaluateError::NoBound));
            }
            let mut outline = vec![[0.0; 2]; 100];
            for name in [MIDPLANE, DIAGONAL] {
                let points = instant.outline(name, Frame::Laboratory, &mut outline);
                assert_finite_or_refused(name, points, |count| outline[..count].as_flattened().to_vec());
            }
        });
    }
}

/// A mode that grows: forward Euler along the learned law (1 + 1.5 h)^n falls behind exp(1.5 t) by a third. Deviations
/// that are only added up leave 1.5 h / 2.
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

/// Refusals of every kind, each after a query that was answered.
#[test]
fn a_refused_query_leaves_nothing_prepared() {
    let file = Family::new(2).file();
    let model = Model::open(&file).unwrap();
    let mut workspace = Workspace::<f32, 129, 0, 32, { scratch_len(0, 32) }>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    let good = Query::new([0.1, 0.9], Method::Direct);
    let refused = [
        Query::new([0.9, 0.9], Method::Direct),
        Query::new([f32::NAN, 0.9], Method::Direct),
        Query::new([0.1, -0.9], Method::Direct),
        Query::new([0.199, 0.9], Method::Direct),
        Query::new([0.1], Method::Direct),
        Query {
            step: Some(-1.0),
            ..good
        },
        Query {
            extrapolate: true,
            ..Query::new([1e5, 100.0], Method::Direct)
        },
        // No room for it in this workspace.
        Query::new([0.1, 0.9], Method::Paper),
    ];
    for query in refused {
        evaluator.prepare(&good).unwrap();
        assert!(evaluator.at(3.0).unwrap().observables().is_ok());
        assert!(evaluator.prepare(&query).is_err(), "{query:?}");
        assert_eq!(evaluator.at(3.0).unwrap_err(), EvaluateError::NotPrepared, "{query:?}");
    }
}

#[test]
fn the_domain_of_too_few_or_too_many_parameters_is_refused() {
    let file = Family::new(2).file();
    let model = Model::open(&file).unwrap();
    assert_eq!(model.domain([0.1, 0.9]), Ok(Domain::Inside));
    let count = |found| Err(EvaluateError::ParameterCount { expected: 2, found });
    assert_eq!(model.domain([0.1]), count(1));
    assert_eq!(model.domain([0.1, 0.9, 0.9]), count(3));
}

/// The family's volume grows when it is extrapolated: it is refused where it is 2 % off or a node is beyond a wall, at
/// every door, and answered before that, without a bound.
#[test]
fn an_impossible_extrapolated_shape_is_refused_at_every_door() {
    let family = Family::new(2);
    let file = family.file();
    let model = Model::open(&file).unwrap();
    let mut workspace = Workspace::<f64>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    let (mut answered, mut volumes, mut walls) = (0, 0, 0);
    for [ca, confinement] in [[0.141, 0.76], [0.2, 0.8], [0.2, 1.15], [0.3, 0.8], [0.1, 1.4]] {
        let query = Query {
            extrapolate: true,
            ..Query::new([ca, confinement], Method::Direct)
        };
        assert_ne!(evaluator.prepare(&query).unwrap(), Domain::Inside);
        for t in [0.0, 0.01, 3.0] {
            // Independent of the core: the family's own nodes.
            let [exact, _] = family.exact([ca, confinement], t);
            let reach = exact
                .iter()
                .flat_map(|[_, y, z]| [y.abs(), z.abs()])
                .fold(0.0, f64::max);
            let mut instant = evaluator.at(t).unwrap();
            assert_eq!(instant.error_bound(), Err(EvaluateError::NoBound));
            let found = instant.volume();
            let mut nodes = vec![[0.0; 3]; family.nodes()];
            let scene = Scene {
                nodes: Nodes::All,
                frame: Frame::Laboratory,
            };
            let mut outline = [[0.0; 2]; 100];
            let room = vec![0.0; playback_len(&model)];
            let doors = [
                instant.positions(&scene, &mut nodes).err(),
                instant.velocities(&scene, &mut nodes).err(),
                instant.centroid().err(),
                instant.centroid_velocity().err(),
                instant.observables().err(),
                instant.outline(MIDPLANE, Frame::Centroid, &mut outline).err(),
                instant.membrane(&mut nodes.clone()).err(),
                evaluator
                    .frame(t, Frame::Centroid, &mut Playback::new(room), &mut nodes)
                    .err(),
            ];
            assert!(
                doors.iter().all(|error| *error == found.err()),
                "{ca} {confinement} {t}: {doors:?}"
            );
            match found {
                Ok(_) => answered += 1,
                Err(EvaluateError::BeyondWall { reach: found }) => {
                    assert!(
                        (f64::from(found) - reach).abs() < 1e-4 && reach > 1.0,
                        "{found} {reach}"
                    );
                    walls += 1;
                }
                Err(EvaluateError::WrongVolume { volume, .. }) => {
                    assert!(reach < 1.0 + 1e-4 && (volume - 1.0).abs() > 0.02, "{volume} {reach}");
                    volumes += 1;
                }
                Err(error) => panic!("{error}"),
            }
        }
    }
    assert!(answered > 0 && volumes > 0 && walls > 0, "{answered} {volumes} {walls}");
}

/// Numbers that a valid file may hold, and that lead beyond single precision: an error, never an infinity.
#[test]
fn absurd_numbers_of_a_valid_model_are_refused_where_they_leave() {
    let family = Family::new(2);
    let mut arena = common::Arena::default();
    let mut contents = family.contents(&mut arena);
    let fill = |matrix: &Matrix<'_>, value: f32| {
        let count = (matrix.rows * matrix.columns) as usize;
        let bytes: Vec<u8> = (0..count).flat_map(|_| value.to_le_bytes()).collect();
        Matrix::f32(matrix.rows, matrix.columns, bytes.leak())
    };
    for cluster in &mut contents.clusters {
        for errors in [&mut cluster.direct_errors, &mut cluster.paper_errors] {
            errors.deviation = fill(&errors.deviation, f32::MIN_POSITIVE);
            errors.left_out = fill(&errors.left_out, 10.0);
        }
    }
    let file = common::write(&contents);
    let model = Model::open(&file).unwrap();
    let mut workspace = Workspace::<f32>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    for method in METHODS {
        evaluator.prepare(&Query::new([0.053, 0.87], method)).unwrap();
        let mut instant = evaluator.at(1.5).unwrap();
        assert_eq!(instant.expected_error(), Err(EvaluateError::NotFinite));
        assert_eq!(instant.error_bound(), Err(EvaluateError::NotFinite));
        assert!(instant.observables().is_ok());
    }
}

#[test]
fn without_outlines_the_lengths_are_those_of_all_nodes() {
    let family = Family::new(3);
    let mut arena = common::Arena::default();
    let mut contents = family.contents(&mut arena);
    contents.mesh.node_sets.clear();
    let file = common::write(&contents);
    let model = Model::open(&file).unwrap();
    let mut workspace = Workspace::<f64>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    evaluator.prepare(&Query::new([0.053, 0.87], Method::Direct)).unwrap();
    let mut instant = evaluator.at(1.5).unwrap();
    let scene = Scene {
        nodes: Nodes::All,
        frame: Frame::Laboratory,
    };
    let mut nodes = vec![[0.0; 3]; family.nodes()];
    instant.positions(&scene, &mut nodes).unwrap();
    let found = instant.observables().unwrap();
    let extent = |along: fn(&[f64; 3]) -> f64| {
        let values = || nodes.iter().map(along);
        values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min)
    };
    let expected = [
        extent(|node| node[0]),
        0.5 * extent(|node| node[1]),
        0.5 * extent(|node| (node[1] + node[2]) / 2.0_f64.sqrt()),
    ];
    let found = [found.axial_length, found.half_width, found.half_diagonal];
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }
}

/// A dent whose deepest point is a node on the axis: its depth is that node's distance from the rearmost ones.
#[test]
fn without_outlines_the_depth_of_a_dent_is_that_of_the_node_on_the_axis() {
    let mut family = Family::new(3);
    // The mode that moves the rim of the rear forward, turned back and strengthened.
    let rim = family.modes.get_mut(2).unwrap();
    rim.iter_mut().for_each(|vector| *vector = vector.map(|x| -16.0 * x));
    let mut arena = common::Arena::default();
    let mut contents = family.contents(&mut arena);
    contents.mesh.node_sets.clear();
    let file = common::write(&contents);
    let model = Model::open(&file).unwrap();
    let mut workspace = Workspace::<f64>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    let query = [0.053, 0.87];
    evaluator.prepare(&Query::new(query, Method::Direct)).unwrap();
    let found = evaluator.at(1.5).unwrap().observables().unwrap().rear_depth;
    let [positions, _] = family.exact(query, 1.5);
    let pole = (family.sphere.nodes.iter().zip(&positions))
        .find(|([x, y, z], _)| *x < 0.0 && y.hypot(*z) < 1e-12)
        .unwrap()
        .1;
    let rear = positions.iter().map(|[x, _, _]| *x).fold(f64::MAX, f64::min);
    let expected = pole[0] - rear;
    assert!(expected > 0.1, "no dent: {expected}");
    assert!((found - expected).abs() < 1e-4, "{found} {expected}");
}
