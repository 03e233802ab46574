//! Section outlines as smooth curves, so that shapes on different meshes compare.

use capsule_fom::Mesh;
use capsule_fom::measures::Outlines;
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

/// The half outlines in the planes z = 0 and y = z, in the frame of the centroid, at their nodes: `[theta, x, r]` with
/// the polar angle on the reference sphere, from the front pole (0) to the rear pole (pi).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Outline {
    sections: [Vec<[f64; 3]>; 2],
}

/// Chords of a section in a comparison.
const CHORDS: usize = 1000;

impl Outline {
    /// The outlines of a shape whose centroid is at `x = centroid`.
    pub fn new(mesh: &Mesh, positions: &[[f64; 3]], centroid: f64) -> Self {
        let Outlines { midplane, diagonal } = Outlines::new(mesh);
        let section = |nodes: Vec<u32>| {
            nodes
                .into_iter()
                .map(|node| {
                    let ([a, b, c], [x, y, z]) = (mesh.nodes[node as usize], positions[node as usize]);
                    [b.hypot(c).atan2(a), x - centroid, y.hypot(z)]
                })
                .collect()
        };
        Self {
            sections: [section(midplane), section(diagonal)],
        }
    }

    /// The modified Hausdorff distance (paper, eqs. 52 to 54) of the curves: the mean distance of the points of one to
    /// the other, in the direction in which it is larger.
    pub fn distance(&self, other: &Self) -> f64 {
        let (a, b) = (self.curves(), other.curves());
        let mean = |from: &[Vec<Vector2<f64>>; 2], to: &[Vec<Vector2<f64>>; 2]| {
            let distances = from
                .iter()
                .zip(to)
                .flat_map(|(from, to)| from.iter().map(|&point| distance(point, to)));
            distances.sum::<f64>() / (2 * (CHORDS + 1)) as f64
        };
        mean(&a, &b).max(mean(&b, &a))
    }

    /// The sections at equidistant angles: cubic splines through the nodes, smooth across the axis.
    fn curves(&self) -> [Vec<Vector2<f64>>; 2] {
        [0, 1].map(|section| {
            let nodes = &self.sections[section];
            let angles: Vec<f64> = nodes.iter().map(|n| n[0]).collect();
            let x = Spline::new(&angles, nodes.iter().map(|n| n[1]).collect(), End::Level);
            let r = Spline::new(&angles, nodes.iter().map(|n| n[2]).collect(), End::Straight);
            let step = std::f64::consts::PI / CHORDS as f64;
            (0..=CHORDS)
                .map(|i| i as f64 * step)
                .map(|t| Vector2::new(x.at(t), r.at(t)))
                .collect()
        })
    }
}

/// The distance of a point to a polyline.
fn distance(point: Vector2<f64>, line: &[Vector2<f64>]) -> f64 {
    let square = line
        .windows(2)
        .map(|chord| {
            let (along, from) = (chord[1] - chord[0], point - chord[0]);
            let part = (from.dot(&along) / along.dot(&along)).clamp(0.0, 1.0);
            let rest = from - part * along;
            rest.dot(&rest)
        })
        .fold(f64::INFINITY, f64::min);
    square.sqrt()
}

/// End conditions of a spline.
#[derive(Clone, Copy, PartialEq)]
enum End {
    /// Slope 0, as an even function.
    Level,
    /// Curvature 0, as an odd function.
    Straight,
}

/// A cubic spline.
struct Spline<'a> {
    knots: &'a [f64],
    values: Vec<f64>,
    /// Second derivatives.
    curvatures: Vec<f64>,
}

impl<'a> Spline<'a> {
    fn new(knots: &'a [f64], values: Vec<f64>, end: End) -> Self {
        let last = knots.len() - 1;
        let width = |i: usize| knots[i + 1] - knots[i];
        let slope = |i: usize| (values[i + 1] - values[i]) / width(i);
        // Rows (lower, diagonal, upper, right-hand side) of the tridiagonal system for the curvatures.
        let row = |i: usize| -> [f64; 4] {
            match (i, end) {
                (0, End::Level) => [0.0, 2.0 * width(0), width(0), 6.0 * slope(0)],
                (i, End::Level) if i == last => [width(i - 1), 2.0 * width(i - 1), 0.0, -6.0 * slope(i - 1)],
                (i, End::Straight) if i == 0 || i == last => [0.0, 1.0, 0.0, 0.0],
                (i, _) => [
                    width(i - 1),
                    2.0 * (width(i - 1) + width(i)),
                    width(i),
                    6.0 * (slope(i) - slope(i - 1)),
                ],
            }
        };
        let mut rows: Vec<[f64; 4]> = (0..=last).map(row).collect();
        for i in 1..=last {
            let [_, diagonal, upper, right] = rows[i - 1];
            let factor = rows[i][0] / diagonal;
            rows[i][1] -= factor * upper;
            rows[i][3] -= factor * right;
        }
        let mut curvatures = vec![0.0; last + 1];
        for i in (0..=last).rev() {
            let next = curvatures.get(i + 1).copied().unwrap_or(0.0);
            curvatures[i] = (rows[i][3] - rows[i][2] * next) / rows[i][1];
        }
        Self {
            knots,
            values,
            curvatures,
        }
    }

    fn at(&self, t: f64) -> f64 {
        let i = self
            .knots
            .partition_point(|&knot| knot <= t)
            .clamp(1, self.knots.len() - 1)
            - 1;
        let width = self.knots[i + 1] - self.knots[i];
        let (b, a) = ((t - self.knots[i]) / width, (self.knots[i + 1] - t) / width);
        let bend = (a * a * a - a) * self.curvatures[i] + (b * b * b - b) * self.curvatures[i + 1];
        a * self.values[i] + b * self.values[i + 1] + bend * width * width / 6.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A hollow shape at mesh frequency `n`, moved along and swollen.
    fn outline(n: usize, shift: f64, swell: f64) -> Outline {
        let mesh = Mesh::octahedral(n).unwrap();
        let positions: Vec<_> = mesh
            .nodes
            .iter()
            .map(|&[x, y, z]| [0.9 * x + 0.4 * (y * y + z * z) + shift, swell * y, swell * z])
            .collect();
        Outline::new(&mesh, &positions, 0.0)
    }

    #[test]
    fn meshes_agree_on_a_smooth_shape() {
        let errors = [4, 8].map(|n| outline(n, 0.0, 0.8).distance(&outline(24, 0.0, 0.8)));
        assert!(errors[1] < 3e-6 && errors[1] < errors[0] / 8.0, "{errors:?}");
    }

    #[test]
    fn small_differences_are_measured() {
        let shape = outline(8, 0.0, 0.8);
        assert!(shape.distance(&shape) < 1e-14);
        // A shift moves each point along its normal by the normal's axial part.
        let shifts = [1e-4, 2e-4].map(|shift| shape.distance(&outline(13, shift, 0.8)));
        assert!(shifts[0] > 2e-5 && shifts[0] < 1e-4, "{shifts:?}");
        assert!((shifts[1] / shifts[0] - 2.0).abs() < 0.02, "{shifts:?}");
        assert!(shape.distance(&outline(8, 0.0, 0.8001)) > 2e-5);
    }
}
