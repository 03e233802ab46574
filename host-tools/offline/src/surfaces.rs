//! Other people's data as plans take them.

use capsule_database::{Collection, Mesh, Symmetry};

use crate::OfflineError;

/// Other people's data in the working units.
#[derive(Clone)]
pub(crate) struct Surfaces {
    pub(crate) collection: Collection,
    /// The parameters in the data's units.
    pub(crate) given: Vec<Vec<f64>>,
    /// Whether the velocities were derived from the positions.
    pub(crate) derived: bool,
    pub(crate) reference: Mesh,
    pub(crate) symmetry: Symmetry,
}

impl Surfaces {
    /// Every `stride`-th instant, and the instants between these.
    pub(crate) fn thinned(&self, stride: usize) -> Result<Option<(Self, Vec<usize>)>, OfflineError> {
        let instants = self.collection.times.len();
        let last = (instants - 1) / stride * stride;
        let held_out: Vec<usize> = (0..last).filter(|instant| instant % stride != 0).collect();
        if held_out.is_empty() {
            return Ok(None);
        }
        fn every<X: Clone>(items: &[X], stride: usize) -> Vec<X> {
            items.iter().step_by(stride).cloned().collect()
        }
        let count = last + 1;
        let thin = |fields: &[Vec<Vec<[f64; 3]>>]| fields.iter().map(|run| every(&run[..count], stride)).collect();
        let mut collection = Collection {
            times: every(&self.collection.times[..count], stride),
            positions: thin(&self.collection.positions),
            velocities: thin(&self.collection.velocities),
            ..self.collection.clone()
        };
        if self.derived {
            collection.velocities = collection.derived_velocities();
        }
        let surfaces = Surfaces {
            collection,
            ..self.clone()
        };
        Ok(Some((surfaces, held_out)))
    }
}
