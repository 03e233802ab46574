//! The effect of the full-order model's bending stiffness, in words.

use capsule_core::Model;
use serde::Serialize;
use std::fmt::{self, Display, Formatter};

/// By how much the full-order model's bending stiffness changes its solution, at the nearest configuration for which
/// that is known.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BendingEffect {
    ca: f32,
    confinement: f32,
    /// Modified Hausdorff distance of the steady shapes with and without it, as a fraction of a.
    distance: f32,
}

/// The nearest in ln Ca and a/l, where a factor of two in Ca counts as 0.1 in a/l; `None` if the model has none.
pub fn bending_effect(model: &Model<'_>, parameters: &[f64]) -> Option<BendingEffect> {
    let [capillary_number, confinement] = *parameters.first_chunk()?;
    let known = model.bending_effect();
    let effect = |row| BendingEffect {
        ca: known.get(row, 0),
        confinement: known.get(row, 1),
        distance: known.get(row, 2),
    };
    let square = |at: &BendingEffect| {
        let octaves = (f64::from(at.ca) / capillary_number).log2();
        octaves * octaves + ((f64::from(at.confinement) - confinement) / 0.1).powi(2)
    };
    let effects = (0..known.rows()).map(effect);
    effects.min_by(|a, b| square(a).total_cmp(&square(b)))
}

impl Display for BendingEffect {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self {
            ca,
            confinement,
            distance,
        } = self;
        let percent = 100.0 * distance;
        write!(
            f,
            "The bending stiffness changes the full-order solution by {percent:.2} % of a at Ca = {ca}, \
             a/l = {confinement}, the nearest configuration for which that is known."
        )
    }
}
