//! The double POD of displacement and velocity together (paper, section 3.2, eqs. 15 to 22), with time in splines.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};

use crate::samples::State;
use crate::settings::{MAX_MODES, Truncation};
use crate::splines::TimeFit;
use crate::svd::left_singular;
use crate::{OfflineError, Ranks};

/// Root-mean-square error of the basis in which the snapshots of a cluster are kept while models are built and rebuilt, as
/// a share of the model's own.
const WORKING_SHARE: f64 = 0.1;
/// What the parameter modes may leave, as a share of the error of the modes: every one of them is paid for at every instant.
const PARAMETER_SHARE: f64 = 1.5;
/// What the splines may add, as a share of the error of the modes.
const TIME_SHARE: f64 = 2.0;
/// What rows of the core that are left out may add.
const ROWS_SHARE: f64 = 1.0;
/// What the digits of the modes, of the parameter modes and of the core may add, each.
const DIGITS_SHARE: f64 = 0.2;
/// What the translation's modes may leave.
const AXIAL_SHARE: f64 = 0.05;
/// The error of the modes where ranks are given instead, l.
const RANKS_TOLERANCE: f64 = 1e-4;

/// Rows of a panel, see [`capsule_core::model::wire::Encoding`]: ranks and the rows of slices are multiples of it.
pub(crate) const LANES: usize = 8;

/// The most modes of the translation that the core holds.
const MAX_AXIAL: usize = 16;

/// The snapshots of a cluster, in coordinates of an orthonormal basis that spans all of them.
///
/// Norms and products are those of the nodes, so the POD of the coordinates is the POD of the snapshots.
pub(crate) struct Snapshots {
    /// `[3 N_s, r]`
    basis: Mat<f64>,
    /// For each sample `[r, 2 N_t]`: displacements, then velocities times the weights of the instants.
    shape: Vec<Mat<f64>>,
    /// For each sample `[1, 2 N_t]`, in the same way.
    translation: Vec<Mat<f64>>,
    fit: TimeFit,
    /// Nodes of the full mesh.
    nodes: usize,
    truncation: Truncation,
}

/// A cluster's motion as the model keeps it, see [`capsule_core::model::wire::Field`].
pub(crate) struct DoublePod {
    /// Shape modes `[r, K - 1]` in the coordinates of the snapshots' basis.
    pub(crate) modes: Mat<f64>,
    /// Psi `[N_c, K_c]`.
    pub(crate) parameter_modes: Mat<f64>,
    /// The slices G_b `[n, K_c]`: the rows that are not negligible.
    pub(crate) slices: Vec<Mat<f64>>,
    /// `[N_b, K_a]`
    pub(crate) axial_controls: Mat<f64>,
    /// `[N_c, K_a]`
    pub(crate) axial_modes: Mat<f64>,
    /// Singular values of the shape matrix T.
    pub(crate) space_values: Vec<f64>,
    /// Singular values of the stacked matrix S of the controls.
    pub(crate) parameter_values: Vec<f64>,
}

impl Snapshots {
    /// The snapshots (displacement, velocity) of some samples at some instants, to be reduced.
    pub(crate) fn new(
        states: &[[&State; 2]],
        times: &[f64],
        nodes: usize,
        truncation: Truncation,
    ) -> Result<Self, OfflineError> {
        let weights = TimeFit::rate_weights(times);
        let joined = |[u, v]: &[&State; 2]| {
            let mut joined = Mat::from_fn(u.shape.nrows(), 2 * times.len(), |r, i| {
                match i.checked_sub(times.len()) {
                    None => u.shape[(r, i)],
                    Some(i) => weights[i] * v.shape[(r, i)],
                }
            });
            TimeFit::limit_start(&mut joined);
            joined
        };
        let joined: Vec<Mat<f64>> = states.iter().map(joined).collect();
        let stacked = hstack(&joined.iter().collect::<Vec<_>>());
        let (vectors, values) = left_singular(stacked.as_ref())?;
        let tolerance = truncation.tolerance().unwrap_or(RANKS_TOLERANCE);
        let rank = rank(&values, WORKING_SHARE * tolerance, nodes * stacked.ncols());
        let basis = vectors.subcols(0, rank).to_owned();
        let transposed = basis.transpose().to_owned();
        let shape: Vec<Mat<f64>> = joined.iter().map(|shape| product(&transposed, shape)).collect();
        let translation = states.iter().map(|[u, v]| {
            Mat::from_fn(1, 2 * times.len(), |_, i| match i.checked_sub(times.len()) {
                None => u.translation[i],
                Some(i) => weights[i] * v.translation[i],
            })
        });
        let fit = TimeFit::new(times, &shape, TIME_SHARE * tolerance * (nodes as f64).sqrt());
        Ok(Snapshots {
            basis,
            shape,
            translation: translation.collect(),
            fit,
            nodes,
            truncation,
        })
    }

    /// The knots of the splines.
    pub(crate) fn knots(&self) -> &[f64] {
        &self.fit.knots
    }

    /// The double POD of the samples `keep`.
    pub(crate) fn reduce(&self, keep: &[usize]) -> Result<DoublePod, OfflineError> {
        let count = keep.len();
        let shapes: Vec<&Mat<f64>> = keep.iter().map(|j| &self.shape[*j]).collect();
        let stacked = hstack(&shapes);
        let (space, space_values) = left_singular(stacked.as_ref())?;
        let space_rank = match self.truncation {
            Truncation::Tolerance(tolerance) => {
                rank(&space_values, tolerance, self.nodes * stacked.ncols()).next_multiple_of(LANES)
            }
            Truncation::Ranks(Ranks { space, .. }) => space - 1,
        };
        let modes = space
            .subcols(0, space_rank.min(MAX_MODES).min(space.ncols()))
            .to_owned();
        let transposed = modes.transpose().to_owned();

        // The transpose of S: a row a sample, all its controls one after the other.
        let size = modes.ncols();
        let controls: Vec<Mat<f64>> = shapes
            .iter()
            .map(|shape| self.fit.controls(&product(&transposed, shape)))
            .collect();
        let slices = self.fit.count();
        let stacked = Mat::from_fn(count, slices * size, |j, column| {
            controls[j][(column % size.max(1), column / size.max(1))]
        });
        let values = self.nodes * slices * count;
        let (parameter, parameter_values) = left_singular(stacked.as_ref())?;
        let parameter_rank = match self.truncation {
            Truncation::Tolerance(tolerance) => {
                rank(&parameter_values, PARAMETER_SHARE * tolerance, values).next_multiple_of(LANES)
            }
            Truncation::Ranks(Ranks { parameter, .. }) => parameter,
        };
        let columns = parameter_rank.clamp(1, MAX_MODES).min(parameter.ncols());
        let parameter_modes = parameter.subcols(0, columns).to_owned();
        let core = product(&parameter_modes.transpose().to_owned(), &stacked);

        let budget = self.share(ROWS_SHARE, &space_values, size, count) * (self.nodes * count) as f64;
        let slice = |b: usize| kept_rows(&Mat::from_fn(size, columns, |k, l| core[(l, b * size + k)]), budget);

        let translations: Vec<Mat<f64>> = keep.iter().map(|j| self.fit.controls(&self.translation[*j])).collect();
        let translations = Mat::from_fn(count, slices, |j, b| translations[j][(0, b)]);
        let (axial, axial_values) = left_singular(translations.as_ref())?;
        let axial_rank = rank(&axial_values, AXIAL_SHARE * self.tolerance(), values).clamp(1, MAX_AXIAL);
        let axial_modes = axial.subcols(0, axial_rank.min(axial.ncols())).to_owned();
        Ok(DoublePod {
            modes,
            slices: (0..slices).map(slice).collect(),
            parameter_modes,
            axial_controls: product(&translations.transpose().to_owned(), &axial_modes),
            axial_modes,
            space_values,
            parameter_values,
        })
    }

    /// Shape modes `[3 N_s, K - 1]`, weighted like [`State::shape`].
    pub(crate) fn modes_at_nodes(&self, pod: &DoublePod) -> Mat<f64> {
        product(&self.basis, &pod.modes)
    }

    fn tolerance(&self) -> f64 {
        self.truncation.tolerance().unwrap_or(RANKS_TOLERANCE)
    }

    /// The mean square of a share of the error of so many modes: finer than the modes that are kept is of no use.
    fn share(&self, share: f64, space_values: &[f64], modes: usize, samples: usize) -> f64 {
        let error = self.error_beyond(space_values, modes, samples).max(self.tolerance());
        (share * error).powi(2)
    }

    /// What digits may add.
    fn digits(&self, pod: &DoublePod) -> f64 {
        let (modes, samples) = (pod.modes.ncols(), pod.parameter_modes.nrows());
        self.share(DIGITS_SHARE, &pod.space_values, modes, samples)
    }

    /// How many of the leading modes need two bytes an entry; `greatest` is the greatest entry of a mode at the nodes.
    pub(crate) fn coarse_modes(&self, pod: &DoublePod, greatest: impl Fn(usize) -> f64) -> usize {
        let (count, samples) = (pod.modes.ncols(), pod.parameter_modes.nrows());
        let snapshots = (self.shape[0].ncols() * samples) as f64;
        // Of each of the three components of a node, times the mode's mean square coefficient.
        let rounding = |k: usize| 3.0 * rounding(greatest(k)) * pod.space_values[k].powi(2) / snapshots;
        trailing(count, self.digits(pod), rounding)
            .next_multiple_of(LANES)
            .min(count)
    }

    /// How many of the leading parameter modes do.
    pub(crate) fn coarse_parameter_modes(&self, pod: &DoublePod) -> usize {
        let psi = &pod.parameter_modes;
        let greatest = |l: usize| (0..psi.nrows()).map(|j| psi[(j, l)].abs()).fold(0.0, f64::max);
        // Times the mean square of what the mode is multiplied by at the nodes.
        let controls = (self.nodes * pod.slices.len()) as f64;
        let rounding = |l: usize| rounding(greatest(l)) * pod.parameter_values[l].powi(2) / controls;
        trailing(psi.ncols(), self.digits(pod), rounding)
    }

    /// How many of the core's leading columns do.
    pub(crate) fn coarse_columns(&self, pod: &DoublePod) -> usize {
        let (samples, columns) = pod.parameter_modes.shape();
        let greatest =
            |slice: &Mat<f64>, k: usize, from: usize| (from..columns).map(|l| slice[(k, l)].abs()).fold(0.0, f64::max);
        // Psi is orthonormal over the samples.
        let error = |from: usize| -> f64 {
            let rows = pod
                .slices
                .iter()
                .flat_map(|slice| (0..slice.nrows()).map(move |k| (slice, k)));
            let sum: f64 = rows.map(|(slice, k)| rounding(greatest(slice, k, from))).sum();
            columns as f64 * sum / (self.nodes * pod.slices.len() * samples) as f64
        };
        let budget = self.digits(pod);
        (0..columns).find(|from| error(*from) <= budget).unwrap_or(columns)
    }

    /// What a root-mean-square error of the displacement over the nodes, instants (or controls) and samples is made of, for
    /// singular values from `from` on.
    pub(crate) fn error_beyond(&self, values: &[f64], from: usize, samples: usize) -> f64 {
        let count = self.nodes * self.shape[0].ncols() * samples;
        (values.iter().skip(from).map(|s| s * s).sum::<f64>() / count as f64).sqrt()
    }
}

/// Leaves out the last rows of a slice, as far as the budget allows: they may add as much to the sum of the squares over
/// all samples, over which the columns of Psi are normalised. What shares a panel is kept alike.
fn kept_rows(slice: &Mat<f64>, budget: f64) -> Mat<f64> {
    let (rows, columns) = slice.shape();
    let square = |k: usize| (0..columns).map(|l| slice[(k, l)].powi(2)).sum::<f64>();
    let kept = trailing(rows, budget, square).next_multiple_of(LANES).min(rows);
    slice.subrows(0, kept).to_owned()
}

/// Mean square of the rounding of numbers to one byte, the greatest of which is the greatest integer: the variance of a
/// uniform distribution over a unit.
fn rounding(greatest: f64) -> f64 {
    let unit = greatest / f64::from(i8::MAX);
    unit * unit / 12.0
}

/// Where the trailing ones begin that add no more than a budget.
fn trailing(end: usize, budget: f64, error: impl Fn(usize) -> f64) -> usize {
    let mut sum = 0.0;
    let within = (0..end).rev().take_while(|k| {
        sum += error(*k);
        sum <= budget
    });
    end - within.count()
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

    const INSTANTS: usize = 24;

    /// Five samples of a motion and its rate, 12 rows, of a mesh of 4 nodes.
    fn states() -> Vec<[State; 2]> {
        // Value and rate of a decay and of swings.
        let time = |n: usize, t: f64| match n {
            0 => [1.0 - (-0.7 * t).exp(), 0.7 * (-0.7 * t).exp()],
            _ => [(n as f64 * t).sin(), n as f64 * (n as f64 * t).cos()],
        };
        let size = |n: usize, j: usize| 0.3f64.powi(n as i32) * (1.0 + j as f64 * (1.0 + 0.3 * (n * j) as f64).cos());
        let state = |j: usize, which: usize| State {
            translation: times()
                .iter()
                .map(|t| [(1.0 + 0.1 * j as f64) * t, 1.0 + 0.1 * j as f64][which])
                .collect(),
            shape: Mat::from_fn(12, INSTANTS, |r, i| {
                (0..6)
                    .map(|n| size(n, j) * time(n, times()[i])[which] * ((1.3 * n as f64 + 0.5) * r as f64).sin())
                    .sum()
            }),
        };
        (0..5).map(|j| [state(j, 0), state(j, 1)]).collect()
    }

    fn times() -> Vec<f64> {
        (0..INSTANTS).map(|i| 0.1 * i as f64).collect()
    }

    fn snapshots(states: &[[State; 2]], truncation: Truncation) -> Snapshots {
        let states: Vec<[&State; 2]> = states.iter().map(|[u, v]| [u, v]).collect();
        Snapshots::new(&states, &times(), 4, truncation).unwrap()
    }

    fn orthonormal(columns: &Mat<f64>) -> f64 {
        let gram = product(&columns.transpose().to_owned(), columns);
        let error = |k: usize, l: usize| (gram[(k, l)] - if k == l { 1.0 } else { 0.0 }).abs();
        (0..gram.nrows())
            .flat_map(|k| (0..gram.ncols()).map(move |l| (k, l)))
            .map(|(k, l)| error(k, l))
            .fold(0.0, f64::max)
    }

    /// Root mean square error of the displacement at the first and last instant, where the spline is its first and last
    /// control, and greatest error of the translation there.
    fn errors_at_ends(states: &[[State; 2]], snapshots: &Snapshots, pod: &DoublePod) -> [f64; 2] {
        let modes = snapshots.modes_at_nodes(pod);
        let (mut square, mut axial) = (0.0, 0.0f64);
        for (slice, i) in [(0, 0), (pod.slices.len() - 1, INSTANTS - 1)] {
            for (j, [state, _]) in states.iter().enumerate() {
                let psi = Mat::from_fn(pod.parameter_modes.ncols(), 1, |l, _| pod.parameter_modes[(j, l)]);
                let alpha = product(&pod.slices[slice], &psi);
                for r in 0..12 {
                    let value: f64 = (0..alpha.nrows()).map(|k| modes[(r, k)] * alpha[(k, 0)]).sum();
                    square += (value - state.shape[(r, i)]).powi(2);
                }
                let translation: f64 = (0..pod.axial_modes.ncols())
                    .map(|a| pod.axial_controls[(slice, a)] * pod.axial_modes[(j, a)])
                    .sum();
                axial = axial.max((translation - state.translation[i]).abs());
            }
        }
        [(square / (2.0 * 4.0 * 5.0)).sqrt(), axial]
    }

    #[test]
    fn the_tolerance_is_kept_and_modes_are_orthonormal() {
        let states = states();
        let mut sizes = Vec::new();
        for tolerance in [1e-2, 1e-4, 1e-6] {
            let snapshots = snapshots(&states, Truncation::Tolerance(tolerance));
            let pod = snapshots.reduce(&[0, 1, 2, 3, 4]).unwrap();
            let modes = snapshots.modes_at_nodes(&pod);
            assert!(orthonormal(&modes) < 1e-12 && orthonormal(&pod.parameter_modes) < 1e-12);
            let [shape, translation] = errors_at_ends(&states, &snapshots, &pod);
            // The tolerance is a mean over the instants, of which these are two.
            assert!(
                shape < 4.0 * tolerance && translation < 2.0 * tolerance,
                "{tolerance} {shape:e} {translation:e}"
            );
            assert!(snapshots.error_beyond(&pod.space_values, pod.modes.ncols(), 5) <= tolerance);
            sizes.push((pod.modes.ncols(), pod.slices.len()));
        }
        assert!(sizes[0] < sizes[1] && sizes[1] < sizes[2], "{sizes:?}");
    }

    #[test]
    fn ranks_are_those_asked_for() {
        let states = states();
        let snapshots = snapshots(&states, Truncation::Ranks(Ranks { space: 4, parameter: 2 }));
        let pod = snapshots.reduce(&[0, 1, 2, 3, 4]).unwrap();
        assert_eq!((pod.modes.ncols(), pod.parameter_modes.ncols()), (3, 2));
    }

    #[test]
    fn what_is_left_out_keeps_the_budget() {
        let slice = Mat::from_fn(20, 7, |k, l| 0.6f64.powi(k as i32) * ((3 * k + l) as f64).cos());
        let end = kept_rows(&slice, 1e-6).nrows();
        let square = |rows: std::ops::Range<usize>| -> f64 {
            rows.flat_map(|k| (0..7).map(move |l| (k, l)))
                .map(|(k, l)| slice[(k, l)].powi(2))
                .sum()
        };
        // A panel less would leave too much out.
        assert!(square(end..20) <= 1e-6 && square(end - LANES..20) > 1e-6);
        assert_eq!(end % LANES, 0);
    }

    /// In the unit in which the greatest is the greatest integer of one byte.
    fn rounded(values: &[f64]) -> Vec<f64> {
        let unit = values.iter().fold(0.0, |a: f64, x| a.max(x.abs())) / 127.0;
        values.iter().map(|x| unit * (x / unit).round()).collect()
    }

    #[test]
    fn fewer_digits_add_no_more_than_their_share() {
        let states = states();
        let snapshots = snapshots(&states, Truncation::Tolerance(2e-4));
        let pod = snapshots.reduce(&[0, 1, 2, 3, 4]).unwrap();
        let (samples, columns) = pod.parameter_modes.shape();
        let psi = |j: usize| (0..columns).map(move |l| (l, j));
        let mean = |sum: f64| sum / (4 * pod.slices.len() * samples) as f64;
        let budget = snapshots.digits(&pod);

        let coarse = snapshots.coarse_columns(&pod);
        assert!(0 < coarse && coarse < columns, "{coarse} of {columns}");
        let error = |coarse: usize| {
            let mut sum = 0.0;
            for (slice, k) in pod
                .slices
                .iter()
                .flat_map(|slice| (0..slice.nrows()).map(move |k| (slice, k)))
            {
                let row: Vec<f64> = (0..columns).map(|l| slice[(k, l)]).collect();
                // The columns of two bytes are exact beside those of one.
                let rest = rounded(&row[coarse..]);
                let error = |(l, j): (usize, usize)| match l.checked_sub(coarse) {
                    Some(m) => (rest[m] - row[l]) * pod.parameter_modes[(j, l)],
                    None => 0.0,
                };
                sum += (0..samples)
                    .map(|j| psi(j).map(error).sum::<f64>().powi(2))
                    .sum::<f64>();
            }
            mean(sum)
        };
        assert!(error(coarse) <= 1.5 * budget && error(coarse - 1) > 0.5 * budget);

        let coarse = snapshots.coarse_parameter_modes(&pod);
        assert!(0 < coarse && coarse < columns, "{coarse} of {columns}");
        let error = |coarse: usize| {
            let modes: Vec<Vec<f64>> = (0..columns)
                .map(|l| {
                    let mode: Vec<f64> = (0..samples).map(|j| pod.parameter_modes[(j, l)]).collect();
                    if l < coarse { mode } else { rounded(&mode) }
                })
                .collect();
            let mut sum = 0.0;
            for (slice, j) in pod
                .slices
                .iter()
                .flat_map(|slice| (0..samples).map(move |j| (slice, j)))
            {
                for k in 0..slice.nrows() {
                    let error = psi(j).map(|(l, j)| slice[(k, l)] * (modes[l][j] - pod.parameter_modes[(j, l)]));
                    sum += error.sum::<f64>().powi(2);
                }
            }
            mean(sum)
        };
        assert!(error(coarse) <= 1.5 * budget && error(coarse - 1) > 0.5 * budget);
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
    }

    #[test]
    fn a_subset_is_reduced_as_if_the_rest_had_never_been() {
        let mut states = states();
        let whole = snapshots(&states, Truncation::Tolerance(1e-6))
            .reduce(&[0, 1, 3, 4])
            .unwrap();
        states.remove(2);
        let alone = snapshots(&states, Truncation::Tolerance(1e-6))
            .reduce(&[0, 1, 2, 3])
            .unwrap();
        for (a, b) in whole.space_values.iter().zip(&alone.space_values) {
            assert!((a - b).abs() < 1e-6 * whole.space_values[0], "{a} {b}");
        }
        assert_eq!(whole.modes.ncols(), alone.modes.ncols());
    }
}
