//! Observables of a shape: its section outlines and their dimensions.

use crate::Mesh;

/// The nodes of the half outlines, from the front pole to the rear pole.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Outlines {
    /// In the plane `z = 0`, `y >= 0`.
    pub midplane: Vec<u32>,
    /// In the plane `y = z >= 0`.
    pub diagonal: Vec<u32>,
}

/// The dimensions of a shape (l). Extremes are those of the parabola through the extreme node of an outline and its
/// two neighbours, with the nodes taken as equidistant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dimensions {
    /// Greatest minus least `x` over both outlines.
    pub axial_length: f64,
    /// Greatest `|y|` in the plane `z = 0`.
    pub half_width: f64,
    /// Greatest distance from the axis in the plane `y = z`.
    pub half_diagonal: f64,
    /// Depth of the hollow at the rear: `x` of the rear pole minus the least `x`.
    pub rear_depth: f64,
}

impl Outlines {
    /// The outlines of a mesh with nodes in the symmetry planes.
    pub fn new(mesh: &Mesh) -> Self {
        let outline = |distance: fn([f64; 3]) -> f64| {
            let mut nodes: Vec<u32> = (0..mesh.nodes.len() as u32)
                .filter(|&i| {
                    let point = mesh.nodes[i as usize];
                    distance(point).abs() < 1e-9 && point[1] > -1e-9
                })
                .collect();
            // Each outline is half a great circle.
            nodes.sort_by(|&a, &b| mesh.nodes[b as usize][0].total_cmp(&mesh.nodes[a as usize][0]));
            nodes
        };
        Self {
            midplane: outline(|[_, _, z]| z),
            diagonal: outline(|[_, y, z]| y - z),
        }
    }

    /// The outline in the plane `z = 0` as `[x, r]` points, from front to rear.
    pub fn profile_midplane(&self, positions: &[[f64; 3]]) -> Vec<[f64; 2]> {
        profile(&self.midplane, positions)
    }

    /// The outline in the plane `y = z` as `[x, r]` points, from front to rear.
    pub fn profile_diagonal(&self, positions: &[[f64; 3]]) -> Vec<[f64; 2]> {
        profile(&self.diagonal, positions)
    }

    /// The dimensions of the shape with these node positions.
    pub fn dimensions(&self, positions: &[[f64; 3]]) -> Dimensions {
        let profiles = [self.profile_midplane(positions), self.profile_diagonal(positions)];
        let front = profiles
            .iter()
            .map(|p| greatest(p, |[x, _]| x))
            .fold(f64::NEG_INFINITY, f64::max);
        let rear = profiles
            .iter()
            .map(|p| -greatest(p, |[x, _]| -x))
            .fold(f64::INFINITY, f64::min);
        let pole = profiles[0].last().map_or(rear, |[x, _]| *x);
        Dimensions {
            axial_length: front - rear,
            half_width: greatest(&profiles[0], |[_, r]| r),
            half_diagonal: greatest(&profiles[1], |[_, r]| r),
            rear_depth: pole - rear,
        }
    }

    /// The rate of the axial length: the difference of the axial velocities at its two ends.
    pub fn axial_length_rate(&self, positions: &[[f64; 3]], velocities: &[[f64; 3]]) -> f64 {
        let axial = |node: u32| positions[node as usize][0];
        let nodes = || self.midplane.iter().chain(&self.diagonal).copied();
        let velocity = |node: Option<u32>| node.map_or(0.0, |node| velocities[node as usize][0]);
        velocity(nodes().max_by(|&a, &b| axial(a).total_cmp(&axial(b))))
            - velocity(nodes().min_by(|&a, &b| axial(a).total_cmp(&axial(b))))
    }
}

fn profile(outline: &[u32], positions: &[[f64; 3]]) -> Vec<[f64; 2]> {
    let point = |&node: &u32| {
        let [x, y, z] = positions[node as usize];
        [x, y.hypot(z)]
    };
    outline.iter().map(point).collect()
}

/// The greatest value along an outline, refined by a parabola. Beyond a pole the outline continues as its mirror image.
fn greatest(profile: &[[f64; 2]], value: impl Fn([f64; 2]) -> f64) -> f64 {
    let values: Vec<f64> = profile.iter().map(|&point| value(point)).collect();
    let Some(i) = (0..values.len()).max_by(|&a, &b| values[a].total_cmp(&values[b])) else {
        return f64::NAN;
    };
    let at = |index: Option<usize>, mirror: usize| index.and_then(|k| values.get(k)).or(values.get(mirror)).copied();
    let (Some(before), Some(after)) = (at(i.checked_sub(1), i + 1), at(Some(i + 1), i.wrapping_sub(1))) else {
        return values[i];
    };
    let curvature = 2.0 * values[i] - before - after;
    if curvature > 0.0 {
        values[i] + (after - before).powi(2) / (8.0 * curvature)
    } else {
        values[i]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outlines_run_from_pole_to_pole() {
        for n in [3, 8] {
            let mesh = Mesh::octahedral(n).unwrap();
            let outlines = Outlines::new(&mesh);
            assert_eq!(
                (outlines.midplane.len(), outlines.diagonal.len()),
                (4 * n + 1, 2 * n + 1)
            );
            for outline in [&outlines.midplane, &outlines.diagonal] {
                assert_eq!(mesh.nodes[outline[0] as usize], [1.0, 0.0, 0.0]);
                assert_eq!(mesh.nodes[outline[outline.len() - 1] as usize], [-1.0, 0.0, 0.0]);
            }
        }
    }

    #[test]
    fn dimensions_of_a_shape_with_known_extremes() {
        // The ellipsoid's x is shifted by 0.7 r^2: the rear pole becomes a hollow.
        let mesh = Mesh::octahedral(13).unwrap();
        let outlines = Outlines::new(&mesh);
        let positions: Vec<_> = mesh
            .nodes
            .iter()
            .map(|&[x, y, z]| [x - 0.7 * (y * y + z * z), 0.8 * y, 0.8 * z])
            .collect();
        let dimensions = outlines.dimensions(&positions);
        // x = c - 0.7 (1 - c^2) on the unit sphere: front at c = 1, rear rim at c = -1/1.4.
        let rim = -1.0 / 1.4;
        let least = rim - 0.7 * (1.0 - rim * rim);
        assert!((dimensions.axial_length - (1.0 - least)).abs() < 2e-4, "{dimensions:?}");
        assert!((dimensions.rear_depth - (-1.0 - least)).abs() < 2e-4);
        assert!((dimensions.half_width - 0.8).abs() < 2e-4);
        assert!((dimensions.half_diagonal - 0.8).abs() < 2e-4);
    }

    #[test]
    fn a_convex_shape_has_no_rear_depth() {
        let mesh = Mesh::octahedral(5).unwrap();
        let outlines = Outlines::new(&mesh);
        let dimensions = outlines.dimensions(&mesh.nodes);
        assert_eq!(dimensions.rear_depth, 0.0);
        assert_eq!(dimensions.axial_length, 2.0);
    }

    #[test]
    fn length_rate_is_the_derivative() {
        let mesh = Mesh::octahedral(8).unwrap();
        let outlines = Outlines::new(&mesh);
        let velocities: Vec<_> = mesh
            .nodes
            .iter()
            .map(|&[x, y, z]| [0.3 * x + 0.1 * y * z, -0.1 * y, -0.1 * z])
            .collect();
        assert!((outlines.axial_length_rate(&mesh.nodes, &velocities) - 0.6).abs() < 1e-14);
    }
}
