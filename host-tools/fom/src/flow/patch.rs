//! A curved triangle that carries a load, both P2: an element of the membrane or a part of one.

use multiversion::multiversion;
use multiversion::target::match_target;

use super::near::Ball;
use super::quadrature::TriangleRule;
use super::real::fused;
use super::stokeslet::{LANES, Sources};

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
        let x = element.map(|i| nodes[i as usize]);
        let combine = |terms: &[(f64, usize)]| {
            [0, 1, 2].map(|d| terms.iter().map(|&(factor, node)| factor * x[node][d]).sum::<f64>())
        };
        // The tangents are linear: those at the corners give those half-way.
        let first = [
            combine(&[(-3.0, 0), (-1.0, 1), (4.0, 3)]),
            combine(&[(1.0, 0), (3.0, 1), (-4.0, 3)]),
            combine(&[(1.0, 0), (-1.0, 1), (4.0, 4), (-4.0, 5)]),
        ];
        let second = [
            combine(&[(-3.0, 0), (-1.0, 2), (4.0, 5)]),
            combine(&[(1.0, 0), (-1.0, 2), (-4.0, 3), (4.0, 4)]),
            combine(&[(1.0, 0), (3.0, 2), (-4.0, 5)]),
        ];
        let tangent = |corners: &[[f64; 3]; 3], k: usize| match k {
            0..3 => corners[k],
            _ => [0, 1, 2].map(|d| 0.5 * (corners[k - 3][d] + corners[(k - 2) % 3][d])),
        };
        Self {
            nodes: std::array::from_fn(|k| {
                let ([x, y, z], [qx, qy, qz]) = (x[k], load[element[k] as usize]);
                let (u, v) = (tangent(&first, k), tangent(&second, k));
                let nx = u[1] * v[2] - u[2] * v[1];
                let ny = u[2] * v[0] - u[0] * v[2];
                let nz = u[0] * v[1] - u[1] * v[0];
                [x, y, z, qx, qy, qz, nx, ny, nz]
            }),
        }
    }

    /// A ball that holds the nodes.
    pub fn ball(&self) -> Ball {
        Ball::around(&self.nodes.map(|[x, y, z, ..]| [x, y, z]))
    }

    /// The four patches that the mid-edge nodes cut it into. A part of a P2 triangle is again P2: nothing is lost.
    pub fn split(&self) -> [Self; 4] {
        let n = &self.nodes;
        // On the edge (a, b) with the mid-node m, a quarter of the way from a to b.
        let quarter = |a: usize, m: usize, b: usize| -> [f64; FIELDS] {
            std::array::from_fn(|c| 0.375 * n[a][c] + 0.75 * n[m][c] - 0.125 * n[b][c])
        };
        // Half-way between two mid-edge nodes p and q about the corner a; r is the third, b and c the other corners.
        let inner = |p: usize, q: usize, r: usize, b: usize, c: usize| -> [f64; FIELDS] {
            std::array::from_fn(|k| 0.5 * (n[p][k] + n[q][k]) + 0.25 * n[r][k] - 0.125 * (n[b][k] + n[c][k]))
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
        .map(|nodes| Self {
            // A quarter of the area.
            nodes: nodes
                .map(|[x, y, z, qx, qy, qz, nx, ny, nz]| [x, y, z, qx, qy, qz, 0.25 * nx, 0.25 * ny, 0.25 * nz]),
        })
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
            for (values, value) in block.shape.iter_mut().zip(shape_functions(point)) {
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

/// The P2 shape functions at a point of the reference triangle.
fn shape_functions([s, t]: [f64; 2]) -> [f64; 6] {
    let r = 1.0 - s - t;
    [
        r * (2.0 * r - 1.0),
        s * (2.0 * s - 1.0),
        t * (2.0 * t - 1.0),
        4.0 * r * s,
        4.0 * s * t,
        4.0 * t * r,
    ]
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
