//! Other people's data in any units and with any offsets give the same model, in these units.

#[path = "support/collection.rs"]
mod support;

use capsule_core::{Evaluator, Frame, Method, Model, Nodes, Parameters, Query, Scene, Workspace};
use capsule_database::{Collection, Mesh};
use capsule_offline::{OfflineError, Settings, Split, Truncation, build};

/// A family over two parameters in the unit square and t in [0, 2].
fn collection(mesh: &Mesh) -> Collection {
    let parameters = (0..25).map(|k| vec![0.25 * f64::from(k % 5), 0.25 * f64::from(k / 5)]);
    let times = (0..=10).map(|i| 0.2 * f64::from(i));
    support::collection(mesh, parameters.collect(), times.collect(), |[x, y, z], [p, q], t| {
        let (stretch, position) = (1.0 + 0.2 * (p + t).sin(), (1.0 + 0.5 * q) * t);
        [stretch * x + position + 0.1 * q * y * y, y, z]
    })
}

/// The units and offsets of data.
#[derive(Clone, Copy)]
struct Units {
    parameters: [(f64, f64); 2],
    length: f64,
    time: f64,
    start: f64,
}

impl Units {
    fn parameters(&self, row: &[f64]) -> Vec<f64> {
        let pairs = row.iter().zip(&self.parameters);
        pairs.map(|(value, (offset, scale))| offset + scale * value).collect()
    }

    fn apply(&self, plain: &Collection) -> Collection {
        let vector = |[x, y, z]: &[f64; 3]| [self.length * (x + self.start), self.length * y, self.length * z];
        let run = |run: &Vec<Vec<[f64; 3]>>| run.iter().map(|nodes| nodes.iter().map(vector).collect()).collect();
        Collection::new(Collection {
            parameters: plain.parameters.iter().map(|row| self.parameters(row)).collect(),
            times: plain.times.iter().map(|t| self.time * t).collect(),
            positions: plain.positions.iter().map(run).collect(),
            velocities: Vec::new(),
            ..plain.clone()
        })
        .unwrap()
    }
}

const PLAIN: Units = Units {
    parameters: [(0.0, 1.0), (0.0, 1.0)],
    length: 1.0,
    time: 1.0,
    start: 0.0,
};

/// Positions and velocities of all nodes, observables, volume, and errors at a query, in plain units.
fn answers(file: &[u8], units: &Units, nodes: usize, method: Method) -> [Vec<f64>; 2] {
    let model = Model::open(file).unwrap();
    let mut workspace = Box::new(Workspace::<f64>::new());
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    let (mut numbers, mut errors) = (Vec::new(), Vec::new());
    for (query, t) in [([0.37, 0.66], 0.33), ([0.9, 0.1], 1.71), ([0.5, 0.5], 2.0)] {
        let parameters = Parameters::new(&units.parameters(&query)).unwrap();
        evaluator.prepare(&Query::new(parameters, method)).unwrap();
        let mut instant = evaluator.at(units.time * t).unwrap();
        let mut vectors = vec![[0.0; 3]; nodes];
        let scene = Scene {
            nodes: Nodes::All,
            frame: Frame::Laboratory,
        };
        instant.positions(&scene, &mut vectors).unwrap();
        let plain = |[x, y, z]: &[f64; 3]| [x / units.length - units.start, y / units.length, z / units.length];
        numbers.extend(vectors.iter().flat_map(plain));
        instant.velocities(&scene, &mut vectors).unwrap();
        numbers.extend(vectors.as_flattened().iter().map(|v| v * units.time / units.length));
        let found = instant.observables().unwrap();
        let lengths = [
            found.axial_length,
            found.half_width,
            found.half_diagonal,
            found.rear_depth,
        ];
        numbers.extend(lengths.map(|length| length / units.length));
        numbers.push(found.centroid / units.length - units.start);
        numbers.push(instant.volume().unwrap() / units.length.powi(3));
        errors.extend([instant.expected_error().unwrap(), instant.error_bound().unwrap()]);
    }
    [numbers, errors]
}

fn model(collection: &Collection, change: impl FnOnce(Settings) -> Settings) -> Vec<u8> {
    let settings = change(Settings::of_collection(collection).unwrap());
    build(collection, &settings, &|_, _, _| {}).unwrap().0
}

#[test]
fn data_in_any_units_give_the_same_model() {
    let mesh = support::octahedral(2);
    let plain = collection(&mesh);
    let nodes = mesh.nodes.len();
    let variants = [
        (
            "nanometres and nanoseconds in SI",
            Units {
                length: 1e-9,
                time: 1e-9,
                ..PLAIN
            },
            1e-5,
        ),
        (
            "large numbers",
            Units {
                length: 1e9,
                time: 1e9,
                ..PLAIN
            },
            1e-5,
        ),
        (
            "tiny and huge parameters",
            Units {
                parameters: [(0.0, 1e-30), (0.0, 1e30)],
                ..PLAIN
            },
            1e-5,
        ),
        (
            "300 K in a range of 0.01 K",
            Units {
                parameters: [(300.0, 0.01), (0.0, 1.0)],
                ..PLAIN
            },
            1e-5,
        ),
        (
            "an offset of 10000",
            Units {
                parameters: [(0.0, 1.0), (10000.0, 0.4)],
                ..PLAIN
            },
            1e-5,
        ),
        (
            "negative numbers",
            Units {
                parameters: [(-2e5, 1e5), (0.0, -3.0)],
                ..PLAIN
            },
            1e-5,
        ),
        ("a start at 10000 radii", Units { start: 1e4, ..PLAIN }, 1e-5),
    ];
    for method in [Method::Direct, Method::Paper] {
        let [expected, errors] = answers(&model(&plain, |settings| settings), &PLAIN, nodes, method);
        for (name, units, within) in &variants {
            let given = units.apply(&plain);
            let [found, found_errors] = answers(&model(&given, |settings| settings), units, nodes, method);
            let apart = expected
                .iter()
                .zip(&found)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f64::max);
            assert!(apart < *within, "{method:?}, {name}: {apart:e}");
            for (expected, found) in errors.iter().zip(&found_errors) {
                assert!(
                    (expected / found - 1.0).abs() < 0.1,
                    "{method:?}, {name}: {expected:e} {found:e}"
                );
            }
        }
    }
}

#[test]
fn settings_are_in_the_units_of_the_data() {
    let mesh = support::octahedral(2);
    let plain = collection(&mesh);
    let units = Units {
        parameters: [(0.0, 1.0), (10000.0, 0.4)],
        length: 1e-6,
        time: 1e-3,
        start: 0.0,
    };
    let coarse = |unit: f64, value: f64| {
        move |settings: Settings| Settings {
            truncation: Truncation::Tolerance(3e-3 * unit),
            split: Some(Split { parameter: 1, value }),
            ..settings
        }
    };
    let expected = model(&plain, coarse(1.0, 0.5));
    let found = model(&units.apply(&plain), coarse(1e-6, 10000.2));
    // As many modes in as many clusters: only texts and units differ.
    let shape = |file: &[u8]| {
        let model = Model::open(file).unwrap();
        let clusters = model.contents().clusters.iter();
        clusters
            .map(|c| (c.samples.parameters.rows, c.field.modes.columns))
            .collect::<Vec<_>>()
    };
    assert_eq!(shape(&expected).len(), 2);
    assert_eq!(shape(&expected), shape(&found));
    let range = Model::open(&found).unwrap().parameters()[1];
    assert_eq!([range.min, range.max], [10000.0, 10000.4]);
}

#[test]
fn numbers_beyond_single_precision_are_refused_by_name() {
    let mesh = support::octahedral(2);
    let plain = collection(&mesh);
    for (units, word) in [
        (Units { length: 1e-20, ..PLAIN }, "`positions`"),
        (Units { time: 1e30, ..PLAIN }, "`times`"),
        (
            Units {
                parameters: [(0.0, 1e-40), (0.0, 1.0)],
                ..PLAIN
            },
            "`p`",
        ),
        (
            Units {
                parameters: [(0.0, 1.0), (0.0, 1e40)],
                ..PLAIN
            },
            "`q`",
        ),
    ] {
        let given = units.apply(&plain);
        let settings = Settings::of_collection(&given).unwrap();
        let error = build(&given, &settings, &|_, _, _| {}).unwrap_err();
        assert!(matches!(error, OfflineError::OutOfScale { .. }), "{error}");
        assert!(error.to_string().contains(word), "{error}");
    }
}

#[test]
fn too_few_samples_are_named_in_the_units_of_the_data() {
    let mesh = support::octahedral(2);
    let mut few = collection(&mesh);
    for list in [&mut few.positions, &mut few.velocities] {
        list.truncate(6);
    }
    few.parameters.truncate(6);
    let units = Units {
        parameters: [(300.0, 0.01), (0.0, 1.0)],
        ..PLAIN
    };
    let given = units.apply(&few);
    let settings = Settings::of_collection(&given).unwrap();
    let error = build(&given, &settings, &|_, _, _| {}).unwrap_err();
    assert!(
        matches!(
            error,
            OfflineError::TooFewSamples {
                found: 6,
                needed: 7,
                ..
            }
        ),
        "{error}"
    );
    assert!(error.to_string().contains("with p in [300, 300.01]"), "{error}");
}
