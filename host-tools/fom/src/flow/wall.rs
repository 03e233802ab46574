//! The wall of the duct: panels, the operator from the perturbation traction `f` to the velocity on the wall, its
//! inverse, and the single layer of `f` in the fluid.
//!
//! Only one eighth of the wall carries unknowns, `y = 1, 0 <= z <= 1`: the rest are its images under the symmetry of
//! the square (or all of it does, in the unreduced mode). The mirror `x -> -x` splits the system into an even and an
//! odd part of half the size.

use faer::Mat;
use faer::linalg::solvers::DenseSolveCore;
use nalgebra::Vector3;
use rayon::prelude::*;

use super::dense::Dense;
use super::error::FlowError;
use super::far::Units;
use super::near::{NearTargets, TargetBlocks, transpose};
use super::panel::{LoadedPanel, Panel, PanelRule};
use super::precision::Precision;
use super::stokeslet::{Sources, StokesletSums};
use crate::symmetry::apply;

/// The walls' panels and the inverse of their operator.
#[derive(Debug, Clone)]
pub struct Wall {
    rule: PanelRule,
    /// First the panels at x > 0, then their mirror images in the same order.
    panels: Vec<Panel>,
    /// Operations that make the whole wall of the panels.
    images: Vec<u8>,
    reach: f64,
    /// Nodes, panel by panel.
    nodes: Vec<[f64; 3]>,
    /// Quadrature weights of the nodes.
    weights: Vec<f64>,
    /// Inverse of the operator on fields even and odd under the mirror, at the nodes at x > 0.
    inverses: [Dense; 2],
    precision: Precision,
    /// The nodes as targets.
    blocks: TargetBlocks,
}

/// Size and order of the panels.
#[derive(Debug, Clone)]
pub struct WallLayout {
    /// Panel boundaries in x, from 0 to the half length.
    pub axial: Vec<f64>,
    /// Panels from z = 0 to z = 1.
    pub transverse: usize,
    /// Gauss nodes of a panel in each direction.
    pub order: usize,
    /// Whether the unknowns are reduced by the symmetry of the square.
    pub symmetric: bool,
    /// Parts of panels closer than this, in units of their radius, are divided.
    pub reach: f64,
    /// Of the far sums and the inverse.
    pub precision: Precision,
}

/// The inverse of an operation of the square.
fn inverse(g: u8) -> u8 {
    if g & 4 == 0 { g } else { 4 | (g & 1) << 1 | (g & 2) >> 1 }
}

fn mirror([x, y, z]: [f64; 3]) -> [f64; 3] {
    [-x, y, z]
}

impl Wall {
    /// Lays out the panels, assembles the operator and inverts it.
    ///
    /// # Errors
    /// [`FlowError::SingularWall`].
    pub fn new(layout: &WallLayout) -> Result<Self, FlowError> {
        let rule = PanelRule::new(layout.order);
        let width = 0.5 / layout.transverse as f64;
        let eighth: Vec<Panel> = layout
            .axial
            .windows(2)
            .flat_map(|x| {
                (0..layout.transverse).map(move |k| Panel {
                    centre: Vector3::new(0.5 * (x[0] + x[1]), 1.0, (2 * k + 1) as f64 * width),
                    u: Vector3::x() * (0.5 * (x[1] - x[0])),
                    v: Vector3::z() * width,
                })
            })
            .collect();
        let all: Vec<u8> = (0..8).collect();
        let (mut panels, images) = if layout.symmetric {
            (eighth, all)
        } else {
            (
                all.iter()
                    .flat_map(|&g| eighth.iter().map(move |panel| panel.map(|p| apply(g, p))))
                    .collect(),
                vec![0],
            )
        };
        panels.extend(panels.clone().iter().map(|panel| panel.map(mirror)));
        let (mut nodes, mut weights) = (Vec::new(), Vec::new());
        for panel in &panels {
            panel.for_each_node(&rule, |position, weight| {
                nodes.push(position);
                weights.push(weight);
            });
        }
        let mut wall = Self {
            rule,
            panels,
            images,
            reach: layout.reach,
            blocks: TargetBlocks::new(&nodes),
            nodes,
            weights,
            inverses: Default::default(),
            precision: layout.precision,
        };
        let [even, odd] = wall.operator();
        let (even, odd) = rayon::join(|| inverted(&even), || inverted(&odd));
        wall.inverses = [even?, odd?].map(|inverse| Dense::new(&inverse, layout.precision));
        Ok(wall)
    }

    /// Collocation nodes.
    pub fn nodes(&self) -> &[[f64; 3]] {
        &self.nodes
    }

    /// The collocation nodes as targets.
    pub fn blocks(&self) -> &TargetBlocks {
        &self.blocks
    }

    /// The even and the odd operator, for the nodes at x > 0: `v(x_i) = int_W J(x_i - y) f(y) dS`, components
    /// interleaved.
    fn operator(&self) -> [Mat<f64>; 2] {
        let half = self.nodes.len() / 2;
        let points = self.rule.nodes();
        // Per node three rows of 3 (2 half) entries.
        let rows: Vec<Vec<f64>> = (0..half)
            .into_par_iter()
            .map(|i| {
                let width = 6 * half;
                let mut block = vec![0.0; 3 * width];
                for (p, panel) in self.panels.iter().enumerate() {
                    for &g in &self.images {
                        let integrals = if g == 0 && i / points == p {
                            panel.own_integrals(&self.rule, i % points)
                        } else {
                            panel.integrals(&self.rule, apply(inverse(g), self.nodes[i]), self.reach)
                        };
                        for (k, [xx, yy, zz, xy, xz, yz]) in integrals.into_iter().enumerate() {
                            // Column d: the velocity of a unit density in direction d, rotated back by g.
                            let columns = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]].map(|c| apply(g, c));
                            for (d, column) in columns.iter().enumerate() {
                                for row in 0..3 {
                                    block[row * width + 3 * (p * points + k) + d] += column[row];
                                }
                            }
                        }
                    }
                }
                block
            })
            .collect();
        [1.0, -1.0].map(|parity| {
            Mat::from_fn(3 * half, 3 * half, |row, column| {
                let line = &rows[row / 3][(row % 3) * 6 * half..];
                let sign = if column % 3 == 0 { -parity } else { parity };
                line[column] + sign * line[3 * half + column]
            })
        })
    }

    /// The traction `f` whose layer gives the velocities `v` at the nodes.
    pub fn solve(&self, velocity: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let half = self.nodes.len() / 2;
        let (front, back) = velocity.split_at(half);
        let part = |parity: f64| -> Vec<f64> {
            front
                .iter()
                .zip(back)
                .flat_map(|(front, back)| [0, 1, 2].map(|d| 0.5 * (front[d] + parity * mirror(*back)[d])))
                .collect()
        };
        let [even, odd] = &self.inverses;
        let (even, odd) = rayon::join(|| even.multiply(&part(1.0)), || odd.multiply(&part(-1.0)));
        let at_front = |i: usize| [0, 1, 2].map(|d| even[3 * i + d] + odd[3 * i + d]);
        let at_back = |i: usize| mirror([0, 1, 2].map(|d| even[3 * i + d] - odd[3 * i + d]));
        (0..half).map(at_front).chain((0..half).map(at_back)).collect()
    }

    /// Adds `int_W J(x - y) f(y) dS` over the whole wall to `out`, for each target in the fluid.
    pub fn add_layer(&self, traction: &[[f64; 3]], targets: &TargetBlocks, out: &mut [[f64; 3]]) {
        // The image of the wall under g acts on a target as the wall does on the target turned back by g.
        let turned = targets.images(self.images.iter().map(|&g| move |target| apply(inverse(g), target)));
        let mut sums = vec![[0.0; 3]; turned.targets()];
        let mut sources = Sources::with_capacity(self.nodes.len());
        for ((&position, &weight), f) in self.nodes.iter().zip(&self.weights).zip(traction) {
            sources.push(position, f.map(|c| c * weight));
        }
        let close = match self.precision {
            Precision::Mixed => self.add_far::<f32>(&sources, &turned, &mut sums),
            Precision::Double => self.add_far::<f64>(&sources, &turned, &mut sums),
        };
        let points = self.rule.nodes();
        let near: Vec<NearTargets> = transpose(&close, self.panels.len())
            .par_iter()
            .enumerate()
            .filter(|(_, close)| !close.is_empty())
            .map(|(p, close)| {
                let mut near = turned.gather(close);
                let loaded = LoadedPanel {
                    panel: self.panels[p],
                    density: traction[p * points..][..points].to_vec(),
                };
                self.add_near(&loaded, &mut near, 0, 0, &mut Sources::default());
                near
            })
            .collect();
        for near in &near {
            near.add_to(&mut sums);
        }
        for (sums, &g) in sums.chunks(out.len().max(1)).zip(&self.images) {
            for (value, &sum) in out.iter_mut().zip(sums) {
                let sum = apply(g, sum);
                for d in 0..3 {
                    value[d] += sum[d];
                }
            }
        }
    }

    fn add_far<S: StokesletSums>(
        &self,
        sources: &Sources,
        targets: &TargetBlocks,
        out: &mut [[f64; 3]],
    ) -> Vec<Vec<u32>> {
        let units = Units::<S> {
            balls: &self.panels.iter().map(Panel::ball).collect::<Vec<_>>(),
            sources: &sources.rounded(),
            reach: self.reach,
            coarse: None,
        };
        units.add_far(targets, out)
    }

    fn add_sources(&self, panel: &Panel, density: impl Iterator<Item = [f64; 3]>, sources: &mut Sources) {
        let mut density = density;
        panel.for_each_node(&self.rule, |position, weight| {
            if let Some(f) = density.next() {
                sources.push(position, f.map(|c| c * weight));
            }
        });
    }

    /// Adds the layer of one panel, or part of one, to the targets from `start` on; reorders them.
    fn add_near(&self, part: &LoadedPanel, near: &mut NearTargets, start: usize, depth: usize, sources: &mut Sources) {
        let safe = if depth == DEEPEST {
            0.0
        } else {
            self.reach * part.panel.radius()
        };
        let close = near.move_outside_to_front(start, part.panel.centre.into(), safe);
        if close > start {
            sources.clear();
            self.add_sources(&part.panel, part.density.iter().copied(), sources);
            near.add(sources.all(), start..close);
        }
        if close < near.len() {
            for half in part.halves(&self.rule) {
                self.add_near(&half, near, close, depth + 1, sources);
            }
        }
    }
}

/// Largest depth of the division of a panel, at any distance.
const DEEPEST: usize = 24;

fn inverted(operator: &Mat<f64>) -> Result<Mat<f64>, FlowError> {
    let inverse = operator.partial_piv_lu().inverse();
    if inverse.is_all_finite() {
        Ok(inverse)
    } else {
        Err(FlowError::SingularWall {
            unknowns: operator.nrows(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_operations_undo() {
        for g in 0..8 {
            assert_eq!(apply(inverse(g), apply(g, [1.0, 2.0, 3.0])), [1.0, 2.0, 3.0]);
        }
    }
}
