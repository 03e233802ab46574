//! Outlines of the full-order model, as a camera would see them, and contours drawn along them.

use capsule_core::{Domain, Model, Parameters, silhouette};
use capsule_database::{Database, Mesh, Trajectory};
use capsule_identify::Observable;

use crate::StudyError;
use crate::random::Random;

/// Half the channel's width in the study, in um: the answer does not depend on it.
pub const HALF_WIDTH_UM: f64 = 25.0;
/// Depth of a dent below which its line cannot be told from the outline, in l.
const LEAST_DEPTH: f64 = 0.05;
/// Instants of the frames of a transient, in l/V.
pub const TRANSIENT: [f64; 3] = [1.0, 2.0, 3.0];

/// A capsule of the full-order model. Outlines are halves, front to rear, so dense that chords do for the curve.
#[derive(Debug, Clone)]
pub struct Truth {
    /// Ca and a/l.
    pub parameters: [f64; 2],
    /// Its outline at the end of its motion.
    pub outline: Vec<[f64; 2]>,
    /// Of a silhouette, the line at which its dent is seen, from the rearmost place of the section to the axis; empty
    /// if there is none.
    pub dent_line: Vec<[f64; 2]>,
    /// Its outlines at the instants of [`TRANSIENT`].
    pub transient: [Vec<[f64; 2]>; 3],
    /// Axial length, half width and rear depth of the outline, and the velocity in that of the flow.
    pub scalars: [f64; 4],
}

impl Truth {
    /// The capsules of a database that lie in a model's domain and are steady at its end.
    ///
    /// # Errors
    /// Those of the database.
    pub fn all(model: &Model<'_>, database: &Database, observable: Observable) -> Result<Vec<Self>, StudyError> {
        let mut all = Vec::new();
        for entry in database.entries()? {
            let inside = Parameters::new(&entry.parameters).map(|p| model.domain(p)) == Some(Ok(Domain::Inside));
            if inside && entry.status.is_steady() {
                all.push(Self::new(
                    model,
                    database,
                    &database.read(&entry.parameters)?,
                    observable,
                )?);
            }
        }
        Ok(all)
    }

    fn new(
        model: &Model<'_>,
        database: &Database,
        trajectory: &Trajectory,
        observable: Observable,
    ) -> Result<Self, StudyError> {
        let mesh = database.mesh();
        let end = trajectory.extended(mesh, &[f64::from(model.end_time())])?;
        let velocity = mesh.centroid_velocity(&end.positions[0], &end.velocities[0])?;
        let centred = |positions: &[[f64; 3]]| -> Result<Vec<[f64; 3]>, StudyError> {
            let (_, centroid) = mesh.volume_and_centroid(positions)?;
            Ok(positions.iter().map(|[x, y, z]| [x - centroid, *y, *z]).collect())
        };
        let positions = centred(&end.positions[0])?;
        let section = smooth(&section(&mesh.nodes, &positions));
        let outline = outlined(model, mesh, &positions, observable)?;
        let mut transient = [const { Vec::new() }; 3];
        let moving = trajectory.extended(mesh, &TRANSIENT)?;
        for (outline, positions) in transient.iter_mut().zip(&moving.positions) {
            *outline = outlined(model, mesh, &centred(positions)?, observable)?;
        }
        let x = |outline: &[[f64; 2]]| {
            let greatest = outline.iter().map(|p| p[0]).fold(f64::NEG_INFINITY, f64::max);
            [greatest, outline.iter().map(|p| p[0]).fold(f64::INFINITY, f64::min)]
        };
        let [front, rear] = x(&outline);
        let pole = section.last().map_or(rear, |p| p[0]);
        let width = outline.iter().map(|p| p[1]).fold(0.0, f64::max);
        Ok(Self {
            parameters: [trajectory.parameters[0], trajectory.parameters[1]],
            dent_line: match observable {
                Observable::Silhouette => dent_line(&section),
                Observable::Midplane => Vec::new(),
            },
            outline,
            transient,
            scalars: [front - rear, width, pole - rear, velocity],
        })
    }
}

/// The nodes of the section z = 0 with y >= 0, front to rear, by their places on the unit sphere.
fn section(nodes: &[[f64; 3]], positions: &[[f64; 3]]) -> Vec<[f64; 2]> {
    const ON: f64 = 1e-9;
    let mut own: Vec<usize> = (0..nodes.len())
        .filter(|&n| nodes[n][2].abs() < ON && nodes[n][1] > -ON)
        .collect();
    own.sort_by(|&a, &b| nodes[b][0].total_cmp(&nodes[a][0]));
    own.into_iter()
        .map(|n| [positions[n][0], positions[n][1].max(0.0)])
        .collect()
}

/// The outline between the nodes: x is even and y odd about both poles, so a sum of cosines and one of sines, through
/// the nodes, is a smooth closed curve. It shares nothing with the curves that the identification puts through points.
fn smooth(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    const BETWEEN: usize = 40;
    let n = points.len() - 1;
    let angle = |i: usize, k: usize, of: usize| std::f64::consts::PI * (i * k) as f64 / of as f64;
    let ends = |k: usize| if k == 0 || k == n { 0.5 } else { 1.0 };
    let cosine = |k: usize| -> f64 {
        let sum = (0..=n)
            .map(|i| ends(i) * points[i][0] * angle(i, k, n).cos())
            .sum::<f64>();
        ends(k) * 2.0 / n as f64 * sum
    };
    let sine = |k: usize| -> f64 { 2.0 / n as f64 * (1..n).map(|i| points[i][1] * angle(i, k, n).sin()).sum::<f64>() };
    let (cosines, sines): (Vec<f64>, Vec<f64>) = (0..=n).map(|k| (cosine(k), sine(k))).unzip();
    let fine = BETWEEN * n;
    let at = |i: usize| {
        let x = (0..=n).map(|k| cosines[k] * angle(i, k, fine).cos()).sum();
        let y = (1..n).map(|k| sines[k] * angle(i, k, fine).sin()).sum();
        [x, y]
    };
    (0..=fine).map(at).collect()
}

/// The part of half a section behind its rearmost place, if that is not on the axis.
fn dent_line(section: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let rear = (0..section.len()).min_by(|a, b| section[*a][0].total_cmp(&section[*b][0]));
    let line = &section[rear.unwrap_or(0)..];
    match (line.first(), line.last()) {
        (Some(rim), Some(axis)) if axis[0] - rim[0] > LEAST_DEPTH => line.to_vec(),
        _ => Vec::new(),
    }
}

/// Half the outline of centred nodes.
fn outlined(
    model: &Model<'_>,
    mesh: &Mesh,
    positions: &[[f64; 3]],
    observable: Observable,
) -> Result<Vec<[f64; 2]>, StudyError> {
    match observable {
        Observable::Midplane => Ok(smooth(&section(&mesh.nodes, positions))),
        Observable::Silhouette => seen(model, positions),
    }
}

/// The silhouette along z. The geometry of the projection is the core's, the surface is not.
fn seen(model: &Model<'_>, positions: &[[f64; 3]]) -> Result<Vec<[f64; 2]>, StudyError> {
    const POINTS: usize = 1025;
    let mesh = model.mesh();
    if positions.len() != mesh.nodes() {
        return Err(StudyError::NothingToCompare);
    }
    let mut normals = vec![[0.0; 3]; mesh.sector_nodes().len()];
    let mut out = vec![[0.0; 2]; POINTS];
    silhouette(&mesh, positions, [1.0, 0.0], &mut normals, &mut out)?;
    Ok(out)
}

/// Errors with which a contour is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drawing {
    /// Pixels per l.
    pub pixels: f64,
    /// Standard deviation of a point's distance from the outline, in pixels.
    pub noise: f64,
    /// How far out the edge is drawn, in pixels.
    pub edge: f64,
    /// Relative error of the scale.
    pub scale: f64,
    /// Tilt, in radians.
    pub tilt: f64,
}

impl Drawing {
    /// A pixel, in um.
    pub fn pixel_um(&self) -> f64 {
        HALF_WIDTH_UM / self.pixels
    }
}

/// A closed contour along half an outline and its mirror image: one point a pixel of the way, in um, somewhere.
pub(crate) fn contour(outline: &[[f64; 2]], drawing: &Drawing, random: &mut Random) -> Vec<[f64; 2]> {
    let [contour, _] = contour_and_line([outline, &[]], drawing, random);
    contour
}

/// The same, and points along a dent line, whose offset is drawn at random like that of the edge.
pub(crate) fn contour_and_line(
    [outline, line]: [&[[f64; 2]]; 2],
    drawing: &Drawing,
    random: &mut Random,
) -> [Vec<[f64; 2]>; 2] {
    let first = random.next();
    let place = [random.between(50.0, 90.0), random.between(20.0, 30.0)];
    let contour = points_along(outline, drawing, (first, place), random);
    if line.is_empty() {
        return [contour, Vec::new()];
    }
    let edge = 0.25 * normal(random);
    let line = points_along(line, &Drawing { edge, ..*drawing }, (first, place), random);
    [contour, line]
}

/// Points along half a curve and its mirror image, one a pixel of the way, in um.
fn points_along(
    half: &[[f64; 2]],
    drawing: &Drawing,
    (first, place): (f64, [f64; 2]),
    random: &mut Random,
) -> Vec<[f64; 2]> {
    let mirrored = half.iter().rev().skip(1).map(|[x, y]| [*x, -y]);
    let closed: Vec<[f64; 2]> = half.iter().copied().chain(mirrored).collect();
    let mut way = vec![0.0];
    for pair in closed.windows(2) {
        way.push(way[way.len() - 1] + (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]));
    }
    let around = way[way.len() - 1];
    let count = ((around * drawing.pixels) as usize).max(12);
    (0..count)
        .map(|k| {
            let s = around * (k as f64 + first) / count as f64;
            let i = way.partition_point(|w| *w <= s).clamp(1, closed.len() - 1);
            let (p, q) = (closed[i - 1], closed[i]);
            let [tx, ty] = [q[0] - p[0], q[1] - p[1]];
            let share = (s - way[i - 1]) / (way[i] - way[i - 1]);
            let out = (drawing.edge + drawing.noise * normal(random)) / drawing.pixels / tx.hypot(ty);
            let [x, y] = [p[0] + share * tx + out * ty, p[1] + share * ty - out * tx];
            let (cos, sin) = (drawing.tilt.cos(), drawing.tilt.sin());
            let factor = HALF_WIDTH_UM / (1.0 + drawing.scale);
            [
                place[0] + factor * (cos * x - sin * y),
                place[1] + factor * (cos * y + sin * x),
            ]
        })
        .collect()
}

/// A normal number (Box and Muller, 1958).
pub(crate) fn normal(random: &mut Random) -> f64 {
    let radius = (-2.0 * (1.0 - random.next()).ln()).sqrt();
    radius * (std::f64::consts::TAU * random.next()).cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smooth_outline_is_the_ellipse_that_its_nodes_lie_on() {
        let nodes: Vec<[f64; 2]> = (0..=52)
            .map(|i| {
                let angle = std::f64::consts::PI * f64::from(i) / 52.0;
                [1.2 * angle.cos(), 0.8 * angle.sin()]
            })
            .collect();
        for [x, y] in smooth(&nodes) {
            assert!(((x / 1.2).hypot(y / 0.8) - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn normal_numbers_have_mean_0_and_variance_1() {
        let mut random = Random(3);
        let numbers: Vec<f64> = (0..100_000).map(|_| normal(&mut random)).collect();
        let mean = numbers.iter().sum::<f64>() / 1e5;
        let variance = numbers.iter().map(|x| x * x).sum::<f64>() / 1e5;
        assert!(mean.abs() < 0.01 && (variance - 1.0).abs() < 0.02, "{mean} {variance}");
    }
}
