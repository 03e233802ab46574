//! Quadratic shape functions of the six-node triangle and the quadrature rule that integrates them.
//!
//! The reference triangle has corners (0, 0), (1, 0), (0, 1); node order as in [`crate::Mesh`].

use nalgebra::Vector3;

use crate::vectors::norm;

/// A quadrature point with everything that the element integrals need there.
#[derive(Debug, Clone, Copy)]
pub struct Point {
    /// Weight; the weights of a rule sum to the area of the reference triangle, 1/2.
    pub weight: f64,
    /// Values of the six shape functions.
    pub value: [f64; 6],
    /// Their derivatives with respect to the two reference coordinates.
    pub gradient: [[f64; 6]; 2],
}

impl Point {
    pub(crate) fn at(xi: f64, eta: f64, weight: f64) -> Self {
        let zeta = 1.0 - xi - eta;
        Self {
            weight,
            value: values([xi, eta]),
            gradient: [
                [
                    1.0 - 4.0 * zeta,
                    4.0 * xi - 1.0,
                    0.0,
                    4.0 * (zeta - xi),
                    4.0 * eta,
                    -4.0 * eta,
                ],
                [
                    1.0 - 4.0 * zeta,
                    0.0,
                    4.0 * eta - 1.0,
                    -4.0 * xi,
                    4.0 * xi,
                    4.0 * (zeta - eta),
                ],
            ],
        }
    }

    /// The two tangents `x_,1` and `x_,2` of the element with these nodes.
    pub fn tangents(&self, nodes: &[Vector3<f64>; 6]) -> [Vector3<f64>; 2] {
        self.gradient.map(|derivative| combine(&derivative, nodes))
    }

    /// The cross product of the two tangents: a normal.
    pub fn normal(&self, nodes: &[Vector3<f64>; 6]) -> Vector3<f64> {
        let [t1, t2] = self.tangents(nodes);
        t1.cross(&t2)
    }

    /// The area per area of the reference triangle.
    pub fn area(&self, nodes: &[Vector3<f64>; 6]) -> f64 {
        norm(self.normal(nodes))
    }

    /// The position in the element with these nodes, or the value of another field with these nodal values.
    pub fn interpolate(&self, nodes: &[Vector3<f64>; 6]) -> Vector3<f64> {
        combine(&self.value, nodes)
    }

    /// The points at the element's own nodes (weight 0).
    pub fn at_nodes() -> [Self; 6] {
        [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.5, 0.0), (0.5, 0.5), (0.0, 0.5)].map(|(xi, eta)| Self::at(xi, eta, 0.0))
    }
}

/// The shape functions at a point of the reference triangle.
pub fn values([xi, eta]: [f64; 2]) -> [f64; 6] {
    let zeta = 1.0 - xi - eta;
    [
        zeta * (2.0 * zeta - 1.0),
        xi * (2.0 * xi - 1.0),
        eta * (2.0 * eta - 1.0),
        4.0 * zeta * xi,
        4.0 * xi * eta,
        4.0 * eta * zeta,
    ]
}

/// The values of a field, such as the position, at the nodes of an element.
pub fn nodes_of(element: &[u32; 6], field: &[[f64; 3]]) -> [Vector3<f64>; 6] {
    element.map(|node| field[node as usize].into())
}

fn combine(coefficients: &[f64; 6], nodes: &[Vector3<f64>; 6]) -> Vector3<f64> {
    coefficients.iter().zip(nodes).map(|(c, node)| *c * node).sum()
}

/// The 12-point rule of degree 6 (Dunavant, Int. J. Numer. Methods Eng. 21, 1985): exact for volume and first moment
/// of a six-node surface.
pub fn quadrature() -> [Point; 12] {
    const A: (f64, f64) = (0.249_286_745_170_910, 0.116_786_275_726_379);
    const B: (f64, f64) = (0.063_089_014_491_502, 0.050_844_906_370_207);
    const C: (f64, f64, f64) = (0.310_352_451_033_785, 0.053_145_049_844_816, 0.082_851_075_618_374);
    let ((a, wa), (b, wb), (c, d, wc)) = (A, B, C);
    let e = 1.0 - c - d;
    [
        (a, a, wa),
        (1.0 - 2.0 * a, a, wa),
        (a, 1.0 - 2.0 * a, wa),
        (b, b, wb),
        (1.0 - 2.0 * b, b, wb),
        (b, 1.0 - 2.0 * b, wb),
        (c, d, wc),
        (d, c, wc),
        (c, e, wc),
        (e, c, wc),
        (d, e, wc),
        (e, d, wc),
    ]
    .map(|(xi, eta, weight)| Point::at(xi, eta, 0.5 * weight))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rule_is_exact_to_degree_six() {
        // The integral of xi^p eta^q over the reference triangle is p! q! / (p + q + 2)!.
        let factorial = |n: i32| (1..=n).map(f64::from).product::<f64>();
        for p in 0..=6 {
            for q in 0..=6 - p {
                let sum: f64 = quadrature()
                    .iter()
                    .map(|point| {
                        // Coordinates by interpolation of the nodes' own.
                        let xi = point.value[1] + 0.5 * (point.value[3] + point.value[4]);
                        let eta = point.value[2] + 0.5 * (point.value[4] + point.value[5]);
                        point.weight * xi.powi(p) * eta.powi(q)
                    })
                    .sum();
                assert!(
                    (sum - factorial(p) * factorial(q) / factorial(p + q + 2)).abs() < 1e-15,
                    "{p} {q}"
                );
            }
        }
    }

    #[test]
    fn shape_functions_are_nodal_and_sum_to_one() {
        for (i, point) in Point::at_nodes().iter().enumerate() {
            for j in 0..6 {
                assert_eq!(point.value[j], if i == j { 1.0 } else { 0.0 });
            }
        }
        for point in quadrature() {
            assert!((point.value.iter().sum::<f64>() - 1.0).abs() < 1e-15);
            assert!(point.gradient.iter().all(|g| g.iter().sum::<f64>().abs() < 1e-14));
        }
    }

    #[test]
    fn gradients_are_the_derivatives_of_the_values() {
        let (xi, eta, step) = (0.23, 0.41, 1e-5);
        let gradient = Point::at(xi, eta, 0.0).gradient;
        for j in 0..6 {
            let along_xi =
                (Point::at(xi + step, eta, 0.0).value[j] - Point::at(xi - step, eta, 0.0).value[j]) / step / 2.0;
            let along_eta =
                (Point::at(xi, eta + step, 0.0).value[j] - Point::at(xi, eta - step, 0.0).value[j]) / step / 2.0;
            assert!((gradient[0][j] - along_xi).abs() < 1e-9 && (gradient[1][j] - along_eta).abs() < 1e-9);
        }
    }
}
