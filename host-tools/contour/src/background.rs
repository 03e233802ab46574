//! The empty channel behind the capsules, from what the ends of the picture show of it.
//!
//! A channel is the same all along, so what lies between the two ends is what both show: profiles across the channel,
//! shifted along the channel's slope where it is not parallel to the picture's edge, and with a linear change of the
//! light along it.

use crate::grid::{Grid, median, vertex};

/// The share of the columns that make the profile of an end, and the fewest.
const SHARE: usize = 20;
const FEWEST: usize = 3;
/// The steepest slope of the channel that is searched for.
const STEEPEST: f64 = 0.06;
/// Rows over which a step of brightness is measured.
const STEP: usize = 6;
/// Contrast of a capsule, in that of the walls, that is not looked for in the ends.
const WEAK: f64 = 0.2;
/// How much stronger the light at one end may be.
const STRONGER: f64 = 1.5;
/// A step in the one end that the other does not have, in the contrast of the capsule, that is no uneven light.
const FOREIGN: f64 = 0.4;
/// The same in the usual step, which is noise.
const CLEAR: f64 = 8.0;

/// Profiles of the brightness across the channel at both ends of a picture.
#[derive(Clone, Debug)]
pub(crate) struct Ends {
    pub(crate) profiles: [Vec<f64>; 2],
    /// Places of the profiles along the channel.
    pub(crate) places: [f64; 2],
    /// Rise of the channel's axis, in pixels per pixel.
    pub(crate) slope: f64,
}

impl Ends {
    pub(crate) fn of(grid: &Grid) -> Self {
        let count = (grid.width / SHARE).max(FEWEST);
        let profile = |first: usize| {
            (0..grid.height)
                .map(|y| median(&mut (first..first + count).map(|x| grid.at(x, y)).collect::<Vec<_>>()))
                .collect::<Vec<_>>()
        };
        let profiles = [profile(0), profile(grid.width - count)];
        let places = [0.5 * count as f64, grid.width as f64 - 0.5 * count as f64];
        let slope = shift(&profiles, STEEPEST * (places[1] - places[0])) / (places[1] - places[0]);
        Self {
            profiles,
            places,
            slope,
        }
    }

    /// Brightness of the empty channel.
    fn at(&self, x: f64, y: f64) -> f64 {
        let share = ((x - self.places[0]) / (self.places[1] - self.places[0])).clamp(0.0, 1.0);
        let [left, right] = [0, 1].map(|end| {
            let y = y - self.slope * (x - self.places[end]);
            between(&self.profiles[end], y)
        });
        left + share * (right - left)
    }

    /// Takes the empty channel away from the picture.
    pub(crate) fn taken_from(&self, mut grid: Grid) -> Grid {
        let width = grid.width;
        for (i, value) in grid.values.iter_mut().enumerate() {
            *value -= self.at((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
        }
        grid
    }

    /// The profile of the right end, shifted to where its walls are those of the left end.
    fn aligned(&self) -> Vec<f64> {
        let [left, right] = &self.profiles;
        let rise = self.slope * (self.places[1] - self.places[0]);
        (0..left.len()).map(|y| between(right, y as f64 + 0.5 + rise)).collect()
    }

    /// How much both ends have in common: the sum of the products of their steps.
    pub(crate) fn common(&self) -> f64 {
        product(&self.profiles[0], &self.aligned())
    }

    /// Whether one end shows an edge of something that the other does not show.
    pub(crate) fn differ(&self, contrast: f64) -> bool {
        let (left, right) = (&self.profiles[0], self.aligned());
        // Walls in weaker light are weaker.
        let light = product(left, &right) / product(&right, &right).max(f64::MIN_POSITIVE);
        let light = light.clamp(1.0 / STRONGER, STRONGER);
        let difference: Vec<f64> = left
            .iter()
            .zip(&right)
            .map(|(left, right)| left - light * right)
            .collect();
        let range = left
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
                [low.min(*value), high.max(*value)]
            });
        let contrast = contrast.max(WEAK * (range[1] - range[0]));
        let mut steps: Vec<f64> = difference
            .windows(STEP + 1)
            .map(|window| (window[STEP] - window[0]).abs())
            .collect();
        let greatest = steps.iter().copied().fold(0.0, f64::max);
        greatest > (FOREIGN * contrast).max(CLEAR * median(&mut steps))
    }
}

/// The sum of the products of the steps of two profiles.
fn product(a: &[f64], b: &[f64]) -> f64 {
    let steps = a.windows(2).zip(b.windows(2));
    steps.map(|(a, b)| (a[1] - a[0]) * (b[1] - b[0])).sum()
}

/// The value of a profile at a place between the centres of its rows.
fn between(profile: &[f64], y: f64) -> f64 {
    let y = (y - 0.5).clamp(0.0, (profile.len() - 1) as f64);
    let row = (y as usize).min(profile.len() - 2);
    profile[row] + (y - row as f64) * (profile[row + 1] - profile[row])
}

/// By how many rows the second profile is lower in the picture than the first: where their derivatives differ least. 0
/// where no shift makes them much more alike.
fn shift([left, right]: &[Vec<f64>; 2], most: f64) -> f64 {
    let steps = |profile: &[f64]| profile.windows(2).map(|pair| pair[1] - pair[0]).collect::<Vec<_>>();
    let (left, right) = (steps(left), steps(right));
    let most = (most as isize).min(left.len() as isize / 4);
    let difference = |shift: isize| {
        let rows = most..left.len() as isize - most;
        let square = |row: isize| (left[row as usize] - right[(row + shift) as usize]).powi(2);
        rows.map(square).sum::<f64>()
    };
    let sums: Vec<f64> = (-most..=most).map(difference).collect();
    let least = (0..sums.len())
        .min_by(|a, b| sums[*a].total_cmp(&sums[*b]))
        .unwrap_or(0);
    let unshifted = sums[most as usize];
    if least == 0 || least + 1 >= sums.len() || sums[least] > 0.5 * unshifted && least != most as usize {
        return 0.0;
    }
    least as f64 - most as f64 + vertex([sums[least - 1], sums[least], sums[least + 1]])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_channel_that_slopes_is_taken_away() {
        let (width, height) = (200, 90);
        let slope = 0.02;
        let wall = |y: f64| 0.7 - 0.5 * (-((y - 15.0) / 3.0_f64).powi(2)).exp() + 0.001 * y;
        let values = (0..width * height)
            .map(|i| {
                let (x, y) = ((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
                wall(y - slope * x) + 1e-4 * x
            })
            .collect();
        let grid = Grid { width, height, values };
        let ends = Ends::of(&grid);
        assert!((ends.slope - slope).abs() < 1e-3, "{}", ends.slope);
        let left = ends.taken_from(grid);
        let greatest = left.values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        assert!(greatest < 0.03, "{greatest}");
        assert!(!ends.differ(0.3));
    }
}
