//! The double POD of one field (paper, section 3.2, eqs. 15 to 22).

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};

use crate::samples::State;
use crate::settings::MAX_RANK;
use crate::svd::left_singular;
use crate::{OfflineError, Ranks};

/// Root-mean-square error of the basis in which the snapshots of a cluster are kept while models are built and rebuilt:
/// as a share of the tolerance of the models' own, and (l or V) where they have fixed ranks. Snapshots carry rounding of
/// 2e-7 and more, which a finer basis would span.
const WORKING_SHARE: f64 = 0.03;
const WORKING_ERROR: f64 = 1e-6;

/// The snapshots of one field of a cluster, in coordinates of an orthonormal basis that spans all of them.
///
/// Norms and products are those of the nodes, so the POD of the coordinates is the POD of the snapshots.
pub(crate) struct Snapshots {
    /// `[3 N_s, r]`
    basis: Mat<f64>,
    /// For each sample `[r, N_t]`.
    shape: Vec<Mat<f64>>,
    /// For each sample `[N_t]`.
    translation: Vec<Vec<f64>>,
    /// Nodes of the full mesh.
    nodes: usize,
}

/// How a field is truncated.
#[derive(Clone, Copy)]
pub(crate) enum Rule {
    /// Root-mean-square error.
    Tolerance(f64),
    Ranks(Ranks),
}

impl Rule {
    /// Root-mean-square error of the working basis.
    fn working_error(self) -> f64 {
        match self {
            Rule::Tolerance(tolerance) => WORKING_SHARE * tolerance,
            Rule::Ranks(_) => WORKING_ERROR,
        }
    }
}

/// A field as the model keeps it: value(t_i, theta_j) = Phi A(t_i) Psi_j^T.
pub(crate) struct DoublePod {
    /// Shape modes `[r, K - 1]` in the coordinates of the snapshots' basis.
    pub(crate) modes: Mat<f64>,
    /// A(t_i), each `[K, K_c]`; row 0 is the translation.
    pub(crate) coefficients: Vec<Mat<f64>>,
    /// Psi `[N_c, K_c]`.
    pub(crate) parameter_modes: Mat<f64>,
    /// Singular values of the shape matrix T.
    pub(crate) space_values: Vec<f64>,
    /// Singular values of the stacked matrix S, translation included.
    pub(crate) parameter_values: Vec<f64>,
}

impl Snapshots {
    /// The snapshots of some samples, to be reduced by a rule.
    pub(crate) fn new(states: &[&State], nodes: usize, rule: Rule) -> Result<Self, OfflineError> {
        let stacked = hstack(&states.iter().map(|s| &s.shape).collect::<Vec<_>>());
        let (vectors, values) = left_singular(stacked.as_ref())?;
        let rank = rank(&values, rule.working_error(), nodes * stacked.ncols());
        let basis = vectors.subcols(0, rank).to_owned();
        let shape = states
            .iter()
            .map(|s| product(&basis.transpose().to_owned(), &s.shape))
            .collect();
        Ok(Snapshots {
            basis,
            shape,
            translation: states.iter().map(|s| s.translation.clone()).collect(),
            nodes,
        })
    }

    /// The double POD of the samples `keep`.
    pub(crate) fn reduce(&self, keep: &[usize], rule: Rule) -> Result<DoublePod, OfflineError> {
        let shapes: Vec<&Mat<f64>> = keep.iter().map(|j| &self.shape[*j]).collect();
        let (instants, size, count) = (shapes[0].ncols(), self.basis.ncols(), keep.len());
        let (space, space_values) = left_singular(hstack(&shapes).as_ref())?;
        // The transpose of S: a row a sample, all its instants one after the other.
        let stacked = Mat::from_fn(count, instants * (size + 1), |j, column| {
            let (i, k) = (column / (size + 1), column % (size + 1));
            if k == 0 {
                self.translation[keep[j]][i]
            } else {
                shapes[j][(k - 1, i)]
            }
        });
        let (parameter, parameter_values) = left_singular(stacked.as_ref())?;
        let values = self.nodes * instants * count;
        let (space_rank, parameter_rank) = match rule {
            Rule::Tolerance(tolerance) => (
                rank(&space_values, tolerance, values).min(MAX_RANK - 1),
                rank(&parameter_values, tolerance, values).clamp(1, MAX_RANK),
            ),
            Rule::Ranks(ranks) => (ranks.space - 1, ranks.parameter),
        };
        let modes = space.subcols(0, space_rank.min(space.ncols())).to_owned();
        let parameter_modes = parameter.subcols(0, parameter_rank.min(parameter.ncols())).to_owned();
        let projected: Vec<Mat<f64>> = shapes
            .iter()
            .map(|s| product(&modes.transpose().to_owned(), s))
            .collect();
        let coefficients = (0..instants).map(|i| {
            let snapshots = Mat::from_fn(modes.ncols() + 1, count, |k, j| {
                if k == 0 {
                    self.translation[keep[j]][i]
                } else {
                    projected[j][(k - 1, i)]
                }
            });
            product(&snapshots, &parameter_modes)
        });
        let coefficients = coefficients.collect();
        Ok(DoublePod {
            modes,
            coefficients,
            parameter_modes,
            space_values,
            parameter_values,
        })
    }

    /// Shape modes `[3 N_s, K - 1]`, weighted like [`State::shape`].
    pub(crate) fn modes_at_nodes(&self, pod: &DoublePod) -> Mat<f64> {
        product(&self.basis, &pod.modes)
    }

    /// What a root-mean-square error over the nodes, instants and samples is made of, for singular values from `from` on.
    pub(crate) fn error_beyond(&self, values: &[f64], from: usize, samples: usize) -> f64 {
        let count = self.nodes * self.shape[0].ncols() * samples;
        (values.iter().skip(from).map(|s| s * s).sum::<f64>() / count as f64).sqrt()
    }
}

/// The least rank beyond which the singular values add up to no more than the tolerance, root mean square over `count`.
fn rank(values: &[f64], tolerance: f64, count: usize) -> usize {
    let budget = tolerance * tolerance * count as f64;
    let mut tail = 0.0;
    let dropped = values.iter().rev().take_while(|s| {
        tail += **s * **s;
        tail <= budget
    });
    values.len() - dropped.count()
}

fn hstack(matrices: &[&Mat<f64>]) -> Mat<f64> {
    let columns = matrices.iter().map(|m| m.ncols()).sum();
    let mut stacked = Mat::zeros(matrices.first().map_or(0, |m| m.nrows()), columns);
    let mut at = 0;
    for matrix in matrices {
        stacked.as_mut().subcols_mut(at, matrix.ncols()).copy_from(matrix);
        at += matrix.ncols();
    }
    stacked
}

/// The product of two matrices on this thread alone, so that the result does not depend on the number of threads.
pub(crate) fn product(a: &Mat<f64>, b: &Mat<f64>) -> Mat<f64> {
    let mut result = Mat::zeros(a.nrows(), b.ncols());
    matmul(&mut result, Accum::Replace, a, b, 1.0, Par::Seq);
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Five samples of a field with three modes of falling size and noise, 12 rows, 9 instants, of a mesh of 4 nodes.
    fn states() -> Vec<State> {
        let state = |j: usize| State {
            translation: (0..9).map(|i| (1.0 + 0.1 * j as f64) * i as f64).collect(),
            shape: Mat::from_fn(12, 9, |r, i| {
                let (r, i, j) = (r as f64, i as f64, j as f64);
                let modes = (0.5 * r).sin() * (1.0 + j) * i + 0.1 * (0.9 * r).cos() * (j - 2.0) * (0.3 * i).sin();
                modes + 0.01 * (1.7 * r).sin() * j * j + 1e-4 * ((7.0 * r + 3.0 * i + 5.0 * j) * 12.9898).sin()
            }),
        };
        (0..5).map(state).collect()
    }

    fn orthonormal(columns: &Mat<f64>) -> f64 {
        let gram = product(&columns.transpose().to_owned(), columns);
        let error = |k: usize, l: usize| (gram[(k, l)] - if k == l { 1.0 } else { 0.0 }).abs();
        (0..gram.nrows())
            .flat_map(|k| (0..gram.ncols()).map(move |l| (k, l)))
            .map(|(k, l)| error(k, l))
            .fold(0.0, f64::max)
    }

    fn snapshots(states: &[State]) -> Snapshots {
        Snapshots::new(&states.iter().collect::<Vec<_>>(), 4, Rule::Tolerance(1e-6)).unwrap()
    }

    #[test]
    fn modes_are_orthonormal_and_leave_the_energy_of_the_tail() {
        let states = states();
        let snapshots = snapshots(&states);
        let all = [0, 1, 2, 3, 4];
        let pod = snapshots
            .reduce(&all, Rule::Ranks(Ranks { space: 3, parameter: 5 }))
            .unwrap();
        let modes = snapshots.modes_at_nodes(&pod);
        assert!(orthonormal(&modes) < 1e-13 && orthonormal(&pod.parameter_modes) < 1e-13);
        let mut error = 0.0;
        for (j, state) in states.iter().enumerate() {
            for i in 0..9 {
                let psi = Mat::from_fn(5, 1, |l, _| pod.parameter_modes[(j, l)]);
                let alpha = product(&pod.coefficients[i], &psi);
                assert!((alpha[(0, 0)] - state.translation[i]).abs() < 1e-12);
                for r in 0..12 {
                    let value: f64 = (0..2).map(|k| modes[(r, k)] * alpha[(k + 1, 0)]).sum();
                    error += (value - state.shape[(r, i)]).powi(2);
                }
            }
        }
        let tail: f64 = pod.space_values[2..].iter().map(|s| s * s).sum();
        assert!((error / tail - 1.0).abs() < 1e-6, "{error:e} {tail:e}");
        let rms = snapshots.error_beyond(&pod.space_values, 2, 5);
        assert!((rms - (error / (4.0 * 9.0 * 5.0)).sqrt()).abs() < 1e-9);
    }

    #[test]
    fn parameter_modes_leave_the_energy_of_their_tail() {
        let states = states();
        let snapshots = snapshots(&states);
        let pod = snapshots
            .reduce(
                &[0, 1, 2, 3, 4],
                Rule::Ranks(Ranks {
                    space: 13,
                    parameter: 2,
                }),
            )
            .unwrap();
        let modes = snapshots.modes_at_nodes(&pod);
        let mut error = 0.0;
        for (j, state) in states.iter().enumerate() {
            for i in 0..9 {
                let psi = Mat::from_fn(2, 1, |l, _| pod.parameter_modes[(j, l)]);
                let alpha = product(&pod.coefficients[i], &psi);
                error += (alpha[(0, 0)] - state.translation[i]).powi(2);
                for r in 0..12 {
                    let value: f64 = (0..modes.ncols()).map(|k| modes[(r, k)] * alpha[(k + 1, 0)]).sum();
                    error += (value - state.shape[(r, i)]).powi(2);
                }
            }
        }
        let tail: f64 = pod.parameter_values[2..].iter().map(|s| s * s).sum();
        assert!((error / tail - 1.0).abs() < 1e-3, "{error:e} {tail:e}");
    }

    #[test]
    fn a_tolerance_gives_the_least_rank_that_keeps_it() {
        let values = [10.0, 3.0, 2.0, 1.0];
        let tail = |k: usize| (values[k..].iter().map(|s| s * s).sum::<f64>() / 7.0).sqrt();
        for k in 0..4 {
            assert_eq!(rank(&values, 1.0001 * tail(k), 7), k);
            assert_eq!(rank(&values, 0.9999 * tail(k), 7), k + 1);
        }
        assert_eq!(rank(&values, 0.0, 7), 4);
        let snapshots = snapshots(&states());
        let pod = snapshots.reduce(&[0, 1, 2, 3, 4], Rule::Tolerance(1e-3)).unwrap();
        assert!(snapshots.error_beyond(&pod.space_values, pod.modes.ncols(), 5) <= 1e-3);
        assert_eq!(pod.modes.ncols(), 3);
    }

    #[test]
    fn a_subset_is_reduced_as_if_the_rest_had_never_been() {
        let states = states();
        let whole = snapshots(&states).reduce(&[0, 1, 3, 4], Rule::Tolerance(1e-6)).unwrap();
        let kept: Vec<&State> = [0, 1, 3, 4].iter().map(|j| &states[*j]).collect();
        let alone = Snapshots::new(&kept, 4, Rule::Tolerance(1e-6))
            .unwrap()
            .reduce(&[0, 1, 2, 3], Rule::Tolerance(1e-6))
            .unwrap();
        for (a, b) in whole.space_values.iter().zip(&alone.space_values) {
            assert!((a - b).abs() < 1e-6 * whole.space_values[0], "{a} {b}");
        }
        assert_eq!(whole.modes.ncols(), alone.modes.ncols());
    }
}
