//! How a prediction's distance to the truth is measured.

use crate::hausdorff::{Sector, symmetric_modified_hausdorff};

/// The distance between two states of a surface.
#[derive(Clone)]
pub(crate) enum Distance {
    /// The modified Hausdorff distance, as the paper has it.
    ModifiedHausdorff(Sector),
    /// The mean distance of the nodes: of other people's data it is not known that a node may slide within the surface.
    Nodes,
}

impl Distance {
    /// Distance between two lists of nodes of the same length, in their unit.
    pub(crate) fn between(&self, a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
        match self {
            Distance::ModifiedHausdorff(sector) => symmetric_modified_hausdorff(a, b, sector),
            Distance::Nodes => {
                let apart = |(p, q): (&[f64; 3], &[f64; 3])| (0..3).map(|d| (p[d] - q[d]).powi(2)).sum::<f64>().sqrt();
                a.iter().zip(b).map(apart).sum::<f64>() / a.len() as f64
            }
        }
    }
}
