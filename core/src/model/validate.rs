//! The checks of [`Model::open`](super::Model::open): dimensions, indices, ranges, finiteness.

use super::matrix::{Indices, MatrixView};
use super::wire::{Blob, Cluster, Contents, Encoding, Errors, Field, Matrix, Mesh};
use super::{DIAGONAL, MIDPLANE, MOST_SAMPLES};
use crate::error::OpenError;

/// Larger numbers have no meaning in any array of a model, and could overflow what is computed from them.
const LARGEST: f32 = 1e6;
/// The largest mesh that u16 indices can number.
const MOST_NODES: usize = 1 << 16;

pub(super) fn contents(contents: &Contents<'_>) -> Result<(), OpenError> {
    for range in &contents.metadata.parameters {
        setting("parameter minimum", range.min, 1e-6, 1e6)?;
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
    let limit = rising("steady limit", &contents.steady_limit, 1)?;
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
    setting("capillary scale of the kernel", kernel.capillary_scale, 1e-3, 1e3)?;
    let paper = &contents.paper;
    setting(
        "neighbours of the diffuse approximation",
        paper.neighbours.into(),
        1.0,
        1e4,
    )?;
    setting(
        "capillary scale of the diffuse approximation",
        paper.capillary_scale,
        1e-3,
        1e3,
    )?;
    setting("radius of the diffuse approximation", paper.radius, 1.0 + 1e-3, 10.0)?;
    setting("local displacement rank", paper.displacement_rank.into(), 1.0, 1e4)?;
    setting("local velocity rank", paper.velocity_rank.into(), 1.0, 1e4)?;
    setting("window of the manifold", paper.window, 1.0, 4.0)?;

    let mut reached = None;
    for cluster in &contents.clusters {
        setting(
            "least confinement of a cluster",
            cluster.confinement_min,
            1e-6,
            reached.unwrap_or(1e6),
        )?;
        setting(
            "greatest confinement of a cluster",
            cluster.confinement_max,
            cluster.confinement_min,
            1e6,
        )?;
        reached = Some(cluster.confinement_max);
        self::cluster(cluster, nodes, times.rows(), error_times.rows())?;
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
    let reference = matrix("sector's reference nodes", &mesh.sector_reference, -1.001, 1.001)?;
    for node in 0..sector {
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
    let corners = mesh.elements.data.len() / 12 * 6;
    indices("elements", &mesh.elements, corners, nodes)?;
    for set in &mesh.node_sets {
        indices("node sets", &set.nodes, set.nodes.data.len() / 2, nodes)?;
    }
    for name in [MIDPLANE, DIAGONAL] {
        let long_enough = mesh
            .node_sets
            .iter()
            .any(|set| set.name == name && set.nodes.data.len() >= 6);
        if !long_enough {
            return Err(OpenError::MissingNodeSet { name });
        }
    }
    Ok(sector)
}

fn cluster(cluster: &Cluster<'_>, nodes: usize, times: usize, error_times: usize) -> Result<(), OpenError> {
    let samples = matrix("samples", &cluster.samples, 1e-6, LARGEST)?;
    dimension("columns of the samples", 2, cluster.samples.columns)?;
    if samples.rows() == 0 || samples.rows() > MOST_SAMPLES {
        return Err(OpenError::Dimension {
            what: "samples",
            expected: samples.rows().clamp(1, MOST_SAMPLES),
            found: samples.rows(),
        });
    }
    let sample = |i| (samples.get(i, 0), samples.get(i, 1));
    for second in 0..samples.rows() {
        if let Some(first) = (0..second).find(|&first| sample(first) == sample(second)) {
            return Err(OpenError::DuplicateSample { first, second });
        }
    }
    for field in [&cluster.displacement, &cluster.velocity] {
        self::field(field, nodes, times, samples.rows())?;
    }
    let [rank_u, rank_v] = [&cluster.displacement, &cluster.velocity].map(|field| field.modes.columns + 1);
    dimension("rows of the cross product", rank_u as usize, cluster.cross_product.rows)?;
    dimension(
        "columns of the cross product",
        rank_v as usize,
        cluster.cross_product.columns,
    )?;
    matrix("cross product", &cluster.cross_product, -LARGEST, LARGEST)?;
    for Errors {
        left_out,
        deviation,
        floor,
    } in [&cluster.direct_errors, &cluster.paper_errors]
    {
        dimension("rows of the leave-one-out errors", samples.rows(), left_out.rows)?;
        dimension("columns of the leave-one-out errors", error_times, left_out.columns)?;
        matrix("leave-one-out errors", left_out, 0.0, LARGEST)?;
        dimension("rows of the deviations", samples.rows(), deviation.rows)?;
        dimension("columns of the deviations", 1, deviation.columns)?;
        matrix("deviations", deviation, f32::MIN_POSITIVE, LARGEST)?;
        setting("error floor", *floor, 0.0, 1e6)?;
    }
    Ok(())
}

fn field(field: &Field<'_>, nodes: usize, times: usize, samples: usize) -> Result<(), OpenError> {
    dimension("rows of the modes", 3 * nodes, field.modes.rows)?;
    matrix("modes", &field.modes, -LARGEST, LARGEST)?;
    dimension("rows of the translation", times, field.translation.rows)?;
    dimension(
        "columns of the translation",
        field.coefficients.columns as usize,
        field.translation.columns,
    )?;
    matrix("translation", &field.translation, -LARGEST, LARGEST)?;
    dimension(
        "rows of the coefficients",
        times.saturating_mul(field.modes.columns as usize),
        field.coefficients.rows,
    )?;
    matrix("coefficients", &field.coefficients, -LARGEST, LARGEST)?;
    dimension("rows of the parameter modes", samples, field.parameter_modes.rows)?;
    dimension(
        "columns of the parameter modes",
        field.coefficients.columns as usize,
        field.parameter_modes.columns,
    )?;
    matrix("parameter modes", &field.parameter_modes, -LARGEST, LARGEST)?;
    Ok(())
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
