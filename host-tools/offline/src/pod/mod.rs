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

/// Leading modes of the motion over all time, before the spans of time add their own: the paper's method works in the
/// leading modes at all times.
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
            Truncation::Ranks(_) => fit.one_span(times),
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
pub(super) mod tests;
