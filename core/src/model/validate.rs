//! The checks of [`Model::open`](super::Model::open): dimensions, indices, ranges, finiteness.

use super::matrix::{Indices, MatrixView};
use super::wire::{Blob, Cluster, Contents, Encoding, Errors, Field, Matrix, Mesh, NodeSet, Reference};
use super::{DIAGONAL, MIDPLANE, MOST_SAMPLES};
use crate::error::OpenError;

/// Larger numbers have no meaning in any array of a model, and could overflow what is computed from them.
const LARGEST: f32 = 1e6;
/// Order of the cubic splines.
const ORDER: usize = 4;
/// The largest mesh that u16 indices can number.
const MOST_NODES: usize = 1 << 16;

pub(super) fn contents(contents: &Contents<'_>) -> Result<(), OpenError> {
    // Ca and a/l of a capsule in the channel are positive.
    let sphere = matches!(contents.mesh.reference, Reference::Sphere);
    let least = if sphere { 1e-6 } else { -1e6 };
    let parameters = contents.metadata.parameters.len();
    let expected = if sphere { 2 } else { parameters.max(1) };
    if parameters != expected {
        return Err(OpenError::Dimension {
            what: "parameters",
            expected,
            found: parameters,
        });
    }
    for range in &contents.metadata.parameters {
        setting("parameter minimum", range.min, least, 1e6)?;
        setting("parameter maximum", range.max, range.min, 1e6)?;
    }
    let nodes = mesh(&contents.mesh)?;

    let times = rising("times", &contents.times, 2)?;
    if times.get(0, 0) != 0.0 {
        return Err(OpenError::Number {
            what: "times",
            index: 0,
            value: times.get(0, 0),
            expected: "0",
        });
    }
    let error_times = rising("error times", &contents.error_times, 1)?;
    dimension("columns of the steady limit", 2, contents.steady_limit.columns)?;
    let limit = rising("steady limit", &contents.steady_limit, 0)?;
    if limit.rows() > 0 && !sphere {
        return Err(OpenError::Dimension {
            what: "rows of the steady limit of a model that is not one of a capsule in the channel",
            expected: 0,
            found: limit.rows(),
        });
    }
    for row in 0..limit.rows() {
        setting(
            "capillary number of the steady limit",
            limit.get(row, 1).into(),
            1e-6,
            1e6,
        )?;
    }

    dimension("columns of the border", 2, contents.border.columns)?;
    rising("border", &contents.border, 0)?;

    let kernel = &contents.kernel;
    setting("neighbours of the kernel", kernel.neighbours.into(), 1.0, 1e4)?;
    for scale in kernel.scales {
        setting("scale of the kernel", scale, 1e-9, 1e9)?;
    }
    let paper = &contents.paper;
    setting(
        "neighbours of the diffuse approximation",
        paper.neighbours.into(),
        1.0,
        1e4,
    )?;
    for scale in paper.scales {
        setting("scale of the diffuse approximation", scale, 1e-9, 1e9)?;
    }
    setting("radius of the diffuse approximation", paper.radius, 1.0 + 1e-3, 10.0)?;
    setting("local displacement rank", paper.displacement_rank.into(), 1.0, 1e4)?;
    setting("local velocity rank", paper.velocity_rank.into(), 1.0, 1e4)?;
    setting("window of the manifold", paper.window, 1.0, 4.0)?;

    bounded("parameter of the clusters", 0, contents.split.into(), parameters)?;
    let mut reached = None;
    for cluster in &contents.clusters {
        setting("least value of a cluster", cluster.min, least, reached.unwrap_or(1e6))?;
        setting("greatest value of a cluster", cluster.max, cluster.min, 1e6)?;
        reached = Some(cluster.max);
        samples(cluster, parameters, least as f32)?;
        self::cluster(cluster, nodes, times.get(times.rows() - 1, 0), error_times.rows())?;
    }
    if reached.is_none() {
        return Err(OpenError::Dimension {
            what: "clusters",
            expected: 1,
            found: 0,
        });
    }
    Ok(())
}

/// Checks the mesh and returns the number of sector nodes.
fn mesh(mesh: &Mesh<'_>) -> Result<usize, OpenError> {
    let nodes = mesh.nodes as usize;
    if nodes > MOST_NODES {
        return Err(OpenError::Dimension {
            what: "nodes",
            expected: MOST_NODES,
            found: nodes,
        });
    }
    let sector = mesh.sector_reference.rows as usize;
    dimension(
        "columns of the sector's reference nodes",
        3,
        mesh.sector_reference.columns,
    )?;
    let reference = matrix("sector's reference nodes", &mesh.sector_reference, -LARGEST, LARGEST)?;
    match mesh.reference {
        Reference::Sphere => on_unit_sphere(&reference)?,
        Reference::Shape { radius } => setting("radius of the reference shape", radius, 1e-9, 1e6)?,
    }
    let representative = indices("representatives", &mesh.representative, nodes, sector)?;
    length("operations", &mesh.operation, nodes)?;
    for (index, &operation) in mesh.operation.data.iter().enumerate() {
        bounded("operations", index, operation.into(), 8)?;
    }
    let sector_nodes = indices("sector nodes", &mesh.sector_nodes, sector, nodes)?;
    for (index, node) in sector_nodes.iter().enumerate() {
        let itself = representative.get(node) == Some(index) && mesh.operation.data.get(node) == Some(&0);
        if !itself {
            return Err(OpenError::SectorNode { index, node });
        }
    }
    let element_nodes = usize::from(mesh.element_nodes);
    if element_nodes != 3 && element_nodes != 6 {
        return Err(OpenError::Dimension {
            what: "nodes of an element",
            expected: 6,
            found: element_nodes,
        });
    }
    let whole = mesh.elements.data.len() / (2 * element_nodes) * element_nodes;
    indices("elements", &mesh.elements, whole, nodes)?;
    for set in &mesh.node_sets {
        indices("node sets", &set.nodes, set.nodes.data.len() / 2, nodes)?;
    }
    for name in [MIDPLANE, DIAGONAL] {
        let short = |set: &NodeSet<'_>| set.name == name && set.nodes.data.len() < 6;
        if mesh.node_sets.iter().any(short) {
            return Err(OpenError::ShortOutline { name });
        }
    }
    Ok(sector)
}

fn on_unit_sphere(reference: &MatrixView<'_>) -> Result<(), OpenError> {
    for node in 0..reference.rows() {
        let [x, y, z] = [0, 1, 2].map(|axis| reference.get(node, axis));
        let square = x * x + y * y + z * z;
        if (square - 1.0).abs() > 1e-3 {
            let expected = "a node on the unit sphere (this is its squared radius)";
            return Err(OpenError::Number {
                what: "sector's reference nodes",
                index: node,
                value: square,
                expected,
            });
        }
    }
    Ok(())
}

/// Checks the samples of a cluster.
fn samples(cluster: &Cluster<'_>, parameters: usize, least: f32) -> Result<(), OpenError> {
    let samples = matrix("samples", &cluster.samples, least, LARGEST)?;
    dimension("columns of the samples", parameters, cluster.samples.columns)?;
    if samples.rows() == 0 || samples.rows() > MOST_SAMPLES {
        return Err(OpenError::Dimension {
            what: "samples",
            expected: samples.rows().clamp(1, MOST_SAMPLES),
            found: samples.rows(),
        });
    }
    let same = |first, second| (0..parameters).all(|d| samples.get(first, d) == samples.get(second, d));
    for second in 0..samples.rows() {
        if let Some(first) = (0..second).find(|&first| same(first, second)) {
            return Err(OpenError::DuplicateSample { first, second });
        }
    }
    Ok(())
}

fn cluster(cluster: &Cluster<'_>, nodes: usize, end_time: f32, error_times: usize) -> Result<(), OpenError> {
    let samples = cluster.samples.rows as usize;
    field(&cluster.field, nodes, end_time, samples)?;
    for Errors {
        left_out,
        deviation,
        bound_factors,
        floor,
    } in [&cluster.direct_errors, &cluster.paper_errors]
    {
        dimension("rows of the leave-one-out errors", samples, left_out.rows)?;
        dimension("columns of the leave-one-out errors", error_times, left_out.columns)?;
        matrix("leave-one-out errors", left_out, 0.0, LARGEST)?;
        dimension("rows of the deviations", samples, deviation.rows)?;
        dimension("columns of the deviations", 1, deviation.columns)?;
        matrix("deviations", deviation, f32::MIN_POSITIVE, LARGEST)?;
        dimension("rows of the bound's factors", error_times, bound_factors.rows)?;
        dimension("columns of the bound's factors", 1, bound_factors.columns)?;
        matrix("bound's factors", bound_factors, 0.0, LARGEST)?;
        setting("error floor", *floor, 0.0, 1e6)?;
    }
    Ok(())
}

fn field(field: &Field<'_>, nodes: usize, end_time: f32, samples: usize) -> Result<(), OpenError> {
    dimension("rows of the modes", 3 * nodes, field.modes.rows)?;
    matrix("modes", &field.modes, -LARGEST, LARGEST)?;
    dimension("rows of the parameter modes", samples, field.parameter_modes.rows)?;
    matrix("parameter modes", &field.parameter_modes, -LARGEST, LARGEST)?;
    let controls = knots(&field.knots, end_time)?;
    for rows in [&field.coarse, &field.fine] {
        dimension(
            "columns of the core",
            field.parameter_modes.columns as usize,
            rows.columns,
        )?;
        matrix("core", rows, -LARGEST, LARGEST)?;
    }
    slices(field, controls)?;
    dimension("rows of the axial controls", controls, field.axial_controls.rows)?;
    matrix("axial controls", &field.axial_controls, -LARGEST, LARGEST)?;
    dimension("rows of the axial modes", samples, field.axial_modes.rows)?;
    dimension(
        "columns of the axial modes",
        field.axial_controls.columns as usize,
        field.axial_modes.columns,
    )?;
    matrix("axial modes", &field.axial_modes, -LARGEST, LARGEST)?;
    Ok(())
}

/// Checks the knots and returns the number of controls.
fn knots(stored: &Matrix<'_>, end_time: f32) -> Result<usize, OpenError> {
    dimension("columns of the knots", 1, stored.columns)?;
    let knots = matrix("knots", stored, 0.0, LARGEST)?;
    let controls = knots.rows().saturating_sub(ORDER);
    if controls < ORDER {
        return Err(OpenError::Dimension {
            what: "knots",
            expected: 2 * ORDER,
            found: knots.rows(),
        });
    }
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
        return Err(OpenError::Number {
            what: "knots",
            index,
            value,
            expected: fault,
        });
    }
    Ok(controls)
}

/// Checks that the slices have no more rows than there are modes, and share out all rows.
fn slices(field: &Field<'_>, controls: usize) -> Result<(), OpenError> {
    length("slices", &field.slices, 4 * controls)?;
    let modes = field.modes.columns as usize;
    let mut sum = [0, 0];
    for (slice, [coarse, fine]) in Indices::new(&field.slices).pairs().enumerate() {
        bounded("slices", 2 * slice + 1, coarse + fine, modes + 1)?;
        sum = [sum[0] + coarse, sum[1] + fine];
    }
    dimension("coarse rows of the core", sum[0], field.coarse.rows)?;
    dimension("fine rows of the core", sum[1], field.fine.rows)
}

fn dimension(what: &'static str, expected: usize, found: u32) -> Result<(), OpenError> {
    let found = found as usize;
    if found == expected {
        Ok(())
    } else {
        Err(OpenError::Dimension { what, expected, found })
    }
}

fn length(what: &'static str, blob: &Blob<'_>, expected: usize) -> Result<(), OpenError> {
    let found = blob.data.len();
    if found == expected {
        Ok(())
    } else {
        Err(OpenError::Length { what, expected, found })
    }
}

fn setting(what: &'static str, value: f64, min: f64, max: f64) -> Result<(), OpenError> {
    if min <= value && value <= max {
        Ok(())
    } else {
        Err(OpenError::Setting { what, value, min, max })
    }
}

fn bounded(what: &'static str, index: usize, value: usize, bound: usize) -> Result<(), OpenError> {
    if value < bound {
        Ok(())
    } else {
        Err(OpenError::Index {
            what,
            index,
            value,
            bound,
        })
    }
}

/// Checks the length of a list of u16 and that every one is below the bound.
fn indices<'a>(what: &'static str, blob: &Blob<'a>, count: usize, bound: usize) -> Result<Indices<'a>, OpenError> {
    length(what, blob, 2 * count)?;
    let indices = Indices::new(blob);
    for (index, value) in indices.iter().enumerate() {
        bounded(what, index, value, bound)?;
    }
    Ok(indices)
}

/// Checks the length of a matrix and that every entry lies within bounds.
fn matrix<'a>(what: &'static str, matrix: &Matrix<'a>, min: f32, max: f32) -> Result<MatrixView<'a>, OpenError> {
    let [rows, columns] = [matrix.rows, matrix.columns].map(|count| count as usize);
    let count = rows.saturating_mul(columns);
    let bytes = match matrix.encoding {
        Encoding::F32 => count.saturating_mul(4),
        Encoding::I16 => count.saturating_mul(2).saturating_add(columns.saturating_mul(4)),
        Encoding::I16Rows => count.saturating_mul(2).saturating_add(rows.saturating_mul(4)),
        Encoding::I8Rows => count.saturating_add(rows.saturating_mul(4)),
    };
    length(what, &matrix.blob, bytes)?;
    let view = MatrixView::new(matrix);
    for row in 0..rows {
        for column in 0..columns {
            let value = view.get(row, column);
            if !(min <= value && value <= max) {
                let expected = "a finite number in the array's range";
                return Err(OpenError::Number {
                    what,
                    index: row * columns + column,
                    value,
                    expected,
                });
            }
        }
    }
    Ok(view)
}

/// Checks that there are enough rows and that their first entries rise.
fn rising<'a>(what: &'static str, matrix: &Matrix<'a>, least: usize) -> Result<MatrixView<'a>, OpenError> {
    let view = self::matrix(what, matrix, 0.0, LARGEST)?;
    if view.rows() < least {
        return Err(OpenError::Dimension {
            what,
            expected: least,
            found: view.rows(),
        });
    }
    for index in 1..view.rows() {
        if view.get(index, 0) <= view.get(index - 1, 0) {
            let value = view.get(index, 0);
            return Err(OpenError::Number {
                what,
                index,
                value,
                expected: "more than the one before",
            });
        }
    }
    Ok(view)
}
