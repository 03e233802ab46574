//! The square duct: Poiseuille flow, disturbed by a membrane, between no-slip walls.

use std::f64::consts::PI;

use nalgebra::Vector3;

use super::error::FlowError;
use super::membrane_layer::{MembraneLayer, MembraneRules};
use super::near::TargetBlocks;
use super::panel::{Panel, PanelRule};
use super::poiseuille::Poiseuille;
use super::settings::DuctSettings;
use super::stokeslet::{self, Sources};
use super::wall::{Wall, WallLayout};
use super::{Flow, Membrane, check_finite};

/// No node may come closer to the wall than this (l).
const MINIMUM_GAP: f64 = 1e-3;
/// Nor closer to an end of the duct than this (l): the quadrature of the end relies on it.
const END_DISTANCE: f64 = 1.0;
/// Gauss nodes across the outlet, in each direction of each of its quarters.
const OUTLET_ORDER: usize = 6;

/// The duct with all that does not depend on the membrane.
#[derive(Debug, Clone)]
pub struct Duct {
    half_length: f64,
    poiseuille: Poiseuille,
    rules: MembraneRules,
    wall: Wall,
    /// The outlet under unit pressure: `n dS`.
    outlet: Sources,
    /// Traction on the wall that cancels the velocity of the outlet under unit pressure.
    outlet_traction: Vec<[f64; 3]>,
    resolved_film: f64,
}

/// The action of a membrane on the flow: enough to evaluate the velocity anywhere.
struct Disturbance<'a> {
    layer: MembraneLayer<'a>,
    /// Perturbation traction at the wall's nodes.
    traction: Vec<[f64; 3]>,
    pressure_drop: f64,
}

impl Duct {
    /// Assembles and inverts the operator of the walls; once for all capsules.
    ///
    /// # Errors
    /// [`FlowError::Setting`] with the name of a setting out of range, [`FlowError::SingularWall`].
    pub fn new(settings: &DuctSettings) -> Result<Self, FlowError> {
        settings.check()?;
        let wall = Wall::new(&WallLayout {
            axial: settings.axial_boundaries(),
            transverse: settings.transverse_panels,
            order: settings.order,
            symmetric: settings.symmetric,
            reach: settings.wall_reach,
            precision: settings.precision,
        })?;
        let rule = PanelRule::new(OUTLET_ORDER);
        let mut outlet = Sources::default();
        let mut velocity = vec![[0.0; 3]; wall.nodes().len()];
        for (y, z) in [(-0.5, -0.5), (-0.5, 0.5), (0.5, -0.5), (0.5, 0.5)] {
            let quarter = Panel {
                centre: Vector3::new(settings.half_length, y, z),
                u: Vector3::y() * 0.5,
                v: Vector3::z() * 0.5,
            };
            quarter.for_each_node(&rule, |position, weight| outlet.push(position, [weight, 0.0, 0.0]));
            // The outlet touches the wall's last panels: divided where it is close.
            for (value, &node) in velocity.iter_mut().zip(wall.nodes()) {
                for [xx, _, _, xy, xz, _] in quarter.integrals(&rule, node, settings.wall_reach) {
                    *value = [value[0] + xx, value[1] + xy, value[2] + xz];
                }
            }
        }
        Ok(Self {
            half_length: settings.half_length,
            poiseuille: Poiseuille::new(),
            rules: MembraneRules::new(&settings.membrane, settings.precision),
            outlet_traction: wall.solve(&velocity),
            wall,
            outlet,
            resolved_film: settings.node_spacing(),
        })
    }

    /// The undisturbed flow.
    pub fn poiseuille(&self) -> &Poiseuille {
        &self.poiseuille
    }

    /// The thinnest film (l) that node positions leave between the membrane and the walls; negative outside of them.
    pub fn thinnest_film(positions: &[[f64; 3]]) -> f64 {
        positions
            .iter()
            .map(|&[_, y, z]| 1.0 - y.abs().max(z.abs()))
            .fold(1.0, f64::min)
    }

    /// The film (l) below which the walls' panels do not resolve the traction that the film exerts: velocities of some
    /// nodes are then wrong by more than 1e-3 V. About the spacing of the panels' nodes, as measured on capsules of
    /// (Ca, a/l) = (0.005, 1.15) and (0.02, 1.10). The quadrature itself is adaptive and good for any film.
    pub fn resolved_film(&self) -> f64 {
        self.resolved_film
    }

    /// The velocity (V) at any points of the fluid, and the additional pressure drop.
    ///
    /// # Errors
    /// As [`Flow::velocity`]; points outside of the duct, in thin films or near its ends are refused like nodes.
    pub fn velocity_at(
        &self,
        membrane: &Membrane,
        points: &[[f64; 3]],
        out: &mut [[f64; 3]],
    ) -> Result<f64, FlowError> {
        membrane.check(&[], &[])?;
        self.check_inside(membrane.nodes)?;
        self.check_inside(points)?;
        let disturbance = self.disturbance(membrane);
        self.evaluate(&disturbance, &[], points, out);
        check_finite("velocity", out)?;
        Ok(disturbance.pressure_drop)
    }

    fn check_inside(&self, points: &[[f64; 3]]) -> Result<(), FlowError> {
        for (node, &[x, y, z]) in points.iter().enumerate() {
            let gap = 1.0 - y.abs().max(z.abs());
            let limit = self.half_length - END_DISTANCE;
            if gap <= 0.0 {
                return Err(FlowError::OutsideDuct { node, overlap: -gap });
            }
            if gap < MINIMUM_GAP {
                return Err(FlowError::ThinFilm {
                    node,
                    gap,
                    minimum: MINIMUM_GAP,
                });
            }
            if x.abs() > limit {
                return Err(FlowError::NearDuctEnd { node, x, limit });
            }
        }
        Ok(())
    }

    /// Finds the pressure drop and the traction on the wall that cancels the velocity of membrane and outlet there.
    fn disturbance<'a>(&'a self, membrane: &Membrane<'a>) -> Disturbance<'a> {
        // Reciprocity with the undisturbed flow, whose flow rate is 4.
        let power = |(&[_, y, z], force): (&[f64; 3], &[f64; 3])| self.poiseuille.velocity(y, z) * force[0];
        let pressure_drop = 0.25 * membrane.nodes.iter().zip(membrane.force).map(power).sum::<f64>();
        let layer = MembraneLayer::new(membrane, &self.rules);
        let mut velocity = vec![[0.0; 3]; self.wall.nodes().len()];
        layer.add_to(&[], self.wall.blocks(), &mut velocity);
        let mut traction = self.wall.solve(&velocity);
        for (f, outlet) in traction.iter_mut().zip(&self.outlet_traction) {
            for d in 0..3 {
                f[d] = pressure_drop * outlet[d] - f[d];
            }
        }
        Disturbance {
            layer,
            traction,
            pressure_drop,
        }
    }

    /// `v = v_inf - 1/(8 pi) [int_C J q dS + int_W J f dS - dp int_out J n dS]`; the first points are the `nodes`.
    fn evaluate(&self, disturbance: &Disturbance, nodes: &[u32], points: &[[f64; 3]], out: &mut [[f64; 3]]) {
        out.fill([0.0; 3]);
        stokeslet::add_sums(self.outlet.all(), points, out);
        for value in out.iter_mut().flatten() {
            *value *= -disturbance.pressure_drop;
        }
        let blocks = TargetBlocks::new(points);
        disturbance.layer.add_to(nodes, &blocks, out);
        self.wall.add_layer(&disturbance.traction, &blocks, out);
        for (value, &[_, y, z]) in out.iter_mut().zip(points) {
            *value = value.map(|c| -c / (8.0 * PI));
            value[0] += self.poiseuille.velocity(y, z);
        }
    }
}

impl Flow for Duct {
    fn velocity(&self, membrane: &Membrane, targets: &[u32], out: &mut [[f64; 3]]) -> Result<f64, FlowError> {
        membrane.check(targets, out)?;
        self.check_inside(membrane.nodes)?;
        let points: Vec<[f64; 3]> = targets.iter().map(|&i| membrane.nodes[i as usize]).collect();
        let disturbance = self.disturbance(membrane);
        self.evaluate(&disturbance, targets, &points, out);
        check_finite("velocity", out)?;
        Ok(disturbance.pressure_drop)
    }
}

#[cfg(test)]
mod tests {
    use super::super::membrane_layer::MembraneQuadrature;
    use super::super::precision::Precision;
    use super::super::quadrature::gauss_legendre;
    use super::super::test_support::{Loaded, difference};
    use super::*;

    fn velocity(duct: &Duct, loaded: &Loaded) -> (Vec<[f64; 3]>, f64) {
        let mut out = vec![[0.0; 3]; loaded.nodes.len()];
        let drop = duct.velocity(&loaded.membrane(), &loaded.all(), &mut out).unwrap();
        (out, drop)
    }

    fn duct(settings: DuctSettings) -> Duct {
        Duct::new(&settings).unwrap()
    }

    #[test]
    fn net_disturbance_flux_vanishes_in_every_section() {
        let duct = duct(DuctSettings::default());
        let (x, w) = gauss_legendre(12);
        let mut last = f64::MAX;
        for n in [4, 8] {
            let capsule = Loaded::capsule(n);
            for section in [-3.0, -1.5, 1.5, 3.0] {
                let points: Vec<_> = x
                    .iter()
                    .flat_map(|&y| x.iter().map(move |&z| [section, y, z]))
                    .collect();
                let weights: Vec<_> = w.iter().flat_map(|a| w.iter().map(move |b| a * b)).collect();
                let mut out = vec![[0.0; 3]; points.len()];
                let drop = duct.velocity_at(&capsule.membrane(), &points, &mut out).unwrap();
                let flux: f64 = out.iter().zip(&weights).map(|(v, w)| v[0] * w).sum::<f64>() - 4.0;
                // The rest is the error of interpolating v_inf from the nodes in the pressure drop.
                println!("mesh {n}, section {section}: flux {flux:.2e}, pressure drop {drop}");
                assert!(flux.abs() < [1e-3, 5e-5][n / 8] && flux.abs() < last);
                if section == 3.0 {
                    last = flux.abs();
                }
            }
        }
    }

    #[test]
    fn the_wall_holds_between_its_nodes() {
        let duct = duct(DuctSettings::default());
        let capsule = Loaded::capsule(6);
        let membrane = capsule.membrane();
        let disturbance = duct.disturbance(&membrane);
        let points: Vec<_> = (0..60)
            .map(|i| [-3.0 + 0.0937 * f64::from(i), 1.0, 0.9 * (1.7 * f64::from(i)).sin()])
            .collect();
        let mut out = vec![[0.0; 3]; points.len()];
        duct.evaluate(&disturbance, &[], &points, &mut out);
        let largest = out.iter().flatten().fold(0.0_f64, |m, c| m.max(c.abs()));
        println!("largest velocity on the wall {largest:.2e}");
        assert!(largest < 1e-3);
    }

    #[test]
    fn length_of_the_duct_does_not_matter() {
        let capsule = Loaded::capsule(4);
        let (short, drop) = velocity(&duct(DuctSettings::default()), &capsule);
        let longer = DuctSettings {
            half_length: 6.0,
            growing_panels: 4,
            ..DuctSettings::default()
        };
        let (long, same_drop) = velocity(&duct(longer), &capsule);
        println!("length: {:.2e}", difference(&short, &long));
        assert_eq!(drop, same_drop);
        assert!(difference(&short, &long) < 1e-4);
    }

    #[test]
    fn reduced_wall_equals_unreduced_wall() {
        let capsule = Loaded::capsule(3);
        // Without what depends on the blocks of targets.
        let settings = DuctSettings {
            precision: Precision::Double,
            membrane: MembraneQuadrature {
                far: 50.0,
                ..MembraneQuadrature::default()
            },
            ..DuctSettings::coarse()
        };
        let (reduced, _) = velocity(&duct(settings.clone()), &capsule);
        let unreduced = DuctSettings {
            symmetric: false,
            ..settings
        };
        let (full, _) = velocity(&duct(unreduced), &capsule);
        println!("reduced - unreduced: {:.2e}", difference(&reduced, &full));
        assert!(difference(&reduced, &full) < 1e-9);
    }

    #[test]
    fn finer_quadrature_changes_nothing() {
        let capsule = Loaded::capsule(6);
        let production = DuctSettings::default();
        let fine = DuctSettings {
            wall_reach: 5.0,
            membrane: MembraneQuadrature {
                far: 50.0,
                middle: 5.0,
                near: 3.0,
                duffy: [8, 20],
            },
            ..production.clone()
        };
        let (coarse, _) = velocity(&duct(production), &capsule);
        let (fine, _) = velocity(&duct(fine), &capsule);
        println!("quadrature: {:.2e}", difference(&coarse, &fine));
        assert!(difference(&coarse, &fine) < 2e-5);
    }

    #[test]
    fn single_precision_and_nodal_forces_change_nothing() {
        let capsule = Loaded::capsule(8);
        // A load like that of a stiff membrane: a pressure that all but cancels is added.
        let mut stiff = Loaded::capsule(8);
        let inflated = |(q, p): (&[f64; 3], &[f64; 3])| [0, 1, 2].map(|d| q[d] + 60.0 * p[d]);
        stiff.set_load(stiff.load.iter().zip(&stiff.mesh.nodes).map(inflated).collect());
        let production = duct(DuctSettings::default());
        let double = DuctSettings {
            precision: Precision::Double,
            ..DuctSettings::default()
        };
        let no_nodal_forces = DuctSettings {
            membrane: MembraneQuadrature {
                far: 50.0,
                ..MembraneQuadrature::default()
            },
            ..double.clone()
        };
        let (double, no_nodal_forces) = (duct(double), duct(no_nodal_forces));
        for (name, loaded, nodal) in [("soft", &capsule, 2e-6), ("stiff", &stiff, 2e-5)] {
            let reference = velocity(&double, loaded).0;
            let rounding = difference(&velocity(&production, loaded).0, &reference);
            let coarsening = difference(&velocity(&no_nodal_forces, loaded).0, &reference);
            println!("{name}: single precision {rounding:.2e}, nodal forces {coarsening:.2e}");
            assert!(rounding < 2e-6 && coarsening < nodal, "{name}");
        }
    }

    #[test]
    fn the_number_of_threads_does_not_matter() {
        let duct = duct(DuctSettings::coarse());
        let capsule = Loaded::capsule(5);
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| velocity(&duct, &capsule))
        };
        assert_eq!(with(1), with(3));
    }

    /// Solves `operator(x) = b` by GMRES without restarts; returns the solution after `steps` steps.
    fn gmres(operator: impl Fn(&[f64]) -> Vec<f64>, b: &[f64], steps: usize) -> Vec<f64> {
        use faer::Mat;
        use faer::linalg::solvers::SolveLstsq;
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let size = dot(b, b).sqrt();
        let mut basis = vec![b.iter().map(|c| c / size).collect::<Vec<_>>()];
        let mut hessenberg = Mat::<f64>::zeros(steps + 1, steps);
        for k in 0..steps {
            let mut next = operator(&basis[k]);
            for (j, q) in basis.iter().enumerate() {
                let projection = dot(&next, q);
                hessenberg[(j, k)] = projection;
                next.iter_mut().zip(q).for_each(|(n, q)| *n -= projection * q);
            }
            let length = dot(&next, &next).sqrt();
            hessenberg[(k + 1, k)] = length;
            basis.push(next.into_iter().map(|n| n / length).collect());
        }
        let right = Mat::from_fn(steps + 1, 1, |i, _| if i == 0 { size } else { 0.0 });
        let y = hessenberg.qr().solve_lstsq(right);
        (0..b.len())
            .map(|i| (0..steps).map(|k| y[(k, 0)] * basis[k][i]).sum())
            .collect()
    }

    #[test]
    fn a_small_rigid_sphere_on_the_axis_obeys_faxens_law() {
        let duct = duct(DuctSettings::default());
        for (radius, expected) in [(0.1, 2.0844), (0.2, 2.0488)] {
            let sphere = |q: &[f64]| {
                let mut loaded = Loaded::new(3, |p| p.map(|c| radius * c), |_| [0.0; 3]);
                loaded.set_load(q.as_chunks().0.to_vec());
                loaded
            };
            let rest = sphere(&vec![0.0; 3 * 146]);
            let undisturbed: Vec<f64> = velocity(&duct, &rest).0.into_flattened();
            let operator = |q: &[f64]| -> Vec<f64> {
                let moving = velocity(&duct, &sphere(q)).0.into_flattened();
                moving.iter().zip(&undisturbed).map(|(v, u)| v - u).collect()
            };
            // The loads that stop the fluid, and that move it with velocity 1, at the sphere; U makes the force zero.
            let force = |velocity: &[f64]| -> f64 {
                let q = gmres(operator, velocity, 12);
                sphere(&q).force.iter().map(|r| r[0]).sum()
            };
            let one: Vec<f64> = (0..undisturbed.len())
                .map(|i| if i % 3 == 0 { 1.0 } else { 0.0 })
                .collect();
            let velocity = force(&undisturbed) / force(&one);
            println!("sphere of radius {radius}: U = {velocity:.5}");
            assert!((velocity - expected).abs() < 1e-3, "{velocity}");
        }
    }

    #[test]
    fn the_thinnest_film_and_what_the_panels_resolve() {
        let capsule = Loaded::capsule(4);
        let film = Duct::thinnest_film(&capsule.nodes);
        assert!((0.1..0.13).contains(&film), "{film}");
        assert!((Duct::thinnest_film(&[[0.0, 0.2, -1.25]]) + 0.25).abs() < 1e-15);
        let fine = DuctSettings {
            order: 6,
            ..DuctSettings::coarse()
        };
        assert_eq!(
            duct(DuctSettings::coarse()).resolved_film(),
            2.0 * duct(fine).resolved_film()
        );
    }

    /// The capsule of the other tests, widened to leave a film of this thickness.
    fn with_film(film: f64) -> Loaded {
        let mut capsule = Loaded::capsule(6);
        let factor = (1.0 - film) / (1.0 - Duct::thinnest_film(&capsule.nodes));
        for [_, y, z] in &mut capsule.nodes {
            (*y, *z) = (factor * *y, factor * *z);
        }
        capsule.set_load(capsule.load.clone());
        capsule
    }

    #[test]
    fn the_quadrature_is_good_for_any_film_and_the_panels_down_to_their_spacing() {
        let production = DuctSettings::default();
        let quadrature = DuctSettings {
            wall_reach: 5.0,
            membrane: MembraneQuadrature {
                far: 50.0,
                middle: 5.0,
                near: 3.0,
                duffy: [8, 20],
            },
            ..production.clone()
        };
        let panels = DuctSettings {
            transverse_panels: 4,
            uniform_panels: 7,
            ..production.clone()
        };
        let (production, quadrature, panels) = (duct(production), duct(quadrature), duct(panels));
        let mut last = 0.0;
        for film in [1.0, 0.3, 0.05].map(|part| part * production.resolved_film()) {
            let capsule = with_film(film);
            let coarse = velocity(&production, &capsule).0;
            let by_quadrature = difference(&coarse, &velocity(&quadrature, &capsule).0);
            let by_panels = difference(&coarse, &velocity(&panels, &capsule).0);
            println!("film {film:.3}: quadrature {by_quadrature:.1e}, panels {by_panels:.1e}");
            assert!(by_quadrature < 1e-4 && by_panels > last);
            if last == 0.0 {
                assert!(by_panels < 1e-3);
            }
            last = by_panels;
        }
    }

    #[test]
    fn refuses_bad_positions_by_name() {
        let duct = duct(DuctSettings::coarse());
        let moved = |shift: [f64; 3]| {
            let capsule = Loaded::new(2, |p| [0, 1, 2].map(|d| 0.5 * p[d] + shift[d]), |p| p);
            duct.velocity(&capsule.membrane(), &[0], &mut [[0.0; 3]])
        };
        assert!(moved([0.0; 3]).is_ok());
        assert!(matches!(moved([0.0, 0.7, 0.0]), Err(FlowError::OutsideDuct { overlap, .. }) if overlap > 0.0));
        assert!(matches!(moved([0.0, 0.0, 0.4995]), Err(FlowError::ThinFilm { gap, .. }) if gap < 6e-4));
        assert!(matches!(moved([3.0, 0.0, 0.0]), Err(FlowError::NearDuctEnd { x, .. }) if x > 3.0));
    }
}
