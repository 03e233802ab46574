//! The membrane in elements: elastic load and energy on isoparametric six-node triangles.
//!
//! Equilibrium in weak form: `int_C w . q dS = int_C eps(w) : T dS`. With the second Piola-Kirchhoff tension
//! `S^ab` of the law ([`MembraneLaw`]) the right-hand side gives the load vector `r_i = int S^ab x_,a phi_i,b dA_ref`,
//! which is the gradient of the energy with respect to the node's position.

use nalgebra::Vector3;

use crate::shape_functions::nodes_of;
use crate::surface::Patch;
use crate::vectors::metric;
use crate::{EvaluationError, MembraneLaw, Mesh};

/// The stress-free sphere seen by the elements of a patch.
#[derive(Debug, Clone)]
pub struct Membrane {
    law: MembraneLaw,
    /// For each element and quadrature point of the unit sphere.
    reference: Vec<[ReferencePoint; 12]>,
}

/// The metric of the unit sphere at a quadrature point.
#[derive(Debug, Clone, Copy)]
struct ReferencePoint {
    /// Contravariant metric `A^11`, `A^22`, `A^12`.
    contravariant: [f64; 3],
    /// Determinant of the covariant metric.
    determinant: f64,
    /// Quadrature weight times area element.
    area: f64,
}

impl ReferencePoint {
    /// The first invariant of a covariant metric, `A^ab a_ab`.
    fn trace(&self, [m11, m22, m12]: [f64; 3]) -> f64 {
        let [a11, a22, a12] = self.contravariant;
        a11 * m11 + a22 * m22 + 2.0 * a12 * m12
    }
}

/// The least ratio of deformed to undeformed area that counts as a surface.
const MIN_AREA_RATIO: f64 = 1e-3;

impl Membrane {
    /// The reference state of the elements of `patch`, a part of `mesh`.
    pub fn new(mesh: &Mesh, patch: &Patch, law: MembraneLaw) -> Self {
        let reference = patch
            .elements
            .iter()
            .map(|element| {
                let nodes = nodes_of(element, &mesh.nodes);
                patch.points().map(|point| {
                    let ([m11, m22, m12], determinant) = metric(point.tangents(&nodes));
                    ReferencePoint {
                        contravariant: [m22 / determinant, m11 / determinant, -m12 / determinant],
                        determinant,
                        area: point.weight * determinant.sqrt(),
                    }
                })
            })
            .collect();
        Self { law, reference }
    }

    /// The load vector `r` at the sector's nodes, in `G_s` times the length unit of `nodes`.
    ///
    /// `nodes` are the current positions (full mesh); the stress-free state is the sphere of `radius` in the same
    /// unit. `r` is the energy's gradient; the fluid carries it, so it is also the fluid's load on the membrane.
    ///
    /// # Errors
    /// [`EvaluationError::Collapsed`] where an element's area vanishes or is not finite.
    pub fn load(
        &self,
        patch: &Patch,
        nodes: &[[f64; 3]],
        radius: f64,
        load: &mut [[f64; 3]],
    ) -> Result<(), EvaluationError> {
        let mut collapsed = None;
        patch.assemble(nodes, load, |element, x| {
            let mut sum = [Vector3::zeros(); 6];
            for (point, reference) in patch.points().iter().zip(&self.reference[element]) {
                let [t1, t2] = point.tangents(x);
                let ([m11, m22, m12], determinant) = metric([t1, t2]);
                // The squared area ratio J_s^2; the reference lengths scale with the radius.
                let ratio = determinant / (reference.determinant * radius.powi(4));
                if !(ratio > MIN_AREA_RATIO * MIN_AREA_RATIO && ratio.is_finite()) {
                    collapsed = Some(ratio);
                }
                // S^ab dA_ref, with the area and the contravariant metric of the unit sphere.
                let [a11, a22, a12] = reference.contravariant;
                let trace = reference.trace([m11, m22, m12]) / radius.powi(2);
                let [push, pull] = self.law.factors(trace, ratio, radius * radius, determinant);
                let s11 = reference.area * (push * a11 - pull * m22);
                let s22 = reference.area * (push * a22 - pull * m11);
                let s12 = reference.area * (push * a12 + pull * m12);
                let [flux1, flux2] = [s11 * t1 + s12 * t2, s12 * t1 + s22 * t2];
                for i in 0..6 {
                    sum[i] += flux1 * point.gradient[0][i] + flux2 * point.gradient[1][i];
                }
            }
            sum
        });
        match collapsed {
            Some(ratio) => Err(EvaluationError::Collapsed {
                area_ratio: ratio.sqrt(),
            }),
            None => Ok(()),
        }
    }

    /// The elastic energy of the patch's elements, in `G_s` times the squared length unit.
    ///
    /// It is the capsule's energy if the patch covers the whole mesh.
    pub fn energy(&self, patch: &Patch, nodes: &[[f64; 3]], radius: f64) -> f64 {
        let mut energy = 0.0;
        for (element, reference) in patch.elements.iter().zip(&self.reference) {
            let x = nodes_of(element, nodes);
            for (point, reference) in patch.points().iter().zip(reference) {
                let [t1, t2] = point.tangents(&x);
                let (current, _) = metric([t1, t2]);
                let trace = reference.trace(current) / radius.powi(2);
                let normal = t1.cross(&t2);
                let ratio = normal.dot(&normal) / (reference.determinant * radius.powi(4));
                energy += reference.area * radius.powi(2) * self.law.energy_density(trace, ratio);
            }
        }
        energy
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Symmetry;
    use crate::law::tests::{LAWS, exact_pressure};
    use crate::mass_matrix::MassMatrix;

    struct Fixture {
        mesh: Mesh,
        symmetry: Symmetry,
        patch: Patch,
        membrane: Membrane,
    }

    impl Fixture {
        fn new(frequency: usize, law: MembraneLaw) -> Self {
            let mesh = Mesh::octahedral(frequency).unwrap();
            let symmetry = Symmetry::unreduced(&mesh);
            let patch = Patch::new(&mesh, &symmetry);
            let membrane = Membrane::new(&mesh, &patch, law);
            Self {
                mesh,
                symmetry,
                patch,
                membrane,
            }
        }

        fn load(&self, nodes: &[[f64; 3]], radius: f64) -> Vec<[f64; 3]> {
            let mut load = vec![[0.0; 3]; nodes.len()];
            self.membrane.load(&self.patch, nodes, radius, &mut load).unwrap();
            load
        }

        fn traction(&self, nodes: &[[f64; 3]], load: &[[f64; 3]]) -> Vec<[f64; 3]> {
            let mut traction = vec![[0.0; 3]; nodes.len()];
            MassMatrix::new(&self.patch)
                .solve(&self.patch, &self.symmetry, nodes, load, &mut traction)
                .unwrap();
            traction
        }
    }

    fn norm(field: &[[f64; 3]]) -> f64 {
        field.iter().flatten().fold(0.0_f64, |m, c| m.max(c.abs()))
    }

    #[test]
    fn load_is_the_gradient_of_the_energy() {
        LAWS.into_iter().for_each(check_gradient);
    }

    fn check_gradient(law: MembraneLaw) {
        let f = Fixture::new(3, law);
        let radius = 0.9;
        let mut nodes: Vec<_> = f
            .mesh
            .nodes
            .iter()
            .map(|&[x, y, z]| [1.1 * x + 0.1 * y * z, 0.8 * y + 0.1 * x * x, 0.9 * z - 0.2 * x * y])
            .collect();
        let load = f.load(&nodes, radius);
        let step = 1e-5;
        for node in [0, 5, 33, 77, 140] {
            for d in 0..3 {
                let original = nodes[node][d];
                nodes[node][d] = original + step;
                let up = f.membrane.energy(&f.patch, &nodes, radius);
                nodes[node][d] = original - step;
                let down = f.membrane.energy(&f.patch, &nodes, radius);
                nodes[node][d] = original;
                let gradient = (up - down) / (2.0 * step);
                let scale = norm(&load).max(1.0);
                assert!(
                    (gradient - load[node][d]).abs() < 1e-8 * scale,
                    "{law}: {gradient} {}",
                    load[node][d]
                );
            }
        }
    }

    #[test]
    fn rigid_motion_gives_no_load() {
        LAWS.into_iter().for_each(check_rigid_motion);
    }

    fn check_rigid_motion(law: MembraneLaw) {
        let f = Fixture::new(4, law);
        let (sine, cosine) = 0.7_f64.sin_cos();
        let moved: Vec<_> = f
            .mesh
            .nodes
            .iter()
            .map(|&[x, y, z]| {
                [
                    1.3 * (cosine * x - sine * y) + 5.0,
                    1.3 * (sine * x + cosine * y) - 2.0,
                    1.3 * z + 1.0,
                ]
            })
            .collect();
        // The stiffest law has seven times the area dilatation modulus of the neo-Hookean one.
        let bound = if law.is_neo_hookean() { 1e-14 } else { 1e-13 };
        assert!(norm(&f.load(&moved, 1.3)) < bound, "{law}");
        assert!(f.membrane.energy(&f.patch, &moved, 1.3).abs() < 1e-13);
    }

    /// The pressure inside the inflated sphere, by virtual work: `r . x = p dV/dx . x = 3 p V`.
    fn inflation_pressure(f: &Fixture, stretch: f64) -> f64 {
        let nodes: Vec<_> = f.mesh.nodes.iter().map(|p| p.map(|c| stretch * c)).collect();
        let load = f.load(&nodes, 1.0);
        let work: f64 = load
            .iter()
            .zip(&nodes)
            .map(|(r, x)| Vector3::from(*r).dot(&Vector3::from(*x)))
            .sum();
        work / (3.0 * crate::surface::Moments::of(&f.mesh.elements, &nodes).volume)
    }

    #[test]
    fn inflated_sphere_has_the_exact_pressure() {
        for law in LAWS {
            for stretch in [0.9, 1.1, 1.2, 1.5] {
                let exact = exact_pressure(law, stretch);
                let errors =
                    [3, 6, 12].map(|n| (inflation_pressure(&Fixture::new(n, law), stretch) / exact - 1.0).abs());
                assert!(errors[2] < 2e-5, "{law}: {errors:?}");
                for pair in errors.windows(2) {
                    assert!(pair[0] / pair[1] > 8.0, "{law}: {errors:?}");
                }
            }
        }
    }

    #[test]
    fn inflation_pressure_has_its_limit_point() {
        let f = Fixture::new(8, MembraneLaw::NeoHookean);
        let limit = 7_f64.powf(1.0 / 6.0);
        let maximum = inflation_pressure(&f, limit);
        assert!((maximum - 1.239463).abs() < 1e-3, "{maximum}");
        assert!(inflation_pressure(&f, limit - 0.05) < maximum && inflation_pressure(&f, limit + 0.05) < maximum);
        assert!((inflation_pressure(&f, 1.2) - 1.108503).abs() < 1e-3);
    }

    /// Nodal tractions converge to the pressure too, if slowly: the kinks of the surface make them oscillate.
    #[test]
    fn traction_of_the_inflated_sphere_converges() {
        let stretch = 1.2_f64;
        let exact = 2.0 * (stretch.recip() - stretch.powi(-7));
        let errors = [4, 8, 16].map(|n| {
            let f = Fixture::new(n, MembraneLaw::NeoHookean);
            let nodes: Vec<_> = f.mesh.nodes.iter().map(|p| p.map(|c| stretch * c)).collect();
            let traction = f.traction(&nodes, &f.load(&nodes, 1.0));
            let normal = traction
                .iter()
                .zip(&f.mesh.nodes)
                .map(|(q, n)| (Vector3::from(*q).dot(&Vector3::from(*n)) / exact - 1.0).powi(2))
                .sum::<f64>();
            (normal / traction.len() as f64).sqrt()
        });
        assert!(
            errors[2] < 0.05 && errors[0] > 1.5 * errors[1] && errors[1] > 1.5 * errors[2],
            "{errors:?}"
        );
    }

    /// A flat sheet pulled in one direction, free at its sides.
    #[test]
    fn uniaxial_tension() {
        let mesh = Mesh {
            nodes: vec![
                [0.0; 3],
                [1.0, 0.0, 0.0],
                [0.0, 1.0, 0.0],
                [0.5, 0.0, 0.0],
                [0.5, 0.5, 0.0],
                [0.0, 0.5, 0.0],
            ],
            elements: vec![[0, 1, 2, 3, 4, 5]],
        };
        let symmetry = Symmetry::unreduced(&mesh);
        let patch = Patch::new(&mesh, &symmetry);
        for (law, stretch) in LAWS
            .into_iter()
            .flat_map(|law| [0.8, 1.3, 2.0_f64].map(|stretch| (law, stretch)))
        {
            let square = stretch * stretch;
            // The lateral stretch without lateral tension, and the tension (paper, eq. 9).
            let (lateral, exact) = match law {
                MembraneLaw::NeoHookean => (stretch.powf(-0.5), stretch.powf(1.5) - stretch.powf(-1.5)),
                MembraneLaw::Skalak { area } => {
                    let lateral = ((1.0 + area * square) / (1.0 + area * square * square)).sqrt();
                    let dilatation = (stretch * lateral).powi(2) - 1.0;
                    let tension = stretch / lateral * (square - 1.0 + area * lateral * lateral * dilatation);
                    (lateral, tension)
                }
            };
            let nodes: Vec<_> = mesh
                .nodes
                .iter()
                .map(|&[x, y, _]| [stretch * x, lateral * y, 0.0])
                .collect();
            let mut load = vec![[0.0; 3]; 6];
            Membrane::new(&mesh, &patch, law)
                .load(&patch, &nodes, 1.0, &mut load)
                .unwrap();
            // Virtual work of a uniform stretch rate: r . x = (T_1 + T_2) A, and r_x x = T_1 A.
            let area = 0.5 * stretch * lateral;
            let work = |d: usize| load.iter().zip(&nodes).map(|(r, x)| r[d] * x[d]).sum::<f64>() / area;
            assert!((work(0) / exact - 1.0).abs() < 1e-13, "{law}: {} {exact}", work(0));
            assert!(work(1).abs() < 1e-13 * exact.abs().max(1.0), "{law}: {}", work(1));
        }
    }

    #[test]
    fn a_collapsed_surface_is_refused() {
        let f = Fixture::new(2, MembraneLaw::NeoHookean);
        let flat: Vec<_> = f.mesh.nodes.iter().map(|&[x, _, _]| [x, 0.0, 0.0]).collect();
        let mut load = vec![[0.0; 3]; flat.len()];
        assert!(matches!(
            f.membrane.load(&f.patch, &flat, 1.0, &mut load),
            Err(EvaluationError::Collapsed { .. })
        ));
        let mut broken = f.mesh.nodes.clone();
        broken[3][1] = f64::NAN;
        assert!(f.membrane.load(&f.patch, &broken, 1.0, &mut load).is_err());
    }
}
