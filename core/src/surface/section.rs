//! The cross-section of a surface by a plane x = constant.

use crate::Real;
use crate::error::EvaluateError;
use crate::model::Mesh;

/// A segment of a cross-section: two points [y, z]. Seen from the front (from larger x), the inside of the surface is
/// to the left of the direction from the first to the second.
pub type Segment<T> = [[T; 2]; 2];

/// Cuts a surface by the plane at `x` into segments, in the first entries of `out`; returns their number. Each element
/// is cut as four flat triangles (or one), so it has at most four segments. They form closed curves, in no order; a
/// shared point has the same bits in both its segments. `positions` are those of all nodes.
///
/// # Errors
/// [`EvaluateError::BufferTooShort`] for `positions`, or for `out` with the number of segments needed.
pub fn section<T: Real>(
    mesh: &Mesh<'_>,
    positions: &[[T; 3]],
    x: T,
    out: &mut [Segment<T>],
) -> Result<usize, EvaluateError> {
    if positions.len() < mesh.nodes() {
        return Err(EvaluateError::BufferTooShort {
            required: mesh.nodes(),
            found: positions.len(),
        });
    }
    let mut count = 0;
    for element in mesh.elements() {
        for part in mesh.flat_parts() {
            let corners = part.map(|corner| usize::from(element[corner]));
            if let Some(segment) = cut(corners, positions, x) {
                if let Some(out) = out.get_mut(count) {
                    *out = segment;
                }
                count += 1;
            }
        }
    }
    if count <= out.len() {
        Ok(count)
    } else {
        Err(EvaluateError::BufferTooShort {
            required: count,
            found: out.len(),
        })
    }
}

/// The segment in which the plane cuts a triangle.
fn cut<T: Real>([a, b, c]: [usize; 3], positions: &[[T; 3]], x: T) -> Option<Segment<T>> {
    let before = |node: usize| positions[node][0] >= x;
    // Permutes the corners cyclically until the first is alone on its side.
    let [a, b, c] = match [before(a), before(b), before(c)] {
        [p, q, r] if q == r && p != q => [a, b, c],
        [p, q, r] if p == r && p != q => [b, c, a],
        [p, q, r] if p == q && p != r => [c, a, b],
        _ => return None,
    };
    let segment = [crossing(a, b, positions, x), crossing(a, c, positions, x)];
    let [first, second] = segment;
    Some(if before(a) { segment } else { [second, first] })
}

/// Intersection of an edge with the plane, the same bits for both its triangles.
fn crossing<T: Real>(a: usize, b: usize, positions: &[[T; 3]], x: T) -> [T; 2] {
    let ([x0, y0, z0], [x1, y1, z1]) = (positions[a.min(b)], positions[a.max(b)]);
    let share = (x - x0) / (x1 - x0);
    [y0 + share * (y1 - y0), z0 + share * (z1 - z0)]
}
