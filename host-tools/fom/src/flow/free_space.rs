//! A membrane in unbounded fluid.

use super::error::FlowError;
use super::membrane_layer::{MembraneLayer, MembraneQuadrature, MembraneRules};
use super::near::TargetBlocks;
use super::precision::Precision;
use super::{Flow, Membrane};

/// The flow far from the membrane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Background {
    /// Fluid at rest.
    Rest,
    /// Simple shear, `u = (rate y, 0, 0)`.
    Shear {
        /// Velocity per length.
        rate: f64,
    },
}

/// Unbounded fluid of viscosity 1 inside and outside of the membrane.
#[derive(Debug, Clone)]
pub struct FreeSpace {
    background: Background,
    rules: MembraneRules,
}

impl FreeSpace {
    /// Unbounded fluid with the given flow at infinity.
    pub fn new(background: Background) -> Self {
        Self::with_precision(background, Precision::default())
    }

    /// The same with a choice of the precision of the far sums.
    pub fn with_precision(background: Background, precision: Precision) -> Self {
        Self {
            background,
            rules: MembraneRules::new(&MembraneQuadrature::default(), precision),
        }
    }
}

impl Flow for FreeSpace {
    /// `v(x) = v_inf(x) - 1/(8 pi) int_C J q dS`; there is no pressure drop: 0 is returned.
    fn velocity(&self, membrane: &Membrane, targets: &[u32], out: &mut [[f64; 3]]) -> Result<f64, FlowError> {
        membrane.check(targets, out)?;
        let points: Vec<[f64; 3]> = targets.iter().map(|&i| membrane.nodes[i as usize]).collect();
        let mut layer = vec![[0.0; 3]; points.len()];
        MembraneLayer::new(membrane, &self.rules).add_to(targets, &TargetBlocks::new(&points), &mut layer);
        for ((value, &[_, y, _]), layer) in out.iter_mut().zip(&points).zip(layer) {
            *value = layer.map(|c| -c / (8.0 * std::f64::consts::PI));
            if let Background::Shear { rate } = self.background {
                value[0] += rate * y;
            }
        }
        super::check_finite("velocity", out)?;
        Ok(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_support::{Loaded, difference};
    use super::*;

    /// `(gradient of Y, Y)` of a solid harmonic of degree n at a point of the unit sphere.
    type Harmonic = fn([f64; 3]) -> ([f64; 3], f64);

    /// Largest error at the nodes of the velocity for the load `mode`, whose exact velocity is `- eigenvalue mode`.
    fn error(n: usize, eigenvalue: f64, mode: impl Fn([f64; 3]) -> [f64; 3]) -> f64 {
        let sphere = Loaded::new(n, |p| p, mode);
        let expected: Vec<_> = sphere.load.iter().map(|q| q.map(|c| -eigenvalue * c)).collect();
        let mut velocity = vec![[0.0; 3]; sphere.nodes.len()];
        FreeSpace::new(Background::Rest)
            .velocity(&sphere.membrane(), &sphere.all(), &mut velocity)
            .unwrap();
        difference(&velocity, &expected)
    }

    #[test]
    fn uniform_and_normal_traction_on_the_sphere() {
        assert!(error(4, 2.0 / 3.0, |_| [1.0, -0.5, 0.3]) < 1e-3);
        assert!(error(8, 2.0 / 3.0, |_| [1.0, -0.5, 0.3]) < 1e-4);
        assert!(error(8, 0.0, |p| p) < 1e-4);
    }

    #[test]
    fn eigenvalues_of_vector_harmonics_and_their_convergence() {
        let two: Harmonic = |[x, y, z]| ([y, x + z, y], x * y + y * z);
        let three: Harmonic = |[x, y, z]| ([2.0 * x * z, -2.0 * y * z, x * x - y * y], (x * x - y * y) * z);
        for (degree, harmonic) in [(2.0, two), (3.0, three)] {
            let v = |p: [f64; 3]| {
                let (gradient, y) = harmonic(p);
                // The surface gradient of Y is grad Y - n Y r: V_n = grad Y - (2 n + 1) Y r for the solid harmonic.
                [0, 1, 2].map(|d| gradient[d] - (2.0 * degree + 1.0) * y * p[d])
            };
            let w = |p: [f64; 3]| harmonic(p).0;
            let x = |p: [f64; 3]| {
                let (g, _) = harmonic(p);
                [
                    p[1] * g[2] - p[2] * g[1],
                    p[2] * g[0] - p[0] * g[2],
                    p[0] * g[1] - p[1] * g[0],
                ]
            };
            let n = degree;
            let errors = |mesh| {
                [
                    error(mesh, n / ((2.0 * n + 1.0) * (2.0 * n + 3.0)), v),
                    error(mesh, (n + 1.0) / ((2.0 * n + 1.0) * (2.0 * n - 1.0)), w),
                    error(mesh, 1.0 / (2.0 * n + 1.0), x),
                ]
            };
            let (coarse, fine) = (errors(4), errors(8));
            for (coarse, fine) in coarse.iter().zip(&fine) {
                println!("degree {degree}: {coarse:.2e} {fine:.2e}");
                assert!(*fine < 1e-3 && *fine < coarse / 5.0, "{coarse} {fine}");
            }
        }
    }

    #[test]
    fn background_shear_and_checked_input() {
        let flow = FreeSpace::new(Background::Shear { rate: 2.0 });
        let sphere = Loaded::new(2, |p| p, |_| [0.0; 3]);
        let mut velocity = vec![[0.0; 3]; sphere.nodes.len()];
        flow.velocity(&sphere.membrane(), &sphere.all(), &mut velocity).unwrap();
        let expected: Vec<_> = sphere.nodes.iter().map(|p| [2.0 * p[1], 0.0, 0.0]).collect();
        assert_eq!(velocity, expected);

        let membrane = sphere.membrane();
        assert!(matches!(
            flow.velocity(&membrane, &[0, 999], &mut [[0.0; 3]; 2]),
            Err(FlowError::NodeIndex {
                what: "targets",
                node: 999,
                ..
            })
        ));
        assert!(matches!(
            flow.velocity(&membrane, &[0], &mut []),
            Err(FlowError::Length {
                what: "out",
                expected: 1,
                found: 0
            })
        ));
        let mut nodes = sphere.nodes.clone();
        nodes[3][1] = f64::NAN;
        let broken = Membrane {
            nodes: &nodes,
            ..membrane
        };
        assert_eq!(
            flow.velocity(&broken, &[0], &mut [[0.0; 3]]),
            Err(FlowError::NonFinite { what: "nodes", node: 3 })
        );
    }
}
