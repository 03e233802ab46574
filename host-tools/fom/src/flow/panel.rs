//! Flat rectangular panels with a tensor Gauss-Legendre grid: the duct's wall and its ends.
//!
//! A density on a panel is the tensor product of Lagrange polynomials on the Gauss nodes. A part of a panel carries
//! the same polynomial, so that panels close to a target are divided without loss.

use nalgebra::Vector3;

use super::near::Ball;
use super::quadrature::gauss_legendre;
use super::stokeslet::stokeslet;
use crate::vectors::norm;

/// The points `centre + s u + t v` with `s, t` in [-1, 1]; `u` and `v` are orthogonal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Panel {
    /// Its centre.
    pub centre: Vector3<f64>,
    /// Half of its first side.
    pub u: Vector3<f64>,
    /// Half of its second side.
    pub v: Vector3<f64>,
}

/// The one-dimensional rule behind the nodes of a panel. Node `(a, b)`, at `s = abscissae[a]` along `u` and
/// `t = abscissae[b]` along `v`, has the index `a order + b`.
#[derive(Debug, Clone)]
pub struct PanelRule {
    abscissae: Vec<f64>,
    weights: Vec<f64>,
    /// `halves[c][i * order + j]`: polynomial `j` at abscissa `i` of the lower (0) and upper (1) half of the interval.
    halves: [Vec<f64>; 2],
}

/// Largest depth of the divisions, at any distance.
const DEEPEST: usize = 24;
/// Points along an edge in the rule for the panel that holds the target.
const EDGE_POINTS: usize = 20;

impl Panel {
    /// The image under a linear map.
    pub fn map(&self, f: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        let f = |vector: Vector3<f64>| f(vector.into()).into();
        Self {
            centre: f(self.centre),
            u: f(self.u),
            v: f(self.v),
        }
    }

    /// Radius of the ball about the centre that holds the panel.
    pub fn radius(&self) -> f64 {
        norm(self.u).hypot(norm(self.v))
    }

    /// The ball about the centre that holds the panel.
    pub fn ball(&self) -> Ball {
        Ball {
            centre: self.centre.into(),
            radius: self.radius(),
        }
    }

    /// Whether the first side is the longer one (the one to cut).
    fn is_long(&self) -> bool {
        norm(self.u) >= norm(self.v)
    }

    /// The two halves, across the longer side.
    fn halves(&self) -> [Self; 2] {
        [-0.5, 0.5].map(|s| {
            let mut half = *self;
            let cut = if self.is_long() { &mut half.u } else { &mut half.v };
            half.centre += s * *cut;
            *cut *= 0.5;
            half
        })
    }

    /// Calls `visit(position, weight)` for each node in order; the weights add up to the area.
    pub fn for_each_node(&self, rule: &PanelRule, mut visit: impl FnMut([f64; 3], f64)) {
        let area = norm(self.u) * norm(self.v);
        for (&s, &ws) in rule.abscissae.iter().zip(&rule.weights) {
            for (&t, &wt) in rule.abscissae.iter().zip(&rule.weights) {
                visit((self.centre + s * self.u + t * self.v).into(), ws * wt * area);
            }
        }
    }

    /// `int J(target - y) L_j(y) dS` for each node `j`, as the components of [`stokeslet`]. Parts of the panel with
    /// their centre nearer than `reach` of their radii are halved.
    pub fn integrals(&self, rule: &PanelRule, target: [f64; 3], reach: f64) -> Vec<[f64; 6]> {
        self.part_integrals(rule, target, reach, 0)
    }

    fn part_integrals(&self, rule: &PanelRule, target: [f64; 3], reach: f64, depth: usize) -> Vec<[f64; 6]> {
        let offset = Vector3::from(target) - self.centre;
        if norm(offset) >= reach * self.radius() || depth == DEEPEST {
            let mut integrals = Vec::with_capacity(rule.nodes());
            self.for_each_node(rule, |y, weight| {
                integrals.push(stokeslet((Vector3::from(target) - Vector3::from(y)).into()).map(|c| c * weight));
            });
            return integrals;
        }
        let order = rule.order();
        let mut integrals = vec![[0.0; 6]; rule.nodes()];
        for (half, interpolation) in self.halves().iter().zip(&rule.halves) {
            let part = half.part_integrals(rule, target, reach, depth + 1);
            // The transpose of the interpolation from the panel's nodes to those of its half.
            for i in 0..order {
                for j in 0..order {
                    let factor = interpolation[i * order + j];
                    for b in 0..order {
                        let (from, to) = if self.is_long() {
                            (i * order + b, j * order + b)
                        } else {
                            (b * order + i, b * order + j)
                        };
                        for c in 0..6 {
                            integrals[to][c] += factor * part[from][c];
                        }
                    }
                }
            }
        }
        integrals
    }

    /// [`Self::integrals`] for a target that is node `node` of the panel itself.
    ///
    /// The panel is the sum of the four triangles over its edges with their apex in the target. In a triangle of
    /// height `h` the points are `rho (h n + s e)`; `s = h sinh(w)` along the edge makes the integrand a polynomial
    /// times `h dw drho` however flat or long the triangle is (plain Duffy coordinates lose digits on long panels).
    pub fn own_integrals(&self, rule: &PanelRule, node: usize) -> Vec<[f64; 6]> {
        let order = rule.order();
        let (s0, t0) = (rule.abscissae[node / order], rule.abscissae[node % order]);
        let (half_u, half_v) = (norm(self.u), norm(self.v));
        let (rho, rho_weights) = gauss_legendre(order);
        let (edge, edge_weights) = gauss_legendre(EDGE_POINTS);
        let mut integrals = vec![[0.0; 6]; rule.nodes()];
        // Height and the range along the edge, in units of length along u and v.
        let (up, down) = ((1.0 - s0) * half_u, (1.0 + s0) * half_u);
        let (right, left) = ((1.0 - t0) * half_v, (1.0 + t0) * half_v);
        for (height, across_u, range) in [
            (up, false, (-left, right)),
            (-down, false, (-left, right)),
            (right, true, (-down, up)),
            (-left, true, (-down, up)),
        ] {
            let h = height.abs();
            let (low, high) = ((range.0 / h).asinh(), (range.1 / h).asinh());
            for (&e, &we) in edge.iter().zip(&edge_weights) {
                let w = 0.5 * (low + high) + 0.5 * (high - low) * e;
                let along = h * w.sinh();
                for (&r, &wr) in rho.iter().zip(&rho_weights) {
                    let r = 0.5 * (1.0 + r);
                    let (du, dv) = if across_u {
                        (r * along, r * height)
                    } else {
                        (r * height, r * along)
                    };
                    let (ds, dt) = (du / half_u, dv / half_v);
                    // J dS = (I + d d^T / d^2) h dw drho
                    let weight = 0.25 * (high - low) * we * wr * h * (du * du + dv * dv).sqrt();
                    let tensor = stokeslet((ds * self.u + dt * self.v).into()).map(|c| c * weight);
                    let (along_u, along_v) = (rule.lagrange(s0 + ds), rule.lagrange(t0 + dt));
                    for a in 0..order {
                        for b in 0..order {
                            let value = along_u[a] * along_v[b];
                            for c in 0..6 {
                                integrals[a * order + b][c] += value * tensor[c];
                            }
                        }
                    }
                }
            }
        }
        integrals
    }
}

impl PanelRule {
    /// The rule with `order` Gauss-Legendre nodes in each direction.
    pub fn new(order: usize) -> Self {
        let (abscissae, weights) = gauss_legendre(order);
        let mut rule = Self {
            abscissae,
            weights,
            halves: [Vec::new(), Vec::new()],
        };
        rule.halves = [-0.5, 0.5].map(|shift| {
            rule.abscissae
                .iter()
                .flat_map(|s| rule.lagrange(0.5 * s + shift))
                .collect()
        });
        rule
    }

    /// Nodes in one direction.
    pub fn order(&self) -> usize {
        self.abscissae.len()
    }

    /// Nodes of a panel.
    pub fn nodes(&self) -> usize {
        self.order() * self.order()
    }

    /// The Lagrange polynomials at `s`.
    fn lagrange(&self, s: f64) -> Vec<f64> {
        let nodes = &self.abscissae;
        (0..nodes.len())
            .map(|j| {
                (0..nodes.len())
                    .filter(|&k| k != j)
                    .map(|k| (s - nodes[k]) / (nodes[j] - nodes[k]))
                    .product()
            })
            .collect()
    }
}

/// A panel with the values of a density at its nodes.
#[derive(Debug, Clone)]
pub struct LoadedPanel {
    /// Where it is.
    pub panel: Panel,
    /// The density at the nodes.
    pub density: Vec<[f64; 3]>,
}

impl LoadedPanel {
    /// The two halves, across the longer side.
    pub fn halves(&self, rule: &PanelRule) -> [Self; 2] {
        let order = rule.order();
        let panels = self.panel.halves();
        [0, 1].map(|half| {
            let interpolation = &rule.halves[half];
            let mut density = vec![[0.0; 3]; rule.nodes()];
            for i in 0..order {
                for j in 0..order {
                    let factor = interpolation[i * order + j];
                    for b in 0..order {
                        let (to, from) = if self.panel.is_long() {
                            (i * order + b, j * order + b)
                        } else {
                            (b * order + i, b * order + j)
                        };
                        for d in 0..3 {
                            density[to][d] += factor * self.density[from][d];
                        }
                    }
                }
            }
            Self {
                panel: panels[half],
                density,
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_support::difference;
    use super::*;

    fn panel(length: f64) -> Panel {
        Panel {
            centre: Vector3::new(0.1, 1.0, 0.2),
            u: Vector3::x() * (0.5 * length),
            v: Vector3::z() * 0.1,
        }
    }

    #[test]
    fn own_panel_agrees_with_halving_down_to_the_singularity() {
        let rule = PanelRule::new(4);
        // Panels up to six times as long as wide.
        for length in [0.2, 0.5, 1.2] {
            let panel = panel(length);
            for node in [0, 5, 7, 15] {
                let own = panel.own_integrals(&rule, node);
                let mut target = [0.0; 3];
                let mut k = 0;
                panel.for_each_node(&rule, |y, _| {
                    if k == node {
                        target = y;
                    }
                    k += 1;
                });
                let halved = panel.integrals(&rule, target, 4.0);
                // The region around the target that halving leaves out contributes about as much as the last part.
                assert!(difference(&own, &halved) < 2e-4 * length, "{length} {node}");
            }
        }
    }

    #[test]
    fn own_panel_integral_of_one_is_exact() {
        // int 1/r over a rectangle is known: sum over its quarters of a asinh(b/a) + b asinh(a/b).
        let rule = PanelRule::new(4);
        let panel = panel(0.9);
        let (s, t) = (rule.abscissae[1], rule.abscissae[3]);
        let sums = panel
            .own_integrals(&rule, 7)
            .iter()
            .fold([0.0; 6], |sum, c| std::array::from_fn(|k| sum[k] + c[k]));
        let mut exact = 0.0;
        for a in [0.45 * (1.0 - s), 0.45 * (1.0 + s)] {
            for b in [0.1 * (1.0 - t), 0.1 * (1.0 + t)] {
                exact += a * (b / a).asinh() + b * (a / b).asinh();
            }
        }
        // The yy component has no d d^T part on the plane of the wall; the trace is 4/r.
        assert!((sums[1] - exact).abs() < 1e-10, "{} {exact}", sums[1]);
        assert!((sums[0] + sums[1] + sums[2] - 4.0 * exact).abs() < 1e-10);
    }

    #[test]
    fn near_integrals_converge_with_the_reach() {
        let rule = PanelRule::new(4);
        for target in [[0.1, 0.97, 0.2], [0.4, 1.0, 0.2], [0.1, 0.8, 0.3]] {
            let fine = panel(0.4).integrals(&rule, target, 8.0);
            let production = panel(0.4).integrals(&rule, target, 4.0);
            assert!(difference(&fine, &production) < 2e-6, "{target:?}");
        }
    }

    #[test]
    fn halves_carry_the_same_polynomial() {
        let rule = PanelRule::new(4);
        let mut density = Vec::new();
        let field = |y: [f64; 3]| [y[0].powi(3), y[2].powi(3) * y[0], 1.0];
        panel(0.4).for_each_node(&rule, |y, _| density.push(field(y)));
        let whole = LoadedPanel {
            panel: panel(0.4),
            density,
        };
        for half in whole.halves(&rule).iter().flat_map(|h| h.halves(&rule)) {
            let mut values = half.density.iter();
            half.panel.for_each_node(&rule, |y, _| {
                let value = values.next().unwrap();
                assert!((0..3).all(|d| (value[d] - field(y)[d]).abs() < 1e-14));
            });
        }
    }
}
