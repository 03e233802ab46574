//! Interpolation in the parameters: f(theta) = sum_j L_j(theta) f(theta_j), linear in the data.
//!
//! [`Coordinates`] transforms the parameters, `search` finds the nearest samples, and [`Weights`] holds the L_j. Two
//! methods compute them: `kernel`, a quintic kernel with a quadratic tail, for
//! [`Method::Direct`](crate::Method::Direct), and `diffuse`, the diffuse approximation of the paper (section 3.4.1),
//! for [`Method::Paper`](crate::Method::Paper). `derivative` has the derivatives of the kernel's weights.

mod coordinates;
mod derivative;
mod diffuse;
mod kernel;
mod search;
#[cfg(test)]
mod tests;
mod weights;

pub use coordinates::Coordinates;
pub(crate) use diffuse::{ridge_rows, weight};
pub use weights::Weights;

use crate::Real;
use crate::linalg::MAX_COLUMNS;
use crate::model::wire::MAX_PARAMETERS;

/// Numbers of scratch that the weights of `neighbours` samples need: the columns of monomials and the kernel's matrix.
pub(crate) const fn scratch_len(neighbours: usize) -> usize {
    (MAX_COLUMNS + neighbours) * neighbours
}

/// Squared length of a vector of parameters. Written out as the next two: optimised for size, it would be a loop.
fn square<T: Real>([a, b, c, d]: [T; MAX_PARAMETERS]) -> T {
    (a * a + b * b) + (c * c + d * d)
}

/// a - b.
fn minus<T: Real>(a: [T; MAX_PARAMETERS], b: [T; MAX_PARAMETERS]) -> [T; MAX_PARAMETERS] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]]
}

/// The products of two vectors' entries.
fn times<T: Real>(a: [T; MAX_PARAMETERS], b: [T; MAX_PARAMETERS]) -> [T; MAX_PARAMETERS] {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2], a[3] * b[3]]
}
