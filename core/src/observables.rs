//! Scalars that describe the capsule at an instant.

use crate::Real;
use crate::error::EvaluateError;
use crate::model::Model;
use crate::model::{DIAGONAL, MIDPLANE, Mesh};
use crate::reconstruct::Snapshot;

/// Scalars of an instant, lengths in l, velocity in V; the lengths from the two section outlines. Extremes are those
/// of the parabola through the extreme node of an outline and its two neighbours, the nodes taken as equidistant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observables<T> {
    /// max x - min x over both outlines.
    pub axial_length: T,
    /// max |y| in the plane z = 0.
    pub half_width: T,
    /// max sqrt(y^2 + z^2) in the plane y = z.
    pub half_diagonal: T,
    /// x of the rear pole on the axis - min x over both outlines, >= 0: the depth of the parachute.
    pub rear_depth: T,
    /// Axial velocity of the volume centroid.
    pub velocity: T,
    /// Axial position of the volume centroid in the laboratory frame.
    pub centroid: T,
}

/// Extremes of the two outlines.
pub(crate) struct Extremes<T> {
    pub(crate) front: T,
    pub(crate) rear: T,
    pub(crate) rear_pole: T,
    pub(crate) half_width: T,
    pub(crate) half_diagonal: T,
}

impl<T: Real> Extremes<T> {
    /// Reconstructs the nodes of the outlines, one at a time.
    pub(crate) fn new(model: &Model<'_>, snapshot: &Snapshot<'_, '_, T>) -> Result<Self, EvaluateError> {
        let midplane = Outline::new(model, snapshot, MIDPLANE)?;
        let diagonal = Outline::new(model, snapshot, DIAGONAL)?;
        Ok(Self {
            front: midplane.front.value().max(diagonal.front.value()),
            rear: -midplane.rear.value().max(diagonal.rear.value()),
            rear_pole: midplane.rear_pole,
            half_width: midplane.width.value(),
            half_diagonal: diagonal.width.value(),
        })
    }
}

struct Outline<T> {
    front: Greatest<T>,
    rear: Greatest<T>,
    width: Greatest<T>,
    rear_pole: T,
}

impl<T: Real> Outline<T> {
    fn new(model: &Model<'_>, snapshot: &Snapshot<'_, '_, T>, name: &str) -> Result<Self, EvaluateError> {
        let nodes = model.node_set(name).ok_or(EvaluateError::UnknownNodeSet)?;
        let mut outline = Self {
            front: Greatest::NONE,
            rear: Greatest::NONE,
            width: Greatest::NONE,
            rear_pole: T::ZERO,
        };
        for node in nodes.iter() {
            let [x, r] = axial_radial(snapshot.node(node)?);
            outline.front.push(x);
            outline.rear.push(-x);
            outline.width.push(r);
            outline.rear_pole = x;
        }
        Ok(outline)
    }
}

/// A point as [x, r].
pub(crate) fn axial_radial<T: Real>([x, y, z]: [T; 3]) -> [T; 2] {
    [x, (y * y + z * z).sqrt()]
}

/// The greatest of a sequence of values, with its two neighbours. Beyond its ends, which are the poles, an outline
/// goes on as its mirror image, so that a neighbour is missing at an end only, where the parabola's vertex is the node.
struct Greatest<T> {
    last: [Option<T>; 2],
    before: Option<T>,
    greatest: Option<T>,
    after: Option<T>,
}

impl<T: Real> Greatest<T> {
    const NONE: Self = Self {
        last: [None; 2],
        before: None,
        greatest: None,
        after: None,
    };

    fn push(&mut self, value: T) {
        let [previous, _] = self.last;
        if self.greatest.is_none_or(|greatest| value > greatest) {
            (self.before, self.greatest, self.after) = (previous, Some(value), None);
        } else if self.after.is_none() && previous == self.greatest {
            self.after = Some(value);
        }
        self.last = [Some(value), previous];
    }

    /// The vertex of the parabola.
    fn value(&self) -> T {
        let greatest = self.greatest.unwrap_or(T::ZERO);
        let (Some(before), Some(after)) = (self.before, self.after) else {
            return greatest;
        };
        let curvature = greatest + greatest - before - after;
        let slope = after - before;
        let eight = T::from_f32(8.0);
        if curvature > T::ZERO {
            greatest + slope * slope / (eight * curvature)
        } else {
            greatest
        }
    }
}

/// Points (three barycentric weights each) and weight of the quadrature of degree 4 with six points (Dunavant, 1985),
/// for the unit triangle of area 1/2.
const QUADRATURE: [(f64, f64); 2] = [
    (0.445_948_490_915_965, 0.111_690_794_839_005_5),
    (0.091_576_213_509_771, 0.054_975_871_827_661),
];

/// Volume within a closed P2 surface, exactly: the integral of x n_x, of degree 4 on each element. Where the mesh is
/// symmetric to y = 0 and z = 0, a quarter of it is enough.
pub(crate) fn volume<T: Real>(snapshot: &Snapshot<'_, '_, T>) -> Result<T, EvaluateError> {
    let mesh = &snapshot.mesh;
    let quarter = |element: &[u16; 6]| element.iter().all(|&node| in_quarter(mesh, node.into()));
    let symmetric = 4 * mesh.elements().filter(quarter).count() == mesh.elements().len()
        && (0..mesh.nodes()).all(|node| mirrored_from_quarter(mesh, node));
    let mut volume = T::ZERO;
    for element in mesh.elements().filter(|element| !symmetric || quarter(element)) {
        let mut nodes = [[T::ZERO; 3]; 6];
        for (node, index) in nodes.iter_mut().zip(element) {
            *node = snapshot.node(index.into())?;
        }
        volume += element_volume(&nodes);
    }
    let volume = if symmetric { T::from_f32(4.0) * volume } else { volume };
    if volume.is_finite() {
        Ok(volume)
    } else {
        Err(EvaluateError::NotFinite)
    }
}

/// Whether a node's reference position has y >= 0 and z >= 0.
fn in_quarter(mesh: &Mesh<'_>, node: usize) -> bool {
    const ON_PLANE: f32 = 1e-6;
    mesh.reference(node)
        .is_some_and(|[_, y, z]| y >= -ON_PLANE && z >= -ON_PLANE)
}

/// Whether a node that is not in the quarter takes its value from a node that is.
fn mirrored_from_quarter(mesh: &Mesh<'_>, node: usize) -> bool {
    let sector_node = mesh.origin(node).and_then(|(index, _)| mesh.sector_nodes().get(index));
    in_quarter(mesh, node) || sector_node.is_some_and(|sector_node| in_quarter(mesh, sector_node))
}

/// Integral of x n_x over a P2 triangle.
fn element_volume<T: Real>(nodes: &[[T; 3]; 6]) -> T {
    let [one, two, four] = [T::ONE, T::from_f32(2.0), T::from_f32(4.0)];
    let mut sum = T::ZERO;
    for (a, weight) in QUADRATURE {
        let (a, b) = (T::from_f64(a), T::from_f64(1.0 - 2.0 * a));
        for l in [[b, a, a], [a, b, a], [a, a, b]] {
            let [l0, l1, l2] = l;
            let shape = [
                l0 * (two * l0 - one),
                l1 * (two * l1 - one),
                l2 * (two * l2 - one),
                four * l0 * l1,
                four * l1 * l2,
                four * l2 * l0,
            ];
            // Derivatives by l1 and l2, with l0 = 1 - l1 - l2.
            let by_l1 = [
                one - four * l0,
                four * l1 - one,
                T::ZERO,
                four * (l0 - l1),
                four * l2,
                -four * l2,
            ];
            let by_l2 = [
                one - four * l0,
                T::ZERO,
                four * l2 - one,
                -four * l1,
                four * l1,
                four * (l0 - l2),
            ];
            let at = |weights: &[T; 6], axis: usize| (0..6).map(|i| weights[i] * nodes[i][axis]).sum::<T>();
            let normal_x = at(&by_l1, 1) * at(&by_l2, 2) - at(&by_l1, 2) * at(&by_l2, 1);
            sum += T::from_f64(weight) * at(&shape, 0) * normal_x;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parabola_s_vertex() {
        let vertex = |values: &[f64]| {
            let mut greatest = Greatest::NONE;
            values.iter().for_each(|&value| greatest.push(value));
            greatest.value()
        };
        let parabola = |i: f64| 3.0 - (i - 1.2) * (i - 1.2);
        assert!((vertex(&[0.0, 1.0, 2.0, 3.0].map(parabola)) - 3.0).abs() < 1e-15);
        assert_eq!(vertex(&[5.0, 4.0, 1.0]), 5.0);
        assert_eq!(vertex(&[1.0, 4.0, 5.0]), 5.0);
    }

    #[test]
    fn volume_of_curved_elements() {
        // A flat triangle and the same one bulging: x of the mid-edges raised.
        let flat = [
            [2.0, 0.0, 0.0],
            [2.0, 1.0, 0.0],
            [2.0, 0.0, 1.0],
            [2.0, 0.5, 0.0],
            [2.0, 0.5, 0.5],
            [2.0, 0.0, 0.5],
        ];
        assert!((element_volume::<f64>(&flat) - 1.0).abs() < 1e-14);
        let mut bulging = flat;
        bulging[4][0] = 2.3;
        // The mid-edge shape function has the integral 1/6 over the unit triangle.
        assert!((element_volume::<f64>(&bulging) - (1.0 + 0.3 / 6.0)).abs() < 1e-14);
    }
}
