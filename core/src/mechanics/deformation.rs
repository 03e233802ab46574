//! Local mechanics at a node: stretches, tensions, energy and load of the neo-Hookean membrane.

use super::{determinant, metric};
use crate::Real;
use crate::error::{EvaluateError, finite};
use crate::linalg::dot;
use crate::model::apply;
use nalgebra::Vector3;

/// Derivatives of the current position at a node by the arc lengths along two orthogonal directions of the stress-free
/// sphere, from which all local quantities follow. Tensions and energies are in G_s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deformation<T> {
    /// x_,1 and x_,2.
    pub first: [[T; 3]; 2],
    /// x_,11, x_,12 and x_,22, in 1/l.
    pub second: [[T; 3]; 3],
}

impl<T: Real> Deformation<T> {
    /// Zeros, to initialise buffers.
    pub const ZERO: Self = Self {
        first: [[T::ZERO; 3]; 2],
        second: [[T::ZERO; 3]; 3],
    };

    /// The deformation at the image of the node under a symmetry operation, see
    /// [`Mesh::origin`](crate::model::Mesh::origin).
    #[must_use]
    pub fn transformed(&self, operation: u8) -> Self {
        Self {
            first: self.first.map(|vector| apply(operation, vector)),
            second: self.second.map(|vector| apply(operation, vector)),
        }
    }

    /// Area dilation J_s: current area over stress-free area.
    pub fn area_dilation(&self) -> T {
        determinant(metric(&self.first)).sqrt()
    }

    /// Principal extension ratios, lambda_1 >= lambda_2.
    pub fn stretches(&self) -> [T; 2] {
        let greatest = self.greatest_squared();
        [greatest.sqrt(), (determinant(metric(&self.first)) / greatest).sqrt()]
    }

    /// Unit vectors along the principal directions of lambda_1 and lambda_2, tangent to the current surface. Two
    /// arbitrary orthogonal directions where the stretch is isotropic.
    pub fn directions(&self) -> [[T; 3]; 2] {
        let [m11, m22, m12] = metric(&self.first);
        let half = (m11 - m22) / T::from_f32(2.0);
        let root = (half * half + m12 * m12).sqrt();
        // An eigenvector of the metric, by the row without cancellation.
        let (c, s) = if half < T::ZERO {
            (m12, root - half)
        } else {
            (half + root, m12)
        };
        let (c, s) = if root > T::ZERO { (c, s) } else { (T::ONE, T::ZERO) };
        let [first, second] = self.first.map(Vector3::from);
        let unit = |vector: Vector3<T>| (vector / dot(vector.as_slice(), vector.as_slice()).sqrt()).into();
        // Sums start at 0, so that no component is -0.
        let zero = Vector3::from([T::ZERO; 3]);
        [unit(zero + first * c + second * s), unit(zero + second * c - first * s)]
    }

    /// Principal tensions T_1 >= T_2 in G_s: T_1 = (lambda_1^2 - (lambda_1 lambda_2)^-2) / (lambda_1 lambda_2).
    pub fn tensions(&self) -> [T; 2] {
        let [greatest, least] = self.stretches();
        let area = greatest * least;
        [greatest, least].map(|stretch| (stretch * stretch - T::ONE / (area * area)) / area)
    }

    /// Elastic energy per stress-free area, in G_s: (lambda_1^2 + lambda_2^2 + (lambda_1 lambda_2)^-2 - 3) / 2.
    pub fn energy_density(&self) -> T {
        let metric = metric(&self.first);
        energy_density(metric[0] + metric[1], determinant(metric))
    }

    /// Load q of the fluid on the membrane per current area, in mu V / l: the jump of traction of eq. (8), which is
    /// minus the surface divergence of the tension over `capillary_number`.
    ///
    /// # Errors
    /// [`EvaluateError::NotFinite`].
    pub fn load(&self, capillary_number: T) -> Result<[T; 3], EvaluateError> {
        let two = T::from_f32(2.0);
        let ([x1, x2], [x11, x12, x22]) = (self.first.map(Vector3::from), self.second.map(Vector3::from));
        let metric = metric(&self.first);
        let square = determinant(metric);
        let [s11, s22, s12] = stress(metric);
        let product = |a: Vector3<T>, b: Vector3<T>| dot(a.as_slice(), b.as_slice());
        // Derivatives of the metric, and of the stress along its first index. Derivatives of the stress-free metric are
        // 0 in the coordinates of a stencil.
        let along_1 = [
            two * product(x11, x1),
            two * product(x12, x2),
            product(x11, x2) + product(x1, x12),
        ];
        let along_2 = [
            two * product(x12, x1),
            two * product(x22, x2),
            product(x12, x2) + product(x1, x22),
        ];
        let [ds11, _, ds12] = stress_rate(metric, square, along_1);
        let [_, ds22, ds21] = stress_rate(metric, square, along_2);
        // -div (S^ab x_,b) = -(S^ab_,a x_,b + S^ab x_,ab) per stress-free area.
        let zero = Vector3::from([T::ZERO; 3]);
        let sum = zero + x1 * (ds11 + ds21) + x2 * (ds12 + ds22) + x11 * s11 + x22 * s22 + x12 * (two * s12);
        let scale = -T::ONE / (square.sqrt() * capillary_number);
        finite((sum * scale).into())
    }

    /// lambda_1^2, the greater eigenvalue of the metric.
    fn greatest_squared(&self) -> T {
        let two = T::from_f32(2.0);
        let [m11, m22, m12] = metric(&self.first);
        let half = (m11 - m22) / two;
        (m11 + m22) / two + (half * half + m12 * m12).sqrt()
    }
}

/// Energy per stress-free area from the first invariant of the metric and its determinant.
pub(super) fn energy_density<T: Real>(trace: T, determinant: T) -> T {
    T::from_f32(0.5) * (trace + T::ONE / determinant - T::from_f32(3.0))
}

/// Second Piola-Kirchhoff tension S = I - C^-1 / det C (eq. (9), referred to the stress-free state): components 11, 22,
/// 12.
fn stress<T: Real>(metric: [T; 3]) -> [T; 3] {
    let [m11, m22, m12] = metric;
    let square = determinant(metric);
    let scale = T::ONE / (square * square);
    [T::ONE - scale * m22, T::ONE - scale * m11, scale * m12]
}

/// Derivative of [`stress`] for the derivative `rate` of the metric.
fn stress_rate<T: Real>(metric: [T; 3], square: T, rate: [T; 3]) -> [T; 3] {
    let two = T::from_f32(2.0);
    let [m11, m22, m12] = metric;
    let [r11, r22, r12] = rate;
    let scale = T::ONE / (square * square);
    let decline = two * (r11 * m22 + m11 * r22 - two * m12 * r12) / square;
    [
        scale * (decline * m22 - r22),
        scale * (decline * m11 - r11),
        scale * (r12 - decline * m12),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stretched(lambda: [f64; 2]) -> Deformation<f64> {
        // Principal directions at 30 degrees to those of the reference, rotated in space.
        let (s, c) = (0.5, 0.75_f64.sqrt());
        let [along, across] = [[0.6, 0.0, 0.8], [0.0, 1.0, 0.0]].map(Vector3::from);
        let first = [[c, s], [-s, c]].map(|[a, b]| (along * (a * lambda[0]) + across * (b * lambda[1])).into());
        Deformation {
            first,
            second: [[0.0; 3]; 3],
        }
    }

    #[test]
    fn principal_values_and_directions() {
        let deformation = stretched([1.4, 0.8]);
        let [one, two] = deformation.stretches();
        assert!((one - 1.4).abs() < 1e-14 && (two - 0.8).abs() < 1e-14);
        assert!((deformation.area_dilation() - 1.12).abs() < 1e-14);
        let [along, across] = deformation.directions();
        assert!((along[0] * 0.6 + along[2] * 0.8).abs() > 1.0 - 1e-14);
        assert!(across[1].abs() > 1.0 - 1e-14);
        // The greater stretch comes first.
        let [along, _] = stretched([0.8, 1.4]).directions();
        assert!(along[1].abs() > 1.0 - 1e-14);
    }

    #[test]
    fn uniaxial_tension() {
        for stretch in [1.3, 2.0_f64] {
            let deformation = stretched([stretch, stretch.powf(-0.5)]);
            let [one, two] = deformation.tensions();
            assert!((one - (stretch.powf(1.5) - stretch.powf(-1.5))).abs() < 1e-13);
            assert!(two.abs() < 1e-13);
            let energy = 0.5 * (stretch * stretch + 2.0 / stretch - 3.0);
            assert!((deformation.energy_density() - energy).abs() < 1e-13);
        }
    }

    #[test]
    fn tension_is_the_energy_s_derivative() {
        let (a, b, step) = (1.3, 0.9, 1e-5);
        let energy = |a, b| stretched([a, b]).energy_density();
        let [one, two] = stretched([a, b]).tensions();
        assert!((one - (energy(a + step, b) - energy(a - step, b)) / (2.0 * step * b)).abs() < 1e-9);
        assert!((two - (energy(a, b + step) - energy(a, b - step)) / (2.0 * step * a)).abs() < 1e-9);
    }

    #[test]
    fn isotropic_stretch_has_directions() {
        let deformation = Deformation {
            first: [[1.2_f32, 0.0, 0.0], [0.0, 1.2, 0.0]],
            second: [[0.0; 3]; 3],
        };
        assert_eq!(deformation.directions(), [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    }
}
