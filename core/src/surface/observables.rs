//! Lengths and velocity of the capsule at an instant.

use crate::Real;
use crate::error::{EvaluateError, finite};
use crate::model::{DIAGONAL, Indices, MIDPLANE, Model};
use crate::surface::reconstruct::{Plane, Snapshot};

/// Scalars of an instant, lengths in l, velocity in V (or the model's units). The lengths are those of the two
/// outlines; an extreme is the vertex of the parabola through the extreme node of an outline and its two neighbours,
/// taken as equidistant. For a model without outlines they are the extents of all nodes: half the extent along y is the
/// half width, half the extent along the direction y = z the half diagonal, and the rear pole is the point where the
/// parallel to the axis through the middle of the extents enters the surface.
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

/// The lengths of [`Observables`].
pub(crate) struct Lengths<T> {
    pub(crate) axial_length: T,
    pub(crate) rear_depth: T,
    pub(crate) half_width: T,
    pub(crate) half_diagonal: T,
}

impl<T: Real> Lengths<T> {
    /// Reconstructs the nodes of the outlines, or all nodes, one at a time.
    #[inline(never)]
    pub(crate) fn new(model: &Model<'_>, snapshot: &Snapshot<'_, '_, T>) -> Result<Self, EvaluateError> {
        let (Some(midplane), Some(diagonal)) = (model.node_set(MIDPLANE), model.node_set(DIAGONAL)) else {
            return Self::of_all(snapshot);
        };
        let midplane = Outline::new(midplane, Plane::Mirror, snapshot)?;
        let diagonal = Outline::new(diagonal, Plane::Diagonal, snapshot)?;
        let [front, back, half_width] = midplane.extremes();
        let [other_front, other_back, half_diagonal] = diagonal.extremes();
        let axial = [front.max(other_front), -back.max(other_back), midplane.rear_pole];
        Self::between(axial, half_width, half_diagonal)
    }

    /// Lengths from the greatest x, the least x and the x of the rear pole. Differences of finite numbers may overflow.
    #[inline(never)]
    fn between([front, rear, rear_pole]: [T; 3], half_width: T, half_diagonal: T) -> Result<Self, EvaluateError> {
        let (axial_length, rear_depth) = (front - rear, rear_pole - rear);
        let [axial_length, rear_depth, half_width, half_diagonal] =
            finite([axial_length, rear_depth, half_width, half_diagonal])?;
        Ok(Self {
            axial_length,
            rear_depth,
            half_width,
            half_diagonal,
        })
    }

    /// Lengths of a mesh without outlines, from all its nodes.
    #[inline(never)]
    fn of_all(snapshot: &Snapshot<'_, '_, T>) -> Result<Self, EvaluateError> {
        let mesh = &snapshot.mesh;
        let half = T::from_f32(0.5);
        // Along x, y, z and (y + z) / sqrt 2.
        let infinity = T::from_f32(f32::INFINITY);
        let mut extents = [[infinity, -infinity]; 4];
        for node in 0..mesh.nodes() {
            let [x, y, z] = snapshot.node(node)?;
            for ([least, greatest], value) in extents.iter_mut().zip(&[x, y, z, (y + z) * half.sqrt()]) {
                (*least, *greatest) = (least.min(*value), greatest.max(*value));
            }
        }
        let [[rear, front], y, z, diagonal] = extents;
        let middle = |[least, greatest]: [T; 2]| half * (least + greatest);
        let axis = [middle(y), middle(z)];
        let mut rear_pole = infinity;
        for element in mesh.elements() {
            for part in mesh.flat_parts() {
                let mut corners = [[T::ZERO; 3]; 3];
                for (corner, index) in corners.iter_mut().zip(part) {
                    // The index is below 6, which the compiler does not know: no panic is linked.
                    *corner = snapshot.node(element.get(*index).copied().unwrap_or_default().into())?;
                }
                rear_pole = rear_pole.min(axial_crossing(corners, axis));
            }
        }
        let half_extent = |[least, greatest]: [T; 2]| half * (greatest - least);
        let rear_pole = if rear_pole < infinity { rear_pole } else { rear };
        Self::between([front, rear, rear_pole], half_extent(y), half_extent(diagonal))
    }
}

/// x at which the parallel to the axis through (y, z) meets a flat triangle; infinity where it does not.
fn axial_crossing<T: Real>(corners: [[T; 3]; 3], [y, z]: [T; 2]) -> T {
    let [[xa, ya, za], [xb, yb, zb], [xc, yc, zc]] = corners;
    let double_area = |[p, q]: [T; 2], [r, s]: [T; 2], [t, u]: [T; 2]| (r - p) * (u - q) - (t - p) * (s - q);
    let (point, a, b, c) = ([y, z], [ya, za], [yb, zb], [yc, zc]);
    let of_a = double_area(point, b, c);
    let of_b = double_area(a, point, c);
    let of_c = double_area(a, b, point);
    let whole = of_a + of_b + of_c;
    let x = (of_a * xa + of_b * xb + of_c * xc) / whole;
    // Inside, all partial areas have the sign of the whole.
    let inside = of_a * whole >= T::ZERO && of_b * whole >= T::ZERO && of_c * whole >= T::ZERO;
    if inside && x.is_finite() {
        x
    } else {
        T::from_f32(f32::INFINITY)
    }
}

/// Maxima along an outline: of x, -x and r; and the x of its end.
struct Outline<T> {
    maxima: [Maximum<T>; 3],
    rear_pole: T,
}

impl<T: Real> Outline<T> {
    fn new(nodes: Indices<'_>, plane: Plane, snapshot: &Snapshot<'_, '_, T>) -> Result<Self, EvaluateError> {
        let mut outline = Self {
            maxima: [Maximum::NONE; 3],
            rear_pole: T::ZERO,
        };
        let mut cache = snapshot.panel_cache();
        for node in nodes.iter() {
            let [x, r] = cache.axial_radial(node, plane)?;
            for (maximum, value) in outline.maxima.iter_mut().zip(&[x, -x, r]) {
                maximum.push(*value);
            }
            outline.rear_pole = x;
        }
        Ok(outline)
    }

    /// The three maxima.
    fn extremes(&self) -> [T; 3] {
        let [front, back, radius] = &self.maxima;
        [front.value(), back.value(), radius.value()]
    }
}

/// Maximum of a sequence of values, with its two neighbours. A neighbour is missing at an end only. There, at a pole,
/// the outline continues as its mirror image, so the vertex of the parabola is the node.
#[derive(Clone, Copy)]
struct Maximum<T> {
    last: [Option<T>; 2],
    before: Option<T>,
    greatest: Option<T>,
    after: Option<T>,
}

impl<T: Real> Maximum<T> {
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
    #[inline(never)]
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parabola_s_vertex() {
        let vertex = |values: &[f64]| {
            let mut maximum = Maximum::NONE;
            values.iter().for_each(|&value| maximum.push(value));
            maximum.value()
        };
        let parabola = |i: f64| 3.0 - (i - 1.2) * (i - 1.2);
        assert!((vertex(&[0.0, 1.0, 2.0, 3.0].map(parabola)) - 3.0).abs() < 1e-15);
        assert_eq!(vertex(&[5.0, 4.0, 1.0]), 5.0);
        assert_eq!(vertex(&[1.0, 4.0, 5.0]), 5.0);
    }
}
