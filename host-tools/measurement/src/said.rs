//! Information on an outline beside its file.

use capsule_contour::text::Unit;
use capsule_contour::{Edge, Picture};
use capsule_identify::Direction;

/// Information on an outline beside its file.
#[derive(Clone, Debug)]
pub struct Said {
    /// Half the side of the channel, in um.
    pub half_width_um: f64,
    /// Unit of a text's numbers, where its headings do not say it.
    pub unit: Option<Unit>,
    /// Size of a pixel, in um.
    pub pixel_um: Option<f64>,
    /// Direction of the flow, as in a picture: y points down in it, and up in a text.
    pub direction: Direction,
    /// Which of several capsules in a picture, from 1.
    pub capsule: Option<usize>,
    /// Criterion for the edge in a picture.
    pub edge: Option<Edge>,
    /// Picture of the empty channel.
    pub background: Option<Picture>,
}
