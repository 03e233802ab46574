//! The parts of a model that its evaluations share.

use crate::surface::Surface;
use capsule_core::EvaluateError;
use capsule_core::mechanics::Stencil;
use self_cell::self_cell;
use std::cell::OnceCell;

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
    pub stencils: OnceCell<Result<Vec<Stencil<f32>>, EvaluateError>>,
}

impl Shared {
    pub fn core(&self) -> &CoreModel<'_> {
        self.file.borrow_dependent()
    }

    /// The stencils at the sector's nodes, computed at the first call.
    pub fn stencils(&self) -> Result<&[Stencil<f32>], EvaluateError> {
        let make = || {
            let mesh = self.core().mesh();
            let nodes = mesh.sector_nodes();
            nodes.iter().map(|node| Stencil::at(&mesh, node)).collect()
        };
        self.stencils.get_or_init(make).as_deref().map_err(|error| *error)
    }
}
