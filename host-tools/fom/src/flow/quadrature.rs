//! Quadrature rules: Gauss-Legendre on the interval, two symmetric rules on the triangle, and Duffy's rule on the
//! triangle for integrands that are singular like 1/r at a node of a six-node element.

/// A rule on the reference triangle `(0, 0), (1, 0), (0, 1)`; the weights add up to its area, 1/2.
#[derive(Debug, Clone)]
pub struct TriangleRule {
    /// Abscissae.
    pub points: Vec<[f64; 2]>,
    /// Weights.
    pub weights: Vec<f64>,
}

/// The Gauss-Legendre rule of `order` points on [-1, 1], as (abscissae, weights); exact to degree `2 order - 1`.
pub fn gauss_legendre(order: usize) -> (Vec<f64>, Vec<f64>) {
    let n = order as f64;
    (0..order)
        .map(|i| {
            // Newton's iteration on the Legendre polynomial, from Tricomi's estimate of its roots.
            let mut x = -(std::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5)).cos();
            let mut derivative = 1.0;
            for _ in 0..8 {
                let (mut previous, mut value) = (1.0, x);
                for k in 2..=order {
                    let k = k as f64;
                    (previous, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * previous) / k);
                }
                derivative = n * (x * value - previous) / (x * x - 1.0);
                x -= value / derivative;
            }
            (x, 2.0 / ((1.0 - x * x) * derivative * derivative))
        })
        .unzip()
}

impl TriangleRule {
    /// Radon's rule: 7 points, exact to degree 5.
    pub fn seven() -> Self {
        let root = 15_f64.sqrt();
        Self::symmetric(
            0.225,
            &[
                ((6.0 - root) / 21.0, (155.0 - root) / 1200.0),
                ((6.0 + root) / 21.0, (155.0 + root) / 1200.0),
            ],
            &[],
        )
    }

    /// The rule of Dunavant (1985): 16 points, exact to degree 8.
    pub fn sixteen() -> Self {
        Self::symmetric(
            0.144_315_607_677_787,
            &[
                (0.459_292_588_292_723, 0.095_091_634_267_285),
                (0.170_569_307_751_760, 0.103_217_370_534_718),
                (0.050_547_228_317_031, 0.032_458_497_623_198),
            ],
            &[(0.008_394_777_409_958, 0.263_112_829_634_638, 0.027_230_314_174_435)],
        )
    }

    /// A rule of the centre, orbits `(a, a, 1 - 2 a)` and orbits `(a, b, 1 - a - b)` with weights that add up to 1.
    fn symmetric(centre: f64, threes: &[(f64, f64)], sixes: &[(f64, f64, f64)]) -> Self {
        let mut rule = Self {
            points: vec![[1.0 / 3.0; 2]],
            weights: vec![0.5 * centre],
        };
        for &(a, weight) in threes {
            let b = 1.0 - 2.0 * a;
            for point in [[a, a], [a, b], [b, a]] {
                rule.points.push(point);
                rule.weights.push(0.5 * weight);
            }
        }
        for &(a, b, weight) in sixes {
            let c = 1.0 - a - b;
            for point in [[a, b], [b, a], [a, c], [c, a], [b, c], [c, b]] {
                rule.points.push(point);
                rule.weights.push(0.5 * weight);
            }
        }
        rule
    }

    /// Duffy's rule about local node `node` (0 to 5) of the six-node triangle: the triangle (one that has the node as
    /// a corner, or the two that the node cuts it into) is the image of a square whose side `rho = 0` shrinks to the
    /// node, so that the Jacobian, proportional to `rho`, cancels a 1/r singularity there. Gauss-Legendre with `radial`
    /// points in rho and `angular` points across.
    pub fn duffy(node: usize, radial: usize, angular: usize) -> Self {
        const NODES: [[f64; 2]; 6] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]];
        let opposite: &[[usize; 2]] = match node {
            0 => &[[1, 2]],
            1 => &[[2, 0]],
            2 => &[[0, 1]],
            3 => &[[1, 2], [2, 0]],
            4 => &[[2, 0], [0, 1]],
            _ => &[[0, 1], [1, 2]],
        };
        let apex = NODES[node];
        let (rho, rho_weights) = gauss_legendre(radial);
        let (across, across_weights) = gauss_legendre(angular);
        let mut rule = Self {
            points: Vec::new(),
            weights: Vec::new(),
        };
        for &[a, b] in opposite {
            let (u, v) = (
                [NODES[a][0] - apex[0], NODES[a][1] - apex[1]],
                [NODES[b][0] - apex[0], NODES[b][1] - apex[1]],
            );
            let twice_area = u[0] * v[1] - u[1] * v[0];
            for (&r, &wr) in rho.iter().zip(&rho_weights) {
                let r = 0.5 * (1.0 + r);
                for (&s, &ws) in across.iter().zip(&across_weights) {
                    let s = 0.5 * (1.0 + s);
                    rule.points
                        .push([0, 1].map(|d| apex[d] + r * ((1.0 - s) * u[d] + s * v[d])));
                    rule.weights.push(0.25 * wr * ws * r * twice_area);
                }
            }
        }
        rule
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn factorial(n: u32) -> f64 {
        (1..=n).map(f64::from).product()
    }

    /// Largest error over all monomials of the degree; exact: i! j! / (i + j + 2)!.
    fn error(rule: &TriangleRule, degree: u32) -> f64 {
        (0..=degree)
            .map(|i| {
                let j = degree - i;
                let sum: f64 = rule
                    .points
                    .iter()
                    .zip(&rule.weights)
                    .map(|(p, w)| w * p[0].powi(i as i32) * p[1].powi(j as i32))
                    .sum();
                (sum - factorial(i) * factorial(j) / factorial(i + j + 2)).abs()
            })
            .fold(0.0, f64::max)
    }

    #[test]
    fn gauss_legendre_is_exact_to_its_degree() {
        for order in 1..=24 {
            let (x, w) = gauss_legendre(order);
            for degree in 0..2 * order {
                let sum: f64 = x.iter().zip(&w).map(|(x, w)| w * x.powi(degree as i32)).sum();
                let exact = if degree % 2 == 0 {
                    2.0 / (degree as f64 + 1.0)
                } else {
                    0.0
                };
                assert!((sum - exact).abs() < 1e-14, "order {order} degree {degree}");
            }
        }
    }

    #[test]
    fn triangle_rules_are_exact_to_their_degree_and_no_further() {
        for (rule, exact) in [(TriangleRule::seven(), 5), (TriangleRule::sixteen(), 8)] {
            for degree in 0..=exact {
                assert!(error(&rule, degree) < 1e-14, "degree {degree}");
            }
            assert!(error(&rule, exact + 1) > 1e-9);
        }
    }

    #[test]
    fn duffy_integrates_polynomials_and_the_singularity() {
        for node in 0..6 {
            let rule = TriangleRule::duffy(node, 5, 5);
            for degree in 0..=8 {
                assert!(error(&rule, degree) < 1e-14, "node {node} degree {degree}");
            }
        }
        // 1 / r over the right triangle from the right angle: sqrt(2) ln(1 + sqrt(2)).
        let rule = TriangleRule::duffy(0, 1, 16);
        let sum: f64 = rule
            .points
            .iter()
            .zip(&rule.weights)
            .map(|(p, w)| w / p[0].hypot(p[1]))
            .sum();
        assert!((sum - 2_f64.sqrt() * (1.0 + 2_f64.sqrt()).ln()).abs() < 1e-12);
    }
}
