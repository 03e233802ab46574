//! Mechanics of the membrane from the nodes of the surface: stretches, tensions, load, energy.
//!
//! The stress-free capsule is a sphere, and the current position is a smooth function on it. A [`Stencil`] holds the
//! weights of the first two derivatives of that function at a node; it depends on the mesh only, so it is the same for
//! every instant and query. A [`Membrane`] is the surface at an instant; it gives the [`Deformation`] at a stencil's
//! node, from which all local quantities follow, and the [`Totals`].
//!
//! Vectors are nalgebra's, whose component-wise operations and cross product have the order of the formulas. Scalar
//! products are those of `linalg`: nalgebra adds (x + y) + z, and all targets here add (x + z) + y.

mod deformation;
mod membrane;
mod poiseuille;
mod stencil;

pub use deformation::Deformation;
pub use membrane::{Membrane, Totals};
pub use poiseuille::undisturbed_velocity;
pub use stencil::Stencil;

use crate::Real;

/// The membrane's law in the mechanics, by its name in a model.
pub const LAW: &str = "neo-Hookean";

/// Metric of two tangents: components 11, 22, 12.
fn metric<T: Real>(tangents: &[[T; 3]; 2]) -> [T; 3] {
    let [a, b] = tangents;
    [product(a, a), product(b, b), product(a, b)]
}

/// Scalar product, with the order of sums of [`dot`](crate::linalg::dot).
fn product<T: Real>([ax, ay, az]: &[T; 3], [bx, by, bz]: &[T; 3]) -> T {
    (*ax * *bx + *az * *bz) + *ay * *by
}

/// Determinant of a metric.
fn determinant<T: Real>([m11, m22, m12]: [T; 3]) -> T {
    m11 * m22 - m12 * m12
}
