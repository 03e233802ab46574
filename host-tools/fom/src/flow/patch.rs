//! A curved triangle that carries a load, both P2: an element of the membrane or a part of one.

use super::quadrature::TriangleRule;
use super::stokeslet::Sources;

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

    /// Adds the patch's sources by a rule: at each point the load times weight and surface element.
    pub fn add_sources(&self, rule: &PatchRule, sources: &mut Sources) {
        for point in &rule.points {
            let mut value = [0.0; 6];
            let mut tangents = [[0.0; 3]; 2];
            for (k, node) in self.nodes.iter().enumerate() {
                for c in 0..6 {
                    value[c] += point.shape[k] * node[c];
                }
                for d in 0..3 {
                    tangents[0][d] += point.derivatives[0][k] * node[d];
                    tangents[1][d] += point.derivatives[1][k] * node[d];
                }
            }
            let [[ax, ay, az], [bx, by, bz]] = tangents;
            let normal = [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx];
            let area = normal.iter().map(|c| c * c).sum::<f64>().sqrt() * point.weight;
            let [x, y, z, qx, qy, qz] = value;
            sources.push([x, y, z], [qx * area, qy * area, qz * area]);
        }
    }
}

/// A triangle rule with the P2 shape functions at its points.
#[derive(Debug, Clone)]
pub struct PatchRule {
    points: Vec<RulePoint>,
}

#[derive(Debug, Clone)]
struct RulePoint {
    shape: [f64; 6],
    derivatives: [[f64; 6]; 2],
    weight: f64,
}

impl PatchRule {
    /// Tabulates the shape functions at the points of `rule`.
    pub fn new(rule: &TriangleRule) -> Self {
        let points = rule.points.iter().zip(&rule.weights).map(|(&[s, t], &weight)| {
            let r = 1.0 - s - t;
            RulePoint {
                shape: [
                    r * (2.0 * r - 1.0),
                    s * (2.0 * s - 1.0),
                    t * (2.0 * t - 1.0),
                    4.0 * r * s,
                    4.0 * s * t,
                    4.0 * t * r,
                ],
                derivatives: [
                    [1.0 - 4.0 * r, 4.0 * s - 1.0, 0.0, 4.0 * (r - s), 4.0 * t, -4.0 * t],
                    [1.0 - 4.0 * r, 0.0, 4.0 * t - 1.0, -4.0 * s, 4.0 * s, 4.0 * (r - t)],
                ],
                weight,
            }
        });
        Self {
            points: points.collect(),
        }
    }

    /// The number of points.
    pub fn len(&self) -> usize {
        self.points.len()
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
