//! The flow of the fluid: velocities at the membrane's nodes for a given membrane load.

/// The membrane as the fluid sees it.
#[derive(Debug, Clone, Copy)]
pub struct Membrane<'a> {
    /// Six-node triangles (VTK node order, outward).
    pub elements: &'a [[u32; 6]],
    /// Current node positions in the frame of the volume centroid.
    pub nodes: &'a [[f64; 3]],
    /// Nodal load of the fluid on the membrane, the traction jump `q` (mu V/l), P2-interpolated.
    pub load: &'a [[f64; 3]],
    /// Finite-element load vector `r = M q` (mu V l).
    pub force: &'a [[f64; 3]],
}

/// What can go wrong in the flow.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FlowError {}

/// A flow that a membrane disturbs.
pub trait Flow {
    /// Writes the velocities of the fluid at the nodes `targets` of the membrane to `out` (one each) and returns the
    /// additional pressure drop (mu V/l).
    ///
    /// # Errors
    /// [`FlowError`] if the velocity cannot be found.
    fn velocity(&self, membrane: &Membrane, targets: &[u32], out: &mut [[f64; 3]]) -> Result<f64, FlowError>;
}
