//! Lengths, metrics and greatest magnitudes.

use nalgebra::Vector3;

/// The greatest absolute value, or NaN if there is one (which `f64::max` would lose).
pub fn greatest_magnitude(values: impl Iterator<Item = f64>) -> f64 {
    values.map(f64::abs).fold(0.0, |greatest, value| {
        if greatest >= value || greatest.is_nan() {
            greatest
        } else {
            value
        }
    })
}

/// The length of a vector. nalgebra has this with its features `std` or `libm` alone, which put 18 versions of glam in
/// Cargo.lock.
pub fn norm(vector: Vector3<f64>) -> f64 {
    vector.dot(&vector).sqrt()
}

/// The metric of a surface with two tangents, components 11, 22 and 12, and its determinant.
pub(crate) fn metric([t1, t2]: [Vector3<f64>; 2]) -> ([f64; 3], f64) {
    let [m11, m22, m12] = [t1.dot(&t1), t2.dot(&t2), t1.dot(&t2)];
    ([m11, m22, m12], m11 * m22 - m12 * m12)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_greatest_magnitude_keeps_nan() {
        assert_eq!(greatest_magnitude([1.0, -3.0, 2.0].into_iter()), 3.0);
        assert!(greatest_magnitude([1.0, f64::NAN, 2.0].into_iter()).is_nan());
    }
}
