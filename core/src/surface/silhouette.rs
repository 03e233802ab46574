//! The outline of a surface's projection along a direction across the axis: what bright-field microscopy shows.
//!
//! The projection ends where the surface turns away from the viewer: on the curves where the normal is perpendicular to
//! the line of sight. They are traced on the mesh, through the flat parts whose nodes face both ways. A point of such a
//! curve misses its place on the surface by the error of the normals; the projection moves only by the square of that.
//! Of several curves (the front, the rim of a dent, a bulge that hides another) the outermost counts.

use crate::Real;
use crate::error::{EvaluateError, finite};
use crate::model::{Mesh, apply};
use crate::surface::quadrature::Point;
use crate::surface::reconstruct::prefix_mut;

/// Barycentric coordinates of the six nodes of an element.
const PLACES: [[f32; 3]; 6] = [
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.5, 0.5, 0.0],
    [0.0, 0.5, 0.5],
    [0.5, 0.0, 0.5],
];

/// The silhouette on the plane of the axis and the direction `across` = [cos, sin], of length 1: w = cos y + sin z,
/// seen along (0, -sin, cos). [1, 0] looks along z; [1, 1] / sqrt 2 along the diagonal. Fills `out` with points [x, w]
/// on the side w >= 0, front to rear, as many as there is room for (at least 3). The square's symmetry makes the other
/// side the mirror image.
///
/// The points lie on rays from the middle of the axial extent, about as far from each other in angle: with
/// u = 2 k / (count - 1), the ray's direction is (1 - u^2, 2 u) in the front half, and mirrored in the rear half.
///
/// `positions` are those of all nodes; `normals` is room for one vector for each of the sector's nodes.
///
/// # Errors
/// [`EvaluateError::BufferTooShort`] for `positions`, `normals` or `out`; [`EvaluateError::NotFinite`], also for a
/// surface that is not closed around its middle.
pub fn silhouette<T: Real>(
    mesh: &Mesh<'_>,
    positions: &[[T; 3]],
    across: [T; 2],
    normals: &mut [[T; 3]],
    out: &mut [[T; 2]],
) -> Result<(), EvaluateError> {
    trace(mesh, positions, [], across, normals, out, &mut [])
}

/// The silhouette, and derivatives of its points for derivatives of the positions (those of
/// [`Derivatives::positions`](crate::Derivatives::positions), for all nodes): of the place of the membrane that is seen
/// there, projected, into `movement`, as many as there is room for in `out`. What moves the outline is the part along
/// its normal: along the rim the line of sight touches the surface, so to first order it does not count that the rim
/// wanders over the membrane.
///
/// # Errors
/// Those of [`silhouette`]; [`EvaluateError::BufferTooShort`] for the derivatives or `movement`.
pub fn silhouette_derivatives<T: Real, const D: usize>(
    mesh: &Mesh<'_>,
    positions: &[[T; 3]],
    derivatives: [&[[T; 3]]; D],
    across: [T; 2],
    normals: &mut [[T; 3]],
    out: &mut [[T; 2]],
    movement: &mut [[[T; 2]; D]],
) -> Result<(), EvaluateError> {
    let movement = prefix_mut(movement, out.len())?;
    trace(mesh, positions, derivatives, across, normals, out, movement)
}

#[inline(always)]
fn trace<T: Real, const D: usize>(
    mesh: &Mesh<'_>,
    positions: &[[T; 3]],
    derivatives: [&[[T; 3]]; D],
    across: [T; 2],
    normals: &mut [[T; 3]],
    out: &mut [[T; 2]],
    movement: &mut [[[T; 2]; D]],
) -> Result<(), EvaluateError> {
    const LEAST: usize = 3;
    let short = |required, found| Err(EvaluateError::BufferTooShort { required, found });
    let fields = core::iter::once(positions).chain(derivatives);
    if let Some(field) = fields.into_iter().find(|field| field.len() < mesh.nodes()) {
        return short(mesh.nodes(), field.len());
    }
    if out.len() < LEAST {
        return short(LEAST, out.len());
    }
    let positions = positions.get(..mesh.nodes()).unwrap_or_default();
    let normals = prefix_mut(normals, mesh.sector_nodes().len())?;
    fill_normals(mesh, positions, normals);
    let extent = positions
        .iter()
        .fold([positions[0][0]; 2], |[least, greatest], [x, ..]| {
            [least.min(*x), greatest.max(*x)]
        });
    let middle = T::from_f32(0.5) * (extent[0] + extent[1]);
    let mut rays = Rays::new(middle, out, movement);
    let view = View { across };
    let mirrored = across[1] == T::ZERO && mesh.sector_nodes().len() < mesh.nodes();
    for element in mesh.elements().map(|element| element.map(usize::from)) {
        let places = element.map(|node| positions[node]);
        // The outline's other half is not wanted, and along z its front and its back are the same.
        if places.iter().all(|place| view.project(*place)[1] < T::ZERO)
            || (mirrored && places.iter().all(|place| view.toward(*place) < T::ZERO))
        {
            continue;
        }
        let nodes = element.map(|node| {
            let (sector_node, operation) = mesh.origin(node).unwrap_or_default();
            let normal = normals.get(sector_node).copied().unwrap_or([T::ZERO; 3]);
            Node {
                position: positions[node],
                normal: apply(operation, normal),
                derivatives: derivatives.map(|field| field[node]),
            }
        });
        let facing = nodes.map(|node| view.toward(node.normal));
        let toward = facing.iter().filter(|facing| **facing >= T::ZERO).count();
        if toward == 0 || toward == facing.len() {
            continue;
        }
        for part in mesh.flat_parts() {
            if let Some(corners) = crossed(*part, &facing) {
                let ends = corners.map(|pair| view.point(pair, &nodes, &facing, mesh.element_nodes() == 3));
                rays.offer(ends);
            }
        }
    }
    rays.finish()
}

/// Normals at the sector's nodes, each the sum over the elements around it, of any length.
fn fill_normals<T: Real>(mesh: &Mesh<'_>, positions: &[[T; 3]], normals: &mut [[T; 3]]) {
    let flat = mesh.element_nodes() == 3;
    let at_nodes = PLACES.map(|place| {
        let point = Point::new(0.0, place.map(T::from_f32));
        if flat { point.flat() } else { point }
    });
    normals.fill([T::ZERO; 3]);
    for element in mesh.elements() {
        let mut nodes = None;
        for (node, point) in element.iter().zip(&at_nodes).take(mesh.element_nodes()) {
            let Some((sector_node, 0)) = mesh.origin((*node).into()) else {
                continue;
            };
            let nodes = nodes.get_or_insert_with(|| element.map(|node| positions[usize::from(node)]));
            let [a, b] = point.derivatives(nodes);
            if let Some(normal) = normals.get_mut(sector_node) {
                normal[0] += a[1] * b[2] - a[2] * b[1];
                normal[1] += a[2] * b[0] - a[0] * b[2];
                normal[2] += a[0] * b[1] - a[1] * b[0];
            }
        }
    }
}

/// The two edges of a triangle on which its nodes change from facing the viewer to not.
fn crossed<T: Real>([a, b, c]: [usize; 3], facing: &[T; 6]) -> Option<[[usize; 2]; 2]> {
    let toward = |node: usize| facing[node] >= T::ZERO;
    match [toward(a), toward(b), toward(c)] {
        [p, q, r] if q == r && p != q => Some([[a, b], [a, c]]),
        [p, q, r] if p == r && p != q => Some([[b, c], [b, a]]),
        [p, q, r] if p == q && p != r => Some([[c, a], [c, b]]),
        _ => None,
    }
}

/// A node of an element.
#[derive(Clone, Copy)]
struct Node<T, const D: usize> {
    position: [T; 3],
    normal: [T; 3],
    derivatives: [[T; 3]; D],
}

/// A point of the projection, the direction of the surface's normal there, and the point's derivatives.
#[derive(Clone, Copy)]
struct Rim<T, const D: usize> {
    place: [T; 2],
    normal: [T; 2],
    movement: [[T; 2]; D],
}

struct View<T> {
    across: [T; 2],
}

impl<T: Real> View<T> {
    /// How far a vector points to the viewer.
    fn toward(&self, [_, y, z]: [T; 3]) -> T {
        let [cos, sin] = self.across;
        cos * z - sin * y
    }

    fn project(&self, [x, y, z]: [T; 3]) -> [T; 2] {
        let [cos, sin] = self.across;
        [x, cos * y + sin * z]
    }

    /// The place on an edge between two nodes of an element where the surface turns away.
    fn point<const D: usize>(
        &self,
        [a, b]: [usize; 2],
        nodes: &[Node<T, D>; 6],
        facing: &[T; 6],
        flat: bool,
    ) -> Rim<T, D> {
        let share = facing[a] / (facing[a] - facing[b]);
        let between = |from: T, to: T| from + share * (to - from);
        let [from, to] = [a, b].map(|node| PLACES[node].map(T::from_f32));
        let point = Point::new(0.0, core::array::from_fn(|i| between(from[i], to[i])));
        let point = if flat { point.flat() } else { point };
        let at = |value: &dyn Fn(&Node<T, D>) -> [T; 3]| {
            let mut sum = [T::ZERO; 3];
            for (shape, node) in point.shape.iter().zip(nodes) {
                for (sum, x) in sum.iter_mut().zip(value(node)) {
                    *sum += *shape * x;
                }
            }
            self.project(sum)
        };
        let (n, m) = (nodes[a].normal, nodes[b].normal);
        let normal = self.project([0, 1, 2].map(|axis| between(n[axis], m[axis])));
        let movement = core::array::from_fn(|d| at(&|node| node.derivatives[d]));
        Rim {
            place: at(&|node| node.position),
            normal,
            movement,
        }
    }
}

/// The rays that the outline's points lie on; `out` holds how far out each goes until the end.
struct Rays<'o, T, const D: usize> {
    middle: T,
    /// Rays from one half's end to the middle: (count - 1) / 2.
    half: T,
    out: &'o mut [[T; 2]],
    movement: &'o mut [[[T; 2]; D]],
}

impl<'o, T: Real, const D: usize> Rays<'o, T, D> {
    fn new(middle: T, out: &'o mut [[T; 2]], movement: &'o mut [[[T; 2]; D]]) -> Self {
        out.fill([T::ZERO; 2]);
        let half = T::from_f32(0.5) * T::from_index(out.len() - 1);
        Self {
            middle,
            half,
            out,
            movement,
        }
    }

    /// Number of the ray through a point, with fractions; below 0 or above the last where w < 0.
    fn number(&self, [x, w]: [T; 2]) -> T {
        let tangent = w / ((x * x + w * w).sqrt() + x.abs());
        if x >= T::ZERO {
            self.half * tangent
        } else {
            self.half * (T::from_f32(2.0) - tangent)
        }
    }

    /// Direction of length 1 of a ray.
    fn direction(&self, number: usize) -> [T; 2] {
        let (two, u) = (T::from_f32(2.0), T::from_index(number) / self.half);
        let front = u <= T::ONE;
        let u = if front { u } else { two - u };
        let length = T::ONE + u * u;
        let x = (T::ONE - u * u) / length;
        [if front { x } else { -x }, two * u / length]
    }

    /// Moves the rays that cross a piece of the rim out to it.
    fn offer(&mut self, ends: [Rim<T, D>; 2]) {
        /// Share of a ray's distance to the next by which a piece reaches over its ends, so that none slips between.
        const OVERLAP: f32 = 1e-3;
        let ends = ends.map(|rim| Rim {
            place: [rim.place[0] - self.middle, rim.place[1]],
            ..rim
        });
        let [a, b] = ends.map(|rim| self.number(rim.place));
        let (low, high) = (a.min(b) - T::from_f32(OVERLAP), a.max(b) + T::from_f32(OVERLAP));
        // A piece on the far side, where the numbers jump.
        if high - low > self.half || high < T::ZERO {
            return;
        }
        let movement = ends.map(|rim| rim.movement);
        let piece = Piece::new(ends.map(|rim| (rim.place, rim.normal)));
        let first = if low > T::ZERO { low.to_index() + 1 } else { 0 };
        for number in first..=high.to_index() {
            let direction = self.direction(number);
            let (found, share) = piece.radius(direction);
            if let Some([radius, _]) = self.out.get_mut(number)
                && *radius < found
            {
                *radius = found;
                if let Some(own) = self.movement.get_mut(number) {
                    let [from, to] = movement;
                    let between = |d: usize, axis: usize| from[d][axis] + share * (to[d][axis] - from[d][axis]);
                    *own = core::array::from_fn(|d| [between(d, 0), between(d, 1)]);
                }
            }
        }
    }

    /// Turns how far out the rays go into points.
    fn finish(self) -> Result<(), EvaluateError> {
        let count = self.out.len();
        for number in 0..count {
            let [x, w] = self.direction(number);
            if let Some(point) = self.out.get_mut(number) {
                let [radius, _] = *point;
                if radius <= T::ZERO {
                    return Err(EvaluateError::NotFinite);
                }
                *point = finite([self.middle + radius * x, radius * w])?;
            }
        }
        Ok(())
    }
}

fn cross<T: Real>([a, b]: [T; 2], [c, d]: [T; 2]) -> T {
    a * d - b * c
}

/// A piece of the rim: a cubic between two points, with tangents perpendicular to the normals.
struct Piece<T> {
    points: [[T; 2]; 2],
    tangents: [[T; 2]; 2],
}

impl<T: Real> Piece<T> {
    /// The piece between two places with normals there.
    fn new(ends: [([T; 2], [T; 2]); 2]) -> Self {
        let [p, q] = ends.map(|(place, _)| place);
        let chord = [q[0] - p[0], q[1] - p[1]];
        let square = chord[0] * chord[0] + chord[1] * chord[1];
        let tangents = ends.map(|(_, [x, w])| {
            let along = chord[1] * x - chord[0] * w;
            // The tangent whose part along the chord is the chord's length; at a corner the chord itself.
            let length = (x * x + w * w).sqrt() * square.sqrt();
            if along.abs() > T::from_f32(0.5) * length {
                [-w * square / along, x * square / along]
            } else {
                chord
            }
        });
        Self {
            points: [p, q],
            tangents,
        }
    }

    /// How far out the cubic crosses a ray, and the share of the piece that lies before.
    fn radius(&self, direction: [T; 2]) -> (T, T) {
        const STEPS: usize = 5;
        let [p, q] = self.points;
        let (at_start, at_end) = (cross(direction, p), cross(direction, q));
        let slope = at_end - at_start;
        let mut share = T::from_f32(0.5);
        if slope.abs() > T::ZERO {
            share = -at_start / slope;
            for _ in 0..STEPS {
                share = share - cross(direction, self.at(share)) / slope;
            }
            // Not a number is neither.
            if !(share > T::from_f32(-0.5) && share < T::from_f32(1.5)) {
                share = T::from_f32(0.5);
            }
        }
        let [x, w] = self.at(share);
        (x * direction[0] + w * direction[1], share)
    }

    fn at(&self, s: T) -> [T; 2] {
        let ([p, q], [m, n]) = (self.points, self.tangents);
        let rest = T::ONE - s;
        let two = T::from_f32(2.0);
        let (from, to) = (rest * rest * (T::ONE + two * s), s * s * (T::ONE + two * rest));
        let (start, end) = (rest * rest * s, s * s * rest);
        [0, 1].map(|i| from * p[i] + to * q[i] + start * m[i] - end * n[i])
    }
}
