//! The distance between two shapes.

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
        // Eight running minima, so that the loop vectorises.
        let mut lanes = [f64::INFINITY; 8];
        let chunks = squares.chunks_exact(8);
        let rest = chunks.remainder();
        for chunk in chunks {
            for (lane, s) in lanes.iter_mut().zip(chunk) {
                *lane = if *s < *lane { *s } else { *lane };
            }
        }
        let least = lanes
            .iter()
            .chain(rest)
            .fold(f64::INFINITY, |m, s| if *s < m { *s } else { m });
        sum += least.sqrt();
    }
    let from_a = sum / a.len() as f64;
    let from_b = nearest.iter().map(|s| s.sqrt()).sum::<f64>() / b.len() as f64;
    from_a.max(from_b)
}

#[cfg(test)]
mod tests {
    use super::*;

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
