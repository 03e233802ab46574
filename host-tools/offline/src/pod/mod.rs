//! The double POD of displacement and velocity together (paper, section 3.2, eqs. 15 to 22), with time in splines.

mod quantisation;
mod ranks;

use capsule_core::model::panels::LANES;
use faer::Mat;
use std::ops::Range;

use self::ranks::{rank, trailing};
use crate::dense::{hstack, leading, orthogonal_complement, product};
use crate::samples::State;
use crate::settings::{MAX_MODES, Truncation};
use crate::splines::{Span, TimeFit};
use crate::svd::left_singular;
use crate::{OfflineError, Ranks};

/// Root-mean-square error of the basis in which the snapshots of a cluster are kept while models are built and rebuilt,
/// as a share of the tolerance. The modes may leave the whole tolerance in a span of time.
const WORKING_SHARE: f64 = 0.05;
/// Error that the parameter modes may leave. Over all time the modes leave half the tolerance, because a span has the
/// modes of the other spans too.
const PARAMETER_SHARE: f64 = 0.625;
/// Error that the splines in time may add.
const TIME_SHARE: f64 = 1.0;
/// Error that the omitted rows of the core may add at a control.
const ROWS_SHARE: f64 = 1.0;
/// Error that the modes of the translation may leave.
const AXIAL_SHARE: f64 = 0.025;
/// Tolerance (l) of everything else where ranks are given.
const RANKS_TOLERANCE: f64 = 2e-4;

/// Capacity of the core: modes of the translation.
const MAX_AXIAL: usize = 16;

/// Modes that are those of the whole motion before a span of time adds its own: the paper's method works in the leading
/// ones at all times.
const COMMON_MODES: usize = 8;

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
    spans: Vec<Span>,
    /// Nodes of the full mesh.
    nodes: usize,
    truncation: Truncation,
}

/// The motion of a cluster as the model stores it, see [`capsule_core::model::wire::Field`].
pub(crate) struct DoublePod {
    /// Shape modes `[r, K - 1]` in the coordinates of the snapshots' basis.
    pub(crate) modes: Mat<f64>,
    /// Sum of the squares of each mode's coefficients, over all instants and samples.
    squares: Vec<f64>,
    /// Root-mean-square error of the displacement over nodes, instants and samples that the modes leave.
    pub(crate) space_error: f64,
    pub(crate) spans: Vec<SpanPod>,
    /// `[N_b, K_a]`
    pub(crate) axial_controls: Mat<f64>,
    /// `[N_c, K_a]`
    pub(crate) axial_modes: Mat<f64>,
    /// Singular values of the shape matrix T.
    pub(crate) space_values: Vec<f64>,
    /// Singular values of the stacked matrix S of all controls.
    pub(crate) parameter_values: Vec<f64>,
}

/// The controls of a span of time, see [`capsule_core::model::wire::Span`].
pub(crate) struct SpanPod {
    /// Psi `[N_c, K_c]`.
    pub(crate) parameter_modes: Mat<f64>,
    /// The slices G_b `[n, K_c]`: the rows that are not negligible.
    pub(crate) slices: Vec<Mat<f64>>,
    /// Singular values of the stacked matrix S of the span's controls.
    pub(crate) values: Vec<f64>,
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
        let spans = match truncation {
            Truncation::Tolerance(_) => fit.spans(times),
            Truncation::Ranks(_) => fit.whole(times),
        };
        Ok(Snapshots {
            basis,
            shape,
            translation: translation.collect(),
            fit,
            spans,
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
        let modes = match self.truncation {
            Truncation::Tolerance(tolerance) => self.modes(&space, &shapes, tolerance)?,
            Truncation::Ranks(Ranks { space: rank, .. }) => leading(&space, (rank - 1).min(MAX_MODES)),
        };
        let transposed = modes.transpose().to_owned();
        let coefficients: Vec<Mat<f64>> = shapes.iter().map(|shape| product(&transposed, shape)).collect();
        let size = modes.ncols();
        let row = |k: usize| coefficients.iter().map(|shape| shape.row(k).squared_norm_l2()).sum();
        let squares: Vec<f64> = (0..size).map(row).collect();
        let all: f64 = stacked.squared_norm_l2();
        let left = (all - squares.iter().sum::<f64>()).max(0.0);
        let space_error = (left / (self.nodes * stacked.ncols()) as f64).sqrt();

        // The transpose of S: a row a sample, all its controls one after the other.
        let controls: Vec<Mat<f64>> = coefficients.iter().map(|shape| self.fit.controls(shape)).collect();
        let stacked = |controls_of: &Range<usize>| {
            Mat::from_fn(count, controls_of.len() * size, |j, column| {
                controls[j][(column % size.max(1), controls_of.start + column / size.max(1))]
            })
        };
        let slices = self.fit.count();
        let (_, parameter_values) = left_singular(stacked(&(0..slices)).as_ref())?;
        // Sum of squares over all samples that omitted rows may add.
        let error = space_error.max(self.tolerance());
        let budget = (ROWS_SHARE * error).powi(2) * (self.nodes * count) as f64;
        let span = |span: &Span| {
            let stacked = stacked(&span.controls);
            let (parameter, values) = left_singular(stacked.as_ref())?;
            let rank = match self.truncation {
                Truncation::Tolerance(tolerance) => {
                    let count = self.nodes * span.controls.len() * count;
                    rank(&values, PARAMETER_SHARE * tolerance, count)
                }
                Truncation::Ranks(Ranks { parameter, .. }) => parameter,
            };
            let parameter_modes = leading(&parameter, rank.clamp(1, MAX_MODES));
            let core = product(&parameter_modes.transpose().to_owned(), &stacked);
            let columns = parameter_modes.ncols();
            let slice = |b: usize| kept_rows(&Mat::from_fn(size, columns, |k, l| core[(l, b * size + k)]), budget);
            Ok(SpanPod {
                slices: (0..span.controls.len()).map(slice).collect(),
                parameter_modes,
                values,
            })
        };
        let spans: Result<Vec<SpanPod>, OfflineError> = self.spans.iter().map(span).collect();

        let translations: Vec<Mat<f64>> = keep.iter().map(|j| self.fit.controls(&self.translation[*j])).collect();
        let translations = Mat::from_fn(count, slices, |j, b| translations[j][(0, b)]);
        let (axial, axial_values) = left_singular(translations.as_ref())?;
        let values = self.nodes * slices * count;
        let axial_rank = rank(&axial_values, AXIAL_SHARE * self.tolerance(), values).clamp(1, MAX_AXIAL);
        let axial_modes = leading(&axial, axial_rank);
        Ok(DoublePod {
            modes,
            squares,
            space_error,
            spans: spans?,
            axial_controls: product(&translations.transpose().to_owned(), &axial_modes),
            axial_modes,
            space_values,
            parameter_values,
        })
    }

    /// Modes that leave no more than the tolerance in every span of time. The common ones come first, then what each
    /// span needs beside those before, the last span first: so the end of a motion, where most instants are, needs the
    /// leading modes alone, and the rows of the others are left out of the core there.
    fn modes(&self, space: &Mat<f64>, shapes: &[&Mat<f64>], tolerance: f64) -> Result<Mat<f64>, OfflineError> {
        let mut modes = leading(space, COMMON_MODES);
        for span in self.spans.iter().rev() {
            let instants = span.instants.len();
            let rates = shapes[0].ncols() / 2;
            let stacked = Mat::from_fn(modes.nrows(), 2 * instants * shapes.len(), |r, column| {
                let (sample, place) = (column / (2 * instants), column % (2 * instants));
                let instant = span.instants.start + place % instants;
                shapes[sample][(r, if place < instants { instant } else { rates + instant })]
            });
            let within = product(&modes, &product(&modes.transpose().to_owned(), &stacked));
            let (others, values) = left_singular((&stacked - within).as_ref())?;
            let rank = modes.ncols() + rank(&values, tolerance, self.nodes * stacked.ncols());
            let rank = rank.next_multiple_of(LANES).min(MAX_MODES);
            let others = leading(&others, rank - modes.ncols());
            modes = hstack(&[&modes, &orthogonal_complement(&modes, &others)]);
        }
        Ok(modes)
    }

    /// Shape modes `[3 N_s, K - 1]`, weighted like [`State::shape`].
    pub(crate) fn modes_at_nodes(&self, pod: &DoublePod) -> Mat<f64> {
        product(&self.basis, &pod.modes)
    }

    fn tolerance(&self) -> f64 {
        self.truncation.tolerance().unwrap_or(RANKS_TOLERANCE)
    }

    /// Root-mean-square error of the displacement over the nodes, controls and samples that the parameter modes leave.
    pub(crate) fn parameter_error(&self, pod: &DoublePod) -> f64 {
        let left = |span: &SpanPod| -> f64 {
            let kept = span.parameter_modes.ncols();
            span.values.iter().skip(kept).map(|s| s * s).sum()
        };
        let count = self.nodes * self.fit.count() * pod.samples();
        (pod.spans.iter().map(left).sum::<f64>() / count as f64).sqrt()
    }
}

impl DoublePod {
    fn samples(&self) -> usize {
        self.axial_modes.nrows()
    }
}

/// Leaves out the last rows of a slice, as far as the budget allows: they may add as much to the sum of the squares
/// over all samples, over which the columns of Psi are normalised. What shares a panel is kept alike.
fn kept_rows(slice: &Mat<f64>, budget: f64) -> Mat<f64> {
    let (rows, columns) = slice.shape();
    let square = |k: usize| (0..columns).map(|l| slice[(k, l)].powi(2)).sum::<f64>();
    let kept = trailing(rows, budget, square).next_multiple_of(LANES).min(rows);
    slice.subrows(0, kept).to_owned()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::dense::product;

    const INSTANTS: usize = 24;

    /// Five samples of a motion and its rate, 12 rows, of a mesh of 4 nodes.
    pub(crate) fn states() -> Vec<[State; 2]> {
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

    pub(crate) fn snapshots(states: &[[State; 2]], truncation: Truncation) -> Snapshots {
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
        let ends = [(pod.spans.first(), 0), (pod.spans.last(), INSTANTS - 1)];
        for (span, i) in ends {
            let span = span.unwrap();
            let slice = if i == 0 { 0 } else { span.slices.len() - 1 };
            let control = if i == 0 { 0 } else { pod.axial_controls.nrows() - 1 };
            for (j, [state, _]) in states.iter().enumerate() {
                let psi = Mat::from_fn(span.parameter_modes.ncols(), 1, |l, _| span.parameter_modes[(j, l)]);
                let alpha = product(&span.slices[slice], &psi);
                for r in 0..12 {
                    let value: f64 = (0..alpha.nrows()).map(|k| modes[(r, k)] * alpha[(k, 0)]).sum();
                    square += (value - state.shape[(r, i)]).powi(2);
                }
                let translation: f64 = (0..pod.axial_modes.ncols())
                    .map(|a| pod.axial_controls[(control, a)] * pod.axial_modes[(j, a)])
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
            assert!(orthonormal(&modes) < 1e-12);
            assert!(pod.spans.iter().all(|span| orthonormal(&span.parameter_modes) < 1e-12));
            let [shape, translation] = errors_at_ends(&states, &snapshots, &pod);
            // The tolerance is a mean over the instants, of which these are two.
            assert!(
                shape < 4.0 * tolerance && translation < 2.0 * tolerance,
                "{tolerance} {shape:e} {translation:e}"
            );
            assert!(pod.space_error <= tolerance && snapshots.parameter_error(&pod) <= PARAMETER_SHARE * tolerance);
            sizes.push((pod.modes.ncols(), pod.axial_controls.nrows()));
        }
        assert!(sizes[0] < sizes[1] && sizes[1] < sizes[2], "{sizes:?}");
    }

    #[test]
    fn the_end_of_a_motion_needs_fewer_modes_than_its_start() {
        // Two shapes that stay, and sixteen that pass.
        const LONG: usize = 80;
        let times: Vec<f64> = (0..LONG).map(|i| 0.05 * i as f64).collect();
        let share = |n: usize, j: usize| 1.0 + (j as f64 * (0.4 + 0.7 * n as f64)).cos();
        let value = |n: usize, j: usize, t: f64| match n {
            0 | 1 => [
                share(n, j) * (0.2 * t * n as f64).cos(),
                -share(n, j) * 0.2 * n as f64 * (0.2 * t * n as f64).sin(),
            ],
            _ => {
                let (size, rate) = (0.1 * share(n, j) * (-4.0 * t).exp(), (3 * n) as f64);
                [
                    size * (rate * t).cos(),
                    -size * (4.0 * (rate * t).cos() + rate * (rate * t).sin()),
                ]
            }
        };
        let state = |j: usize, which: usize| State {
            translation: times.iter().map(|t| [*t, 1.0][which]).collect(),
            shape: Mat::from_fn(24, LONG, |r, i| {
                (0..18)
                    .map(|n| value(n, j, times[i])[which] * ((1.1 * n as f64 + 0.5) * r as f64).sin())
                    .sum()
            }),
        };
        let states: Vec<[State; 2]> = (0..7).map(|j| [state(j, 0), state(j, 1)]).collect();
        let joined: Vec<[&State; 2]> = states.iter().map(|[u, v]| [u, v]).collect();
        let tolerance = 1e-4;
        let snapshots = Snapshots::new(&joined, &times, 8, Truncation::Tolerance(tolerance)).unwrap();
        let pod = snapshots.reduce(&[0, 1, 2, 3, 4, 5, 6]).unwrap();

        assert_eq!(pod.spans.len(), 4);
        let controls: usize = pod.spans.iter().map(|span| span.slices.len()).sum();
        assert_eq!(controls, pod.axial_controls.nrows());
        let spans = snapshots.spans.iter();
        assert_eq!(spans.clone().map(|span| span.instants.start).min(), Some(0));
        assert_eq!(spans.map(|span| span.instants.end).max(), Some(LONG));
        let [first, .., last] = &pod.spans[..] else {
            unreachable!()
        };
        let rows = |span: &SpanPod| span.slices.iter().map(Mat::nrows).max().unwrap();
        assert!(rows(last) < rows(first), "{} {}", rows(last), rows(first));
        assert!(last.parameter_modes.ncols() < first.parameter_modes.ncols());

        // At its two ends the spline is its first and last control.
        let modes = snapshots.modes_at_nodes(&pod);
        for (span, slice, i) in [(first, 0, 0), (last, last.slices.len() - 1, LONG - 1)] {
            let alpha = product(&span.slices[slice], &span.parameter_modes.transpose().to_owned());
            let found = product(&leading(&modes, alpha.nrows()), &alpha);
            let square: f64 = (0..7)
                .flat_map(|j| (0..24).map(move |r| (j, r)))
                .map(|(j, r)| (found[(r, j)] - states[j][0].shape[(r, i)]).powi(2))
                .sum();
            let error = (square / (8.0 * 7.0)).sqrt();
            assert!(error < 4.0 * tolerance, "{i}: {error:e}");
        }
    }

    #[test]
    fn ranks_are_those_asked_for() {
        let states = states();
        let snapshots = snapshots(&states, Truncation::Ranks(Ranks { space: 4, parameter: 2 }));
        let pod = snapshots.reduce(&[0, 1, 2, 3, 4]).unwrap();
        assert_eq!(pod.spans.len(), 1);
        assert_eq!((pod.modes.ncols(), pod.spans[0].parameter_modes.ncols()), (3, 2));
    }

    #[test]
    fn what_is_left_out_keeps_the_budget() {
        let slice = Mat::from_fn(20, 7, |k, l| 0.6f64.powi(k as i32) * ((3 * k + l) as f64).cos());
        let end = kept_rows(&slice, 1e-6).nrows();
        let square = |rows: Range<usize>| -> f64 {
            rows.flat_map(|k| (0..7).map(move |l| (k, l)))
                .map(|(k, l)| slice[(k, l)].powi(2))
                .sum()
        };
        // A panel less would leave too much out.
        assert!(square(end..20) <= 1e-6 && square(end - LANES..20) > 1e-6);
        assert_eq!(end % LANES, 0);
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
