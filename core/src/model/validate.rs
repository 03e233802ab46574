//! The checks of [`Model::open`](super::Model::open): dimensions, indices, ranges, finiteness.

use super::matrix::{Indices, MatrixView};
use super::wire::{Blob, Cluster, Contents, Digits, Encoding, Errors, Matrix, Mesh, NodeSet, Reference, Samples, Span};
use super::{DIAGONAL, MAX_SAMPLES, MIDPLANE};
use crate::error::OpenError;
use crate::linalg::LANES;

/// Larger numbers have no meaning in any array of a model of a capsule in the channel, and could overflow what is
/// computed from them.
const MAX: f32 = 1e6;
/// The same for lengths of a model in its own units, in its radius.
const MAX_IN_RADII: f32 = 1e9;
/// The radius of such a model: its cube is a single-precision number.
const RADIUS: [f64; 2] = [1e-12, 1e12];
/// Times in units of any kind.
const TIME: [f32; 2] = [0.0, 1e18];
/// The largest value of a parameter in its own units.
const MAX_PARAMETER: f64 = 1e36;
/// The range of numbers that may have either sign.
const ANY: [f32; 2] = [-MAX, MAX];
/// The range of numbers that may not be negative.
const POSITIVE: [f32; 2] = [0.0, MAX];
/// Order of the cubic splines.
const ORDER: usize = 4;
/// The largest mesh that u16 indices can number, and one is left that says that there is no node.
const MAX_NODES: usize = u16::MAX as usize;

/// Judges the contents of a model.
pub(super) fn contents(contents: &Contents<'_>) -> Result<(), OpenError> {
    let length = match contents.mesh.reference {
        Reference::Sphere => MAX,
        // The radius itself is judged with the mesh.
        Reference::Shape { radius, .. } => MAX_IN_RADII * radius as f32,
    };
    let mut judge = Judge {
        found: Ok(()),
        length: [-length, length],
    };
    judge.contents(contents);
    judge.found
}

/// What a setting must lie within.
struct Range {
    what: &'static str,
    min: f64,
    max: f64,
}

/// Keeps what was found wrong first. After it no array is looked at any more: what is known of one is that it is empty.
struct Judge {
    found: Result<(), OpenError>,
    /// The range of lengths.
    length: [f32; 2],
}

impl Judge {
    fn contents(&mut self, contents: &Contents<'_>) {
        // Ca and a/l of a capsule in the channel are positive.
        let sphere = matches!(contents.mesh.reference, Reference::Sphere);
        let least = if sphere { 1e-6 } else { -1e6 };
        let parameters = contents.metadata.parameters.len();
        self.count("parameters", if sphere { 2 } else { parameters.max(1) }, parameters);
        let greatest = if sphere { 1e6 } else { MAX_PARAMETER };
        for range in &contents.metadata.parameters {
            self.setting(
                "parameter minimum",
                range.min,
                if sphere { least } else { -greatest },
                greatest,
            );
            self.setting("parameter maximum", range.max, range.min, greatest);
            let [origin, scale] = if sphere {
                [[0.0, 0.0], [1.0, 1.0]]
            } else {
                [[-greatest, greatest], [1.0 / greatest, greatest]]
            };
            self.setting("origin of a parameter", range.origin, origin[0], origin[1]);
            self.setting("scale of a parameter", range.scale, scale[0], scale[1]);
        }
        if let Some(stiffness) = contents.metadata.bending_stiffness {
            self.setting("bending stiffness", stiffness, 0.0, 1e6);
        }
        self.mesh(&contents.mesh);

        let times = self.rising("times", &contents.times, [1, 2], TIME);
        let (start, end_time) = (times.get(0, 0), times.get(times.rows().saturating_sub(1), 0));
        if start != 0.0 {
            self.number("times", 0, start, "0");
        }
        let error_times = self.rising("error times", &contents.error_times, [1, 1], TIME);
        let limit = self.rising("steady limit", &contents.steady_limit, [2, 0], POSITIVE);
        let effect = &contents.bending_effect;
        self.matrix("effect of bending", effect, [effect.rows as usize, 3], POSITIVE);
        self.singles("effect of bending", effect);
        if !sphere {
            self.count(
                "points of the steady limit and of the effect of bending outside the channel",
                0,
                limit.rows() + effect.rows as usize,
            );
        }
        for row in 0..limit.rows() {
            let value = limit.get(row, 1).into();
            self.fixed(
                value,
                &Range {
                    what: "capillary number of the steady limit",
                    min: 1e-6,
                    max: 1e6,
                },
            );
        }
        self.rising("border", &contents.border, [2, 0], POSITIVE);
        self.singles("steady limit", &contents.steady_limit);
        self.singles("border", &contents.border);

        let kernel = &contents.kernel;
        self.at_least_one("neighbours of the kernel", kernel.neighbours);
        for scale in &kernel.scales {
            self.fixed(
                *scale,
                &Range {
                    what: "scale of the kernel",
                    min: 1e-9,
                    max: 1e9,
                },
            );
        }
        let paper = &contents.paper;
        self.at_least_one("neighbours of the diffuse approximation", paper.neighbours);
        for scale in &paper.scales {
            self.fixed(
                *scale,
                &Range {
                    what: "scale of the diffuse approximation",
                    min: 1e-9,
                    max: 1e9,
                },
            );
        }
        self.fixed(
            paper.radius,
            &Range {
                what: "radius of the diffuse approximation",
                min: 1.0 + 1e-3,
                max: 10.0,
            },
        );
        self.at_least_one("local displacement rank", paper.displacement_rank);
        self.at_least_one("local velocity rank", paper.velocity_rank);
        self.fixed(
            paper.window,
            &Range {
                what: "window of the manifold",
                min: 1.0,
                max: 4.0,
            },
        );

        self.index("parameter of the clusters", 0, contents.split.into(), parameters);
        self.count("clusters", contents.clusters.len().max(1), contents.clusters.len());
        let mut reached = 1e6;
        for cluster in &contents.clusters {
            self.setting("least value of a cluster", cluster.min, least, reached);
            self.setting("greatest value of a cluster", cluster.max, cluster.min, 1e6);
            reached = cluster.max;
            self.samples(&cluster.samples, parameters, least as f32);
            self.field(cluster, contents.mesh.sector_reference.rows as usize, end_time);
            let (samples, instants) = (cluster.samples.parameters.rows as usize, error_times.rows());
            self.errors(&cluster.direct_errors, samples, instants);
            self.errors(&cluster.paper_errors, samples, instants);
            let known = cluster.interval_errors.rows > 0;
            let shape = if known {
                [samples, times.rows().saturating_sub(1)]
            } else {
                [0, 0]
            };
            self.matrix("errors between instants", &cluster.interval_errors, shape, POSITIVE);
            let factors = [shape[1], usize::from(known)];
            self.matrix(
                "bound's factors between instants",
                &cluster.interval_bound_factors,
                factors,
                POSITIVE,
            );
        }
    }

    fn mesh(&mut self, mesh: &Mesh<'_>) {
        let nodes = mesh.nodes as usize;
        self.count("nodes", nodes.clamp(1, MAX_NODES), nodes);
        let sector = mesh.sector_reference.rows as usize;
        let what = "sector's reference nodes";
        let reference = self.matrix(what, &mesh.sector_reference, [sector, 3], self.length);
        self.singles(what, &mesh.sector_reference);
        match mesh.reference {
            Reference::Sphere => self.on_unit_sphere(what, &reference),
            Reference::Shape {
                radius,
                origin,
                volumes: [least, greatest],
            } => {
                self.setting("radius of the reference shape", radius, RADIUS[0], RADIUS[1]);
                let [near, far] = self.length.map(f64::from);
                self.setting("axial origin", origin, near, far);
                self.setting("least volume", least, 1e-6, 1e6);
                self.setting("greatest volume", greatest, least, 1e6);
            }
        }
        self.images(mesh, nodes, sector);
        let element_nodes = usize::from(mesh.element_nodes);
        if element_nodes != 3 {
            self.count("nodes of an element", 6, element_nodes);
        }
        let whole = mesh.elements.data.len() / (2 * element_nodes.max(1)) * element_nodes;
        self.indices("elements", &mesh.elements, whole, nodes);
        for set in &mesh.node_sets {
            self.indices("node sets", &set.nodes, set.nodes.data.len() / 2, nodes);
        }
        for name in [MIDPLANE, DIAGONAL] {
            let short = |set: &NodeSet<'_>| set.name == name && set.nodes.data.len() < 6;
            if mesh.node_sets.iter().any(short) {
                self.refuse(OpenError::ShortOutline { name });
            }
        }
    }

    /// Every node is an image of one sector node, by one operation; a sector node is its own by the identity.
    fn images(&mut self, mesh: &Mesh<'_>, nodes: usize, sector: usize) {
        let operations = mesh.operations.data;
        self.count("operations", operations.len().clamp(1, 8), operations.len());
        for (index, &operation) in operations.iter().enumerate() {
            self.index("operations", index, operation.into(), if index == 0 { 1 } else { 8 });
        }
        self.length("images", &mesh.images, 2 * operations.len() * sector);
        if self.found.is_err() {
            return;
        }
        let images = Indices::new(&mesh.images);
        for (index, node) in images.iter().take(sector).enumerate() {
            self.index("images", index, node, nodes);
        }
        let count = images.iter().filter(|node| *node < nodes).count();
        self.count("images that are nodes", nodes, count);
        let origins = self.indices("origins", &mesh.origins, nodes, images.len());
        for (node, place) in origins.iter().enumerate() {
            if images.get(place) != Some(node) {
                self.refuse(OpenError::NoImage { node });
            }
        }
    }

    fn on_unit_sphere(&mut self, what: &'static str, reference: &MatrixView<'_>) {
        for node in 0..reference.rows() {
            let [x, y, z] = [reference.get(node, 0), reference.get(node, 1), reference.get(node, 2)];
            let square = x * x + y * y + z * z;
            if (square - 1.0).abs() > 1e-3 {
                let expected = "a node on the unit sphere (this is its squared radius)";
                self.number(what, node, square, expected);
            }
        }
    }

    fn samples(&mut self, samples: &Samples<'_>, parameters: usize, least: f32) {
        let (stored, places) = (&samples.parameters, &samples.places);
        let rows = stored.rows as usize;
        self.count("samples", rows.clamp(1, MAX_SAMPLES), rows);
        let samples = self.matrix("samples", stored, [rows, parameters], [least, MAX]);
        self.singles("samples", stored);
        self.matrix("places of the samples", places, [rows, parameters], ANY);
        self.singles("places of the samples", places);
        for second in 1..samples.rows() {
            let first = second - 1;
            // The last parameter in which they differ.
            let differing = (0..parameters)
                .rev()
                .find(|d| samples.get(first, *d) != samples.get(second, *d));
            let Some(d) = differing else {
                return self.refuse(OpenError::DuplicateSample { first, second });
            };
            let value = samples.get(second, d);
            if value < samples.get(first, d) {
                let expected = "more than in the sample before, whose later parameters are the same";
                self.number("samples", second * parameters + d, value, expected);
            }
        }
    }

    fn errors(&mut self, errors: &Errors<'_>, samples: usize, error_times: usize) {
        let Errors {
            left_out,
            deviation,
            bound_factors,
            changes,
            floor,
        } = errors;
        self.matrix("leave-one-out errors", left_out, [samples, error_times], POSITIVE);
        self.matrix("deviations", deviation, [samples, 1], [f32::MIN_POSITIVE, MAX]);
        self.matrix("bound's factors", bound_factors, [error_times, 1], POSITIVE);
        self.matrix("changes between samples", changes, [error_times, 1], POSITIVE);
        self.fixed(
            *floor,
            &Range {
                what: "error floor",
                min: 0.0,
                max: 1e6,
            },
        );
    }

    fn field(&mut self, cluster: &Cluster<'_>, nodes: usize, end_time: f32) {
        let (field, samples) = (&cluster.field, cluster.samples.parameters.rows as usize);
        let columns = |matrix: &Matrix<'_>| matrix.columns as usize;
        let (modes, axial) = (columns(&field.modes), columns(&field.axial_controls));
        self.matrix("modes", &field.modes, [panelled(nodes).saturating_mul(3), modes], ANY);
        let controls = self.knots(&field.knots, end_time);
        let mut slices = 0;
        for span in &field.spans {
            let columns = columns(&span.parameter_modes);
            self.matrix("parameter modes", &span.parameter_modes, [samples, columns], ANY);
            self.matrix("core", &span.core, [span.core.rows as usize, columns], self.length);
            slices += self.slices(span, modes);
        }
        self.count("slices", controls, slices);
        self.matrix("axial controls", &field.axial_controls, [controls, axial], self.length);
        self.matrix("axial modes", &field.axial_modes, [samples, axial], ANY);
    }

    /// Returns the number of controls.
    fn knots(&mut self, stored: &Matrix<'_>, end_time: f32) -> usize {
        let rows = stored.rows as usize;
        self.count("knots", rows.max(2 * ORDER), rows);
        let knots = self.matrix("knots", stored, [rows, 1], TIME);
        let controls = knots.rows().saturating_sub(ORDER);
        for index in 0..knots.rows() {
            let value = knots.get(index, 0);
            let fault = if index < ORDER && value != 0.0 {
                "0, as the first four"
            } else if index >= controls && value != end_time {
                "the end time, as the last four"
            } else if index > 0 && value < knots.get(index - 1, 0) {
                "no less than the one before"
            } else if index >= ORDER && value <= knots.get(index - ORDER, 0) {
                "more than the fourth before it"
            } else {
                continue;
            };
            self.number("knots", index, value, fault);
        }
        controls
    }

    /// The slices have no more panels than the modes need, and share out all rows. Returns how many there are.
    fn slices(&mut self, span: &Span<'_>, modes: usize) -> usize {
        let count = span.slices.data.len() / 2;
        let slices = self.indices("slices", &span.slices, count, modes.div_ceil(LANES) + 1);
        let panels: usize = slices.iter().sum();
        self.count("rows of the core", LANES * panels, span.core.rows as usize);
        count
    }

    #[inline(never)]
    fn refuse(&mut self, error: OpenError) {
        if self.found.is_ok() {
            self.found = Err(error);
        }
    }

    #[inline(never)]
    fn number(&mut self, what: &'static str, index: usize, value: f32, expected: &'static str) {
        self.refuse(OpenError::Number {
            what,
            index,
            value,
            expected,
        });
    }

    #[inline(never)]
    fn count(&mut self, what: &'static str, expected: usize, found: usize) {
        if found != expected {
            self.refuse(OpenError::Dimension { what, expected, found });
        }
    }

    #[inline(never)]
    fn length(&mut self, what: &'static str, blob: &Blob<'_>, expected: usize) {
        let found = blob.data.len();
        if found != expected {
            self.refuse(OpenError::Length { what, expected, found });
        }
    }

    #[inline(never)]
    fn setting(&mut self, what: &'static str, value: f64, min: f64, max: f64) {
        let within = min <= value && value <= max;
        if !within {
            self.refuse(OpenError::Setting { what, value, min, max });
        }
    }

    /// A setting whose range is the same in every model.
    #[inline(never)]
    fn fixed(&mut self, value: f64, range: &Range) {
        let Range { what, min, max } = *range;
        self.setting(what, value, min, max);
    }

    #[inline(never)]
    fn at_least_one(&mut self, what: &'static str, value: u32) {
        self.setting(what, value.into(), 1.0, 1e4);
    }

    #[inline(never)]
    fn index(&mut self, what: &'static str, index: usize, value: usize, bound: usize) {
        if value >= bound {
            self.refuse(OpenError::Index {
                what,
                index,
                value,
                bound,
            });
        }
    }

    /// A list of `count` u16, every one below the bound.
    #[inline(never)]
    fn indices<'a>(&mut self, what: &'static str, blob: &Blob<'a>, count: usize, bound: usize) -> Indices<'a> {
        self.length(what, blob, 2 * count);
        if self.found.is_err() {
            return Indices::new(&Blob::new(&[]));
        }
        let indices = Indices::new(blob);
        for (index, value) in indices.iter().enumerate() {
            self.index(what, index, value, bound);
        }
        indices
    }

    /// A matrix of these dimensions with every entry within bounds.
    #[inline(never)]
    fn matrix<'a>(
        &mut self,
        what: &'static str,
        matrix: &Matrix<'a>,
        [rows, columns]: [usize; 2],
        [min, max]: [f32; 2],
    ) -> MatrixView<'a> {
        let found = matrix.rows as usize;
        if found != rows {
            let expected = rows;
            self.refuse(OpenError::Rows { what, expected, found });
        }
        let found = matrix.columns as usize;
        if found != columns {
            let expected = columns;
            self.refuse(OpenError::Columns { what, expected, found });
        }
        let (units, coarse) = match matrix.encoding {
            Encoding::F32 => (0, 0),
            Encoding::Columns(Digits { coarse }) | Encoding::ColumnPanels(Digits { coarse }) => (columns, coarse),
            Encoding::RowPanels(Digits { coarse }) => (rows, coarse),
        };
        let coarse = usize::from(coarse);
        self.index(what, 0, coarse, columns.saturating_add(1));
        let bytes = match matrix.encoding {
            Encoding::F32 => columns.saturating_mul(4).saturating_mul(rows),
            Encoding::Columns(_) => blocks(columns.saturating_add(coarse), rows.div_ceil(2)),
            Encoding::ColumnPanels(_) | Encoding::RowPanels(_) => {
                let pairs = columns.saturating_sub(coarse).div_ceil(2);
                blocks(rows, coarse.saturating_add(pairs))
            }
        };
        self.length(what, &matrix.blob, bytes.saturating_add(units.saturating_mul(4)));
        if self.found.is_err() {
            return MatrixView::new(&Matrix::f32(0, columns as u32, &[]));
        }
        let view = MatrixView::new(matrix);
        if let Some((index, value)) = view.outside(min, max) {
            self.number(what, index, value, "a finite number in the array's range");
        }
        view
    }

    /// Not of integers: it is read again and again.
    fn singles(&mut self, what: &'static str, matrix: &Matrix<'_>) {
        if matrix.encoding != Encoding::F32 {
            let expected = (matrix.columns as usize)
                .saturating_mul(matrix.rows as usize)
                .saturating_mul(4);
            let found = matrix.blob.data.len();
            self.refuse(OpenError::Length { what, expected, found });
        }
    }

    /// A matrix of so many columns and at least so many rows, whose first entries rise.
    #[inline(never)]
    fn rising<'a>(
        &mut self,
        what: &'static str,
        stored: &Matrix<'a>,
        [columns, least]: [usize; 2],
        range: [f32; 2],
    ) -> MatrixView<'a> {
        let rows = stored.rows as usize;
        self.count(what, rows.max(least), rows);
        let view = self.matrix(what, stored, [rows, columns], range);
        for index in 1..view.rows() {
            let value = view.get(index, 0);
            if value <= view.get(index - 1, 0) {
                self.number(what, index, value, "more than the one before");
            }
        }
        view
    }
}

/// Bytes of panels of so many rows and blocks.
fn blocks(rows: usize, count: usize) -> usize {
    rows.div_ceil(LANES).saturating_mul(count).saturating_mul(2 * LANES)
}

/// So many rows in whole panels.
fn panelled(rows: usize) -> usize {
    rows.div_ceil(LANES).saturating_mul(LANES)
}
