//! From reduced clusters to the bytes of a model file.

use capsule_core::interpolate::Coordinates;
use capsule_core::model::wire::{
    self, Blob, Cluster, Contents, Digits, Encoding, Errors, Field, Matrix, Metadata, NodeSet, Parameter, Reference,
    Samples, Span,
};
use capsule_core::model::{Curve, MatrixView, encode};
use capsule_core::{DIAGONAL, MIDPLANE, Parameters};
use capsule_database::{Mesh, Symmetry};
use faer::Mat;
use std::ops::Range;

use crate::pod::{DoublePod, LANES, Snapshots, SpanPod};
use crate::scaling::Scaling;
use crate::settings::Storage;
use crate::{LeftOut, OfflineError, Settings};

/// A reference coordinate closer to a plane than this share of the radius lies on it.
const ON_PLANE: f64 = 1e-9;

/// A matrix as the file holds it.
#[derive(Clone)]
pub(crate) struct Numbers {
    rows: usize,
    columns: usize,
    encoding: Encoding,
    bytes: Vec<u8>,
}

impl Numbers {
    pub(crate) fn new(rows: usize, columns: usize, value: impl Fn(usize, usize) -> f64) -> Self {
        let value = &value;
        let entries = (0..rows).flat_map(|i| (0..columns).map(move |j| value(i, j) as f32));
        Numbers {
            rows,
            columns,
            encoding: Encoding::F32,
            bytes: entries.flat_map(f32::to_le_bytes).collect(),
        }
    }

    /// As [`Numbers::new`], but units of the columns or of the rows and multiples of them if the storage is so: the
    /// first `coarse` columns in two digits, the others in one.
    fn integers(
        storage: Storage,
        encoding: fn(Digits) -> Encoding,
        coarse: usize,
        [rows, columns]: [usize; 2],
        value: impl Fn(usize, usize) -> f64,
    ) -> Self {
        if storage == Storage::Single {
            return Numbers::new(rows, columns, value);
        }
        let encoding = encoding(Digits { coarse: coarse as u16 });
        let of_rows = matches!(encoding, Encoding::RowPanels(_));
        let greatest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |a: f64, x| a.max(x.abs()));
        let units: Vec<f32> = if of_rows {
            let part = |i, columns: Range<usize>| greatest(&mut columns.map(|j| value(i, j)));
            let row = |i| unit(part(i, 0..coarse), true).max(unit(part(i, coarse..columns), false));
            (0..rows).map(row).collect()
        } else {
            let column = |j| greatest(&mut (0..rows).map(|i| value(i, j)));
            (0..columns).map(|j| unit(column(j), j < coarse)).collect()
        };
        let mut bytes: Vec<u8> = units.iter().copied().flat_map(f32::to_le_bytes).collect();
        let digits = |i: usize, j: usize| {
            let unit = units[if of_rows { i } else { j }];
            // A unit is rounded, so a multiple may be one more than the greatest. Of a unit that is 0 every multiple
            // is.
            let most = greatest_multiple(j < coarse);
            let multiple = if unit > 0.0 { value(i, j) / f64::from(unit) } else { 0.0 };
            let integer = multiple.round().clamp(-most, most) as i32;
            let last = integer as i8;
            [((integer - i32::from(last)) / 256) as u8, last as u8]
        };
        let places = columns + coarse;
        bytes.extend(if matches!(encoding, Encoding::Columns(_)) {
            let digit = |place: usize, i| match place.checked_sub(columns) {
                Some(j) => digits(i, j)[0],
                None => digits(i, place)[1],
            };
            panels([places, rows], digit)
        } else {
            let digit = |i, place: usize| match place.checked_sub(2 * coarse) {
                Some(fine) => digits(i, coarse + fine)[1],
                None => digits(i, place / 2)[place % 2],
            };
            panels([rows, places], digit)
        });
        Numbers {
            rows,
            columns,
            encoding,
            bytes,
        }
    }

    /// The numbers times a factor: of integers their units.
    fn times(&self, factor: f64) -> Self {
        let numbers = match self.encoding {
            Encoding::F32 => self.rows * self.columns,
            Encoding::RowPanels(_) => self.rows,
            _ => self.columns,
        };
        let mut bytes = self.bytes.clone();
        for number in bytes.as_chunks_mut::<4>().0.iter_mut().take(numbers) {
            *number = ((f64::from(f32::from_le_bytes(*number)) * factor) as f32).to_le_bytes();
        }
        Numbers { bytes, ..*self }
    }

    pub(crate) fn column(values: &[f64]) -> Self {
        Numbers::new(values.len(), 1, |i, _| values[i])
    }

    /// An entry of numbers that are not integers.
    pub(crate) fn get(&self, row: usize, column: usize) -> f64 {
        MatrixView::new(&self.matrix()).get(row, column).into()
    }

    /// Without the rows at these places.
    fn without(&self, out: &[usize]) -> Self {
        let kept: Vec<usize> = (0..self.rows).filter(|row| !out.contains(row)).collect();
        let bytes = if let Encoding::Columns(Digits { coarse }) = self.encoding {
            let (units, entries) = self.bytes.split_at(4 * self.columns);
            let places = self.columns + usize::from(coarse);
            let digit = |place, i: usize| entries[place_in_panels([place, kept[i]], self.rows)];
            [units.to_vec(), panels([places, kept.len()], digit)].concat()
        } else {
            let width = self.bytes.len() / self.rows.max(1);
            let row = |row: &usize| &self.bytes[row * width..(row + 1) * width];
            kept.iter().flat_map(row).copied().collect()
        };
        Numbers {
            rows: kept.len(),
            bytes,
            ..*self
        }
    }

    fn matrix(&self) -> Matrix<'_> {
        Matrix::new(self.rows as u32, self.columns as u32, self.encoding, &self.bytes)
    }
}

/// Digits as panels hold them, see [`Encoding`]; zeros beyond the rows and columns.
fn panels([rows, columns]: [usize; 2], digit: impl Fn(usize, usize) -> u8) -> Vec<u8> {
    let length = rows.next_multiple_of(LANES) * columns.next_multiple_of(2);
    let mut bytes = vec![0; length];
    for row in 0..rows {
        for column in 0..columns {
            bytes[place_in_panels([row, column], columns)] = digit(row, column);
        }
    }
    bytes
}

/// Where the panels of so many columns hold a digit.
fn place_in_panels([row, column]: [usize; 2], columns: usize) -> usize {
    let block = row / LANES * columns.div_ceil(2) + column / 2;
    let word = block * (LANES / 2) + row % LANES / 2;
    4 * word + 2 * (column % 2) + row % 2
}

/// The unit in which the greatest number is the greatest integer of two digits or of one.
fn unit(greatest: f64, two_digits: bool) -> f32 {
    (greatest / greatest_multiple(two_digits)) as f32
}

/// The greatest integer of two digits or of one.
fn greatest_multiple(two_digits: bool) -> f64 {
    let digit = f64::from(i8::MAX);
    if two_digits { 256.0 * digit + digit } else { digit }
}

/// The mesh as the file holds it.
#[derive(Clone)]
pub(crate) struct MeshParts {
    nodes: usize,
    element_nodes: usize,
    elements: Vec<u8>,
    reference: Reference,
    sector_reference: Numbers,
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

impl MeshParts {
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
        Ok(MeshParts {
            nodes: mesh.nodes.len(),
            element_nodes,
            elements: indices(mesh.elements.iter().flat_map(|element| &element[..element_nodes])),
            reference,
            sector_reference: Numbers::new(sector.len(), 3, |s, d| mesh.nodes[sector[s] as usize][d]),
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
        MeshParts {
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
pub(crate) struct ErrorParts {
    /// `[N_c, N_e]`
    pub(crate) left_out: Numbers,
    /// `[N_c, 1]`
    pub(crate) deviation: Numbers,
    /// `[N_e, 1]`
    pub(crate) bound_factors: Numbers,
    /// `[N_e, 1]`
    pub(crate) changes: Numbers,
    pub(crate) floor: f64,
}

impl ErrorParts {
    /// Errors that are not known yet.
    pub(crate) fn unknown(samples: usize, times: usize) -> Self {
        ErrorParts {
            left_out: Numbers::new(samples, times, |_, _| 0.0),
            deviation: Numbers::new(samples, 1, |_, _| 1.0),
            bound_factors: Numbers::new(times, 1, |_, _| 1.0),
            changes: Numbers::new(times, 1, |_, _| 0.0),
            floor: 0.0,
        }
    }

    /// The errors of all samples of a cluster, in their order.
    pub(crate) fn new<'a>(errors: impl IntoIterator<Item = &'a LeftOut>, times: usize, floor: f64) -> Self {
        let errors: Vec<&LeftOut> = errors.into_iter().collect();
        ErrorParts {
            left_out: Numbers::new(errors.len(), times, |j, i| errors[j].laboratory[i]),
            deviation: Numbers::new(errors.len(), 1, |j, _| errors[j].deviation.max(1e-12)),
            floor,
            ..ErrorParts::unknown(0, times)
        }
    }

    /// Without the samples at these places.
    fn without(&self, out: &[usize]) -> Self {
        ErrorParts {
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
struct FieldParts {
    modes: Numbers,
    knots: Numbers,
    spans: Vec<SpanParts>,
    axial_controls: Numbers,
    axial_modes: Numbers,
}

#[derive(Clone)]
struct SpanParts {
    parameter_modes: Numbers,
    slices: Vec<u8>,
    core: Numbers,
}

impl SpanParts {
    fn new(snapshots: &Snapshots, pod: &DoublePod, span: &SpanPod, storage: Storage) -> Self {
        let columns = span.parameter_modes.ncols();
        let panels = |slice: &Mat<f64>| slice.nrows().div_ceil(LANES);
        let rows = |slice| (0..LANES * panels(slice)).map(move |k| (slice, k));
        let core: Vec<(&Mat<f64>, usize)> = span.slices.iter().flat_map(rows).collect();
        let entry = |(slice, k): (&Mat<f64>, usize), l: usize| {
            if k < slice.nrows() { slice[(k, l)] } else { 0.0 }
        };
        SpanParts {
            parameter_modes: Numbers::integers(
                storage,
                Encoding::Columns,
                snapshots.coarse_parameter_modes(pod, span),
                [span.parameter_modes.nrows(), columns],
                |j, l| span.parameter_modes[(j, l)],
            ),
            slices: indices(&span.slices.iter().map(|slice| panels(slice) as u32).collect::<Vec<_>>()),
            core: Numbers::integers(
                storage,
                Encoding::RowPanels,
                snapshots.coarse_columns(pod, span),
                [core.len(), columns],
                |i, l| entry(core[i], l),
            ),
        }
    }

    /// Without the samples at these places.
    fn without(&self, out: &[usize]) -> Self {
        SpanParts {
            parameter_modes: self.parameter_modes.without(out),
            ..self.clone()
        }
    }

    /// In another unit of length.
    fn scaled(&self, length: f64) -> Self {
        SpanParts {
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

impl FieldParts {
    fn new(snapshots: &Snapshots, pod: &DoublePod, mesh: &MeshParts, storage: Storage) -> Self {
        let modes = snapshots.modes_at_nodes(pod);
        // Rows of whole panels, one component after the other.
        let stride = mesh.order.len().next_multiple_of(LANES);
        let at_node = |row: usize, k: usize| {
            let s = mesh.order.get(row % stride);
            s.map_or(0.0, |s| modes[(3 * s + row / stride, k)] / mesh.scales[*s])
        };
        let greatest = |k| (0..3 * stride).map(|row| at_node(row, k).abs()).fold(0.0, f64::max);
        let coarse_modes = snapshots.coarse_modes(pod, greatest);
        let dense = |matrix: &Mat<f64>| Numbers::new(matrix.nrows(), matrix.ncols(), |i, j| matrix[(i, j)]);
        FieldParts {
            modes: Numbers::integers(
                storage,
                Encoding::ColumnPanels,
                coarse_modes,
                [3 * stride, modes.ncols()],
                at_node,
            ),
            knots: Numbers::column(snapshots.knots()),
            spans: pod
                .spans
                .iter()
                .map(|span| SpanParts::new(snapshots, pod, span, storage))
                .collect(),
            axial_controls: dense(&pod.axial_controls),
            axial_modes: dense(&pod.axial_modes),
        }
    }

    /// Without the samples at these places.
    fn without(&self, out: &[usize]) -> Self {
        FieldParts {
            spans: self.spans.iter().map(|span| span.without(out)).collect(),
            axial_modes: self.axial_modes.without(out),
            ..self.clone()
        }
    }

    /// In the units of the data.
    fn scaled(&self, scaling: &Scaling) -> Self {
        FieldParts {
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
            spans: self.spans.iter().map(SpanParts::wire).collect(),
            axial_controls: self.axial_controls.matrix(),
            axial_modes: self.axial_modes.matrix(),
        }
    }

    /// Bytes of its arrays.
    fn length(&self) -> usize {
        let arrays = [&self.modes, &self.knots, &self.axial_controls, &self.axial_modes];
        let spans = self.spans.iter().map(SpanParts::length);
        spans.chain(arrays.map(|array| array.bytes.len())).sum()
    }
}

/// One cluster as the file holds it.
#[derive(Clone)]
pub(crate) struct ClusterParts {
    range: [f64; 2],
    samples: Numbers,
    field: FieldParts,
    /// Of the direct method and of the paper's.
    pub(crate) errors: [ErrorParts; 2],
    /// Errors between the instants, `[N_c, N_t - 1]`, or none.
    pub(crate) interval_errors: Numbers,
    /// The 95 % bound as a multiple of them, `[N_t - 1, 1]`, or none.
    pub(crate) interval_bound_factors: Numbers,
}

impl ClusterParts {
    /// The cluster of the samples at `parameters`, from their double POD; errors unknown.
    pub(crate) fn new(
        range: [f64; 2],
        parameters: &[&[f64]],
        snapshots: &Snapshots,
        pod: &DoublePod,
        mesh: &MeshParts,
        error_times: usize,
        storage: Storage,
    ) -> Self {
        let unknown = || ErrorParts::unknown(parameters.len(), error_times);
        ClusterParts {
            range,
            samples: Numbers::new(
                parameters.len(),
                parameters.first().map_or(0, |row| row.len()),
                |j, d| parameters[j][d],
            ),
            field: FieldParts::new(snapshots, pod, mesh, storage),
            errors: [unknown(), unknown()],
            interval_errors: Numbers::new(0, 0, |_, _| 0.0),
            interval_bound_factors: Numbers::new(0, 0, |_, _| 0.0),
        }
    }

    /// Without the samples at these places: the modes and coefficients stay.
    pub(crate) fn without(&self, out: &[usize]) -> Self {
        ClusterParts {
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
        ClusterParts {
            field: self.field.scaled(scaling),
            ..self.clone()
        }
    }

    /// The samples' places in the coordinates.
    pub(crate) fn places(&self, coordinates: &Coordinates<'_>) -> Numbers {
        let matrix = self.samples.matrix();
        let samples = MatrixView::new(&matrix);
        let place = |j: usize| {
            let parameters: Vec<f64> = (0..samples.columns()).map(|d| samples.get(j, d).into()).collect();
            let parameters = Parameters::new(&parameters);
            parameters.map_or([0.0; wire::MAX_PARAMETERS], |parameters| {
                coordinates.transform(&parameters)
            })
        };
        let places: Vec<_> = (0..samples.rows()).map(place).collect();
        Numbers::new(samples.rows(), samples.columns(), |j, d| places[j][d])
    }

    fn wire<'a>(&'a self, places: &'a Numbers) -> Cluster<'a> {
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
    mesh: &MeshParts,
    clusters: &[&ClusterParts],
    scaling: &Scaling,
) -> Result<Vec<u8>, OfflineError> {
    // The creation time is not a setting of the mathematics, and has its own place.
    let text = serde_json::to_string(&Settings {
        created_unix_s: 0,
        ..given.clone()
    })
    .unwrap_or_default();
    let [times, error_times] = [&domain.times, &domain.error_times].map(|t| Numbers::column(t).times(scaling.time));
    let limit = Numbers::new(domain.steady_limit.len(), 2, |i, d| domain.steady_limit[i][d]);
    let border = Numbers::new(domain.border.len(), 2, |i, d| domain.border[i][d]);
    let effect = Numbers::new(domain.bending_effect.len(), 3, |i, d| domain.bending_effect[i][d]);
    let parameters = domain.names.iter().zip(&scaling.parameters);
    let parameters = parameters.map(|(name, parameter)| Parameter {
        name,
        min: parameter.range[0],
        max: parameter.range[1],
        origin: parameter.origin,
        scale: parameter.scale,
    });
    let [limit_matrix, border_matrix] = [&limit, &border].map(Numbers::matrix);
    let mesh = mesh.scaled(scaling);
    let clusters: Vec<ClusterParts> = clusters.iter().map(|cluster| cluster.scaled(scaling)).collect();
    let coordinates = Coordinates {
        scales: settings.kernel.scales,
        limit: (limit.rows > 0).then_some(Curve::new(&limit_matrix)),
        jump_curve: Curve::new(&border_matrix),
    };
    let places: Vec<Numbers> = clusters.iter().map(|cluster| cluster.places(&coordinates)).collect();
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
