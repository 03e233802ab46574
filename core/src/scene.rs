//! What the caller looks at: only these nodes are reconstructed.

/// A choice of nodes and the frame in which they are given. Fields and instants are chosen by the calls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scene<'a> {
    /// Nodes to reconstruct.
    pub nodes: Nodes<'a>,
    /// Frame of positions and velocities.
    pub frame: Frame,
}

/// Nodes of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Nodes<'a> {
    /// The full mesh; each sector node is computed once and mirrored.
    All,
    /// A named set of the model.
    Set(&'a str),
    /// Full node indices.
    List(&'a [u16]),
}

/// Frame of reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frame {
    /// At rest with the duct; the capsule starts at x = 0.
    Laboratory,
    /// Moving with the capsule's volume centroid.
    Centroid,
}
