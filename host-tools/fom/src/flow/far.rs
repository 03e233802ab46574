//! Sums over the sources of elements or panels that are far from a block of targets.

use rayon::prelude::*;

use super::near::{Ball, TargetBlocks};
use super::stokeslet::{self, Sources, StokesletSums};

/// Elements or panels, each with as many sources.
pub struct Units<'a, S> {
    /// Balls around them.
    pub balls: &'a [Ball],
    /// Their sources, unit by unit.
    pub sources: &'a Sources<S>,
    /// Targets closer than this many radii of a unit's ball are close to it.
    pub reach: f64,
    /// Fewer sources that stand for all units together at targets beyond so many radii of every unit's ball.
    pub coarse: Option<(f64, &'a Sources<S>)>,
}

impl<S: StokesletSums> Units<'_, S> {
    /// Adds the velocities of those units that are far from all targets of a block; returns the others of each block.
    pub fn add_far(&self, blocks: &TargetBlocks, out: &mut [[f64; 3]]) -> Vec<Vec<u32>> {
        let sums: Vec<_> = (0..blocks.len())
            .into_par_iter()
            .map(|b| self.block(b, blocks))
            .collect();
        sums.into_iter()
            .enumerate()
            .map(|(b, (values, close))| {
                blocks.add_to(b, &values, out);
                close
            })
            .collect()
    }

    fn block(&self, b: usize, blocks: &TargetBlocks) -> (Vec<[f64; 3]>, Vec<u32>) {
        let (ball, targets) = (blocks.ball(b), blocks.positions(b));
        let mut values = vec![[0.0; 3]; targets.len()];
        if let Some((far, coarse)) = self.coarse
            && self.balls.iter().all(|unit| unit.is_beyond(far, ball))
        {
            stokeslet::add_sums(coarse.all(), targets, &mut values);
            return (values, Vec::new());
        }
        let close: Vec<u32> = (0..)
            .zip(self.balls)
            .filter(|(_, unit)| !unit.is_beyond(self.reach, ball))
            .map(|(index, _)| index)
            .collect();
        // Units that follow each other are summed together.
        let each = self.sources.len() / self.balls.len().max(1);
        let ends = close.iter().copied().chain([self.balls.len() as u32]);
        let mut start = 0;
        for end in ends.map(|unit| unit as usize) {
            let run = self.sources.range(start * each, (end - start) * each);
            stokeslet::add_sums(run, targets, &mut values);
            start = end + 1;
        }
        (values, close)
    }
}
