//! The parts of a model that its evaluations share.

use crate::surface::Surface;
use self_cell::self_cell;

pub(crate) type CoreModel<'a> = capsule_core::Model<'a>;

self_cell!(
    /// The file's bytes with the model that reads them in place.
    pub(crate) struct File {
        owner: Vec<u8>,
        #[covariant]
        dependent: CoreModel,
    }
);

/// The parts that all evaluations of a model share.
pub(crate) struct Shared {
    pub file: File,
    /// The membrane as triangles to draw.
    pub surface: Surface,
    /// Nodes of the full mesh.
    pub nodes: usize,
}

impl Shared {
    pub fn core(&self) -> &CoreModel<'_> {
        self.file.borrow_dependent()
    }
}
