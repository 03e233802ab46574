//! Targets close to an element or a panel, and what is added for them beyond the far sum.

use std::ops::Range;

use super::stokeslet::{self, SourceSlice};

/// Targets by index, with positions and the values gathered for them.
#[derive(Debug, Default)]
pub struct NearTargets {
    index: Vec<u32>,
    position: Vec<[f64; 3]>,
    value: Vec<[f64; 3]>,
}

/// Targets in blocks of a few, each with a ball around it, so that those close to a point are found quickly.
pub struct TargetBlocks<'a> {
    targets: &'a [[f64; 3]],
    balls: Vec<([f64; 3], f64)>,
}

const BLOCK: usize = 16;

impl<'a> TargetBlocks<'a> {
    /// Finds the balls; blocks are of targets that follow each other.
    pub fn new(targets: &'a [[f64; 3]]) -> Self {
        let ball = |block: &[[f64; 3]]| {
            let centre = [0, 1, 2].map(|d| block.iter().map(|p| p[d]).sum::<f64>() / block.len() as f64);
            let square = block.iter().map(|&p| distance_squared(p, centre)).fold(0.0, f64::max);
            (centre, square.sqrt())
        };
        Self {
            targets,
            balls: targets.chunks(BLOCK).map(ball).collect(),
        }
    }

    /// The targets within `distance` of `centre`.
    pub fn within(&self, centre: [f64; 3], distance: f64) -> NearTargets {
        let mut near = NearTargets::default();
        for (b, &(block_centre, radius)) in self.balls.iter().enumerate() {
            if distance_squared(block_centre, centre) < (distance + radius) * (distance + radius) {
                for (i, &target) in (0..).zip(self.targets).skip(b * BLOCK).take(BLOCK) {
                    if distance_squared(target, centre) < distance * distance {
                        near.index.push(i);
                        near.position.push(target);
                    }
                }
            }
        }
        near.value.resize(near.index.len(), [0.0; 3]);
        near
    }
}

impl NearTargets {
    /// Their number.
    pub fn len(&self) -> usize {
        self.index.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.index.is_empty()
    }

    /// Index of the `k`-th in the list it was taken from.
    pub fn index(&self, k: usize) -> usize {
        self.index[k] as usize
    }

    /// Exchanges two of them.
    pub fn swap(&mut self, i: usize, j: usize) {
        self.index.swap(i, j);
        self.position.swap(i, j);
        self.value.swap(i, j);
    }

    /// Moves those of `start..` that are not within `distance` of `centre` to the front of that range; returns where
    /// the others begin.
    pub fn move_outside_to_front(&mut self, start: usize, centre: [f64; 3], distance: f64) -> usize {
        let mut close = start;
        for k in start..self.len() {
            if distance_squared(self.position[k], centre) >= distance * distance {
                self.swap(close, k);
                close += 1;
            }
        }
        close
    }

    /// Adds the velocity of `sources` to the targets in `range`.
    pub fn add(&mut self, sources: SourceSlice<'_>, range: Range<usize>) {
        stokeslet::add_sums(sources, &self.position[range.clone()], &mut self.value[range]);
    }

    /// Sets all values to minus the velocity of `sources`.
    pub fn subtract(&mut self, sources: SourceSlice<'_>) {
        self.value.fill([0.0; 3]);
        self.add(sources, 0..self.len());
        self.value.iter_mut().flatten().for_each(|v| *v = -*v);
    }

    /// Adds the values to the list that the targets were taken from.
    pub fn add_to(&self, out: &mut [[f64; 3]]) {
        for (&i, value) in self.index.iter().zip(&self.value) {
            for d in 0..3 {
                out[i as usize][d] += value[d];
            }
        }
    }
}

fn distance_squared(a: [f64; 3], b: [f64; 3]) -> f64 {
    let d = [0, 1, 2].map(|k| a[k] - b[k]);
    d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
}
