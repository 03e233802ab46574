//! Integrals over the elements of the surface.

use crate::Real;
use crate::error::{EvaluateError, finite};
use crate::model::{Mesh, apply};

/// Quadrature of degree 4 with six points (Dunavant, 1985), in two orbits of three: the barycentric coordinate that two
/// of three share, the third one, and the weight for the unit triangle of area 1/2.
const QUADRATURE: [[f64; 3]; 2] = [
    [
        0.445_948_490_915_965,
        1.0 - 2.0 * 0.445_948_490_915_965,
        0.111_690_794_839_005_5,
    ],
    [
        0.091_576_213_509_771,
        1.0 - 2.0 * 0.091_576_213_509_771,
        0.054_975_871_827_661,
    ],
];

/// A quadrature point of an element.
pub(crate) struct Point<T> {
    pub(crate) weight: T,
    /// Shape functions of the six nodes; 0 for the missing mid-edge nodes of a flat triangle.
    pub(crate) shape: [T; 6],
    /// Their derivatives by the barycentric coordinates l1 and l2, with l0 = 1 - l1 - l2.
    pub(crate) gradient: [[T; 6]; 2],
}

impl<T: Real> Point<T> {
    pub(crate) fn new(weight: f64, [l0, l1, l2]: [T; 3]) -> Self {
        let [one, two, four] = [T::ONE, T::from_f32(2.0), T::from_f32(4.0)];
        Self {
            weight: T::from_f64(weight),
            shape: [
                l0 * (two * l0 - one),
                l1 * (two * l1 - one),
                l2 * (two * l2 - one),
                four * l0 * l1,
                four * l1 * l2,
                four * l2 * l0,
            ],
            gradient: [
                [
                    one - four * l0,
                    four * l1 - one,
                    T::ZERO,
                    four * (l0 - l1),
                    four * l2,
                    -four * l2,
                ],
                [
                    one - four * l0,
                    T::ZERO,
                    four * l2 - one,
                    -four * l1,
                    four * l1,
                    four * (l0 - l2),
                ],
            ],
        }
    }

    /// The point with the shape functions of a flat triangle.
    pub(crate) fn flat(self) -> Self {
        let [zero, one] = [T::ZERO, T::ONE];
        let [a, b, c, ab, bc, ca] = self.shape;
        let half = T::from_f32(0.5);
        Self {
            weight: self.weight,
            shape: [
                a + half * (ab + ca),
                b + half * (ab + bc),
                c + half * (bc + ca),
                zero,
                zero,
                zero,
            ],
            gradient: [[-one, one, zero, zero, zero, zero], [-one, zero, one, zero, zero, zero]],
        }
    }

    /// All points of a quadratic element, or of a flat triangle.
    fn all(flat: bool) -> [Self; 6] {
        let [first, second] = QUADRATURE;
        core::array::from_fn(|index| {
            let [two, third, weight] = if index < 3 { first } else { second };
            let mut weights = [T::from_f64(two); 3];
            if let Some(weight) = weights.get_mut(index % 3) {
                *weight = T::from_f64(third);
            }
            let point = Self::new(weight, weights);
            if flat { point.flat() } else { point }
        })
    }

    /// Derivatives of a field given at the six nodes: for positions the two tangents.
    pub(crate) fn derivatives<const W: usize>(&self, nodes: &[[T; W]; 6]) -> [[T; W]; 2] {
        let mut derivatives = [[T::ZERO; W]; 2];
        for (derivative, gradient) in derivatives.iter_mut().zip(&self.gradient) {
            for (axis, out) in derivative.iter_mut().enumerate() {
                *out = combine(gradient, |i| nodes[i][axis]);
            }
        }
        derivatives
    }
}

/// sum_i weights_i values_i.
fn combine<T: Real>(weights: &[T; 6], value: impl Fn(usize) -> T) -> T {
    (0..6).map(|i| weights[i] * value(i)).sum()
}

/// Integrals over the surface: sums of `weight * integrand` over the elements and their quadrature points. `node` gives
/// `W` values at a node; the integrand receives those of the element's six nodes.
///
/// # Errors
/// Those of `node`; [`EvaluateError::NotFinite`].
pub(crate) fn integrate<T: Real, const W: usize, const R: usize>(
    mesh: &Mesh<'_>,
    node: impl Fn(usize) -> Result<[T; W], EvaluateError>,
    integrand: impl Fn(&Point<T>, &[[T; W]; 6]) -> [T; R],
) -> Result<[T; R], EvaluateError> {
    let mut sums = [T::ZERO; R];
    let share = visit(mesh, &mut |element, points| {
        let mut nodes = [[T::ZERO; W]; 6];
        for (values, index) in nodes.iter_mut().zip(&element) {
            *values = node((*index).into())?;
        }
        let mut own = [T::ZERO; R];
        for point in points {
            for (own, value) in own.iter_mut().zip(&integrand(point, &nodes)) {
                *own += point.weight * *value;
            }
        }
        sums.iter_mut().zip(&own).for_each(|(sum, own)| *sum += *own);
        Ok(())
    })?;
    sums.iter_mut().for_each(|sum| *sum *= share);
    finite(sums)
}

/// Function of an element's nodes and quadrature points.
type Visit<'v, T> = dyn FnMut([u16; 6], &[Point<T>; 6]) -> Result<(), EvaluateError> + 'v;

/// Visits the elements, or those of a quarter where the mesh is symmetric to y = 0 and z = 0. Returns the ratio of the
/// whole surface to the visited part, 1 or 4.
fn visit<T: Real>(mesh: &Mesh<'_>, visit: &mut Visit<'_, T>) -> Result<T, EvaluateError> {
    let points = Point::all(mesh.element_nodes() == 3);
    let quarter = |element: &[u16; 6]| element.iter().all(|&node| in_quarter(mesh, node.into()));
    let elements = mesh.elements();
    let symmetric = 4 * elements.clone().filter(quarter).count() == elements.len()
        && (0..mesh.nodes()).all(|node| mirrored_from_quarter(mesh, node));
    for element in elements {
        if !symmetric || quarter(&element) {
            visit(element, &points)?;
        }
    }
    Ok(if symmetric { T::from_f32(4.0) } else { T::ONE })
}

/// Whether a node's reference position has y >= 0 and z >= 0.
fn in_quarter(mesh: &Mesh<'_>, node: usize) -> bool {
    const ON_PLANE: f32 = 1e-6;
    mesh.origin(node).is_some_and(|(sector_node, operation)| {
        let [_, y, z] = apply(operation, mesh.sector_reference(sector_node));
        y >= -ON_PLANE && z >= -ON_PLANE
    })
}

/// Whether a node lies in the quarter, or is the image of a sector node that does.
fn mirrored_from_quarter(mesh: &Mesh<'_>, node: usize) -> bool {
    let sector_node = mesh.origin(node).and_then(|(index, _)| mesh.sector_nodes().get(index));
    in_quarter(mesh, node) || sector_node.is_some_and(|sector_node| in_quarter(mesh, sector_node))
}

/// Volume within a closed surface. The quadrature is exact: the integrand x n_x has degree 4 on each element.
///
/// # Errors
/// Those of `node`; [`EvaluateError::NotFinite`].
pub(crate) fn volume<T: Real>(
    mesh: &Mesh<'_>,
    node: impl Fn(usize) -> Result<[T; 3], EvaluateError>,
) -> Result<T, EvaluateError> {
    let [volume] = integrate(mesh, node, |point, nodes| [volume_density(point, nodes)])?;
    Ok(volume)
}

fn volume_density<T: Real>(point: &Point<T>, nodes: &[[T; 3]; 6]) -> T {
    let [a, b] = point.derivatives(nodes);
    combine(&point.shape, |i| nodes[i][0]) * (a[1] * b[2] - a[2] * b[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn volume_of_curved_elements() {
        let volume = |nodes: &[[f64; 3]; 6]| -> f64 {
            Point::all(false)
                .iter()
                .map(|point| point.weight * volume_density(point, nodes))
                .sum()
        };
        // A flat triangle and the same one bulging: x of the mid-edges raised.
        let flat = [
            [2.0, 0.0, 0.0],
            [2.0, 1.0, 0.0],
            [2.0, 0.0, 1.0],
            [2.0, 0.5, 0.0],
            [2.0, 0.5, 0.5],
            [2.0, 0.0, 0.5],
        ];
        assert!((volume(&flat) - 1.0).abs() < 1e-14);
        let mut bulging = flat;
        bulging[4][0] = 2.3;
        // The mid-edge shape function has the integral 1/6 over the unit triangle.
        assert!((volume(&bulging) - (1.0 + 0.3 / 6.0)).abs() < 1e-14);
    }
}
