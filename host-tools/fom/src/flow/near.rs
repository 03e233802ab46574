//! Targets in compact blocks, which share one far-field decision, and targets close to an element or a panel with their
//! corrections.

use std::ops::Range;

use super::stokeslet::{self, SourceSlice};

/// A ball around some points.
#[derive(Debug, Clone, Copy)]
pub struct Ball {
    /// Its centre.
    pub centre: [f64; 3],
    /// Its radius.
    pub radius: f64,
}

impl Ball {
    /// A ball about the mean of some points that holds them; of longer arrays the first three entries count.
    #[inline]
    pub fn around<const N: usize>(points: &[[f64; N]]) -> Self {
        let mut centre = [0.0; 3];
        for point in points {
            for d in 0..3 {
                centre[d] += point[d];
            }
        }
        for c in &mut centre {
            *c /= points.len() as f64;
        }
        let mut square = 0.0_f64;
        for point in points {
            square = square.max(distance_squared([point[0], point[1], point[2]], centre));
        }
        Self {
            centre,
            radius: square.sqrt(),
        }
    }

    /// Whether all points of `other` are farther from the centre than `reach` radii.
    pub fn is_beyond(&self, reach: f64, other: Self) -> bool {
        let distance = reach * self.radius + other.radius;
        distance_squared(self.centre, other.centre) >= distance * distance
    }
}

/// Targets, sorted into blocks of neighbours with a ball around each.
#[derive(Debug, Clone)]
pub struct TargetBlocks {
    /// Which of the given targets they are.
    index: Vec<u32>,
    position: Vec<[f64; 3]>,
    balls: Vec<Ball>,
    /// The last block of each of so many targets may be smaller.
    period: usize,
}

/// Targets of a block.
pub const BLOCK: usize = 16;

impl TargetBlocks {
    /// Sorts the targets by cutting them in two, across their longest extent, until a block is left.
    pub fn new(targets: &[[f64; 3]]) -> Self {
        let mut index: Vec<u32> = (0..targets.len() as u32).collect();
        bisect(&mut index, targets);
        let position: Vec<[f64; 3]> = index.iter().map(|&i| targets[i as usize]).collect();
        Self {
            balls: position.chunks(BLOCK).map(Ball::around::<3>).collect(),
            period: index.len(),
            index,
            position,
        }
    }

    /// The images of the targets under some isometries, those of one after those of the other.
    pub fn images(&self, maps: impl Iterator<Item = impl Fn([f64; 3]) -> [f64; 3]>) -> Self {
        let mut images = Self {
            index: Vec::new(),
            position: Vec::new(),
            balls: Vec::new(),
            period: self.period,
        };
        for (k, map) in (0..).zip(maps) {
            images
                .index
                .extend(self.index.iter().map(|i| i + k * self.period as u32));
            images.position.extend(self.position.iter().map(|&p| map(p)));
            images.balls.extend(self.balls.iter().map(|ball| Ball {
                centre: map(ball.centre),
                ..*ball
            }));
        }
        images
    }

    /// The number of targets.
    pub fn targets(&self) -> usize {
        self.index.len()
    }

    /// The number of blocks.
    pub fn len(&self) -> usize {
        self.balls.len()
    }

    /// The ball around block `b`.
    pub fn ball(&self, b: usize) -> Ball {
        self.balls[b]
    }

    fn range(&self, b: usize) -> Range<usize> {
        let blocks = self.period.div_ceil(BLOCK);
        let first = b / blocks * self.period;
        let start = first + b % blocks * BLOCK;
        start..(start + BLOCK).min(first + self.period)
    }

    /// The positions of the targets of block `b`.
    pub fn positions(&self, b: usize) -> &[[f64; 3]] {
        &self.position[self.range(b)]
    }

    /// Adds the values found for block `b` to the list of the given targets.
    pub fn add_to(&self, b: usize, values: &[[f64; 3]], out: &mut [[f64; 3]]) {
        for (&i, value) in self.index[self.range(b)].iter().zip(values) {
            add(&mut out[i as usize], value);
        }
    }

    /// All targets of some blocks.
    pub fn gather(&self, blocks: &[u32]) -> NearTargets {
        let mut near = NearTargets::with_capacity(blocks.len() * BLOCK);
        for range in blocks.iter().map(|&b| self.range(b as usize)) {
            near.index.extend_from_slice(&self.index[range.clone()]);
            near.position.extend_from_slice(&self.position[range]);
        }
        near.value.resize(near.index.len(), [0.0; 3]);
        near
    }
}

fn bisect(index: &mut [u32], targets: &[[f64; 3]]) {
    if index.len() <= BLOCK {
        return;
    }
    let extent = |d: usize| {
        let coordinates = || index.iter().map(|&i| targets[i as usize][d]);
        coordinates().fold(f64::MIN, f64::max) - coordinates().fold(f64::MAX, f64::min)
    };
    let [x, y, z] = [0, 1, 2].map(extent);
    let longest = if x >= y.max(z) {
        0
    } else if y >= z {
        1
    } else {
        2
    };
    let middle = index.len().div_ceil(BLOCK) / 2 * BLOCK;
    index.select_nth_unstable_by(middle, |&i, &j| {
        targets[i as usize][longest].total_cmp(&targets[j as usize][longest])
    });
    let (low, high) = index.split_at_mut(middle);
    bisect(low, targets);
    bisect(high, targets);
}

/// Of each source (an element or a panel) the blocks of targets close to it, from the sources close to each block.
pub fn transpose(close: &[Vec<u32>], sources: usize) -> Vec<Vec<u32>> {
    let mut blocks = vec![Vec::new(); sources];
    for (b, close) in (0..).zip(close) {
        for &source in close {
            blocks[source as usize].push(b);
        }
    }
    blocks
}

/// Targets by index, with positions and the values gathered for them.
#[derive(Debug)]
pub struct NearTargets {
    index: Vec<u32>,
    position: Vec<[f64; 3]>,
    value: Vec<[f64; 3]>,
}

impl NearTargets {
    fn with_capacity(capacity: usize) -> Self {
        Self {
            index: Vec::with_capacity(capacity),
            position: Vec::with_capacity(capacity),
            value: Vec::with_capacity(capacity),
        }
    }

    /// Their number.
    pub fn len(&self) -> usize {
        self.index.len()
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

    /// Adds the values to the list that the targets were taken from.
    pub fn add_to(&self, out: &mut [[f64; 3]]) {
        for (&i, value) in self.index.iter().zip(&self.value) {
            add(&mut out[i as usize], value);
        }
    }
}

fn add(value: &mut [f64; 3], change: &[f64; 3]) {
    for d in 0..3 {
        value[d] += change[d];
    }
}

fn distance_squared(a: [f64; 3], b: [f64; 3]) -> f64 {
    let (x, y, z) = (a[0] - b[0], a[1] - b[1], a[2] - b[2]);
    x * x + y * y + z * z
}
