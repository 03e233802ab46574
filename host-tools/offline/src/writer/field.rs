//! The motion of a cluster: modes, splines in time, core, translation.

use capsule_core::model::panels::LANES;
use capsule_core::model::wire::{Blob, Encoding, Field, Span};
use faer::Mat;

use super::indices;
use super::matrix::StoredMatrix;
use super::mesh::OwnedMesh;
use crate::pod::{DoublePod, Snapshots, SpanPod};
use crate::scaling::Scaling;
use crate::settings::Storage;

/// The motion of a cluster, with its bytes.
#[derive(Clone)]
pub(super) struct OwnedField {
    modes: StoredMatrix,
    knots: StoredMatrix,
    spans: Vec<OwnedSpan>,
    axial_controls: StoredMatrix,
    axial_modes: StoredMatrix,
}

/// A span of time of a motion, with its bytes.
#[derive(Clone)]
struct OwnedSpan {
    parameter_modes: StoredMatrix,
    slices: Vec<u8>,
    core: StoredMatrix,
}

impl OwnedSpan {
    fn new(snapshots: &Snapshots, pod: &DoublePod, span: &SpanPod, storage: Storage) -> Self {
        let columns = span.parameter_modes.ncols();
        let panels = |slice: &Mat<f64>| slice.nrows().div_ceil(LANES);
        let rows = |slice| (0..LANES * panels(slice)).map(move |k| (slice, k));
        let core: Vec<(&Mat<f64>, usize)> = span.slices.iter().flat_map(rows).collect();
        let entry = |(slice, k): (&Mat<f64>, usize), l: usize| {
            if k < slice.nrows() { slice[(k, l)] } else { 0.0 }
        };
        OwnedSpan {
            parameter_modes: StoredMatrix::quantized(
                storage,
                Encoding::Columns,
                snapshots.wide_parameter_modes(pod, span),
                [span.parameter_modes.nrows(), columns],
                |j, l| span.parameter_modes[(j, l)],
            ),
            slices: indices(&span.slices.iter().map(|slice| panels(slice) as u32).collect::<Vec<_>>()),
            core: StoredMatrix::quantized(
                storage,
                Encoding::RowPanels,
                snapshots.wide_core_columns(pod, span),
                [core.len(), columns],
                |i, l| entry(core[i], l),
            ),
        }
    }

    /// Without the samples at these places.
    fn without(&self, out: &[usize]) -> Self {
        OwnedSpan {
            parameter_modes: self.parameter_modes.without(out),
            ..self.clone()
        }
    }

    /// In another unit of length.
    fn scaled(&self, length: f64) -> Self {
        OwnedSpan {
            core: self.core.times(length),
            ..self.clone()
        }
    }

    fn wire(&self) -> Span<'_> {
        Span {
            parameter_modes: self.parameter_modes.matrix(),
            slices: Blob::new(&self.slices),
            core: self.core.matrix(),
        }
    }

    /// Bytes of its arrays.
    fn byte_len(&self) -> usize {
        self.parameter_modes.byte_len() + self.slices.len() + self.core.byte_len()
    }
}

impl OwnedField {
    pub(super) fn new(snapshots: &Snapshots, pod: &DoublePod, mesh: &OwnedMesh, storage: Storage) -> Self {
        let modes = snapshots.modes_at_nodes(pod);
        // Rows of whole panels, one component after the other.
        let stride = mesh.order.len().next_multiple_of(LANES);
        let at_node = |row: usize, k: usize| {
            let s = mesh.order.get(row % stride);
            s.map_or(0.0, |s| modes[(3 * s + row / stride, k)] / mesh.scales[*s])
        };
        let greatest = |k| (0..3 * stride).map(|row| at_node(row, k).abs()).fold(0.0, f64::max);
        let wide_modes = snapshots.wide_modes(pod, greatest);
        let dense = |matrix: &Mat<f64>| StoredMatrix::new(matrix.nrows(), matrix.ncols(), |i, j| matrix[(i, j)]);
        OwnedField {
            modes: StoredMatrix::quantized(
                storage,
                Encoding::ColumnPanels,
                wide_modes,
                [3 * stride, modes.ncols()],
                at_node,
            ),
            knots: StoredMatrix::column(snapshots.knots()),
            spans: pod
                .spans
                .iter()
                .map(|span| OwnedSpan::new(snapshots, pod, span, storage))
                .collect(),
            axial_controls: dense(&pod.axial_controls),
            axial_modes: dense(&pod.axial_modes),
        }
    }

    /// Without the samples at these places.
    pub(super) fn without(&self, out: &[usize]) -> Self {
        OwnedField {
            spans: self.spans.iter().map(|span| span.without(out)).collect(),
            axial_modes: self.axial_modes.without(out),
            ..self.clone()
        }
    }

    /// In the units of the data.
    pub(super) fn scaled(&self, scaling: &Scaling) -> Self {
        OwnedField {
            knots: self.knots.times(scaling.time),
            spans: self.spans.iter().map(|span| span.scaled(scaling.length)).collect(),
            axial_controls: self.axial_controls.times(scaling.length),
            ..self.clone()
        }
    }

    pub(super) fn wire(&self) -> Field<'_> {
        Field {
            modes: self.modes.matrix(),
            knots: self.knots.matrix(),
            spans: self.spans.iter().map(OwnedSpan::wire).collect(),
            axial_controls: self.axial_controls.matrix(),
            axial_modes: self.axial_modes.matrix(),
        }
    }

    /// Bytes of its arrays.
    pub(super) fn byte_len(&self) -> usize {
        let arrays = [&self.modes, &self.knots, &self.axial_controls, &self.axial_modes];
        let spans = self.spans.iter().map(OwnedSpan::byte_len);
        spans.chain(arrays.map(|array| array.byte_len())).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::writer::tests::{Fixture, TOLERANCE};
    use capsule_core::Model;
    use capsule_core::model::{Indices, MatrixView};

    /// At its two ends a spline is its first and its last control.
    #[test]
    fn the_motion_is_read_within_the_tolerance() {
        let fixture = Fixture::new();
        let file = fixture.file(&[&fixture.cluster]);
        let model = Model::open(&file).unwrap();
        let field = &model.contents().clusters[0].field;
        let modes = MatrixView::new(&field.modes);
        let [axial_controls, axial_modes] = [&field.axial_controls, &field.axial_modes].map(MatrixView::new);
        let stride = fixture.owned.order.len().next_multiple_of(LANES);
        let mut square = 0.0;
        let instants = fixture.states[0][0].shape.ncols();
        for at_end in [false, true] {
            let span = &field.spans[if at_end { field.spans.len() - 1 } else { 0 }];
            let (core, psi) = (MatrixView::new(&span.core), MatrixView::new(&span.parameter_modes));
            let slices: Vec<usize> = Indices::new(&span.slices).iter().collect();
            let slice = if at_end { slices.len() - 1 } else { 0 };
            let first = LANES * slices[..slice].iter().sum::<usize>();
            let rows = (LANES * slices[slice]).min(modes.columns());
            let instant = if at_end { instants - 1 } else { 0 };
            for (j, [state, _]) in fixture.states.iter().enumerate() {
                let dot = |row: usize| -> f64 {
                    (0..psi.columns())
                        .map(|l| f64::from(core.get(row, l)) * f64::from(psi.get(j, l)))
                        .sum()
                };
                let alpha: Vec<f64> = (0..rows).map(|k| dot(first + k)).collect();
                for (place, s) in fixture.owned.order.iter().enumerate() {
                    for d in 0..3 {
                        let mode = |k: usize| f64::from(modes.get(d * stride + place, k));
                        let found: f64 = alpha.iter().enumerate().map(|(k, a)| a * mode(k)).sum();
                        let exact = state.shape[(3 * s + d, instant)] / fixture.owned.scales[*s];
                        square += fixture.owned.scales[*s].powi(2) * (found - exact).powi(2);
                    }
                }
                let control = if at_end { axial_controls.rows() - 1 } else { 0 };
                let axial = (0..axial_modes.columns())
                    .map(|a| f64::from(axial_controls.get(control, a)) * f64::from(axial_modes.get(j, a)));
                assert!((axial.sum::<f64>() - state.translation[instant]).abs() < 2.0 * TOLERANCE);
            }
        }
        let error = (square / (2 * fixture.mesh.nodes.len() * fixture.states.len()) as f64).sqrt();
        // The tolerance is a mean over the instants, of which these are two.
        assert!(error < 4.0 * TOLERANCE, "{error:e}");
    }
}
