//! Derivatives by the parameters: against a family whose derivatives are known, and against differences of the shipped
//! model.

use crate::common::{Family, distance};
use capsule_core::{
    DIAGONAL, EvaluateError, Evaluator, Frame, MIDPLANE, Method, Model, Nodes, Query, Real, Scene, Workspace,
};
use capsule_opcount::{Counted, count};

const ALL: Scene<'_> = Scene {
    nodes: Nodes::All,
    frame: Frame::Laboratory,
};
static SHIPPED: &[u8] = include_bytes!("../../../models/capsule.crom");

/// Derivative of the family's positions: they are of second degree in the parameters, so a difference is exact.
fn exact(family: &Family, parameters: [f64; 2], d: usize, t: f64) -> Vec<[f64; 3]> {
    const STEP: f64 = 1e-3;
    let [before, after] = [-STEP, STEP].map(|step| {
        let mut place = parameters;
        place[d] += step;
        let [positions, _] = family.exact(place, t);
        positions
    });
    let difference = |(a, b): (&[f64; 3], &[f64; 3])| [0, 1, 2].map(|axis| (b[axis] - a[axis]) / (2.0 * STEP));
    before.iter().zip(&after).map(difference).collect()
}

fn against_the_family<T: Real>(tolerance: f64) {
    let family = Family::new(3);
    let file = family.file();
    let model = Model::open(&file).unwrap();
    let mut workspace = Workspace::<T>::new();
    for parameters in [[0.073, 0.82], [0.012, 0.9], [0.031, 1.13]] {
        for t in [0.0, 1.0, 2.3] {
            let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
            let query = Query::new(parameters.map(T::from_f64), Method::Direct);
            let mut derivatives = evaluator.derivatives(&query, T::from_f64(t)).unwrap();
            for d in [0, 1, 0] {
                let exact = exact(&family, parameters, d, t);
                let mut found = vec![[T::ZERO; 3]; family.nodes()];
                assert_eq!(derivatives.positions(d, &ALL, &mut found), Ok(family.nodes()));
                let error = distance(&found, &exact);
                assert!(error < tolerance, "{parameters:?} {t} {d}: {error:e}");
                // X_c = (1.1 + 0.4 a/l + Ca) (t - (1 - exp(-2 t)) / 5)
                let factor = [1.0, 0.4][d];
                let centroid = factor * (t - 0.2 * (1.0 - (-2.0 * t).exp()));
                assert!((derivatives.centroid(d).unwrap().to_f64() - centroid).abs() < tolerance);
                let velocity = factor * (1.0 - 0.4 * (-2.0 * t).exp());
                assert!((derivatives.centroid_velocity(d).unwrap().to_f64() - velocity).abs() < 10.0 * tolerance);
                for (name, nodes) in [(MIDPLANE, &family.sphere.midplane), (DIAGONAL, &family.sphere.diagonal)] {
                    let mut outline = [[T::ZERO; 2]; 96];
                    let count = derivatives.outline(d, name, Frame::Laboratory, &mut outline).unwrap();
                    assert_eq!(count, nodes.len());
                    for (node, [x, r]) in nodes.iter().zip(outline) {
                        let node = usize::from(*node);
                        let ([ex, ey, ez], [_, y, z]) = (exact[node], family.sphere.nodes[node]);
                        let length = y.hypot(z);
                        let er = if length > 1e-9 { (y * ey + z * ez) / length } else { 0.0 };
                        let error = (x.to_f64() - ex).abs().max((r.to_f64() - er).abs());
                        assert!(error < tolerance, "{parameters:?} {t} {d} {name} {node}: {error:e}");
                    }
                }
            }
        }
    }
}

#[test]
fn derivatives_of_a_known_family_are_exact() {
    against_the_family::<f64>(3e-5);
    against_the_family::<f32>(1e-3);
}

/// The outline of the shipped model in double precision, or its derivative by a parameter.
fn outline(workspace: &mut Workspace<f64>, by: Option<usize>, parameters: [f64; 2], t: f64) -> Vec<[f64; 2]> {
    let model = Model::open(SHIPPED).unwrap();
    let mut out = vec![[0.0; 2]; 96];
    let mut evaluator = Evaluator::new(&model, workspace).unwrap();
    let query = Query::new(parameters, Method::Direct);
    let count = match by {
        None => {
            evaluator.prepare(&query).unwrap();
            evaluator.at(t).unwrap().outline(MIDPLANE, Frame::Laboratory, &mut out)
        }
        Some(d) => {
            let mut derivatives = evaluator.derivatives(&query, t).unwrap();
            derivatives.outline(d, MIDPLANE, Frame::Laboratory, &mut out)
        }
    };
    out.truncate(count.unwrap());
    out
}

#[test]
fn the_integral_of_the_shipped_model_s_derivatives_is_the_change_of_its_outline() {
    const PARTS: u32 = 16;
    let mut workspace = Box::new(Workspace::<f64>::new());
    let end = f64::from(Model::open(SHIPPED).unwrap().end_time());
    for (parameters, t) in [([0.1, 0.93], 1.7), ([0.03, 1.11], end), ([0.15, 0.81], end)] {
        for d in 0..2 {
            // A tenth of either parameter: samples enter and leave the stencil on the way.
            let width = [0.1 * parameters[0], 0.02][d];
            let at = |share: f64| {
                let mut place = parameters;
                place[d] += (share - 0.5) * width;
                place
            };
            let [before, after] = [0.0, 1.0].map(|share| outline(&mut workspace, None, at(share), t));
            let change = |i: usize| [0, 1].map(|axis| after[i][axis] - before[i][axis]);
            let whole = (0..before.len())
                .flat_map(change)
                .fold(0.0_f64, |most, x| most.max(x.abs()));
            let mut integral = vec![[0.0; 2]; before.len()];
            for part in 0..PARTS {
                let place = at((f64::from(part) + 0.5) / f64::from(PARTS));
                for (sum, by) in integral.iter_mut().zip(outline(&mut workspace, Some(d), place, t)) {
                    (0..2).for_each(|axis| sum[axis] += by[axis] * width / f64::from(PARTS));
                }
            }
            let error = |i: usize| [0, 1].map(|axis| integral[i][axis] - change(i)[axis]);
            let error = (0..before.len())
                .flat_map(error)
                .fold(0.0_f64, |most, x| most.max(x.abs()));
            // Where a sample enters or leaves, the answer itself jumps a little.
            assert!(error < 5e-3 * whole, "{parameters:?} {d}: {error:e} of {whole}");
        }
    }
}

#[test]
fn what_has_no_derivative_is_refused() {
    let family = Family::new(2);
    let file = family.file();
    let model = Model::open(&file).unwrap();
    let mut workspace = Workspace::<f64>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    let query = Query::new([0.05, 0.9], Method::Direct);
    let refused = |error: Result<_, EvaluateError>| error.map(|_: f64| ()).unwrap_err();
    let paper = Query::new([0.05, 0.9], Method::Paper);
    assert_eq!(
        evaluator.derivatives(&paper, 1.0).unwrap_err(),
        EvaluateError::NoDerivatives
    );
    let outside = Query::new([0.5, 0.9], Method::Direct);
    let error = evaluator.derivatives(&outside, 1.0).unwrap_err();
    assert!(matches!(error, EvaluateError::OutsideDomain { index: 0, .. }));
    assert!(matches!(
        evaluator.derivatives(&query, 5.0).unwrap_err(),
        EvaluateError::Value { .. }
    ));
    let mut derivatives = evaluator.derivatives(&query, 1.0).unwrap();
    let unknown = refused(derivatives.centroid(2));
    assert_eq!(unknown, EvaluateError::UnknownParameter { index: 2, count: 2 });
    let mut out = [[0.0; 2]; 4];
    let short = derivatives.outline(0, MIDPLANE, Frame::Centroid, &mut out);
    assert!(matches!(short, Err(EvaluateError::BufferTooShort { found: 4, .. })));
    let set = derivatives.outline(0, "equator", Frame::Centroid, &mut out);
    assert_eq!(set, Err(EvaluateError::UnknownNodeSet));
    // The weights of the query are gone.
    assert_eq!(evaluator.at(1.0).unwrap_err(), EvaluateError::NotPrepared);
}

#[test]
fn the_second_parameter_needs_no_second_solution_of_the_weights() {
    let family = Family::new(4);
    let file = family.file();
    let model = Model::open(&file).unwrap();
    let mut workspace = Workspace::<Counted>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    let query = Query::new([0.05, 0.95].map(Counted), Method::Direct);
    let (_, weights) = count(|| evaluator.prepare(&query).unwrap());
    let (derivatives, both) = count(|| evaluator.derivatives(&query, Counted(1.23)).unwrap());
    let mut derivatives = derivatives;
    // The factors of the weights, and a substitution for each parameter.
    let (weights, both) = (weights.operations(), both.operations());
    assert!(both < 3 * weights, "{both} {weights}");
    let mut out = [[Counted::ZERO; 2]; 96];
    let mut ask = |d| {
        let (asked, counts) = count(|| derivatives.outline(d, MIDPLANE, Frame::Centroid, &mut out));
        asked.unwrap();
        counts.operations()
    };
    let (first, again, second) = (ask(0), ask(0), ask(1));
    assert!(
        first < weights && again < first && second == first,
        "{first} {again} {second} {weights}"
    );
}
