//! The flow of the fluid: velocities at the membrane's nodes for a given load on the membrane, by boundary integrals.
//!
//! `v(x) = v_inf(x) - 1/(8 pi) [ int_C J q dS + int_W J f dS - dp int_out J n dS ]` with the Stokeslet `J`, the
//! membrane `C` with its load `q` (the traction jump, eq. 8 of the paper), the walls `W` with the perturbation traction
//! `f` that makes `v = 0` there, and the additional pressure drop `dp` acting on the outlet.
//!
//! - [`stokeslet`], `real`: sums over point forces, vectorised, in two precisions;
//! - [`quadrature`], `patch`, `far`, `near`, [`membrane_layer`]: the integral over the membrane;
//! - `panel`, `wall`, `dense`: the integral over the walls and the solution for `f`;
//! - [`poiseuille`]: the undisturbed flow;
//! - [`duct`] with its `settings`, [`free_space`]: the two flows behind the trait [`Flow`].

pub mod dense;
pub mod duct;
mod error;
mod far;
pub mod free_space;
pub mod membrane_layer;
mod near;
mod panel;
pub mod patch;
pub mod poiseuille;
mod precision;
pub mod quadrature;
mod real;
mod settings;
pub mod stokeslet;
mod wall;

#[cfg(test)]
mod test_support;

pub use duct::Duct;
pub use error::FlowError;
pub use free_space::{Background, FreeSpace};
pub use membrane_layer::MembraneQuadrature;
pub use poiseuille::Poiseuille;
pub use precision::Precision;
pub use settings::DuctSettings;

/// The membrane as the fluid sees it.
#[derive(Debug, Clone, Copy)]
pub struct Membrane<'a> {
    /// Six-node triangles (VTK node order, outward).
    pub elements: &'a [[u32; 6]],
    /// Current node positions in the frame of the volume centroid (l).
    pub nodes: &'a [[f64; 3]],
    /// Nodal load of the fluid on the membrane, the traction jump `q` (mu V/l), P2-interpolated.
    pub load: &'a [[f64; 3]],
    /// Finite-element load vector `r = M q` (mu V l).
    pub force: &'a [[f64; 3]],
}

/// A flow that a membrane disturbs.
pub trait Flow: Sync {
    /// Writes the velocities of the fluid (V) at the nodes `targets` of the membrane to `out` (one each) and returns
    /// the additional pressure drop (mu V/l).
    ///
    /// # Errors
    /// [`FlowError`] if arrays do not fit together, a number is not finite, or the membrane is too close to a wall or
    /// an end of the duct.
    fn velocity(&self, membrane: &Membrane, targets: &[u32], out: &mut [[f64; 3]]) -> Result<f64, FlowError>;
}

impl Membrane<'_> {
    /// Checks that the arrays fit together, that indices exist and numbers are finite.
    fn check(&self, targets: &[u32], out: &[[f64; 3]]) -> Result<(), FlowError> {
        let nodes = self.nodes.len();
        for (what, expected, found) in [
            ("load", nodes, self.load.len()),
            ("force", nodes, self.force.len()),
            ("out", targets.len(), out.len()),
        ] {
            if found != expected {
                return Err(FlowError::Length { what, expected, found });
            }
        }
        let exist = |what, indices: &[u32]| match indices.iter().find(|&&i| i as usize >= nodes) {
            Some(&node) => Err(FlowError::NodeIndex { what, node, nodes }),
            None => Ok(()),
        };
        exist("elements", self.elements.as_flattened())?;
        exist("targets", targets)?;
        check_finite("nodes", self.nodes)?;
        check_finite("load", self.load)?;
        check_finite("force", self.force)
    }
}

fn check_finite(what: &'static str, values: &[[f64; 3]]) -> Result<(), FlowError> {
    match values.iter().position(|v| v.iter().any(|c| !c.is_finite())) {
        Some(node) => Err(FlowError::NonFinite { what, node }),
        None => Ok(()),
    }
}
