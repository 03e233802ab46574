//! Derivatives on the stress-free sphere from the nodes around a node.

use super::Deformation;
use crate::Real;
use crate::error::{EvaluateError, finite};
use crate::linalg::{dot, gram_schmidt};
use crate::model::Mesh;
use crate::nearest::Nearest;
use nalgebra::Vector3;

/// Number of nodes of a stencil besides its own.
const NEIGHBOURS: usize = 24;
/// Monomials of degree 1 to 4 in two coordinates.
const MONOMIALS: usize = 14;
/// Last monomials, whose coefficients are the derivatives: u, v, u^2/2, u v, v^2/2.
const DERIVATIVES: usize = 5;

/// Weights of the first and second derivatives at a node, by a weighted least-squares fit of a polynomial of degree
/// four to the nearest nodes. Second derivatives are at least third-order accurate on any mesh, whereas the derivatives
/// of the elements' quadratics oscillate from node to node. Shapes that turn within five spacings of the nodes are not
/// resolved: at a sharp rim the error of the load is 10 to 50 %, that of stretches and tensions much less.
///
/// The coordinates are those of the stereographic projection from the opposite point of the sphere: at the node their
/// metric is the identity, and its derivatives are 0.
#[derive(Clone, Debug)]
pub struct Stencil<T> {
    node: u32,
    neighbours: [u32; NEIGHBOURS],
    weights: [[T; NEIGHBOURS]; DERIVATIVES],
}

impl<T: Real> Stencil<T> {
    /// The stencil at a node of a model's mesh.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn at(mesh: &Mesh<'_>, node: usize) -> Result<Self, EvaluateError> {
        let mesh = *mesh;
        let nodes = (0..mesh.nodes()).map(move |node| mesh.reference(node).unwrap_or_default().map(T::from_f32));
        Self::new(nodes, node)
    }

    /// The stencil at one of `nodes` on the unit sphere.
    ///
    /// # Errors
    /// [`EvaluateError::UnknownNode`]; [`EvaluateError::StencilTooSmall`] where the nodes nearby do not determine the
    /// derivatives.
    pub fn new(nodes: impl Iterator<Item = [T; 3]> + Clone, node: usize) -> Result<Self, EvaluateError> {
        let unknown = || EvaluateError::UnknownNode {
            node,
            nodes: nodes.clone().count(),
        };
        let centre = nodes.clone().nth(node).ok_or_else(unknown)?;
        let axes = tangents(centre);
        // The last one has the weight 0: its distance is the radius of the stencil.
        let mut nearest = Nearest::<T, 2, { NEIGHBOURS + 1 }>::new(NEIGHBOURS + 1);
        for (number, point) in nodes.enumerate().filter(|(number, _)| *number != node) {
            let offset = projection(centre, &axes, point);
            nearest.offer(number, dot(&offset, &offset), offset);
        }
        let few = EvaluateError::StencilTooSmall { node };
        let radius = nearest.limit().sqrt();
        if nearest.count() <= NEIGHBOURS || radius >= T::from_f32(FAR) {
            return Err(few);
        }
        let (mut neighbours, mut scaled) = ([0; NEIGHBOURS], [[T::ZERO; 2]; NEIGHBOURS]);
        for ((number, scaled), (neighbour, offset)) in neighbours.iter_mut().zip(&mut scaled).zip(nearest.iter()) {
            *number = neighbour.number.into();
            *scaled = offset.map(|x| x / radius);
        }
        // Weights that decrease with the distance. The cube halves the error at rims, which are as narrow as the
        // stencil.
        let factors = scaled.map(|offset| {
            let factor = T::ONE - dot(&offset, &offset);
            factor * factor * factor
        });
        let mut columns = monomials(&scaled);
        for column in &mut columns {
            for (value, factor) in column.iter_mut().zip(&factors) {
                *value *= *factor;
            }
        }
        let mut weights: [_; DERIVATIVES] = gram_schmidt::last_coefficients(&mut columns).ok_or(few)?;
        for (derivative, weights) in weights.iter_mut().enumerate() {
            let scale = if derivative < 2 { radius } else { radius * radius };
            for (weight, factor) in weights.iter_mut().zip(&factors) {
                *weight = *weight * *factor / scale;
            }
        }
        Ok(Self {
            node: node as u32,
            neighbours,
            weights,
        })
    }

    /// The node's index.
    pub fn node(&self) -> usize {
        self.node as usize
    }

    /// The deformation of a sphere of `radius` whose nodes are now at `position`.
    ///
    /// # Errors
    /// Those of `position`; [`EvaluateError::NotFinite`], also where the surface has no area.
    pub fn deformation(
        &self,
        radius: T,
        position: impl Fn(usize) -> Result<[T; 3], EvaluateError>,
    ) -> Result<Deformation<T>, EvaluateError> {
        let centre = Vector3::from(position(self.node())?);
        let mut sums = [Vector3::from([T::ZERO; 3]); DERIVATIVES];
        for (j, neighbour) in self.neighbours.iter().enumerate() {
            let offset = Vector3::from(position(*neighbour as usize)?) - centre;
            for (sum, weights) in sums.iter_mut().zip(&self.weights) {
                *sum += offset * weights[j];
            }
        }
        let square = radius * radius;
        let [x1, x2, x11, x12, x22] = sums;
        let deformation = Deformation {
            first: [x1, x2].map(|vector| (vector / radius).into()),
            second: [x11, x12, x22].map(|vector| (vector / square).into()),
        };
        for derivative in deformation.second {
            finite(derivative)?;
        }
        // A finite dilation implies a finite metric, stretches, tensions and energy.
        let [dilation] = finite([deformation.area_dilation()])?;
        if dilation > T::from_f32(MIN_AREA_DILATION) {
            Ok(deformation)
        } else {
            Err(EvaluateError::NotFinite)
        }
    }
}

/// Least area dilation of a surface; the fourth power of a smaller one could underflow in single precision.
const MIN_AREA_DILATION: f32 = 1e-3;

/// Distance in the projection beyond that of all nodes within 120 degrees.
const FAR: f32 = 4.0;

/// Coordinates of a point of the unit sphere in the stereographic projection around `centre`; points beyond 120 degrees
/// are mapped to the distance [`FAR`].
fn projection<T: Real>(centre: [T; 3], axes: &[[T; 3]; 2], point: [T; 3]) -> [T; 2] {
    let chord = Vector3::from(point) - Vector3::from(centre);
    let square = dot(chord.as_slice(), chord.as_slice());
    if square < T::from_f32(3.0) {
        let scale = T::ONE / (T::ONE - square * T::from_f32(0.25));
        [0, 1].map(|axis| scale * dot(chord.as_slice(), &axes[axis]))
    } else {
        [T::from_f32(FAR), T::ZERO]
    }
}

/// Two orthogonal unit vectors across a unit vector, right-handed with it.
fn tangents<T: Real>(normal: [T; 3]) -> [[T; 3]; 2] {
    let [x, y, z] = normal;
    // The coordinate axis at the greatest angle to the normal.
    let axis = if x.abs() <= y.abs() && x.abs() <= z.abs() {
        [T::ONE, T::ZERO, T::ZERO]
    } else if y.abs() <= z.abs() {
        [T::ZERO, T::ONE, T::ZERO]
    } else {
        [T::ZERO, T::ZERO, T::ONE]
    };
    let normal = Vector3::from(normal);
    let first = Vector3::from(axis) - normal * dot(&axis, normal.as_slice());
    let first = first / dot(first.as_slice(), first.as_slice()).sqrt();
    [first.into(), normal.cross(&first).into()]
}

/// The monomials at the neighbours, a column each; those of the derivatives come last.
fn monomials<T: Real>(offsets: &[[T; 2]; NEIGHBOURS]) -> [[T; NEIGHBOURS]; MONOMIALS] {
    let half = T::from_f32(0.5);
    let mut columns = [[T::ZERO; NEIGHBOURS]; MONOMIALS];
    for (j, &[u, v]) in offsets.iter().enumerate() {
        let (uu, uv, vv) = (u * u, u * v, v * v);
        let row = [
            uu * u,
            uu * v,
            u * vv,
            v * vv,
            uu * uu,
            uu * uv,
            uu * vv,
            uv * vv,
            vv * vv,
            u,
            v,
            half * uu,
            uv,
            half * vv,
        ];
        for (column, value) in columns.iter_mut().zip(row) {
            column[j] = value;
        }
    }
    columns
}
