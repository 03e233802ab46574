//! Where the promises end: the smallest workspaces, models just over them, single precision where it is worst
//! conditioned.

use crate::common::{Arena, Family, distance, write};
use capsule_core::model::wire::{Contents, Matrix};
use capsule_core::{Capacities, EvaluateError, Evaluator, Frame, Method, Model, Nodes, OpenError, Parts, Query, Real};
use capsule_core::{Scene, Workspace, scratch_len};

/// A model that needs 15 parameter modes, 4 local modes and 15 neighbours: for the paper's method 12 and the ridge's 3
/// rows.
fn modest(change: impl FnOnce(&mut Contents<'_>)) -> Vec<u8> {
    let family = Family::new(2);
    let mut arena = Arena::default();
    let mut contents = family.contents(&mut arena);
    contents.kernel.neighbours = 15;
    contents.paper.neighbours = 12;
    contents.paper.displacement_rank = 4;
    contents.paper.velocity_rank = 4;
    widen(&mut contents, 15);
    change(&mut contents);
    write(&contents)
}

/// Gives the motion parameter modes that are zero.
fn widen(contents: &mut Contents<'_>, columns: usize) {
    for cluster in &mut contents.clusters {
        let spans = cluster.field.spans.iter_mut();
        for matrix in spans.flat_map(|span| [&mut span.parameter_modes, &mut span.core]) {
            let mut bytes = Vec::new();
            for row in matrix.blob.data.chunks(4 * matrix.columns as usize) {
                bytes.extend_from_slice(row);
                bytes.resize(bytes.len().next_multiple_of(4 * columns), 0);
            }
            *matrix = Matrix::f32(matrix.rows, columns as u32, bytes.leak());
        }
    }
}

/// Bits of the observables by both methods.
fn answers<const K: usize, const M: usize, const N: usize>(file: &[u8]) -> Result<Vec<u32>, EvaluateError> {
    let model = Model::open(file).unwrap();
    let mut workspace = Workspace::<f32, K, M, N>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace)?;
    let mut bits = Vec::new();
    for method in [Method::Direct, Method::Paper] {
        evaluator.prepare(&Query {
            step: Some(0.1),
            ..Query::new([0.05, 0.87], method)
        })?;
        let found = evaluator.at(2.3)?.observables()?;
        bits.extend([found.axial_length, found.rear_depth, found.velocity, found.centroid].map(f32::to_bits));
    }
    Ok(bits)
}

/// Bits of everything that the direct method answers at an instant.
fn direct<const K: usize, const M: usize, const N: usize, const S: usize>(file: &[u8]) -> Vec<u32> {
    let model = Model::open(file).unwrap();
    let mut workspace = Workspace::<f32, K, M, N, S>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    evaluator.prepare(&Query::new([0.05, 0.87], Method::Direct)).unwrap();
    let mut instant = evaluator.at(2.3).unwrap();
    let mut vectors = vec![[0.0; 3]; model.mesh().nodes()];
    let scene = Scene {
        nodes: Nodes::All,
        frame: Frame::Laboratory,
    };
    let mut numbers = vec![
        instant.volume().unwrap(),
        instant.centroid_velocity().unwrap(),
        instant.error_bound().unwrap(),
    ];
    instant.positions(&scene, &mut vectors).unwrap();
    numbers.extend(vectors.as_flattened());
    instant.velocities(&scene, &mut vectors).unwrap();
    numbers.extend(vectors.as_flattened());
    let totals = instant.membrane(&mut vectors).unwrap().totals().unwrap();
    numbers.extend([totals.area, totals.energy, totals.pressure_drop]);
    numbers.into_iter().map(f32::to_bits).collect()
}

/// The limit that a workspace is too small for, by one.
fn lacks<const K: usize, const M: usize, const N: usize>(limit: &str, file: &[u8]) {
    match answers::<K, M, N>(file) {
        Err(EvaluateError::Capacity {
            limit: found,
            required,
            capacity,
        }) => assert_eq!((found, required), (limit, capacity + 1)),
        other => panic!("{limit}: {other:?}"),
    }
}

#[test]
fn a_workspace_that_just_fits_answers_as_any_other() {
    let file = modest(|_| ());
    let fitting = answers::<15, 4, 15>(&file);
    assert!(fitting.is_ok(), "{fitting:?}");
    assert_eq!(answers::<64, 16, 15>(&file), fitting);
}

#[test]
fn a_model_that_is_one_too_large_is_refused() {
    let needs = |limit, change: fn(&mut Contents<'_>)| lacks::<15, 4, 15>(limit, &modest(change));
    needs("parameter modes", |c| widen(c, 16));
    needs("neighbours of the kernel", |c| c.kernel.neighbours = 16);
    needs("neighbours of the diffuse approximation", |c| c.paper.neighbours = 13);
    needs("local displacement modes", |c| c.paper.displacement_rank = 5);
    needs("local velocity modes", |c| c.paper.velocity_rank = 5);
    lacks::<15, 3, 15>("local displacement modes", &modest(|_| ()));
}

#[test]
fn the_capacities_of_a_model_are_those_of_the_smallest_workspace() {
    let of = |change: fn(&mut Contents<'_>)| {
        let file = modest(change);
        let Capacities {
            modes,
            local_modes,
            neighbours,
        } = Capacities::of(&Model::open(&file).unwrap());
        (modes, local_modes, neighbours)
    };
    assert_eq!(of(|_| ()), (15, 4, 15));
    assert_eq!(of(|c| widen(c, 16)), (16, 4, 15));
    assert_eq!(of(|c| c.kernel.neighbours = 16), (15, 4, 16));
    assert_eq!(of(|c| c.paper.neighbours = 13), (15, 4, 16));
    assert_eq!(of(|c| c.paper.displacement_rank = 5), (15, 5, 15));
    assert_eq!(of(|c| c.paper.velocity_rank = 5), (15, 5, 15));
}

#[test]
fn without_local_modes_the_direct_method_answers_as_ever_and_the_other_is_refused() {
    let file = modest(|_| ());
    let all = direct::<129, 16, 32, { scratch_len(16, 32) }>(&file);
    assert_eq!(direct::<15, 0, 15, { scratch_len(0, 15) }>(&file), all);
    lacks::<15, 0, 15>("local displacement modes", &modest(|c| c.paper.displacement_rank = 1));
}

/// Two samples of a family, closer and closer to each other, and a query between them: the greatest error of a
/// position.
fn error_at_distance<T: Real>(apart: f64) -> Result<f64, String> {
    let mut family = Family::new(2);
    let at = family
        .samples
        .iter()
        .position(|&sample| sample == [0.05, 0.85])
        .unwrap();
    let [ca, confinement] = family.samples[at];
    family.samples.push([ca * (1.0 + apart), confinement]);
    let file = family.file();
    let model = Model::open(&file).map_err(|error| {
        assert!(matches!(error, OpenError::DuplicateSample { .. }), "{error}");
        error.to_string()
    })?;
    let mut workspace = Workspace::<T>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    let query = [ca * (1.0 + 0.4 * apart), confinement];
    let text = |error: EvaluateError| error.to_string();
    evaluator
        .prepare(&Query::new(query.map(T::from_f64), Method::Direct))
        .map_err(text)?;
    let mut instant = evaluator.at(T::from_f64(1.7)).map_err(text)?;
    let mut found = vec![[T::ZERO; 3]; family.nodes()];
    let scene = Scene {
        nodes: Nodes::All,
        frame: Frame::Laboratory,
    };
    instant.positions(&scene, &mut found).map_err(text)?;
    Ok(distance(&found, &family.exact(query, 1.7)[0]))
}

/// Samples that single precision tells apart do no harm, as close as they may be; others the model file may not have.
#[test]
fn samples_close_to_each_other() {
    for power in 1..=7 {
        let apart = 10_f64.powi(-power);
        let (single, double) = (error_at_distance::<f32>(apart), error_at_distance::<f64>(apart));
        assert!(
            single.as_ref().is_ok_and(|error| *error < 3e-6),
            "{apart:e}: {single:?}"
        );
        // The remaining difference is the rounding of the stored singles.
        assert!(
            double.as_ref().is_ok_and(|error| *error < 2e-7),
            "{apart:e}: {double:?}"
        );
    }
    assert!(error_at_distance::<f64>(1e-9).is_err());
}

/// The weights grow with the distance from the samples, and rounding with them. Where the direct method answers it
/// follows the family, which is linear in Ca; farther out a query is refused. The line goes through two answers within
/// the range.
#[test]
fn extrapolation_that_goes_too_far() {
    let file = Family::new(2).file();
    let model = Model::open(&file).unwrap();
    let mut workspace = Workspace::<f32>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    let mut axial_length = |method, capillary_number: f32| {
        evaluator.prepare(&Query {
            extrapolate: true,
            step: Some(0.1),
            ..Query::new([capillary_number, 0.9], method)
        })?;
        Ok(evaluator.at(0.2)?.observables()?.axial_length)
    };
    let inside = [0.01_f32, 0.1].map(|ca| axial_length(Method::Direct, ca).unwrap());
    let slope = (inside[1] - inside[0]) / 0.09;
    for power in -5..=6 {
        let far = 10_f32.powi(power);
        for method in [Method::Direct, Method::Paper] {
            let found = axial_length(method, far);
            let refused =
                matches!(found, Err(EvaluateError::BeyondExtrapolation { distance, limit }) if distance > limit);
            let linear = inside[0] + slope * (far - 0.01);
            // The paper's steps have an error of their own.
            let tolerance = if method == Method::Direct { 2e-3 } else { 1e-2 };
            let follows = found
                .as_ref()
                .is_ok_and(|found| (found - linear).abs() < tolerance * linear);
            assert!(refused || follows, "{far} {method:?}: {found:?}, {linear}");
            assert_eq!(refused, far > 0.1, "{far} {method:?}");
        }
    }
}

#[test]
fn the_parts_of_a_workspace_lie_in_it_and_apart() {
    /// Where the parts lie: offset, size and alignment.
    struct Places(Vec<[usize; 3]>);
    impl Parts for Places {
        fn put<P>(&mut self, offset: usize, _: P) {
            self.0.push([offset, size_of::<P>(), align_of::<P>()]);
        }
    }
    let mut places = Places(Vec::new());
    Workspace::<f32>::put(&mut places);
    places.0.sort_unstable();
    assert!(places.0.len() > 5, "{:?}", places.0);
    let mut end = 0;
    for [offset, size, alignment] in places.0 {
        assert!(offset >= end && offset % alignment == 0, "{offset}: {alignment}");
        end = offset + size;
    }
    assert!(end <= size_of::<Workspace<f32>>());
}
