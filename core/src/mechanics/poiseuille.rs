//! The undisturbed flow in the channel.

use crate::Real;

/// Pressure gradient -dp/dx of the undisturbed flow, in mu V / l^2.
const GRADIENT: f64 = 7.113_538_442_387_346;

/// Coefficients c_k of the harmonic part, see [`undisturbed_velocity`].
const COEFFICIENTS: [f64; 11] = [
    -1.460_513_206_510_682_5,
    -0.324_323_944_411_601_7,
    6.843_840_443_409_22e-3,
    -4.288_771_165_394e-4,
    4.211_780_789_9e-5,
    -5.172_493_401e-6,
    7.283_399_25e-7,
    -1.124_968_45e-7,
    1.857_634_8e-8,
    -3.226_335e-9,
    5.786_5e-10,
];

/// Axial velocity of the undisturbed flow at (y, z), in V: `G/4 (2 - y^2 - z^2) + sum c_k Re (y + iz)^4k`.
///
/// The sum is the harmonic function that makes the velocity vanish on the walls, y = +-1 and z = +-1; powers 4k have
/// the symmetry of the square. Its error is below 1e-8 where y^2 + z^2 < 1, 1e-5 at y = z = 0.9, and grows to 3e-3 in
/// the corners.
///
/// ```
/// use capsule_core::mechanics::undisturbed_velocity;
///
/// let on_the_axis: f64 = undisturbed_velocity(0.0, 0.0);
/// assert!((on_the_axis - 2.0963).abs() < 1e-4);
/// ```
pub fn undisturbed_velocity<T: Real>(y: T, z: T) -> T {
    let two = T::from_f32(2.0);
    let (square, product) = (y * y - z * z, two * y * z);
    let (w, w_i) = (square * square - product * product, two * square * product);
    // Horner's rule from the highest power down.
    let (mut sum, mut sum_i) = (T::ZERO, T::ZERO);
    for coefficient in COEFFICIENTS.iter().rev() {
        (sum, sum_i) = (sum * w - sum_i * w_i + T::from_f64(*coefficient), sum * w_i + sum_i * w);
    }
    T::from_f64(0.25 * GRADIENT) * (two - y * y - z * z) + sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_cosine_series() {
        // Eq. (3) of the paper for the channel of side 2 l, summed to convergence.
        for (y, z, exact, tolerance) in [
            (0.0, 0.0, 2.096_256_014_68, 1e-8),
            (0.25, 0.0, 1.983_840_16, 1e-7),
            (0.5, 0.0, 1.631_416_22, 1e-7),
            (0.9, 0.0, 0.445_807_66, 1e-7),
            (0.25, 0.25, 1.879_027_14, 1e-7),
            (0.5, 0.5, 1.288_579_27, 1e-7),
            (0.75, 0.75, 0.518_006_31, 1e-6),
            (0.9, 0.9, 0.124_372_76, 2e-5),
        ] {
            for (y, z) in [(y, z), (-z, y), (z, -y)] {
                let found: f64 = undisturbed_velocity(y, z);
                assert!((found - exact).abs() < tolerance, "({y}, {z}): {found} {exact}");
                assert!((f64::from(undisturbed_velocity(y as f32, z as f32)) - found).abs() < 3e-6);
            }
        }
    }

    #[test]
    fn vanishes_on_the_walls() {
        for z in [0.0, 0.2, 0.4, 0.6] {
            assert!(undisturbed_velocity::<f64>(1.0, z).abs() < 1e-6, "{z}");
        }
    }
}
