//! Set-up of a workspace in memory that is zeroed already.

/// Memory in which a workspace is set up: zeros, over which the parts are written that have another representation.
pub trait Parts {
    /// Writes a part at an offset in bytes from the start of the workspace.
    fn put<P>(&mut self, offset: usize, part: P);
}
