//! The walls of the channel, in the profiles of the brightness across it.

use crate::background::Ends;
use crate::grid::{median, vertex};

/// Share of the greatest change of brightness of a side from which a change is a wall.
const STEEP: f64 = 0.3;
/// The same in the noise of the changes.
const CLEAR: f64 = 8.0;
/// The same in the contrast of the capsule, a pixel.
const FAINT: f64 = 0.01;
/// Share by which the distances of the walls at the two ends may differ.
const PARALLEL: f64 = 0.02;

/// The two walls of a channel: where the brightness changes most, on the side of the liquid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Walls {
    /// Both walls as lines: the places of their ends, in pixels.
    pub lines: [[[f64; 2]; 2]; 2],
    /// Their distance, in pixels.
    pub distance: f64,
}

impl Walls {
    /// The walls around a row at the middle of the picture's length, in the profiles of an empty channel.
    pub(crate) fn around(row: f64, ends: &Ends, contrast: f64) -> Option<Self> {
        let middle = 0.5 * (ends.places[0] + ends.places[1]);
        let mut lines = [[[0.0; 2]; 2]; 2];
        for end in 0..2 {
            let place = ends.places[end];
            let row = row + ends.slope * (place - middle);
            for (side, line) in lines.iter_mut().enumerate() {
                line[end] = [place, wall(&ends.profiles[end], row, side == 0, contrast)?];
            }
        }
        let apart = [0, 1].map(|end| lines[1][end][1] - lines[0][end][1]);
        let [left, right] = apart;
        if (left - right).abs() > PARALLEL * left.max(right) {
            return None;
        }
        let cosine = 1.0 / ends.slope.hypot(1.0);
        Some(Self {
            lines,
            distance: 0.5 * (left + right) * cosine,
        })
    }
}

/// The first wall up or down from a row.
fn wall(profile: &[f64], row: f64, up: bool, contrast: f64) -> Option<f64> {
    let changes: Vec<f64> = (1..profile.len() - 1)
        .map(|y| 0.5 * (profile[y + 1] - profile[y - 1]).abs())
        .collect();
    let noise = median(&mut changes.clone());
    let start = (row as usize).clamp(1, changes.len() - 2);
    let outward: Vec<usize> = if up {
        (1..start).rev().collect()
    } else {
        (start..changes.len() - 1).collect()
    };
    let greatest = outward.iter().map(|i| changes[*i]).fold(0.0, f64::max);
    let least = (STEEP * greatest).max(CLEAR * noise).max(FAINT * contrast);
    let peak = |i: &usize| changes[*i] >= least && changes[*i] >= changes[i - 1] && changes[*i] >= changes[i + 1];
    let at = outward.into_iter().find(peak)?;
    // The change `at` is that of the row after it, whose centre is half a row farther.
    Some(at as f64 + 1.5 + vertex([changes[at - 1], changes[at], changes[at + 1]]))
}
