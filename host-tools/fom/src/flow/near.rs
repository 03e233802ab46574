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

impl NearTargets {
    /// The targets within `distance` of `centre`.
    pub fn within(targets: &[[f64; 3]], centre: [f64; 3], distance: f64) -> Self {
        let mut near = Self::default();
        for (i, &target) in (0..).zip(targets) {
            if distance_squared(target, centre) < distance * distance {
                near.index.push(i);
                near.position.push(target);
                near.value.push([0.0; 3]);
            }
        }
        near
    }

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
