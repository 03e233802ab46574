//! Random queries: nothing panics, nothing is NaN, and neighbours have neighbouring answers.

use capsule_core::model::Curve;
use capsule_core::{Domain, EvaluateError, Evaluator, Frame, MIDPLANE, Method, Model, Query, Real, Workspace};

use super::Check;
use crate::random::Random;
use crate::{StudyError, name};

/// How far apart two neighbouring queries are, as a share of each parameter.
const APART: f64 = 1e-4;
/// The greatest distance of their shapes and places, as a share of a: the continuity bound, by method. Each answer
/// takes its nearest samples; where one is exchanged for another, the paper's method jumps by what the interpolation
/// errs, the kernel by the little weight that it gives to the farthest.
const BOUND: [(Method, f64); 2] = [(Method::Direct, 0.01), (Method::Paper, 0.03)];

/// A million queries by direct evaluation, and as many by the paper's method as time allows; then anything at all.
pub(super) fn checks(model: &Model, quick: bool) -> Result<Vec<Check>, StudyError> {
    let counts = if quick { [4_000, 60] } else { [500_000, 2_000] };
    let mut checks = Vec::new();
    for ((method, bound), pairs) in BOUND.into_iter().zip(counts) {
        checks.push(neighbours::<f32>(model, method, bound, pairs)?);
    }
    checks.push(anything(model, if quick { 5_000 } else { 100_000 })?);
    Ok(checks)
}

/// The outline of the capsule in the laboratory frame.
fn outline<T: Real>(
    evaluator: &mut Evaluator<'_, T>,
    query: [f64; 2],
    t: f64,
    method: Method,
    out: &mut [[T; 2]],
) -> Result<usize, EvaluateError> {
    let [ca, confinement] = query.map(T::from_f64);
    evaluator.prepare(&Query::new([ca, confinement], method))?;
    evaluator.at(T::from_f64(t))?.outline(MIDPLANE, Frame::Laboratory, out)
}

fn neighbours<T: Real>(model: &Model, method: Method, bound: f64, pairs: usize) -> Result<Check, StudyError> {
    let mut workspace = Box::new(Workspace::<T>::new());
    let mut evaluator = Evaluator::new(model, &mut workspace)?;
    let contents = model.contents();
    let [ca, confinement] = super::ranges(model);
    let border = Curve::new(&contents.border);
    let nodes = contents.mesh.nodes as usize;
    let (mut a, mut b) = (vec![[T::ZERO; 2]; nodes], vec![[T::ZERO; 2]; nodes]);
    let mut random = Random(1);
    let mut check = Check::new(&format!("pairs of random neighbours, {}", name(method)));
    let mut greatest = 0.0;
    while check.cases < pairs {
        let query = [
            random.between(ca[0], ca[1]),
            random.between(confinement[0], confinement[1]),
        ];
        let beside = query.map(|value| value * (1.0 + APART * (2.0 * random.next() - 1.0)));
        let t = random.between(0.0, f64::from(model.end_time()));
        if [query, beside]
            .iter()
            .any(|[ca, confinement]| model.domain([*ca, *confinement]) != Ok(Domain::Inside))
        {
            continue;
        }
        let answers = outline(&mut evaluator, query, t, method, &mut a)
            .and_then(|count| outline(&mut evaluator, beside, t, method, &mut b).map(|_| count));
        let jump = answers.map(|count| {
            let distance = |(a, b): (&[T; 2], &[T; 2])| (a[0] - b[0]).to_f64().hypot((a[1] - b[1]).to_f64());
            a.iter().zip(&b).take(count).map(distance).fold(0.0, f64::max) / query[1]
        });
        // The solution itself jumps at the border.
        let parted = border.below(query) != border.below(beside);
        let place = || format!("Ca = {:.5}, a/l = {:.4}, t = {t:.2}", query[0], query[1]);
        if let Ok(jump) = jump
            && !parted
            && jump > greatest
        {
            greatest = jump;
            check.worst = format!("the greatest difference is {:.4} % of a at {}", 100.0 * jump, place());
        }
        let right = matches!(jump, Ok(jump) if parted || jump < bound);
        check.count(jump.is_ok(), right, || format!("{}: {jump:?} a", place()));
    }
    check.greatest_percent = Some(100.0 * greatest);
    Ok(check)
}

/// Any parameters, instants and steps, also those that make no sense: an answer is finite, everything else an error.
fn anything(model: &Model, cases: usize) -> Result<Check, StudyError> {
    const STRANGE: [f32; 8] = [
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        0.0,
        -0.0,
        -1.0,
        f32::MIN_POSITIVE,
        f32::MAX,
    ];
    let mut workspace = Box::new(Workspace::<f32>::new());
    let mut evaluator = Evaluator::new(model, &mut workspace)?;
    let mut random = Random(2);
    let mut check = Check::new("any numbers at all, extrapolated");
    for case in 0..cases {
        let mut number = |low: f64, high: f64| {
            if random.next() < 0.02 {
                STRANGE[(random.next() * STRANGE.len() as f64) as usize % STRANGE.len()]
            } else {
                10.0f64.powf(random.between(low, high)) as f32
            }
        };
        let (ca, confinement, t) = (number(-7.0, 3.0), number(-3.0, 2.0), number(-4.0, 1.5));
        // Long steps for the paper's method, which takes its time.
        let (method, step) = if case % 100 == 0 {
            (Method::Paper, 0.5)
        } else {
            (Method::Direct, 0.02)
        };
        let query = Query {
            extrapolate: true,
            step: Some(step),
            ..Query::new([ca, confinement], method)
        };
        let answer = evaluator.prepare(&query).and_then(|_| evaluator.at(t)?.observables());
        let right = answer.as_ref().map_or(true, |observables| {
            [
                observables.axial_length,
                observables.half_width,
                observables.velocity,
                observables.centroid,
            ]
            .iter()
            .all(|value| value.is_finite())
        });
        check.count(answer.is_ok(), right, || format!("{query:?}, t = {t}: {answer:?}"));
    }
    Ok(check)
}
