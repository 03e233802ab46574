//! Results of scenes: observables, volume, outlines, sections; and the quantities that they do not compute.

use crate::common::{Family, distance};
use capsule_core::model::MatrixView;
use capsule_core::{
    DIAGONAL, Domain, EvaluateError, Evaluator, Frame, MIDPLANE, Method, Model, Nodes, Playback, Query, Real, Scene,
    Workspace, playback_len, section,
};

const PARAMETERS: [f64; 2] = [0.05, 0.97];
const T: f64 = 2.0;

/// Runs a check at one instant of one query.
fn at_instant(method: Method, check: impl Fn(&Family, &Model<'_>, capsule_core::Instant<'_, '_, f64>)) {
    let family = Family::new(4);
    let file = family.file();
    let model = Model::open(&file).unwrap();
    let mut workspace = Workspace::<f64>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    evaluator.prepare(&Query::new(PARAMETERS, method)).unwrap();
    check(&family, &model, evaluator.at(T).unwrap());
}

#[test]
fn every_scene_shows_the_same_surface() {
    at_instant(Method::Direct, |family, model, mut instant| {
        let [exact, velocity] = family.exact(PARAMETERS, T);
        let mut found = vec![[0.0; 3]; family.nodes()];
        let list: Vec<u16> = [17, 3, 3, 99].to_vec();
        let scene = |nodes| Scene {
            nodes,
            frame: Frame::Laboratory,
        };
        assert_eq!(instant.positions(&scene(Nodes::List(&list)), &mut found), Ok(4));
        let some: Vec<_> = list.iter().map(|&node| exact[usize::from(node)]).collect();
        assert!(distance(&found[..4], &some) < 2e-6);
        let set = &family.sphere.diagonal;
        assert_eq!(
            instant.positions(&scene(Nodes::Set(DIAGONAL)), &mut found),
            Ok(set.len())
        );
        let some: Vec<_> = set.iter().map(|&node| exact[usize::from(node)]).collect();
        assert!(distance(&found[..set.len()], &some) < 2e-6);

        let (x, u) = (instant.centroid().unwrap(), instant.centroid_velocity().unwrap());
        let centroid = Scene {
            nodes: Nodes::All,
            frame: Frame::Centroid,
        };
        instant.positions(&centroid, &mut found).unwrap();
        let shifted: Vec<_> = exact.iter().map(|p| [p[0] - x, p[1], p[2]]).collect();
        assert!(distance(&found, &shifted) < 2e-6);
        instant.velocities(&centroid, &mut found).unwrap();
        let shifted: Vec<_> = velocity.iter().map(|v| [v[0] - u, v[1], v[2]]).collect();
        // A difference of stored singles over a third of an interval.
        assert!(distance(&found, &shifted) < 2e-5);

        let mut outline = vec![[0.0; 2]; 40];
        let count = instant.outline(MIDPLANE, Frame::Laboratory, &mut outline).unwrap();
        for (point, &node) in outline[..count].iter().zip(&family.sphere.midplane) {
            let [x, y, _] = exact[usize::from(node)];
            assert!((point[0] - x).abs() < 2e-6 && (point[1] - y).abs() < 2e-6);
        }

        let unknown = EvaluateError::UnknownNode {
            node: family.nodes(),
            nodes: family.nodes(),
        };
        let list = [family.nodes() as u16];
        assert_eq!(instant.positions(&scene(Nodes::List(&list)), &mut found), Err(unknown));
        assert_eq!(
            instant.positions(&scene(Nodes::Set("rim")), &mut found),
            Err(EvaluateError::UnknownNodeSet)
        );
        let short = EvaluateError::BufferTooShort {
            required: family.nodes(),
            found: 5,
        };
        assert_eq!(instant.positions(&scene(Nodes::All), &mut found[..5]), Err(short));
        assert_eq!(instant.t(), T);
        assert_eq!(model.mesh().nodes(), family.nodes());
    });
}

#[test]
fn observables_are_those_of_the_exact_outlines() {
    for method in [Method::Direct, Method::Paper] {
        let tolerance = if method == Method::Direct { 1e-5 } else { 5e-3 };
        at_instant(method, |family, _, mut instant| {
            let [exact, _] = family.exact(PARAMETERS, T);
            let points = |set: &[u16]| -> Vec<[f64; 3]> { set.iter().map(|&node| exact[usize::from(node)]).collect() };
            let (midplane, diagonal) = (points(&family.sphere.midplane), points(&family.sphere.diagonal));
            let refine = |values: Vec<f64>| {
                let i = (0..values.len())
                    .max_by(|&a, &b| values[a].total_cmp(&values[b]))
                    .unwrap();
                if i == 0 || i + 1 == values.len() {
                    return values[i];
                }
                let [a, b, c] = [values[i - 1], values[i], values[i + 1]];
                b + (c - a).powi(2) / (8.0 * (2.0 * b - a - c))
            };
            let greatest = |set: &[[f64; 3]], value: fn(&[f64; 3]) -> f64| refine(set.iter().map(value).collect());
            let front = greatest(&midplane, |p| p[0]).max(greatest(&diagonal, |p| p[0]));
            let rear = -greatest(&midplane, |p| -p[0]).max(greatest(&diagonal, |p| -p[0]));
            let found = instant.observables().unwrap();
            let near = |a: f64, b: f64| assert!((a - b).abs() < tolerance, "{method:?}: {a} {b}");
            near(found.axial_length, front - rear);
            near(found.half_width, greatest(&midplane, |p| p[1]));
            near(found.half_diagonal, greatest(&diagonal, |p| p[1].hypot(p[2])));
            near(found.rear_depth, midplane.last().unwrap()[0] - rear);
            let [state, rate] = family.state(PARAMETERS, T);
            let root = (family.nodes() as f64).sqrt();
            near(found.centroid, state[0] / root);
            near(found.velocity, rate[0] / root);
        });
    }
}

#[test]
fn volume_is_the_flux_through_every_element() {
    at_instant(Method::Direct, |family, _, mut instant| {
        let [exact, _] = family.exact(PARAMETERS, T);
        // Divergence theorem with x/3 instead of x_1, on all elements, by the 7-point rule of degree 5.
        let rule = [
            (1.0 / 3.0, 0.225),
            (0.059_715_871_789_770, 0.132_394_152_788_506),
            (0.797_426_985_353_087, 0.125_939_180_544_827),
        ];
        let mut volume = 0.0;
        for element in &family.sphere.elements {
            let nodes = element.map(|node| exact[usize::from(node)]);
            for (a, weight) in rule {
                let b = (1.0 - a) / 2.0;
                let points = if a == 1.0 / 3.0 {
                    vec![[a, a, a]]
                } else {
                    vec![[a, b, b], [b, a, b], [b, b, a]]
                };
                for [l0, l1, l2] in points {
                    let n = [
                        l0 * (2.0 * l0 - 1.0),
                        l1 * (2.0 * l1 - 1.0),
                        l2 * (2.0 * l2 - 1.0),
                        4.0 * l0 * l1,
                        4.0 * l1 * l2,
                        4.0 * l2 * l0,
                    ];
                    let d1 = [
                        1.0 - 4.0 * l0,
                        4.0 * l1 - 1.0,
                        0.0,
                        4.0 * (l0 - l1),
                        4.0 * l2,
                        -4.0 * l2,
                    ];
                    let d2 = [
                        1.0 - 4.0 * l0,
                        0.0,
                        4.0 * l2 - 1.0,
                        -4.0 * l1,
                        4.0 * l1,
                        4.0 * (l0 - l2),
                    ];
                    let at =
                        |w: [f64; 6]| -> [f64; 3] { std::array::from_fn(|i| (0..6).map(|k| w[k] * nodes[k][i]).sum()) };
                    let (x, u, v) = (at(n), at(d1), at(d2));
                    let cross = [
                        u[1] * v[2] - u[2] * v[1],
                        u[2] * v[0] - u[0] * v[2],
                        u[0] * v[1] - u[1] * v[0],
                    ];
                    volume += weight / 6.0 * (0..3).map(|i| x[i] * cross[i]).sum::<f64>();
                }
            }
        }
        let found = instant.volume().unwrap();
        assert!((found - volume).abs() < 1e-4 * volume, "{found} {volume}");
    });
}

#[test]
fn a_section_is_a_closed_curve_of_the_right_area() {
    at_instant(Method::Direct, |family, model, mut instant| {
        let mut positions = vec![[0.0; 3]; family.nodes()];
        instant
            .positions(
                &Scene {
                    nodes: Nodes::All,
                    frame: Frame::Centroid,
                },
                &mut positions,
            )
            .unwrap();
        let mesh = model.mesh();
        let mut segments = vec![[[0.0; 2]; 2]; 4 * mesh.elements().len()];
        let area = |x: f64, segments: &mut [[[f64; 2]; 2]]| {
            let count = section(&mesh, &positions, x, segments).unwrap();
            // Closed: every end is another's start.
            let mut ends: Vec<_> = segments[..count].iter().map(|s| s[1].map(f64::to_bits)).collect();
            let mut starts: Vec<_> = segments[..count].iter().map(|s| s[0].map(f64::to_bits)).collect();
            ends.sort_unstable();
            starts.sort_unstable();
            assert_eq!(ends, starts);
            segments[..count]
                .iter()
                .map(|[p, q]| (p[0] * q[1] - p[1] * q[0]) / 2.0)
                .sum::<f64>()
        };
        // The areas of the sections sum to the volume of the flat triangles, close to the P2 volume.
        let steps = 400;
        let dx = 4.0 / f64::from(steps);
        let sum: f64 = (0..steps)
            .map(|i| dx * area(-2.0 + (f64::from(i) + 0.5) * dx, &mut segments))
            .sum();
        let volume = instant.volume().unwrap();
        assert!((sum - volume).abs() < 0.03 * volume, "{sum} {volume}");
        assert_eq!(section(&mesh, &positions, 3.0, &mut segments), Ok(0));
        let needed = section(&mesh, &positions, 0.1, &mut segments).unwrap();
        let short = EvaluateError::BufferTooShort {
            required: needed,
            found: 3,
        };
        assert_eq!(section(&mesh, &positions, 0.1, &mut segments[..3]), Err(short));
        let short = EvaluateError::BufferTooShort {
            required: family.nodes(),
            found: 1,
        };
        assert_eq!(section(&mesh, &positions[..1], 0.1, &mut segments), Err(short));
    });
}

#[test]
fn expected_error_is_small_at_a_sample_and_grows_away_from_it() {
    let family = Family::new(2);
    let file = family.file();
    let model = Model::open(&file).unwrap();
    let mut workspace = Workspace::<f64>::new();
    for method in [Method::Direct, Method::Paper] {
        let mut errors = [[0.03, 0.85], [0.035, 0.875], [0.2, 1.4]].map(|[ca, confinement]| {
            let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
            let query = Query {
                extrapolate: true,
                ..Query::new([ca, confinement], method)
            };
            let domain = evaluator.prepare(&query).unwrap();
            assert_eq!(domain == Domain::Outside, confinement > 1.2);
            let [early, middle, late] = [0.5, 1.5, 3.0].map(|t| {
                let mut instant = evaluator.at(t).unwrap();
                // The family has no volume to keep.
                instant.unchecked();
                instant.expected_error().unwrap()
            });
            // The stored errors are 0.001 at t = 1 and 0.002 at t = 2.
            assert!((middle - (early + late) / 2.0).abs() < 1e-12 && late >= early);
            // The stored factors of the bound are 2 and 3.
            match evaluator.at(1.5).unwrap().error_bound() {
                Ok(bound) => assert!(domain == Domain::Inside && (bound - 2.5 * middle).abs() < 1e-12),
                Err(error) => assert!(domain == Domain::Outside && error == EvaluateError::NoBound),
            }
            late
        });
        assert!(errors[0] < errors[1] && errors[1] < errors[2], "{method:?}: {errors:?}");
        errors.iter_mut().for_each(|error| *error -= 1e-5);
        assert!(method == Method::Paper || errors[0] < 1e-4, "{errors:?}");
    }
    assert_eq!(MatrixView::new(&model.contents().error_times).rows(), 2);
}

/// Greatest difference between frames and positions, at instants in an order that jumps, and of two queries in turn.
fn frames_against_positions<T: Real>(method: Method) -> f64 {
    let family = Family::new(3);
    let file = family.file();
    let model = Model::open(&file).unwrap();
    let mut workspace = Workspace::<T>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    let mut playback = Playback::new(vec![T::ZERO; playback_len(&model)]);
    let mut found = vec![[T::ZERO; 3]; family.nodes()];
    let mut expected = found.clone();
    let mut greatest = 0.0_f64;
    for parameters in [PARAMETERS, [0.1, 0.8], PARAMETERS] {
        evaluator
            .prepare(&Query::new(parameters.map(T::from_f64), method))
            .unwrap();
        for t in [0.0, 0.05, 0.4, 4.0, 3.9, 2.0, 2.05, 2.1, 0.13] {
            for frame in [Frame::Laboratory, Frame::Centroid] {
                let (t, nodes) = (T::from_f64(t), Nodes::All);
                assert_eq!(evaluator.frame(t, frame, &mut playback, &mut found), Ok(family.nodes()));
                let scene = Scene { nodes, frame };
                evaluator.at(t).unwrap().positions(&scene, &mut expected).unwrap();
                for (a, b) in found.as_flattened().iter().zip(expected.as_flattened()) {
                    greatest = greatest.max((a.to_f64() - b.to_f64()).abs());
                }
            }
        }
    }
    greatest
}

#[test]
fn frames_are_the_positions_but_for_rounding() {
    // The capsule has gone 6 l by then: rounding of singles there is 5e-7.
    assert!(frames_against_positions::<f32>(Method::Direct) < 2e-6);
    assert!(frames_against_positions::<f64>(Method::Direct) < 4e-15);
    assert_eq!(frames_against_positions::<f32>(Method::Paper), 0.0);
}

#[test]
fn frames_need_room() {
    let family = Family::new(2);
    let file = family.file();
    let model = Model::open(&file).unwrap();
    let mut workspace = Workspace::<f32>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    let (required, nodes) = (playback_len(&model), family.nodes());
    let mut out = vec![[0.0; 3]; nodes];
    let mut frame = |prepared: bool, numbers: usize, t: f32, out: &mut [[f32; 3]]| {
        if prepared {
            evaluator.prepare(&Query::new([0.05, 0.97], Method::Direct)).unwrap();
        }
        evaluator.frame(t, Frame::Centroid, &mut Playback::new(vec![0.0; numbers]), out)
    };
    assert_eq!(frame(false, required, 1.0, &mut out), Err(EvaluateError::NotPrepared));
    let short = |required, found| Err(EvaluateError::BufferTooShort { required, found });
    assert_eq!(frame(true, required - 1, 1.0, &mut out), short(required, required - 1));
    assert_eq!(frame(true, required, 1.0, &mut out[1..]), short(nodes, nodes - 1));
    assert!(matches!(
        frame(true, required, 5.0, &mut out),
        Err(EvaluateError::Value { .. })
    ));
    assert_eq!(frame(true, required, 1.0, &mut out), Ok(nodes));
}
