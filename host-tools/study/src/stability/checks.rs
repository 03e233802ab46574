//! Queries on, near and outside every edge of the domain, and instants beyond the end.

use capsule_core::{Domain, EvaluateError, Evaluator, Method, Model, Query, Workspace};

use super::Check;
use crate::{StudyError, name};

/// Distances from an edge, as shares of the parameter's greatest value; negative ones lie inside.
const DISTANCES: [f64; 11] = [-1e-2, -1e-4, -1e-6, -1e-8, -1e-12, 0.0, 1e-12, 1e-8, 1e-5, 1e-4, 1e-2];
/// Within this share of an edge, rounding decides whether a query is inside.
const ROUNDING: f64 = 3e-6;
/// Observables beyond this (lengths in l, velocities in V) are useless.
const USELESS: f64 = 100.0;

/// A finite answer of a moderate size.
fn answers(evaluator: &mut Evaluator<'_, f64>, query: &Query<f64>, t: f64) -> Result<Domain, String> {
    let domain = evaluator.prepare(query).map_err(|error| error.to_string())?;
    let observables = evaluator.at(t).and_then(|mut instant| instant.observables());
    let observables = observables.map_err(|error| format!("no answer: {error}"))?;
    let size = observables.axial_length.abs().max(observables.velocity.abs());
    if size < USELESS {
        Ok(domain)
    } else {
        Err(format!("an answer of size {size:e}"))
    }
}

/// All edges by both methods, then the end of time.
pub(super) fn checks(model: &Model) -> Result<Vec<Check>, StudyError> {
    let mut workspace = Box::new(Workspace::<f64>::new());
    let mut evaluator = Evaluator::new(model, &mut workspace)?;
    let [ca, confinement] = super::ranges(model);
    let along = |[low, high]: [f64; 2]| (0..9).map(move |i| low + (high - low) * (f64::from(i) + 0.5) / 9.0);
    let limit = |confinement: f64| model.steady_limit(confinement).map_or(ca[1], |limit| limit.min(ca[1]));
    let border = model.jump_curve();
    let greatest = [ca[1], confinement[1]];
    // Points of each edge, the parameter that leads across, and the sign with which it leads out.
    let edges: [(&str, Vec<[f64; 2]>, usize, f64); 6] = [
        (
            "the least Ca",
            along(confinement).map(|a| [ca[0], a]).collect(),
            0,
            -1.0,
        ),
        (
            "the steady limit or the greatest Ca",
            along(confinement).map(|a| [limit(a), a]).collect(),
            0,
            1.0,
        ),
        (
            "the least a/l",
            along(ca)
                .map(|c| [c, confinement[0]])
                .filter(|p| p[0] < limit(p[1]))
                .collect(),
            1,
            -1.0,
        ),
        (
            "the greatest a/l",
            along(ca)
                .map(|c| [c, confinement[1]])
                .filter(|p| p[0] < 0.9 * limit(p[1]))
                .collect(),
            1,
            1.0,
        ),
        (
            "the border of the jump",
            along(confinement).filter_map(|a| Some([border.at(a)?, a])).collect(),
            0,
            0.0,
        ),
        (
            "the row that two clusters share",
            along(ca)
                .map(|c| [c, model.contents().clusters[0].max])
                .filter(|p| p[0] < 0.99 * limit(p[1]))
                .collect(),
            1,
            0.0,
        ),
    ];
    let mut checks = Vec::new();
    for (edge, points, across, outward) in edges {
        for method in [Method::Direct, Method::Paper] {
            let mut check = Check::new(&format!("on, near and beyond {edge}, {}", name(method)));
            for point in &points {
                for distance in DISTANCES {
                    let mut place = *point;
                    place[across] += distance * greatest[across] * if outward == 0.0 { 1.0 } else { outward };
                    let query = Query::new(place, method);
                    let answer = answers(&mut evaluator, &query, 5.0);
                    let beyond = outward != 0.0 && distance > 0.0;
                    let right = distance.abs() < ROUNDING && outward != 0.0 || answer.is_ok() != beyond;
                    check.count(answer.is_ok(), right, || format!("{place:?}: {answer:?}"));
                    let query = Query {
                        extrapolate: true,
                        ..query
                    };
                    let answer = answers(&mut evaluator, &query, 5.0);
                    check.count(answer.is_ok(), answer.is_ok(), || {
                        format!("{place:?}, extrapolated: {answer:?}")
                    });
                }
            }
            checks.push(check);
        }
    }
    checks.push(horizon(model, &mut evaluator)?);
    Ok(checks)
}

/// Instants up to the end are answered, later ones are refused as instants.
fn horizon(model: &Model, evaluator: &mut Evaluator<'_, f64>) -> Result<Check, StudyError> {
    let end = f64::from(model.end_time());
    let mut check = Check::new("instants up to t = 200");
    for method in [Method::Direct, Method::Paper] {
        evaluator.prepare(&Query {
            extrapolate: true,
            ..Query::new([0.03, 0.87], method)
        })?;
        for i in 0..=200 {
            let t = f64::from(i);
            let answer = evaluator.at(t).and_then(|mut instant| instant.observables());
            let right = match &answer {
                Ok(observables) => t <= end && observables.centroid.is_finite(),
                Err(error) => {
                    t > end
                        && matches!(
                            error,
                            EvaluateError::Value {
                                what: "the instant",
                                ..
                            }
                        )
                }
            };
            check.count(answer.is_ok(), right, || format!("t = {t}: {answer:?}"));
        }
    }
    Ok(check)
}
