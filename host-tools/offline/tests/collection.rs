//! Models of other people's data: scattered samples of one to four parameters, without symmetry, on flat triangles.

mod support;

use capsule_core::interpolate::{Coordinates, Weights};
use capsule_core::model::MatrixView;
use capsule_core::{
    Domain, EvaluateError, Evaluator, Frame, Method, Model, Nodes, Parameters, Query, Scene, Workspace,
};
use capsule_database::{Collection, Mesh, vtu};
use capsule_offline::{Settings, Split, Storage, Truncation, build, leave_one_out};
use hdf5_pure::FileBuilder;
use ndarray::{Array1, Array2, Array4};
use ndarray_npy::NpzWriter;
use std::fs::File;

fn quiet(_: &str, _: usize, _: usize) {}

/// A tilted sphere of flat triangles: none of the operations of the square maps it onto itself.
fn tilted() -> Mesh {
    let quadratic = support::octahedral(2);
    let ([c, s], [k, l]) = ([0.8, 0.6], [12.0 / 13.0, 5.0 / 13.0]);
    let turn = |[x, y, z]: [f64; 3]| {
        let [x, y] = [c * x - s * y, s * x + c * y];
        [k * x - l * z, y, l * x + k * z]
    };
    let parts = [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]];
    let flat = |element: &[u32; 6]| parts.map(|[a, b, c]| [a, b, c, a, b, c].map(|place| element[place]));
    Mesh {
        nodes: quadratic.nodes.iter().copied().map(turn).collect(),
        elements: quadratic.elements.iter().flat_map(flat).collect(),
    }
}

/// Factors of the parameters within the sine, and its amplitude.
const WAVE: [f64; 4] = [1.1, -0.7, 0.9, 0.6];
const AMPLITUDE: f64 = 0.1;

/// A node of the family: quadratic in the parameters but for a sine, cubic in time.
fn position([x, y, z]: [f64; 3], parameters: &[f64], t: f64) -> [f64; 3] {
    let sum: f64 = parameters.iter().sum();
    let square: f64 = parameters.iter().map(|p| p * p).sum::<f64>() - 0.5 * parameters[0] * sum;
    let phase: f64 = parameters.iter().zip(WAVE).map(|(p, w)| p * w).sum();
    let grow = 1.0 + (0.2 + 0.1 * square) * t - 0.05 * sum * t * t;
    let wave = AMPLITUDE * phase.sin() * t * t * t;
    [
        3.0 * (x * grow + 0.3 * y * wave) + (2.0 + sum) * t,
        3.0 * (y * (1.0 + 0.1 * sum * t) + wave * x * z),
        3.0 * z * (1.2 - 0.1 * t),
    ]
}

/// Halton's points (Numer. Math. 2, 1960) in the unit cube.
fn halton(index: usize, dimensions: usize) -> Vec<f64> {
    let coordinate = |base: usize| {
        let (mut index, mut share, mut value) = (index + 1, 1.0, 0.0);
        while index > 0 {
            share /= base as f64;
            value += share * (index % base) as f64;
            index /= base;
        }
        value
    };
    [2, 3, 5, 7].into_iter().take(dimensions).map(coordinate).collect()
}

fn family(dimensions: usize, samples: usize) -> Collection {
    let mesh = tilted();
    let times: Vec<f64> = (0..=6).map(|i| 0.2 * f64::from(i)).collect();
    let parameters: Vec<Vec<f64>> = (0..samples).map(|j| halton(j, dimensions)).collect();
    let at = |parameters: &[f64], t: f64| mesh.nodes.iter().map(|node| position(*node, parameters, t)).collect();
    Collection::new(Collection {
        parameter_names: (1..=dimensions).map(|d| format!("parameter_{d}")).collect(),
        length_unit: None,
        time_unit: None,
        positions: parameters
            .iter()
            .map(|row| times.iter().map(|t| at(row, *t)).collect())
            .collect(),
        velocities: Vec::new(),
        elements: mesh.elements.clone(),
        parameters,
        times,
    })
    .unwrap()
}

/// Without truncation to speak of.
fn settings(collection: &Collection) -> Settings {
    Settings {
        truncation: Truncation::Tolerance(1e-6),
        storage: Storage::Single,
        ..Settings::of_collection(collection).unwrap()
    }
}

fn predicted(model: &Model, parameters: &[f64], t: f64) -> Result<Vec<[f64; 3]>, EvaluateError> {
    let mut workspace = Box::new(Workspace::<f64>::new());
    let mut evaluator = Evaluator::new(model, &mut workspace)?;
    evaluator.prepare(&Query::new(Parameters::new(parameters).unwrap(), Method::Direct))?;
    let mut nodes = vec![[0.0; 3]; model.mesh().nodes()];
    let scene = Scene {
        nodes: Nodes::All,
        frame: Frame::Laboratory,
    };
    evaluator.at(t)?.positions(&scene, &mut nodes)?;
    Ok(nodes)
}

/// The kernel returns quadratics exactly. What is left of the sine is its Taylor remainder: with s = WAVE . theta,
/// |sin s_j - (its parabola at s)| <= |s_j - s|^3 / 6, so the error is at most sum_j |L_j| |s_j - s|^3 / 6 times the
/// factor of the sine.
fn bound(model: &Model, parameters: &[f64], t: f64) -> f64 {
    let contents = model.contents();
    let samples = MatrixView::new(&contents.clusters[0].samples.parameters);
    let row = |j: usize| -> Vec<f64> { (0..samples.columns()).map(|d| samples.get(j, d).into()).collect() };
    let query = Parameters::new(parameters).unwrap();
    let mut weights = Weights::<f64, 32>::EMPTY;
    let mut scratch = vec![0.0; Weights::<f64, 32>::SCRATCH];
    let (coordinates, samples) = (Coordinates::new(contents), &contents.clusters[0].samples);
    weights
        .kernel(&contents.kernel, &coordinates, samples, &query, None, &mut scratch)
        .unwrap();
    let phase = |row: &[f64]| row.iter().zip(WAVE).map(|(p, w)| p * w).sum::<f64>();
    let remainder = |(j, weight): (usize, f64)| weight.abs() * (phase(&row(j)) - phase(parameters)).abs().powi(3) / 6.0;
    3.0 * AMPLITUDE * t.powi(3) * weights.iter().map(remainder).sum::<f64>()
}

#[test]
fn the_model_returns_the_family_within_the_bound_of_theory() {
    let mesh = tilted();
    for (dimensions, samples) in [(1, 14), (2, 40), (3, 60), (4, 80)] {
        let collection = family(dimensions, samples);
        let (bytes, report) = build(&collection, &settings(&collection), &quiet).unwrap();
        assert_eq!(
            (report.samples, report.symmetry, report.clusters.len()),
            (samples, 1, 1)
        );
        let model = Model::open(&bytes).unwrap();
        assert_eq!(
            (model.mesh().element_nodes(), model.contents().mesh.node_sets.len()),
            (3, 0)
        );
        let (mut answered, mut worst) = (0, 0.0_f64);
        for query in (200..212).map(|index| halton(index, dimensions)) {
            for t in [0.4, 1.2] {
                let found = match predicted(&model, &query, t) {
                    Err(EvaluateError::OutsideDomain { .. } | EvaluateError::FarFromSamples { .. }) => continue,
                    other => other.unwrap(),
                };
                answered += 1;
                let exact = mesh.nodes.iter().map(|node| position(*node, &query, t));
                let apart = |(a, b): (&[f64; 3], [f64; 3])| (0..3).map(|d| (a[d] - b[d]).powi(2)).sum::<f64>().sqrt();
                let error = found.iter().zip(exact).map(apart).fold(0.0, f64::max);
                // Single precision of the file, and the bases' tolerance.
                let bound = bound(&model, &query, t) + 5e-5;
                assert!(
                    error < bound,
                    "P = {dimensions}, {query:?}, t = {t}: {error:e} > {bound:e}"
                );
                worst = worst.max(error / 3.0);
            }
        }
        assert!(answered >= 12, "P = {dimensions}: {answered} answers");
        println!(
            "P = {dimensions}, {samples} samples: {} bytes, error / a at most {worst:.1e}",
            bytes.len()
        );
    }
}

#[test]
fn all_is_answered_without_outlines_and_mechanics_is_refused() {
    let collection = family(3, 40);
    let (bytes, _) = build(&collection, &settings(&collection), &quiet).unwrap();
    let model = Model::open(&bytes).unwrap();
    let mut workspace = Box::new(Workspace::<f64>::new());
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    let query = collection.parameters[7].clone();
    evaluator
        .prepare(&Query::new(Parameters::new(&query).unwrap(), Method::Direct))
        .unwrap();
    let mut instant = evaluator.at(1.2).unwrap();
    let found = instant.observables().unwrap();
    let nodes = &collection.positions[7][6];
    let extent = |f: &dyn Fn(&[f64; 3]) -> f64| {
        let [low, high] = nodes
            .iter()
            .map(f)
            .fold([f64::MAX, f64::MIN], |[a, b], v| [a.min(v), b.max(v)]);
        high - low
    };
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-4, "{a} {b}");
    close(found.axial_length, extent(&|n| n[0]));
    close(found.half_width, 0.5 * extent(&|n| n[1]));
    close(found.half_diagonal, 0.5 * extent(&|n| (n[1] + n[2]) / 2f64.sqrt()));
    assert!(
        found.rear_depth >= 0.0 && found.rear_depth < 0.3 * found.axial_length,
        "{found:?}"
    );
    let mesh = tilted();
    let (volume, centroid) = mesh.volume_and_centroid(nodes).unwrap();
    close(instant.volume().unwrap(), volume);
    close(instant.centroid().unwrap(), centroid);
    let rate = collection.velocities[7][6].clone();
    close(found.velocity, mesh.centroid_velocity(nodes, &rate).unwrap());
    let mut sector = vec![[0.0; 3]; 66];
    assert_eq!(
        instant.membrane(&mut sector).unwrap_err(),
        EvaluateError::UnsupportedReference
    );
    assert_eq!(
        instant
            .outline("midplane", Frame::Laboratory, &mut [[0.0; 2]; 99])
            .unwrap_err(),
        EvaluateError::UnknownNodeSet
    );
}

#[test]
fn far_from_the_samples_is_said() {
    // The samples leave a corner of their box empty.
    let mut collection = family(2, 60);
    let mut keep = collection.parameters.iter().map(|row| row[0] + row[1] < 1.0);
    let keep: Vec<bool> = keep.by_ref().collect();
    let kept = |j: &mut usize| {
        *j += 1;
        keep[*j - 1]
    };
    let (mut a, mut b, mut c) = (0, 0, 0);
    collection.parameters.retain(|_| kept(&mut a));
    collection.positions.retain(|_| kept(&mut b));
    collection.velocities.retain(|_| kept(&mut c));
    let (bytes, _) = build(&collection, &settings(&collection), &quiet).unwrap();
    let model = Model::open(&bytes).unwrap();
    assert!(predicted(&model, &[0.3, 0.3], 1.0).is_ok());
    let corner: Vec<f64> = collection.ranges().iter().map(|[_, top]| *top).collect();
    let error = predicted(&model, &corner, 1.0).unwrap_err();
    assert!(
        matches!(error, EvaluateError::FarFromSamples { ratio } if ratio > 1.0),
        "{error}"
    );
    let error = predicted(&model, &[0.3, 2.0], 1.0).unwrap_err();
    assert!(
        model
            .describe(error)
            .to_string()
            .starts_with("parameter_2 = 2 lies outside"),
        "{error}"
    );
}

/// The family swells with its parameters: a little outside it is answered, as a guess; far outside its volume is none
/// that any snapshot has.
#[test]
fn extrapolated_answers_are_guesses_or_refused() {
    let collection = family(2, 60);
    let (bytes, _) = build(&collection, &settings(&collection), &quiet).unwrap();
    let model = Model::open(&bytes).unwrap();
    let mut workspace = Box::new(Workspace::<f64>::new());
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    let mut ask = |parameters: [f64; 2]| {
        let query = Query {
            extrapolate: true,
            ..Query::new(Parameters::from(parameters), Method::Direct)
        };
        let domain = evaluator.prepare(&query).unwrap();
        let mut instant = evaluator.at(1.0).unwrap();
        (
            domain,
            instant.expected_error(),
            instant.error_bound(),
            instant.volume(),
        )
    };
    let (domain, inside, bound, volume) = ask([0.5, 0.5]);
    assert!(domain == Domain::Inside && bound.is_ok() && volume.is_ok());
    let (domain, beside, bound, volume) = ask([0.5, 1.02]);
    assert_eq!((domain, bound), (Domain::Outside, Err(EvaluateError::NoBound)));
    assert!(volume.is_ok() && beside.unwrap() > inside.unwrap());
    let (domain, _, bound, volume) = ask([0.5, 2.5]);
    assert_eq!((domain, bound), (Domain::Outside, Err(EvaluateError::NoBound)));
    let of = |nodes: &Vec<[f64; 3]>| tilted().volume_and_centroid(nodes).unwrap().0;
    let volumes: Vec<f64> = collection.positions.iter().flatten().map(of).collect();
    let [least, most] = volumes
        .iter()
        .fold([f64::MAX, 0.0], |[a, b]: [f64; 2], v| [a.min(*v), b.max(*v)]);
    match volume {
        Err(EvaluateError::WrongVolume { volume, min, max }) => {
            assert!(volume < min || volume > max);
            // Independent of the model: 2 % around the volumes of the snapshots.
            assert!(
                (f64::from(max / min) - 1.02 / 0.98 * most / least).abs() < 1e-3,
                "{min} {max}"
            );
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_split_makes_two_clusters_and_leave_one_out_covers_all() {
    let mut collection = family(1, 12);
    collection.parameters[3] = vec![0.5];
    let mesh = tilted();
    for (field, t) in collection.positions[3].iter_mut().zip(&collection.times) {
        *field = mesh.nodes.iter().map(|node| position(*node, &[0.5], *t)).collect();
    }
    collection.velocities.clear();
    collection.parameters[0] = vec![0.51];
    for (field, t) in collection.positions[0].iter_mut().zip(&collection.times) {
        *field = mesh.nodes.iter().map(|node| position(*node, &[0.51], *t)).collect();
    }
    let collection = Collection::new(collection).unwrap();
    let settings = Settings {
        split: Some(Split {
            parameter: 0,
            value: 0.5,
        }),
        ..settings(&collection)
    };
    let (times, errors) = leave_one_out(&collection, &settings, &quiet).unwrap();
    // The sample at the split belongs to both clusters; two methods.
    assert_eq!((times.len(), errors.len()), (6, 2 * 13));
    assert!(errors.iter().all(|e| e.inside && e.parameters.len() == 1));
    let direct = errors.iter().filter(|e| e.method == Method::Direct);
    assert!(direct.flat_map(|e| &e.shape).all(|error| *error < 0.05));
}

#[test]
fn the_symmetry_of_mesh_and_data_is_found() {
    let mesh = support::octahedral(2);
    let times: Vec<f64> = (0..=5).map(|i| 0.4 * f64::from(i)).collect();
    let parameters: Vec<[f64; 2]> = (0..5)
        .flat_map(|i| [0.8, 0.9, 1.0].map(|a| [0.02 * f64::from(i + 1), a]))
        .collect();
    let runs = parameters.iter().map(|row| support::trajectory(&mesh, *row, &times));
    let whole = Collection::new(Collection {
        parameter_names: vec!["Ca".to_owned(), "a".to_owned()],
        length_unit: Some("um".to_owned()),
        time_unit: None,
        parameters: parameters.iter().map(|row| row.to_vec()).collect(),
        elements: mesh.elements.clone(),
        positions: runs.map(|run| run.positions).collect(),
        velocities: Vec::new(),
        times,
    })
    .unwrap();
    let order = |collection: &Collection| {
        let (bytes, report) = build(collection, &settings(collection), &quiet).unwrap();
        let model = Model::open(&bytes).unwrap();
        let units = model.units();
        assert_eq!((units.length, units.velocity), ("um", "um/time unit"));
        (report.symmetry, model.contents().mesh.node_sets.len())
    };
    assert_eq!(order(&whole), (8, 2));
    // Shifted along y in one snapshot: only the mirror image in z is left.
    let mut shifted = whole;
    shifted.positions[4][3].iter_mut().for_each(|node| node[1] += 0.01);
    shifted.velocities.clear();
    assert_eq!(order(&Collection::new(shifted).unwrap()), (2, 0));
}

#[test]
fn all_kinds_of_files_give_the_same_model() {
    let directory = tempfile::tempdir().unwrap();
    let collection = family(2, 12);
    let (configurations, instants, nodes) = (12, collection.times.len(), 66);
    let positions = Array4::from_shape_fn((configurations, instants, nodes, 3), |(j, i, n, d)| {
        collection.positions[j][i][n][d]
    });
    let parameters = Array2::from_shape_fn((configurations, 2), |(j, d)| collection.parameters[j][d]);
    let elements = Array2::from_shape_fn((collection.elements.len(), 3), |(e, k)| {
        i64::from(collection.elements[e][k])
    });

    let npz = directory.path().join("data.npz");
    let mut writer = NpzWriter::new(File::create(&npz).unwrap());
    writer.add_array("parameters", &parameters).unwrap();
    writer
        .add_array("times", &Array1::from(collection.times.clone()))
        .unwrap();
    writer.add_array("positions", &positions).unwrap();
    writer.add_array("elements", &elements).unwrap();
    writer.finish().unwrap();

    let hdf5 = directory.path().join("data.h5");
    let mut writer = FileBuilder::new();
    let mut add = |name: &str, values: &[f64], shape: &[u64]| {
        writer.create_dataset(name).with_f64_data(values).with_shape(shape);
    };
    add("parameters", parameters.as_slice().unwrap(), &[12, 2]);
    add("times", &collection.times, &[instants as u64]);
    add(
        "positions",
        positions.as_slice().unwrap(),
        &[12, instants as u64, 66, 3],
    );
    let elements_shape = [elements.nrows() as u64, 3];
    writer
        .create_dataset("elements")
        .with_i64_data(elements.as_slice().unwrap())
        .with_shape(&elements_shape);
    writer.write(&hdf5).unwrap();

    let series = directory.path().join("series");
    let mesh = tilted();
    let mut table = "series,parameter_1,parameter_2\n".to_owned();
    for (j, row) in collection.parameters.iter().enumerate() {
        let mut writer = vtu::Series::create(&series.join(format!("run{j}")), "capsule").unwrap();
        for (t, nodes) in collection.times.iter().zip(&collection.positions[j]) {
            writer.add(*t, &mesh, nodes, &[]).unwrap();
        }
        writer.finish().unwrap();
        table += &format!("run{j}/capsule.pvd,{},{}\n", row[0], row[1]);
    }
    std::fs::write(series.join("parameters.csv"), table).unwrap();

    let bytes = [npz, hdf5, series].map(|path| {
        let (read, _) = Collection::read(&path).unwrap();
        assert_eq!(read, collection, "{}", path.display());
        build(&read, &settings(&read), &quiet).unwrap().0
    });
    assert_eq!(bytes[0], bytes[1]);
    assert_eq!(bytes[0], bytes[2]);
}
