//! Order, number of neighbours and regularisation of the diffuse approximation, on the snapshots themselves: no modes,
//! no dynamics. An implementation of its own, beside the core's, by singular values.

use capsule_core::Model;
use capsule_core::interpolate::Coordinates;
use capsule_core::model::MatrixView;
use capsule_database::Database;
use faer::Mat;

use super::truth::{Errors, INSTANTS, Truth, distance, read, read_one};
use super::{Row, Subject};
use crate::StudyError;

/// The setting that is varied.
#[derive(Clone, Copy)]
pub(super) struct Diffuse {
    pub(super) order: usize,
    pub(super) neighbours: usize,
    /// r on Ca.
    pub(super) scale: f64,
    /// R over the distance of the last neighbour.
    pub(super) radius: f64,
    /// Weight of the penalty on terms of second and higher order.
    pub(super) ridge: f64,
}

/// Weights of the diffuse approximation, and the condition number of its least squares problem.
pub(super) struct Solved {
    pub(super) weights: Vec<(usize, f64)>,
    pub(super) condition: f64,
}

impl Diffuse {
    /// The weights of the samples at a query; none where they do not determine the polynomial.
    pub(super) fn solve(
        &self,
        samples: &[[f64; 2]],
        query: [f64; 2],
        apart: impl Fn([f64; 2]) -> bool,
    ) -> Option<Solved> {
        const SINGULAR: f64 = 1e-12;
        let mut near: Vec<(usize, [f64; 2], f64)> = samples
            .iter()
            .enumerate()
            .filter(|(_, sample)| !apart(**sample))
            .map(|(j, sample)| {
                let offset = [self.scale * (sample[0] - query[0]), sample[1] - query[1]];
                (j, offset, offset[0].hypot(offset[1]))
            })
            .collect();
        near.sort_by(|a, b| a.2.total_cmp(&b.2));
        let radius = self.radius * near.get(self.neighbours.min(near.len()).checked_sub(1)?)?.2;
        near.retain(|(_, _, distance)| *distance < radius);
        let powers: Vec<[i32; 2]> = (0..=self.order as i32)
            .flat_map(|degree| (0..=degree).map(move |y| [degree - y, y]))
            .collect();
        let roots: Vec<f64> = near
            .iter()
            .map(|(_, _, distance)| {
                let d = distance / radius;
                ((2.0 * d - 3.0) * d * d + 1.0).sqrt()
            })
            .collect();
        // Below the samples, a row of the penalty for each term of second order and higher.
        let n = near.len();
        let matrix = Mat::from_fn(n + powers.len(), powers.len(), |i, k| {
            let [x, y] = powers[k];
            match near.get(i) {
                Some((_, offset, _)) => roots[i] * (offset[0] / radius).powi(x) * (offset[1] / radius).powi(y),
                None if i == n + k && x + y >= 2 => self.ridge,
                None => 0.0,
            }
        });
        let svd = matrix.thin_svd().ok()?;
        let values: Vec<f64> = svd.S().column_vector().iter().copied().collect();
        let (largest, least) = (values[0], *values.last()?);
        if least < SINGULAR * largest {
            return None;
        }
        let share: Vec<f64> = values
            .iter()
            .enumerate()
            .map(|(k, value)| svd.V()[(0, k)] / value)
            .collect();
        let weight = |i: usize| (0..values.len()).map(|k| svd.U()[(i, k)] * share[k]).sum::<f64>();
        Some(Solved {
            weights: near
                .iter()
                .enumerate()
                .map(|(i, (j, _, _))| (*j, roots[i] * weight(i)))
                .collect(),
            condition: largest / least,
        })
    }
}

/// The paper's grid, as far as it is steady, at the instants of the errors.
fn samples(database: &Database, quick: bool) -> Result<Vec<Truth>, StudyError> {
    let multiple = |value: f64, step: f64| (value / step - (value / step).round()).abs() < 1e-6;
    let entries = database.entries()?.into_iter().filter(|entry| {
        let [ca, confinement] = [entry.parameters[0], entry.parameters[1]];
        let rows = if quick { 0.84..0.96 } else { 0.74..1.21 };
        entry.status.is_steady()
            && (multiple(ca, 0.01) || (ca - 0.005).abs() < 1e-9)
            && multiple(confinement, 0.05)
            && rows.contains(&confinement)
    });
    entries
        .map(|entry| read_one(database, [entry.parameters[0], entry.parameters[1]]))
        .collect()
}

/// Errors of interpolated snapshots at configurations of the test set.
pub(super) fn rows(subject: &Subject, model: &Model) -> Result<Vec<Row>, StudyError> {
    let samples = samples(subject.database, subject.quick)?;
    let places: Vec<[f64; 2]> = samples.iter().map(|sample| sample.parameters).collect();
    let rows = if subject.quick { 0.85..0.95 } else { 0.75..1.2 };
    let truths = read(subject.tests, if subject.quick { 4 } else { 40 }, |[_, confinement]| {
        rows.contains(&confinement)
    })?;
    let coordinates = Coordinates::new(model.contents());
    let default = Diffuse {
        order: 2,
        neighbours: 12,
        scale: 1.9,
        radius: 1.2,
        ridge: 1e-4,
    };
    // As in the model, no interpolation crosses the row at which the start changes.
    let split = MatrixView::new(&model.contents().clusters[0].samples.parameters)
        .pairs::<f64>()
        .map(|[_, confinement]| confinement)
        .fold(0.0, f64::max);
    let errors = |diffuse: Diffuse| {
        let mut errors = Errors::default();
        for truth in &truths {
            let query = truth.parameters;
            let beyond = |sample: [f64; 2]| {
                coordinates.separated(sample, query) || (sample[1] - split) * (query[1] - split) < -1e-12
            };
            let solved = diffuse.solve(&places, query, beyond);
            errors.count(solved.map(|solved| {
                let at = |i: usize| {
                    let mut found = vec![[0.0; 3]; truth.positions[i].len()];
                    for (j, weight) in &solved.weights {
                        for (found, node) in found.iter_mut().zip(&samples[*j].positions[i]) {
                            (0..3).for_each(|d| found[d] += weight * node[d]);
                        }
                    }
                    distance(&found, &truth.positions[i]) / query[1]
                };
                (0..INSTANTS.len()).map(at).collect()
            }));
        }
        errors
    };
    let mut rows = Vec::new();
    for order in 1..=3 {
        let by = format!("order {order}");
        for neighbours in [6, 10, 12, 16, 20, 30] {
            let diffuse = Diffuse {
                order,
                neighbours,
                ..default
            };
            rows.push(Row::new("M, snapshots alone", neighbours as f64, &by, &errors(diffuse)));
        }
        for ridge in [0.0, 1e-8, 1e-6, 1e-4, 1e-2, 1e-1] {
            let diffuse = Diffuse {
                order,
                ridge,
                neighbours: 6 + 6 * order,
                ..default
            };
            rows.push(Row::new("regularisation", ridge, &by, &errors(diffuse)));
        }
    }
    Ok(rows)
}
