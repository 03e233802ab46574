//! Where answers are allowed: the sampled domain of a model, cut in two where the solution jumps.

use capsule_core::Model;
use capsule_core::model::Curve;

/// A part of the domain: on one side of the border at which the rear of the membrane buckles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Smaller Ca than at the border: the rear is smooth.
    Smooth,
    /// Greater Ca: the rear is dented. Where there is no border, all of the domain.
    Dented,
}

/// The domain in the coordinates of the fit, [ln Ca, a/l].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Domain<'a> {
    min: [f64; 2],
    max: [f64; 2],
    limit: Curve<'a>,
    border: Curve<'a>,
}

/// Share by which the fit keeps off borders, so that rounding does not cross them.
const MARGIN: f64 = 2e-6;

impl<'a> Domain<'a> {
    /// That of a model of capsules in the channel.
    pub(crate) fn new(model: &Model<'a>) -> Option<Self> {
        let [first, second] = model.parameters() else {
            return None;
        };
        let limit = model.steady_limit_curve();
        (!limit.is_empty()).then(|| Self {
            min: [first.min, second.min],
            max: [first.max, second.max],
            limit,
            border: model.jump_curve(),
        })
    }

    /// Range of a/l.
    pub(crate) fn confinements(&self) -> [f64; 2] {
        [self.min[1], self.max[1]]
    }

    /// Range of ln Ca at an a/l on one side; none where that side has nothing.
    pub(crate) fn range(&self, side: Side, confinement: f64) -> Option<[f64; 2]> {
        let limit = self.limit.at(confinement).unwrap_or(f64::INFINITY);
        let mut range = [self.min[0], self.max[0].min(limit)];
        match (self.border.within(confinement), side) {
            (Some(border), Side::Smooth) => range[1] = range[1].min(border),
            (Some(border), Side::Dented) => range[0] = range[0].max(border),
            (None, Side::Smooth) => return None,
            (None, Side::Dented) => {}
        }
        let [low, high] = range;
        (low < high).then(|| [libm::log(low * (1.0 + MARGIN)), libm::log(high * (1.0 - MARGIN))])
    }

    /// The nearest place of a side, by a/l first.
    pub(crate) fn clamp(&self, side: Side, [ca, confinement]: [f64; 2], from: [f64; 2]) -> [f64; 2] {
        let [low, high] = self.confinements();
        let confinement = confinement.clamp(low, high);
        match self.range(side, confinement) {
            Some([low, high]) => [ca.clamp(low, high), confinement],
            // Beyond the border's end: as far as the side reaches is not farther than where it comes from.
            None => from,
        }
    }
}
