//! Errors of the flow solver.

/// Why a velocity could not be found, or a flow not be set up.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FlowError {
    /// A setting is out of range.
    #[error("flow setting `{name}` is {value}: it must be {requirement}")]
    Setting {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The right value.
        requirement: &'static str,
    },
    /// The wall's system of equations could not be inverted.
    #[error("the wall operator of {unknowns} unknowns is singular: the panels do not resolve the duct")]
    SingularWall {
        /// Its size.
        unknowns: usize,
    },
    /// An array has the wrong length.
    #[error("`{what}` has {found} entries, expected {expected}")]
    Length {
        /// The array.
        what: &'static str,
        /// The length it should have.
        expected: usize,
        /// The length it has.
        found: usize,
    },
    /// An index points outside the membrane's nodes.
    #[error("`{what}` refers to node {node}, but the membrane has {nodes} nodes")]
    NodeIndex {
        /// The array.
        what: &'static str,
        /// The index found.
        node: u32,
        /// How many nodes there are.
        nodes: usize,
    },
    /// A number is infinite or not a number.
    #[error("`{what}` is not finite at node {node}")]
    NonFinite {
        /// The array.
        what: &'static str,
        /// Where in the array's order.
        node: usize,
    },
    /// A node lies on or beyond the wall.
    #[error("node {node} lies {overlap} l outside the duct's wall")]
    OutsideDuct {
        /// The node.
        node: usize,
        /// How far beyond the wall (l), at least 0.
        overlap: f64,
    },
    /// The film between membrane and wall is thinner than the quadrature resolves.
    #[error("the film at node {node} is {gap} l thin: the quadrature needs at least {minimum} l")]
    ThinFilm {
        /// The node.
        node: usize,
        /// Distance from the wall (l).
        gap: f64,
        /// The least distance allowed (l).
        minimum: f64,
    },
    /// A node lies too close to an end of the duct.
    #[error("node {node} at x = {x} l is too close to an end of the duct: |x| must stay below {limit} l")]
    NearDuctEnd {
        /// The node.
        node: usize,
        /// Its axial position (l).
        x: f64,
        /// The bound on |x| (l).
        limit: f64,
    },
}
