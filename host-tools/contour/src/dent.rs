//! The line of a dent behind: where the membrane on the axis is seen through the capsule.

use crate::grid::Grid;
use crate::rings::extent;

/// The dent behind a capsule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dent {
    /// The place on the axis, in pixels.
    pub place: [f64; 2],
    /// Its distance from the rearmost place of the outline, in pixels.
    pub depth: f64,
}

/// The search: from this many pixels behind the rear to this share of the length.
const NEAREST: f64 = 4.0;
const FARTHEST: f64 = 0.6;
/// Half the width of the strip about the axis that is averaged, in the capsule's width.
const STRIP: f64 = 0.05;
/// Steps per pixel.
const FINE: f64 = 2.0;
/// How far a line must stand out on both sides, in the contrast of the capsule.
const CLEAR: f64 = 0.1;

/// The line across the axis between rear and middle that stands out most, in a picture in which the capsule is bright.
pub(crate) fn dent(grid: &Grid, outline: &[[f64; 2]], rightward: bool, contrast: f64) -> Option<Dent> {
    let [[left, right], [low, high]] = extent(outline);
    let (rear, sign) = if rightward { (left, 1.0) } else { (right, -1.0) };
    let (axis, half) = (0.5 * (low + high), (STRIP * (high - low)).ceil());
    let rows = 2.0 * half + 1.0;
    let count = ((FARTHEST * (right - left) - NEAREST) * FINE) as usize;
    let at = |i: usize| NEAREST + i as f64 / FINE;
    let profile: Vec<f64> = (0..count)
        .map(|i| {
            let row = |j: usize| grid.sample([rear + sign * at(i), axis - half + j as f64]);
            (0..rows as usize).map(row).sum::<f64>() / rows
        })
        .collect();
    // Where the membrane is seen edge-on, it weakens the light more than the rest of the capsule.
    let highest = (1..count.max(2) - 1).max_by(|a, b| profile[*a].total_cmp(&profile[*b]))?;
    let lowest = |values: &[f64]| values.iter().copied().fold(f64::INFINITY, f64::min);
    let (before, after) = (lowest(&profile[..highest]), lowest(&profile[highest + 1..]));
    let prominence = profile[highest] - before.max(after);
    (prominence > CLEAR * contrast).then(|| Dent {
        place: [rear + sign * at(highest), axis],
        depth: at(highest),
    })
}
