//! The closed curves in which a plane across the channel cuts the surface.

use std::collections::BTreeMap;

/// Cuts triangles of a closed, consistently oriented surface by the plane x = `at`: closed curves of [y, z], each
/// given once around. A plane through the rear cavity gives two; one that misses the surface gives none.
pub fn section(triangles: &[[u32; 3]], positions: &[[f64; 3]], at: f64) -> Vec<Vec<[f64; 2]>> {
    // Each cut triangle is entered through the edge that leads to the front side and left through the one that leads
    // back; its neighbour runs along the same edge the other way, so what leaves one triangle enters the next.
    let front = |vertex: u32| positions.get(vertex as usize).is_some_and(|position| position[0] >= at);
    let mut next = BTreeMap::new();
    for &[a, b, c] in triangles {
        let edges = [(a, b), (b, c), (c, a)];
        let forth = edges.iter().find(|(from, to)| !front(*from) && front(*to));
        let back = edges.iter().find(|(from, to)| front(*from) && !front(*to));
        if let (Some(&(rear, ahead)), Some(&(leaving, behind))) = (forth, back) {
            next.insert((rear, ahead), (behind, leaving));
        }
    }
    let mut curves = Vec::new();
    while let Some((first, mut edge)) = next.pop_first() {
        let mut curve = vec![crossing(first, positions, at)];
        while edge != first {
            curve.push(crossing(edge, positions, at));
            match next.remove(&edge) {
                Some(following) => edge = following,
                None => break,
            }
        }
        curves.push(curve);
    }
    curves
}

/// Where an edge from the rear side to the front side meets the plane.
fn crossing((rear, ahead): (u32, u32), positions: &[[f64; 3]], at: f64) -> [f64; 2] {
    let [p, q] = [rear, ahead].map(|vertex| positions.get(vertex as usize).copied().unwrap_or_default());
    let share = (at - p[0]) / (q[0] - p[0]);
    [p[1] + share * (q[1] - p[1]), p[2] + share * (q[2] - p[2])]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::Surface;
    use crate::surface::tests::octahedron;

    /// A closed ring of tubes around the x axis: radius 2, tube 1.
    fn torus(around: u32, tube: u32) -> (Vec<[u32; 3]>, Vec<[f64; 3]>) {
        let vertex = |i: u32, j: u32| (i % around) * tube + j % tube;
        let turn = |step: u32, of: u32| std::f64::consts::TAU * f64::from(step) / f64::from(of);
        let mut triangles = Vec::new();
        let mut positions = Vec::new();
        for i in 0..around {
            for j in 0..tube {
                let (phi, theta) = (turn(i, around), turn(j, tube));
                let r = 2.0 + theta.cos();
                positions.push([theta.sin(), r * phi.cos(), r * phi.sin()]);
                triangles.push([vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)]);
                triangles.push([vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
            }
        }
        (triangles, positions)
    }

    fn radius([y, z]: [f64; 2]) -> f64 {
        y.hypot(z)
    }

    #[test]
    fn a_ring_is_cut_in_two_circles() {
        let (triangles, positions) = torus(400, 400);
        let curves = section(&triangles, &positions, 0.5);
        assert_eq!(curves.len(), 2);
        let mut radii: Vec<f64> = curves.iter().map(|curve| radius(curve[0])).collect();
        radii.sort_by(f64::total_cmp);
        let half_width = 0.75_f64.sqrt();
        for (curve, expected) in [(&radii[0], 2.0 - half_width), (&radii[1], 2.0 + half_width)] {
            assert!((curve - expected).abs() < 1e-3, "{curve} instead of {expected}");
        }
        for curve in &curves {
            let spread = curve
                .iter()
                .map(|&point| (radius(point) - radius(curve[0])).abs())
                .fold(0.0, f64::max);
            assert!(spread < 1e-3, "not a circle: {spread}");
        }
    }

    #[test]
    fn a_plane_through_nodes_or_beside_the_surface_is_no_special_case() {
        let (nodes, elements) = octahedron(0.5);
        let surface = Surface::new(&elements, 4);
        let positions = surface.positions(&nodes);
        // The flat octahedron's section is the square |y| + |z| = 1 - |x|.
        for at in [-0.999, -0.5, -0.3, 0.0, 0.25, 0.9] {
            let curves = section(surface.triangles(), &positions, at);
            assert_eq!(curves.len(), 1, "x = {at}");
            for [y, z] in &curves[0] {
                assert!(
                    (y.abs() + z.abs() - (1.0 - at.abs())).abs() < 1e-12,
                    "x = {at}: {y}, {z}"
                );
            }
        }
        assert!(section(surface.triangles(), &positions, 1.5).is_empty());
        assert!(section(surface.triangles(), &positions, f64::NAN).is_empty());
    }
}
