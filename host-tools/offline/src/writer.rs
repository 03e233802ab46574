//! From reduced clusters to the bytes of a model file.

use capsule_core::interpolate::Coordinates;
use capsule_core::model::panels::{LANES, Layout};
use capsule_core::model::wire::{
    self, Blob, Cluster, Contents, Encoding, Errors, Field, Matrix, Metadata, NodeSet, Parameter, Reference, Samples,
    Span, Widths,
};
use capsule_core::model::{Curve, MatrixView, encode};
use capsule_core::{DIAGONAL, MIDPLANE, Parameters};
use capsule_database::{Mesh, Symmetry};
use faer::Mat;
use std::ops::Range;

use crate::pod::{DoublePod, Snapshots, SpanPod};
use crate::scaling::Scaling;
use crate::settings::Storage;
use crate::{LeftOut, OfflineError, Settings};

/// A reference coordinate closer to a plane than this share of the radius lies on it.
const ON_PLANE: f64 = 1e-9;

/// A matrix as the file holds it.
#[derive(Clone)]
pub(crate) struct StoredMatrix {
    rows: usize,
    columns: usize,
    encoding: Encoding,
    bytes: Vec<u8>,
}

impl StoredMatrix {
    pub(crate) fn new(rows: usize, columns: usize, value: impl Fn(usize, usize) -> f64) -> Self {
        let value = &value;
        let entries = (0..rows).flat_map(|i| (0..columns).map(move |j| value(i, j) as f32));
        StoredMatrix {
            rows,
            columns,
            encoding: Encoding::F32,
            bytes: entries.flat_map(f32::to_le_bytes).collect(),
        }
    }

    /// As [`StoredMatrix::new`], but quantised if the storage is so: integer multiples of the scales of the columns or
    /// rows, in two bytes in the first `wide_columns` columns, in one byte in the others.
    fn quantized(
        storage: Storage,
        encoding: fn(Widths) -> Encoding,
        wide_columns: usize,
        [rows, columns]: [usize; 2],
        value: impl Fn(usize, usize) -> f64,
    ) -> Self {
        let encoding = encoding(Widths {
            wide_columns: wide_columns as u16,
        });
        let layout = Layout::new(encoding, [rows, columns]);
        let Some(layout) = layout.filter(|_| storage != Storage::Single) else {
            return StoredMatrix::new(rows, columns, value);
        };
        let of_rows = matches!(encoding, Encoding::RowPanels(_));
        let greatest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |a: f64, x| a.max(x.abs()));
        let scales: Vec<f32> = if of_rows {
            let part = |i, columns: Range<usize>| greatest(&mut columns.map(|j| value(i, j)));
            let row = |i| scale(part(i, 0..wide_columns), true).max(scale(part(i, wide_columns..columns), false));
            (0..rows).map(row).collect()
        } else {
            let column = |j| greatest(&mut (0..rows).map(|i| value(i, j)));
            (0..columns).map(|j| scale(column(j), j < wide_columns)).collect()
        };
        let integer = |i: usize, j: usize| {
            let scale = f64::from(scales[if of_rows { i } else { j }]);
            let multiple = if scale > 0.0 { value(i, j) / scale } else { 0.0 };
            // A scale is rounded to single precision, so a multiple may exceed the greatest by one.
            let greatest = greatest_multiple(j < wide_columns);
            multiple.round().clamp(-greatest, greatest) as i32
        };
        let mut bytes = vec![0; layout.byte_len()];
        layout.pack(&scales, integer, &mut bytes);
        StoredMatrix {
            rows,
            columns,
            encoding,
            bytes,
        }
    }

    /// The matrix times a factor: of a quantised one the scales.
    fn times(&self, factor: f64) -> Self {
        let numbers = self.layout().map_or(self.rows * self.columns, |layout| layout.scales());
        let mut bytes = self.bytes.clone();
        for number in bytes.as_chunks_mut::<4>().0.iter_mut().take(numbers) {
            *number = ((f64::from(f32::from_le_bytes(*number)) * factor) as f32).to_le_bytes();
        }
        StoredMatrix { bytes, ..*self }
    }

    fn layout(&self) -> Option<Layout> {
        Layout::new(self.encoding, [self.rows, self.columns])
    }

    pub(crate) fn column(values: &[f64]) -> Self {
        StoredMatrix::new(values.len(), 1, |i, _| values[i])
    }

    /// An entry of numbers that are not integers.
    pub(crate) fn get(&self, row: usize, column: usize) -> f64 {
        MatrixView::new(&self.matrix()).get(row, column).into()
    }

    /// Without the rows at these places. The scales are those of columns, so they stay.
    fn without(&self, out: &[usize]) -> Self {
        let kept: Vec<usize> = (0..self.rows).filter(|row| !out.contains(row)).collect();
        let bytes = if let (Some(layout), Some(left)) =
            (self.layout(), Layout::new(self.encoding, [kept.len(), self.columns]))
        {
            let scales = self.bytes.as_chunks().0.iter().take(layout.scales());
            let scales: Vec<f32> = scales.map(|bytes| f32::from_le_bytes(*bytes)).collect();
            let integer = |i: usize, j| layout.unpack(&self.bytes, kept[i], j).unwrap_or(0);
            let mut bytes = vec![0; left.byte_len()];
            left.pack(&scales, integer, &mut bytes);
            bytes
        } else {
            let width = self.bytes.len() / self.rows.max(1);
            let row = |row: &usize| &self.bytes[row * width..(row + 1) * width];
            kept.iter().flat_map(row).copied().collect()
        };
        StoredMatrix {
            rows: kept.len(),
            bytes,
            ..*self
        }
    }

    fn matrix(&self) -> Matrix<'_> {
        Matrix::new(self.rows as u32, self.columns as u32, self.encoding, &self.bytes)
    }
}

/// The scale with which the greatest number becomes the greatest integer of two bytes or of one.
fn scale(greatest: f64, wide: bool) -> f32 {
    (greatest / greatest_multiple(wide)) as f32
}

/// The greatest integer of two bytes or of one.
fn greatest_multiple(wide: bool) -> f64 {
    let byte = f64::from(i8::MAX);
    if wide { 256.0 * byte + byte } else { byte }
}

/// The mesh as the file holds it.
#[derive(Clone)]
pub(crate) struct OwnedMesh {
    nodes: usize,
    element_nodes: usize,
    elements: Vec<u8>,
    reference: Reference,
    sector_reference: StoredMatrix,
    operations: Vec<u8>,
    images: Vec<u8>,
    origins: Vec<u8>,
    outlines: Vec<(&'static str, Vec<u8>)>,
    scales: Vec<f64>,
    /// The sector's nodes in the order of the file, by their places in the symmetry's.
    order: Vec<usize>,
}

fn indices<'a>(values: impl IntoIterator<Item = &'a u32>) -> Vec<u8> {
    // The number of nodes has been checked, so none is cut.
    values.into_iter().flat_map(|v| (*v as u16).to_le_bytes()).collect()
}

impl OwnedMesh {
    /// # Errors
    /// [`OfflineError::TooManyNodes`]; [`OfflineError::NoOutline`] for a sphere, while another shape may be without
    /// outlines.
    pub(crate) fn new(mesh: &Mesh, symmetry: &Symmetry, reference: Reference) -> Result<Self, OfflineError> {
        // 65535 says that there is none.
        let limit = usize::from(u16::MAX);
        let nodes = symmetry.order() * symmetry.sector.len();
        if nodes > limit {
            return Err(OfflineError::TooManyNodes { nodes, limit });
        }
        let outlines = match reference {
            Reference::Sphere => outlines(&mesh.nodes, 1.0)?,
            // Nodes stay in the planes of the outlines by symmetry alone.
            Reference::Shape { radius, .. } if symmetry.order() == 8 => {
                outlines(&mesh.nodes, radius).unwrap_or_default()
            }
            Reference::Shape { .. } => Vec::new(),
        };
        let order = order(symmetry, outlines.iter().flat_map(|(_, nodes)| nodes));
        let mut place = vec![0; order.len()];
        order.iter().enumerate().for_each(|(new, old)| place[*old] = new);
        let origins = origins(symmetry, &place);
        let mut images = vec![u16::MAX.into(); symmetry.order() * order.len()];
        (0..)
            .zip(&origins)
            .for_each(|(node, place)| images[*place as usize] = node);
        let sector: Vec<u32> = order.iter().map(|s| symmetry.sector[*s]).collect();
        let orbits = symmetry.orbit_sizes();
        let flat = mesh.elements.iter().all(Mesh::is_flat);
        let element_nodes = if flat { 3 } else { 6 };
        Ok(OwnedMesh {
            nodes: mesh.nodes.len(),
            element_nodes,
            elements: indices(mesh.elements.iter().flat_map(|element| &element[..element_nodes])),
            reference,
            sector_reference: StoredMatrix::new(sector.len(), 3, |s, d| mesh.nodes[sector[s] as usize][d]),
            operations: symmetry.operations.clone(),
            images: indices(&images),
            origins: indices(&origins),
            outlines: outlines
                .into_iter()
                .map(|(name, nodes)| (name, indices(&nodes)))
                .collect(),
            scales: orbits.iter().map(|w| f64::from(*w).sqrt()).collect(),
            order,
        })
    }

    /// The square root of the orbit's size of each sector node.
    pub(crate) fn scales(&self) -> &[f64] {
        &self.scales
    }

    /// In the units of the data.
    fn scaled(&self, scaling: &Scaling) -> Self {
        OwnedMesh {
            sector_reference: self.sector_reference.times(scaling.length),
            reference: match self.reference {
                Reference::Sphere => Reference::Sphere,
                Reference::Shape {
                    radius,
                    origin,
                    volumes,
                } => Reference::Shape {
                    radius: scaling.length * radius,
                    origin: scaling.origin + scaling.length * origin,
                    volumes,
                },
            },
            ..self.clone()
        }
    }

    fn wire(&self) -> wire::Mesh<'_> {
        wire::Mesh {
            nodes: self.nodes as u32,
            element_nodes: self.element_nodes as u8,
            elements: Blob::new(&self.elements),
            reference: self.reference,
            sector_reference: self.sector_reference.matrix(),
            operations: Blob::new(&self.operations),
            images: Blob::new(&self.images),
            origins: Blob::new(&self.origins),
            node_sets: self
                .outlines
                .iter()
                .map(|(name, nodes)| NodeSet {
                    name,
                    nodes: Blob::new(nodes),
                })
                .collect(),
        }
    }
}

/// The place of each node in the table of images, a row for each operation and a column for each of the sector's nodes:
/// these at the places given.
fn origins(symmetry: &Symmetry, places: &[usize]) -> Vec<u32> {
    let mut rows = [0; 8];
    for (row, operation) in symmetry.operations.iter().enumerate() {
        rows[usize::from(*operation)] = row;
    }
    let images = symmetry.representative.iter().zip(&symmetry.operation);
    let place = |(s, operation): (&u32, &u8)| rows[usize::from(*operation)] * places.len() + places[*s as usize];
    images.map(|image| place(image) as u32).collect()
}

/// The sector's nodes, by their places in the symmetry's order: first those of the outlines, as these run, so that they
/// share panels and no others are computed with them.
fn order<'a>(symmetry: &Symmetry, outlines: impl Iterator<Item = &'a u32>) -> Vec<usize> {
    let of_outlines = outlines.map(|node| symmetry.representative[*node as usize] as usize);
    let mut taken = vec![false; symmetry.sector.len()];
    of_outlines
        .chain(0..symmetry.sector.len())
        .filter(|s| !std::mem::replace(&mut taken[*s], true))
        .collect()
}

/// The two outlines of a shape of a radius.
fn outlines(nodes: &[[f64; 3]], radius: f64) -> Result<Vec<(&'static str, Vec<u32>)>, OfflineError> {
    let on = ON_PLANE * radius;
    let midplane = outline(MIDPLANE, nodes, on, |[_, y, z]| z.abs() < on && y > -on)?;
    let diagonal = outline(DIAGONAL, nodes, on, |[_, y, z]| (y - z).abs() < on && y > -on)?;
    Ok(vec![(MIDPLANE, midplane), (DIAGONAL, diagonal)])
}

/// The nodes of a half plane through the axis, from the front pole to the rear pole: by the angle from the axis, around
/// the origin, which is the centroid.
fn outline(
    name: &'static str,
    nodes: &[[f64; 3]],
    on_axis: f64,
    lies_on: impl Fn([f64; 3]) -> bool,
) -> Result<Vec<u32>, OfflineError> {
    let mut outline: Vec<u32> = (0..nodes.len() as u32)
        .filter(|i| lies_on(nodes[*i as usize]))
        .collect();
    let radial = |i: &u32| nodes[*i as usize][1].hypot(nodes[*i as usize][2]);
    let angle = |i: &u32| radial(i).atan2(nodes[*i as usize][0]);
    outline.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    let pole = |i: Option<&u32>| i.is_some_and(|i| radial(i) < on_axis);
    if outline.len() < 3 || !pole(outline.first()) || !pole(outline.last()) {
        return Err(OfflineError::NoOutline {
            outline: name,
            found: outline.len(),
        });
    }
    Ok(outline)
}

/// Errors of one method at the samples of a cluster.
#[derive(Clone)]
pub(crate) struct OwnedErrors {
    /// `[N_c, N_e]`
    pub(crate) left_out: StoredMatrix,
    /// `[N_c, 1]`
    pub(crate) deviation: StoredMatrix,
    /// `[N_e, 1]`
    pub(crate) bound_factors: StoredMatrix,
    /// `[N_e, 1]`
    pub(crate) changes: StoredMatrix,
    pub(crate) floor: f64,
}

impl OwnedErrors {
    /// Errors that are not known yet.
    pub(crate) fn unknown(samples: usize, times: usize) -> Self {
        OwnedErrors {
            left_out: StoredMatrix::new(samples, times, |_, _| 0.0),
            deviation: StoredMatrix::new(samples, 1, |_, _| 1.0),
            bound_factors: StoredMatrix::new(times, 1, |_, _| 1.0),
            changes: StoredMatrix::new(times, 1, |_, _| 0.0),
            floor: 0.0,
        }
    }

    /// The errors of all samples of a cluster, in their order.
    pub(crate) fn new<'a>(errors: impl IntoIterator<Item = &'a LeftOut>, times: usize, floor: f64) -> Self {
        let errors: Vec<&LeftOut> = errors.into_iter().collect();
        OwnedErrors {
            left_out: StoredMatrix::new(errors.len(), times, |j, i| errors[j].laboratory[i]),
            deviation: StoredMatrix::new(errors.len(), 1, |j, _| errors[j].deviation.max(1e-12)),
            floor,
            ..OwnedErrors::unknown(0, times)
        }
    }

    /// Without the samples at these places.
    fn without(&self, out: &[usize]) -> Self {
        OwnedErrors {
            left_out: self.left_out.without(out),
            deviation: self.deviation.without(out),
            bound_factors: self.bound_factors.clone(),
            changes: self.changes.clone(),
            floor: self.floor,
        }
    }

    fn wire(&self) -> Errors<'_> {
        Errors {
            left_out: self.left_out.matrix(),
            deviation: self.deviation.matrix(),
            bound_factors: self.bound_factors.matrix(),
            changes: self.changes.matrix(),
            floor: self.floor,
        }
    }
}

#[derive(Clone)]
struct OwnedField {
    modes: StoredMatrix,
    knots: StoredMatrix,
    spans: Vec<OwnedSpan>,
    axial_controls: StoredMatrix,
    axial_modes: StoredMatrix,
}

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
    fn length(&self) -> usize {
        self.parameter_modes.bytes.len() + self.slices.len() + self.core.bytes.len()
    }
}

impl OwnedField {
    fn new(snapshots: &Snapshots, pod: &DoublePod, mesh: &OwnedMesh, storage: Storage) -> Self {
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
    fn without(&self, out: &[usize]) -> Self {
        OwnedField {
            spans: self.spans.iter().map(|span| span.without(out)).collect(),
            axial_modes: self.axial_modes.without(out),
            ..self.clone()
        }
    }

    /// In the units of the data.
    fn scaled(&self, scaling: &Scaling) -> Self {
        OwnedField {
            knots: self.knots.times(scaling.time),
            spans: self.spans.iter().map(|span| span.scaled(scaling.length)).collect(),
            axial_controls: self.axial_controls.times(scaling.length),
            ..self.clone()
        }
    }

    fn wire(&self) -> Field<'_> {
        Field {
            modes: self.modes.matrix(),
            knots: self.knots.matrix(),
            spans: self.spans.iter().map(OwnedSpan::wire).collect(),
            axial_controls: self.axial_controls.matrix(),
            axial_modes: self.axial_modes.matrix(),
        }
    }

    /// Bytes of its arrays.
    fn length(&self) -> usize {
        let arrays = [&self.modes, &self.knots, &self.axial_controls, &self.axial_modes];
        let spans = self.spans.iter().map(OwnedSpan::length);
        spans.chain(arrays.map(|array| array.bytes.len())).sum()
    }
}

/// One cluster as the file holds it.
#[derive(Clone)]
pub(crate) struct OwnedCluster {
    range: [f64; 2],
    samples: StoredMatrix,
    field: OwnedField,
    /// Of the direct method and of the paper's.
    pub(crate) errors: [OwnedErrors; 2],
    /// Errors between the instants, `[N_c, N_t - 1]`, or none.
    pub(crate) interval_errors: StoredMatrix,
    /// The 95 % bound as a multiple of them, `[N_t - 1, 1]`, or none.
    pub(crate) interval_bound_factors: StoredMatrix,
}

impl OwnedCluster {
    /// The cluster of the samples at `parameters`, from their double POD; errors unknown.
    pub(crate) fn new(
        range: [f64; 2],
        parameters: &[&[f64]],
        snapshots: &Snapshots,
        pod: &DoublePod,
        mesh: &OwnedMesh,
        error_times: usize,
        storage: Storage,
    ) -> Self {
        let unknown = || OwnedErrors::unknown(parameters.len(), error_times);
        OwnedCluster {
            range,
            samples: StoredMatrix::new(
                parameters.len(),
                parameters.first().map_or(0, |row| row.len()),
                |j, d| parameters[j][d],
            ),
            field: OwnedField::new(snapshots, pod, mesh, storage),
            errors: [unknown(), unknown()],
            interval_errors: StoredMatrix::new(0, 0, |_, _| 0.0),
            interval_bound_factors: StoredMatrix::new(0, 0, |_, _| 0.0),
        }
    }

    /// Without the samples at these places: the modes and coefficients stay.
    pub(crate) fn without(&self, out: &[usize]) -> Self {
        OwnedCluster {
            samples: self.samples.without(out),
            field: self.field.without(out),
            errors: self.errors.each_ref().map(|errors| errors.without(out)),
            interval_errors: self.interval_errors.without(out),
            interval_bound_factors: self.interval_bound_factors.clone(),
            range: self.range,
        }
    }

    /// In the units of the data.
    fn scaled(&self, scaling: &Scaling) -> Self {
        OwnedCluster {
            field: self.field.scaled(scaling),
            ..self.clone()
        }
    }

    /// The samples' places in the coordinates.
    pub(crate) fn places(&self, coordinates: &Coordinates<'_>) -> StoredMatrix {
        let matrix = self.samples.matrix();
        let samples = MatrixView::new(&matrix);
        let place = |j: usize| {
            let parameters: Vec<f64> = (0..samples.columns()).map(|d| samples.get(j, d).into()).collect();
            let parameters = Parameters::new(&parameters);
            parameters.map_or([0.0; wire::MAX_PARAMETERS], |parameters| coordinates.place(&parameters))
        };
        let places: Vec<_> = (0..samples.rows()).map(place).collect();
        StoredMatrix::new(samples.rows(), samples.columns(), |j, d| places[j][d])
    }

    fn wire<'a>(&'a self, places: &'a StoredMatrix) -> Cluster<'a> {
        Cluster {
            min: self.range[0],
            max: self.range[1],
            samples: Samples {
                parameters: self.samples.matrix(),
                places: places.matrix(),
            },
            field: self.field.wire(),
            direct_errors: self.errors[0].wire(),
            paper_errors: self.errors[1].wire(),
            interval_errors: self.interval_errors.matrix(),
            interval_bound_factors: self.interval_bound_factors.matrix(),
        }
    }
}

/// Names of the units.
#[derive(Clone)]
pub(crate) struct Units {
    length: String,
    velocity: String,
    time: String,
}

impl Units {
    /// Those of the channel.
    pub(crate) fn channel() -> Self {
        Units {
            length: "l".to_owned(),
            velocity: "V".to_owned(),
            time: "l/V".to_owned(),
        }
    }

    /// Those of other people's data, as far as they are known.
    pub(crate) fn new(length: Option<&str>, time: Option<&str>) -> Self {
        let (length, time) = (length.unwrap_or("length unit"), time.unwrap_or("time unit"));
        Units {
            length: length.to_owned(),
            velocity: format!("{length}/{time}"),
            time: time.to_owned(),
        }
    }
}

/// What a file says about the domain.
pub(crate) struct Domain {
    /// The parameters' names.
    pub(crate) names: Vec<String>,
    pub(crate) units: Units,
    /// Least and greatest value of each parameter, in the working units.
    pub(crate) ranges: Vec<[f64; 2]>,
    /// (a/l, Ca)
    pub(crate) steady_limit: Vec<[f64; 2]>,
    /// In G_s a^2, if it is known.
    pub(crate) bending_stiffness: Option<f64>,
    /// (Ca, a/l, effect of the bending stiffness as a fraction of a)
    pub(crate) bending_effect: Vec<[f64; 3]>,
    /// (a/l, Ca)
    pub(crate) border: Vec<[f64; 2]>,
    pub(crate) times: Vec<f64>,
    /// The instants of the leave-one-out errors.
    pub(crate) error_times: Vec<f64>,
    pub(crate) database_digest: String,
}

/// Writes a model file in the units that `scaling` leads to. The settings are told as they were given, and used in the
/// working units.
///
/// # Errors
/// [`OfflineError::Encode`].
pub(crate) fn write(
    [given, settings]: [&Settings; 2],
    domain: &Domain,
    mesh: &OwnedMesh,
    clusters: &[&OwnedCluster],
    scaling: &Scaling,
) -> Result<Vec<u8>, OfflineError> {
    // The creation time is not a setting of the mathematics, and has its own place.
    let text = serde_json::to_string(&Settings {
        created_unix_s: 0,
        ..given.clone()
    })
    .unwrap_or_default();
    let [times, error_times] =
        [&domain.times, &domain.error_times].map(|t| StoredMatrix::column(t).times(scaling.time));
    let limit = StoredMatrix::new(domain.steady_limit.len(), 2, |i, d| domain.steady_limit[i][d]);
    let border = StoredMatrix::new(domain.border.len(), 2, |i, d| domain.border[i][d]);
    let effect = StoredMatrix::new(domain.bending_effect.len(), 3, |i, d| domain.bending_effect[i][d]);
    let parameters = domain.names.iter().zip(&scaling.parameters);
    let parameters = parameters.map(|(name, parameter)| Parameter {
        name,
        min: parameter.range[0],
        max: parameter.range[1],
        origin: parameter.origin,
        scale: parameter.scale,
    });
    let [limit_matrix, border_matrix] = [&limit, &border].map(StoredMatrix::matrix);
    let mesh = mesh.scaled(scaling);
    let clusters: Vec<OwnedCluster> = clusters.iter().map(|cluster| cluster.scaled(scaling)).collect();
    let coordinates = Coordinates {
        scales: settings.kernel.scales,
        limit: (limit.rows > 0).then_some(Curve::new(&limit_matrix)),
        border: Curve::new(&border_matrix),
    };
    let places: Vec<StoredMatrix> = clusters.iter().map(|cluster| cluster.places(&coordinates)).collect();
    let contents = Contents {
        metadata: Metadata {
            title: &settings.title,
            units: wire::Units {
                length: &domain.units.length,
                velocity: &domain.units.velocity,
                time: &domain.units.time,
            },
            membrane_law: &settings.membrane_law,
            bending_stiffness: domain.bending_stiffness,
            parameters: parameters.collect(),
            database_digest: &domain.database_digest,
            offline_settings: &text,
            created_unix_s: settings.created_unix_s,
        },
        mesh: mesh.wire(),
        times: times.matrix(),
        error_times: error_times.matrix(),
        steady_limit: limit_matrix,
        bending_effect: effect.matrix(),
        border: border_matrix,
        default_method: settings.default_method,
        kernel: settings.kernel,
        paper: settings.paper,
        split: settings.split.map_or(0, |split| split.parameter) as u8,
        clusters: clusters.iter().zip(&places).map(|(c, places)| c.wire(places)).collect(),
    };
    let mut room = 8192 + text.len() + settings.title.len() + settings.membrane_law.len();
    room += domain.names.iter().map(String::len).sum::<usize>();
    room += mesh.elements.len()
        + 12 * mesh.scales.len()
        + mesh.images.len()
        + mesh.origins.len()
        + times.bytes.len()
        + limit.bytes.len()
        + effect.bytes.len()
        + border.bytes.len();
    for cluster in &clusters {
        room += cluster.field.length() + 2 * cluster.samples.bytes.len() + cluster.interval_errors.bytes.len();
        room += cluster.interval_bound_factors.bytes.len();
        room += cluster
            .errors
            .iter()
            .map(|e| e.left_out.bytes.len() + e.deviation.bytes.len() + 2 * e.bound_factors.bytes.len())
            .sum::<usize>();
    }
    let mut buffer = vec![0; room];
    let length = encode(&contents, &mut buffer).map_err(OfflineError::Encode)?;
    buffer.truncate(length);
    Ok(buffer)
}
