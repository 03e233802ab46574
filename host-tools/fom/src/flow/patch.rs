//! A curved triangle that carries a load, both P2: an element of the membrane or a part of one.

use multiversion::multiversion;
use multiversion::target::match_target;

use super::quadrature::TriangleRule;
use super::stokeslet::{LANES, Sources, fused};

/// Six nodes (VTK order) with their positions and loads.
#[derive(Debug, Clone)]
pub struct Patch {
    /// Position and load at each node: x, y, z, qx, qy, qz.
    nodes: [[f64; 6]; 6],
}

impl Patch {
    /// The element with nodes `element` of a membrane.
    pub fn new(element: &[u32; 6], nodes: &[[f64; 3]], load: &[[f64; 3]]) -> Self {
        Self {
            nodes: element.map(|i| {
                let ([x, y, z], [qx, qy, qz]) = (nodes[i as usize], load[i as usize]);
                [x, y, z, qx, qy, qz]
            }),
        }
    }

    /// Centre and radius of a ball that holds the nodes.
    pub fn ball(&self) -> ([f64; 3], f64) {
        let centre = [0, 1, 2].map(|d| self.nodes.iter().map(|n| n[d]).sum::<f64>() / 6.0);
        let square = |n: &[f64; 6]| (0..3).map(|d| (n[d] - centre[d]) * (n[d] - centre[d])).sum::<f64>();
        (centre, self.nodes.iter().map(square).fold(0.0, f64::max).sqrt())
    }

    /// The four patches that the mid-edge nodes cut it into. A part of a P2 triangle is again P2: nothing is lost.
    pub fn split(&self) -> [Self; 4] {
        let n = &self.nodes;
        // On the edge (a, b) with the mid-node m, a quarter of the way from a to b.
        let quarter = |a: usize, m: usize, b: usize| {
            [0, 1, 2, 3, 4, 5].map(|c| 0.375 * n[a][c] + 0.75 * n[m][c] - 0.125 * n[b][c])
        };
        // Half-way between two mid-edge nodes p and q about the corner a; r is the third, b and c the other corners.
        let inner = |p: usize, q: usize, r: usize, b: usize, c: usize| {
            [0, 1, 2, 3, 4, 5].map(|k| 0.5 * (n[p][k] + n[q][k]) + 0.25 * n[r][k] - 0.125 * (n[b][k] + n[c][k]))
        };
        let (e03, e31) = (quarter(0, 3, 1), quarter(1, 3, 0));
        let (e14, e42) = (quarter(1, 4, 2), quarter(2, 4, 1));
        let (e25, e50) = (quarter(2, 5, 0), quarter(0, 5, 2));
        let (i35, i43, i54) = (inner(3, 5, 4, 1, 2), inner(4, 3, 5, 2, 0), inner(5, 4, 3, 0, 1));
        [
            [n[0], n[3], n[5], e03, i35, e50],
            [n[3], n[1], n[4], e31, e14, i43],
            [n[5], n[4], n[2], i54, e42, e25],
            [n[3], n[4], n[5], i43, i54, i35],
        ]
        .map(|nodes| Self { nodes })
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

/// Shape functions, their two derivatives, and weights at [`LANES`] points.
#[derive(Debug, Clone)]
struct Block {
    shape: [[f64; LANES]; 6],
    derivatives: [[[f64; LANES]; 6]; 2],
    weight: [f64; LANES],
}

impl PatchRule {
    /// Tabulates the shape functions at the points of `rule`.
    pub fn new(rule: &TriangleRule) -> Self {
        let mut blocks = vec![
            Block {
                shape: [[0.0; LANES]; 6],
                derivatives: [[[0.0; LANES]; 6]; 2],
                weight: [0.0; LANES],
            };
            rule.points.len().div_ceil(LANES)
        ];
        for (p, (&point, &weight)) in rule.points.iter().zip(&rule.weights).enumerate() {
            let (block, lane) = (&mut blocks[p / LANES], p % LANES);
            let (shape, derivatives) = shape_functions(point);
            for k in 0..6 {
                block.shape[k][lane] = shape[k];
                block.derivatives[0][k][lane] = derivatives[0][k];
                block.derivatives[1][k][lane] = derivatives[1][k];
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

/// The P2 shape functions and their derivatives at a point of the reference triangle.
fn shape_functions([s, t]: [f64; 2]) -> ([f64; 6], [[f64; 6]; 2]) {
    let r = 1.0 - s - t;
    (
        [
            r * (2.0 * r - 1.0),
            s * (2.0 * s - 1.0),
            t * (2.0 * t - 1.0),
            4.0 * r * s,
            4.0 * s * t,
            4.0 * t * r,
        ],
        [
            [1.0 - 4.0 * r, 4.0 * s - 1.0, 0.0, 4.0 * (r - s), 4.0 * t, -4.0 * t],
            [1.0 - 4.0 * r, 0.0, 4.0 * t - 1.0, -4.0 * s, 4.0 * s, 4.0 * (r - t)],
        ],
    )
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx2+fma", "x86_64+avx2+fma"))]
fn interpolate(blocks: &[Block], nodes: &[[f64; 6]; 6], sources: [&mut [f64]; 6]) {
    match_target! {
        "x86_64+fma" => interpolate_blocks::<true>(blocks, nodes, sources),
        _ => interpolate_blocks::<false>(blocks, nodes, sources),
    }
}

#[inline(always)]
fn interpolate_blocks<const FMA: bool>(blocks: &[Block], nodes: &[[f64; 6]; 6], sources: [&mut [f64]; 6]) {
    for (b, block) in blocks.iter().enumerate() {
        let mut value = [[0.0; LANES]; 6];
        let mut tangents = [[[0.0; LANES]; 3]; 2];
        for k in 0..6 {
            for c in 0..6 {
                for l in 0..LANES {
                    value[c][l] = fused::<FMA>(block.shape[k][l], nodes[k][c], value[c][l]);
                }
            }
            for (tangent, derivative) in tangents.iter_mut().zip(&block.derivatives) {
                for d in 0..3 {
                    for l in 0..LANES {
                        tangent[d][l] = fused::<FMA>(derivative[k][l], nodes[k][d], tangent[d][l]);
                    }
                }
            }
        }
        let mut area = [0.0; LANES];
        let [u, v] = &tangents;
        for l in 0..LANES {
            let x = u[1][l] * v[2][l] - u[2][l] * v[1][l];
            let y = u[2][l] * v[0][l] - u[0][l] * v[2][l];
            let z = u[0][l] * v[1][l] - u[1][l] * v[0][l];
            area[l] = (x * x + y * y + z * z).sqrt() * block.weight[l];
        }
        for d in 0..3 {
            sources[d][b * LANES..][..LANES].copy_from_slice(&value[d]);
            for l in 0..LANES {
                sources[3 + d][b * LANES + l] = value[3 + d][l] * area[l];
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
        let (_, radius) = curved().ball();
        for part in curved().split() {
            let (_, part_radius) = part.ball();
            assert!(part_radius < 0.7 * radius);
        }
    }
}
