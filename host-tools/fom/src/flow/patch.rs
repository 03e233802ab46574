//! A curved triangle that carries a load, both P2: an element of the membrane or a part of one.

use std::hint::black_box;

use multiversion::multiversion;
use multiversion::target::match_target;
use nalgebra::Vector3;

use super::near::Ball;
use super::quadrature::TriangleRule;
use super::real::fused;
use super::stokeslet::{LANES, Sources};
use crate::shape_functions;

/// Six nodes (VTK order) with all that is interpolated between them.
#[derive(Debug, Clone)]
pub struct Patch {
    /// Position, load and area vector at each node: x, y, z, qx, qy, qz, nx, ny, nz. The area vector, the cross product
    /// of the two tangents, is a quadratic polynomial like the others: its interpolation is exact.
    nodes: [[f64; FIELDS]; 6],
}

const FIELDS: usize = 9;

impl Patch {
    /// The element with nodes `element` of a membrane.
    pub fn new(element: &[u32; 6], nodes: &[[f64; 3]], load: &[[f64; 3]]) -> Self {
        let mut patch = Self {
            nodes: [[0.0; FIELDS]; 6],
        };
        for (values, &i) in patch.nodes.iter_mut().zip(element) {
            values[..3].copy_from_slice(&nodes[i as usize]);
            values[3..6].copy_from_slice(&load[i as usize]);
        }
        let x = &patch.nodes;
        // The two tangents at the nodes: linear, so that those at the corners give those half-way.
        let mut tangents = [[Vector3::zeros(); 6]; 2];
        for d in 0..3 {
            let [a, b, c, ab, bc, ca] = [x[0][d], x[1][d], x[2][d], x[3][d], x[4][d], x[5][d]];
            let corners = [
                [4.0 * ab - 3.0 * a - b, a + 3.0 * b - 4.0 * ab, a - b + 4.0 * (bc - ca)],
                [4.0 * ca - 3.0 * a - c, a - c + 4.0 * (bc - ab), a + 3.0 * c - 4.0 * ca],
            ];
            for (tangent, corners) in tangents.iter_mut().zip(corners) {
                for k in 0..3 {
                    tangent[k][d] = corners[k];
                    tangent[k + 3][d] = 0.5 * (corners[k] + corners[(k + 1) % 3]);
                }
            }
        }
        for (k, values) in patch.nodes.iter_mut().enumerate() {
            values[6..].copy_from_slice(tangents[0][k].cross(&tangents[1][k]).as_slice());
        }
        patch
    }

    /// A ball that holds the nodes.
    pub fn ball(&self) -> Ball {
        Ball::around(&self.nodes)
    }

    /// The four patches that the mid-edge nodes cut it into. A part of a P2 triangle is again P2, so this is exact.
    pub fn split(&self) -> [Self; 4] {
        // The nodes, those a quarter of the way along the edges, and those half-way between two mid-edge nodes.
        let mut points = [[0.0; FIELDS]; 15];
        points[..6].copy_from_slice(&self.nodes);
        for (point, [a, m, b]) in [[0, 3, 1], [1, 3, 0], [1, 4, 2], [2, 4, 1], [2, 5, 0], [0, 5, 2]]
            .iter()
            .enumerate()
        {
            for c in 0..FIELDS {
                points[6 + point][c] = 0.375 * self.nodes[*a][c] + 0.75 * self.nodes[*m][c] - 0.125 * self.nodes[*b][c];
            }
        }
        // Between p and q about a corner; r is the third mid-edge node, b and c are the other corners.
        for (point, [p, q, r, b, c]) in [[3, 5, 4, 1, 2], [4, 3, 5, 2, 0], [5, 4, 3, 0, 1]].iter().enumerate() {
            let n = &self.nodes;
            for k in 0..FIELDS {
                points[12 + point][k] = 0.5 * (n[*p][k] + n[*q][k]) + 0.25 * n[*r][k] - 0.125 * (n[*b][k] + n[*c][k]);
            }
        }
        for point in &mut points {
            // The parts have a quarter of the area.
            for c in 6..FIELDS {
                point[c] *= 0.25;
            }
        }
        let part = |nodes: [usize; 6]| Self {
            nodes: nodes.map(|point| points[point]),
        };
        [
            part([0, 3, 5, 6, 12, 11]),
            part([3, 1, 4, 7, 8, 13]),
            part([5, 4, 2, 14, 9, 10]),
            part([3, 4, 5, 13, 14, 12]),
        ]
    }

    /// Adds the patch's sources by a rule, `rule.slots()` of them: at each point the load times weight and surface
    /// element.
    pub fn add_sources(&self, rule: &PatchRule, sources: &mut Sources) {
        interpolate(&rule.blocks, &self.nodes, sources.extend(rule.slots()));
    }
}

/// A triangle rule with the P2 shape functions at its points, in blocks of [`LANES`] points. The last block is filled
/// up with points of no weight.
#[derive(Debug, Clone)]
pub struct PatchRule {
    blocks: Vec<Block>,
}

/// Shape functions and weights at [`LANES`] points.
#[derive(Debug, Clone)]
struct Block {
    shape: [[f64; LANES]; 6],
    weight: [f64; LANES],
}

impl PatchRule {
    /// Tabulates the shape functions at the points of `rule`.
    pub fn new(rule: &TriangleRule) -> Self {
        let mut blocks = vec![
            Block {
                shape: [[0.0; LANES]; 6],
                weight: [0.0; LANES],
            };
            rule.points.len().div_ceil(LANES)
        ];
        for (p, (&point, &weight)) in rule.points.iter().zip(&rule.weights).enumerate() {
            let (block, lane) = (&mut blocks[p / LANES], p % LANES);
            for (values, value) in block.shape.iter_mut().zip(shape_functions::values(point)) {
                values[lane] = value;
            }
            block.weight[lane] = weight;
        }
        Self { blocks }
    }

    /// The number of sources that it makes: the points, and those of no weight.
    pub fn slots(&self) -> usize {
        self.blocks.len() * LANES
    }

    /// Shape function of node `k` at point `p`.
    pub fn shape(&self, k: usize, p: usize) -> f64 {
        self.blocks[p / LANES].shape[k][p % LANES]
    }
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx2+fma", "x86_64+avx2+fma"))]
fn interpolate(blocks: &[Block], nodes: &[[f64; FIELDS]; 6], sources: [&mut [f64]; 6]) {
    match_target! {
        "x86_64+fma" => interpolate_blocks::<true>(blocks, nodes, sources),
        _ => interpolate_blocks::<false>(blocks, nodes, sources),
    }
}

#[inline(always)]
fn interpolate_blocks<const FMA: bool>(blocks: &[Block], nodes: &[[f64; FIELDS]; 6], sources: [&mut [f64]; 6]) {
    let count = blocks.len();
    let [x, y, z, fx, fy, fz] = sources;
    let ((x, _), (y, _), (z, _)) = (x.as_chunks_mut(), y.as_chunks_mut(), z.as_chunks_mut());
    let ((fx, _), (fy, _), (fz, _)) = (
        fx.as_chunks_mut::<LANES>(),
        fy.as_chunks_mut::<LANES>(),
        fz.as_chunks_mut::<LANES>(),
    );
    let (x, y, z) = (&mut x[..count], &mut y[..count], &mut z[..count]);
    let (fx, fy, fz) = (&mut fx[..count], &mut fy[..count], &mut fz[..count]);
    for (b, block) in blocks.iter().enumerate() {
        // Read in each block: held for all, they would overflow the registers, which takes longer than a short rule.
        let nodes = black_box(nodes);
        let field = |c: usize| {
            let mut value = [0.0; LANES];
            for k in 0..6 {
                for l in 0..LANES {
                    value[l] = fused::<f64, FMA>(block.shape[k][l], nodes[k][c], value[l]);
                }
            }
            value
        };
        [x[b], y[b], z[b]] = [field(0), field(1), field(2)];
        let (nx, ny, nz) = (field(6), field(7), field(8));
        let mut area = [0.0; LANES];
        for l in 0..LANES {
            let square = fused::<f64, FMA>(nx[l], nx[l], fused::<f64, FMA>(ny[l], ny[l], nz[l] * nz[l]));
            area[l] = square.sqrt() * block.weight[l];
        }
        // One loop a component: a loop over all three would not be turned into vector instructions.
        for (force, c) in [(&mut fx[b], 3), (&mut fy[b], 4), (&mut fz[b], 5)] {
            let load = field(c);
            for l in 0..LANES {
                force[l] = load[l] * area[l];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::stokeslet;
    use super::*;

    fn curved() -> Patch {
        let corners = [
            [0.0, 0.0, 0.0],
            [1.0, 0.1, 0.0],
            [0.2, 0.9, 0.2],
            [0.5, -0.1, 0.2],
            [0.7, 0.6, 0.3],
            [0.0, 0.4, 0.1],
        ];
        let load = [
            [1.0, 0.0, 0.2],
            [0.3, -1.0, 0.0],
            [0.5, 0.5, 0.5],
            [0.0, 2.0, -1.0],
            [1.0, 1.0, 0.0],
            [0.2, 0.1, 0.0],
        ];
        Patch::new(&[0, 1, 2, 3, 4, 5], &corners, &load)
    }

    #[test]
    fn parts_add_up_to_the_whole() {
        let rule = PatchRule::new(&TriangleRule::sixteen());
        let target = [0.4, 0.3, 3.0];
        let velocity = |patches: &[Patch]| {
            let mut sources = Sources::default();
            patches.iter().for_each(|p| p.add_sources(&rule, &mut sources));
            stokeslet::sum(sources.all(), target)
        };
        let whole = curved();
        let quarters = whole.split();
        let sixteenths: Vec<_> = quarters.iter().flat_map(Patch::split).collect();
        let (a, b, c) = (velocity(&[whole]), velocity(&quarters), velocity(&sixteenths));
        for d in 0..3 {
            assert!((a[d] - c[d]).abs() < 2e-5, "{a:?} {c:?}");
            assert!((b[d] - c[d]).abs() < 1e-7, "{b:?} {c:?}");
        }
    }

    #[test]
    fn the_ball_holds_the_nodes_and_shrinks_by_half() {
        let radius = curved().ball().radius;
        for part in curved().split() {
            assert!(part.ball().radius < 0.7 * radius);
        }
    }
}
