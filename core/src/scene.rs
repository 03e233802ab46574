//! A scene: the nodes to reconstruct and their frame of reference.

/// Nodes and the frame in which they are given. The call chooses the field and the instant.
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
    /// All nodes of the mesh; sector nodes are computed once and mirrored.
    All,
    /// A named set of the model, such as [`MIDPLANE`](crate::MIDPLANE).
    Set(&'a str),
    /// Indices of nodes in the full mesh.
    List(&'a [u16]),
}

/// Frame of reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frame {
    /// At rest with the channel; the capsule starts at x = 0.
    Laboratory,
    /// Moving with the capsule's volume centroid.
    Centroid,
}
