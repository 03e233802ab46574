//! Directions in a picture.

use crate::rings::extent;

/// The edge of the picture that a channel is parallel to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// The upper and the lower edge.
    Horizontal,
    /// The left and the right edge.
    Vertical,
}

/// The direction of the flow in the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// To the right.
    Right,
    /// To the left.
    Left,
    /// Upward.
    Up,
    /// Downward.
    Down,
}

impl Flow {
    /// Its name in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Left => "left",
            Self::Up => "up",
            Self::Down => "down",
        }
    }
}

/// How far from its ends, in its length, the widths of a capsule are compared.
const NEAR_END: f64 = 0.1;
/// The least difference of these widths that tells the front, in the greatest width.
const APART: f64 = 0.05;

/// Whether the flow is to the right: the front of a capsule is narrower than its rear. None where both are alike.
pub(crate) fn rightward(outline: &[[f64; 2]]) -> Option<bool> {
    let [[left, right], [low, high]] = extent(outline);
    let near = NEAR_END * (right - left);
    let width = |within: &dyn Fn(f64) -> bool| {
        let end: Vec<[f64; 2]> = outline.iter().copied().filter(|[x, _]| within(*x)).collect();
        let [_, [low, high]] = extent(&end);
        high - low
    };
    let difference = width(&|x| x < left + near) - width(&|x| x > right - near);
    (difference.abs() > APART * (high - low)).then_some(difference > 0.0)
}
