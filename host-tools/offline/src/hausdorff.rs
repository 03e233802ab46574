//! The distance between two shapes.

use capsule_database::Symmetry;

/// The modified Hausdorff distance between two sets of points, in their unit (paper, eqs. 52 to 54, where eq. 52 is
/// meant to take the maximum of both directions): the mean distance of the points of one set to the nearest of the
/// other, in the direction in which it is larger.
///
/// Empty sets have no distance: the result is infinite, or 0 when both are empty.
#[must_use]
pub fn modified_hausdorff(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    if a.is_empty() || b.is_empty() {
        return if a.len() == b.len() { 0.0 } else { f64::INFINITY };
    }
    let axis = |d: usize| -> Vec<f64> { b.iter().map(|p| p[d]).collect() };
    let (x, y, z) = (axis(0), axis(1), axis(2));
    let mut squares = vec![0.0; b.len()];
    let mut nearest = vec![f64::INFINITY; b.len()];
    let mut sum = 0.0;
    for p in a {
        for (j, square) in squares.iter_mut().enumerate() {
            let (dx, dy, dz) = (x[j] - p[0], y[j] - p[1], z[j] - p[2]);
            *square = dx * dx + dy * dy + dz * dz;
        }
        for (n, s) in nearest.iter_mut().zip(&squares) {
            *n = if *s < *n { *s } else { *n };
        }
        sum += least(&squares).sqrt();
    }
    let from_a = sum / a.len() as f64;
    let from_b = nearest.iter().map(|s| s.sqrt()).sum::<f64>() / b.len() as f64;
    from_a.max(from_b)
}

/// One representative of each orbit of a symmetry, and the size of its orbit.
#[derive(Clone)]
pub(crate) struct Sector {
    pub(crate) nodes: Vec<u32>,
    pub(crate) orbits: Vec<f64>,
}

impl Sector {
    /// The sector of a symmetry.
    pub(crate) fn of(symmetry: &Symmetry) -> Self {
        Sector {
            nodes: symmetry.sector.clone(),
            orbits: symmetry.orbit_sizes().iter().map(|size| f64::from(*size)).collect(),
        }
    }
}

/// [`modified_hausdorff`] of two sets of equally many points that have the same symmetry: the same number from the
/// points of one sector.
pub(crate) fn symmetric_modified_hausdorff(a: &[[f64; 3]], b: &[[f64; 3]], sector: &Sector) -> f64 {
    let directed = |from: &[[f64; 3]], to: &[[f64; 3]]| {
        let axis = |d: usize| -> Vec<f64> { to.iter().map(|p| p[d]).collect() };
        let (x, y, z) = (axis(0), axis(1), axis(2));
        let mut squares = vec![0.0; to.len()];
        let distances = sector.nodes.iter().zip(&sector.orbits).map(|(node, orbit)| {
            let p = from[*node as usize];
            for (j, square) in squares.iter_mut().enumerate() {
                let (dx, dy, dz) = (x[j] - p[0], y[j] - p[1], z[j] - p[2]);
                *square = dx * dx + dy * dy + dz * dz;
            }
            orbit * least(&squares).sqrt()
        });
        distances.sum::<f64>() / from.len() as f64
    };
    directed(a, b).max(directed(b, a))
}

/// The least of non-negative numbers, by eight running minima, so that the loop vectorises.
fn least(values: &[f64]) -> f64 {
    let mut lanes = [f64::INFINITY; 8];
    let (chunks, rest) = values.as_chunks::<8>();
    for chunk in chunks {
        for (lane, s) in lanes.iter_mut().zip(chunk) {
            *lane = if *s < *lane { *s } else { *lane };
        }
    }
    let all = lanes.iter().chain(rest);
    all.fold(f64::INFINITY, |m, s| if *s < m { *s } else { m })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sector_is_enough_where_there_is_symmetry() {
        // Clouds and their mirror images in y and z.
        let cloud = |shift: f64| -> Vec<[f64; 3]> {
            let point = |i: i32| {
                let i = f64::from(i);
                [
                    (0.7 * i).sin() + shift,
                    1.2 + (1.3 * i).cos(),
                    1.1 + (2.1 * i).sin() - shift,
                ]
            };
            let signs = [[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]];
            (0..50)
                .flat_map(|i| signs.map(|[s, t]| [point(i)[0], s * point(i)[1], t * point(i)[2]]))
                .collect()
        };
        let (a, b) = (cloud(0.0), cloud(0.03));
        let sector = Sector {
            nodes: (0..50).map(|i| 4 * i).collect(),
            orbits: vec![4.0; 50],
        };
        let (whole, part) = (
            modified_hausdorff(&a, &b),
            symmetric_modified_hausdorff(&a, &b, &sector),
        );
        assert!((whole - part).abs() < 1e-12 && whole > 0.01, "{whole} {part}");
    }

    #[test]
    fn known_sets_have_known_distances() {
        let a = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
        let b = [[0.0, 3.0, 4.0], [1.0, 0.0, 0.0], [1.0, 2.0, 0.0]];
        // From a: 1 (to the shared point) and 0. From b: 5, 0, 2.
        assert_eq!(modified_hausdorff(&a, &b), 7.0 / 3.0);
        assert_eq!(modified_hausdorff(&b, &a), 7.0 / 3.0);
        assert_eq!(modified_hausdorff(&a, &a), 0.0);
        assert_eq!(modified_hausdorff(&a, &[]), f64::INFINITY);
    }

    #[test]
    fn a_small_shift_of_a_cloud_is_its_length() {
        let cloud: Vec<[f64; 3]> = (0..1000)
            .map(|i| [i % 10, i / 10 % 10, i / 100].map(f64::from))
            .collect();
        let shifted: Vec<_> = cloud.iter().map(|p| [p[0] + 0.01, p[1], p[2] - 0.02]).collect();
        let distance = modified_hausdorff(&cloud, &shifted);
        assert!((distance - 5e-4f64.sqrt()).abs() < 1e-12, "{distance}");
    }
}
