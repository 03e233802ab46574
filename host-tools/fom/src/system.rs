//! The capsule as a system of ordinary differential equations: membrane load, flow, volume and frame.
//!
//! The state is flat: the positions of the sector's nodes in the frame of the volume centroid, then the centroid's
//! axial position `X_c`. With the fluid's velocity `v` at the nodes, `dX_c/dt = U = (1/V) int x v . n dS` and
//! `dx/dt = v - U e_x`.

use nalgebra::Vector3;

use crate::flow::{Flow, Membrane as FluidMembrane};
use crate::harmonic_membrane::{HarmonicMembrane, HarmonicState};
use crate::mass_matrix::MassMatrix;
use crate::membrane::Membrane;
use crate::surface::{Geometry, Patch};
use crate::vectors::greatest_magnitude;
use crate::{EvaluationError, FomError, MembraneDiscretisation, MembraneLaw, Mesh, Symmetry, initial};

/// Mesh, symmetry and membrane operators, shared by all capsules on one mesh.
#[derive(Debug, Clone)]
pub struct Discretisation {
    /// The reference mesh.
    pub mesh: Mesh,
    /// Its reduction.
    pub symmetry: Symmetry,
    /// The elements that touch the sector.
    pub patch: Patch,
    /// The membrane's law.
    pub law: MembraneLaw,
    /// The membrane's reference state.
    pub membrane: MembraneModel,
}

/// The membrane by one or the other discretisation.
#[derive(Debug, Clone)]
pub enum MembraneModel {
    /// Spherical harmonics.
    Harmonics(Box<HarmonicMembrane>),
    /// Six-node elements.
    QuadraticElements(Membrane),
}

/// A [`MembraneModel`] with its work space.
enum MembraneLoad<'a> {
    Harmonics(&'a HarmonicMembrane, Box<HarmonicState>),
    QuadraticElements(&'a Membrane, MassMatrix),
}

impl Discretisation {
    /// The mesh of frequency `n`, reduced to an eighth or not, with a membrane of `law`.
    ///
    /// # Errors
    /// [`FomError::Law`], [`FomError::MeshFrequency`], [`FomError::Degree`].
    pub fn new(
        frequency: usize,
        symmetric: bool,
        membrane: MembraneDiscretisation,
        law: MembraneLaw,
    ) -> Result<Self, FomError> {
        law.validate()?;
        let mesh = Mesh::octahedral(frequency)?;
        let symmetry = if symmetric {
            Symmetry::reduced(&mesh)?
        } else {
            Symmetry::unreduced(&mesh)
        };
        let patch = Patch::new(&mesh, &symmetry);
        let membrane = match membrane {
            MembraneDiscretisation::Harmonics { degree, bending } => {
                let degree = degree.unwrap_or(3 * frequency);
                let membrane = HarmonicMembrane::new(&mesh, &symmetry, &patch, degree, (law, bending))?;
                MembraneModel::Harmonics(Box::new(membrane))
            }
            MembraneDiscretisation::QuadraticElements => {
                MembraneModel::QuadraticElements(Membrane::new(&mesh, &patch, law))
            }
        };
        Ok(Self {
            mesh,
            symmetry,
            patch,
            law,
            membrane,
        })
    }
}

/// One capsule in a flow, with all work space of an evaluation.
pub struct Capsule<'a> {
    discretisation: &'a Discretisation,
    flow: &'a dyn Flow,
    capillary_number: f64,
    radius: f64,
    membrane: MembraneLoad<'a>,
    geometry: Geometry,
    sector_force: Vec<[f64; 3]>,
    sector_load: Vec<[f64; 3]>,
    nodes: Vec<[f64; 3]>,
    force: Vec<[f64; 3]>,
    load: Vec<[f64; 3]>,
    pressure_drop: f64,
    evaluations: usize,
}

/// The fields of a state over the full mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Fields {
    /// Positions in the laboratory frame.
    pub positions: Vec<[f64; 3]>,
    /// Velocities in the laboratory frame.
    pub velocities: Vec<[f64; 3]>,
    /// Axial position of the volume centroid.
    pub centroid: f64,
    /// Its velocity.
    pub centroid_velocity: f64,
}

/// A membrane cannot move faster than this (V): such a state is an instability on its way to infinity.
const MAX_SPEED: f64 = 1e4;

impl<'a> Capsule<'a> {
    /// A capsule whose stress-free state is a sphere of `radius`, with tensions scaled by `1 / capillary_number`.
    pub fn new(discretisation: &'a Discretisation, flow: &'a dyn Flow, capillary_number: f64, radius: f64) -> Self {
        let sector = vec![[0.0; 3]; discretisation.symmetry.sector.len()];
        let full = vec![[0.0; 3]; discretisation.mesh.nodes.len()];
        Self {
            discretisation,
            flow,
            capillary_number,
            radius,
            membrane: match &discretisation.membrane {
                MembraneModel::Harmonics(membrane) => MembraneLoad::Harmonics(membrane, Box::default()),
                MembraneModel::QuadraticElements(membrane) => {
                    MembraneLoad::QuadraticElements(membrane, MassMatrix::new(&discretisation.patch))
                }
            },
            geometry: Geometry::default(),
            sector_force: sector.clone(),
            sector_load: sector,
            nodes: full.clone(),
            force: full.clone(),
            load: full,
            pressure_drop: 0.0,
            evaluations: 0,
        }
    }

    /// The flat state of the initial shape, centred at `X_c = 0`.
    pub fn initial_value(&self) -> Vec<f64> {
        self.value(&initial::positions(&self.discretisation.mesh, self.radius))
    }

    /// The flat state of node positions (full mesh) in the frame of the centroid, at `X_c = 0`.
    pub fn value(&self, positions: &[[f64; 3]]) -> Vec<f64> {
        let sector = &self.discretisation.symmetry.sector;
        sector
            .iter()
            .flat_map(|&node| positions[node as usize])
            .chain([0.0])
            .collect()
    }

    /// Writes the rate of the flat state `value`.
    ///
    /// # Errors
    /// [`EvaluationError`] if the surface is not one, or the flow refuses it.
    pub fn rate(&mut self, value: &[f64], rate: &mut [f64]) -> Result<(), EvaluationError> {
        let Discretisation {
            mesh, symmetry, patch, ..
        } = self.discretisation;
        self.evaluations += 1;
        symmetry.expand(value.as_chunks().0, &mut self.nodes);
        self.load(value.as_chunks().0)?;
        symmetry.expand(&self.sector_force, &mut self.force);
        symmetry.expand(&self.sector_load, &mut self.load);

        let fluid_membrane = FluidMembrane {
            elements: &mesh.elements,
            nodes: &self.nodes,
            load: &self.load,
            force: &self.force,
        };
        let velocity = rate.as_chunks_mut().0;
        self.pressure_drop = self.flow.velocity(&fluid_membrane, &symmetry.sector, velocity)?;
        symmetry.symmetrise(mesh, velocity);

        patch.geometry(&self.nodes, &symmetry.sector, &mut self.geometry);
        if let MembraneLoad::Harmonics(membrane, state) = &mut self.membrane {
            membrane.filter(state, velocity);
            self.geometry.normals.copy_from_slice(&state.normals);
        }
        let Geometry {
            volume_gradient,
            moment_gradient,
            normals,
            volume,
        } = &self.geometry;
        if volume.is_nan() || *volume <= 0.0 {
            return Err(EvaluationError::Inverted { volume: *volume });
        }
        let inflow = patch.dot(velocity, volume_gradient) / patch.dot(normals, volume_gradient);
        for (v, n) in velocity.iter_mut().zip(normals) {
            *v = (Vector3::from(*v) - inflow * Vector3::from(*n)).into();
        }
        let centroid_velocity = patch.dot(velocity, moment_gradient) / volume;
        for v in velocity.iter_mut() {
            v[0] -= centroid_velocity;
        }
        if let Some(last) = rate.last_mut() {
            *last = centroid_velocity;
        }
        let speed = greatest_magnitude(rate.iter().copied());
        if speed <= MAX_SPEED {
            Ok(())
        } else {
            Err(EvaluationError::Speed { speed })
        }
    }

    /// Finds force and traction of the membrane at the sector's `positions`.
    fn load(&mut self, positions: &[[f64; 3]]) -> Result<(), EvaluationError> {
        let Discretisation {
            mesh, symmetry, patch, ..
        } = self.discretisation;
        let (force, load) = (&mut self.sector_force, &mut self.sector_load);
        match &mut self.membrane {
            MembraneLoad::Harmonics(membrane, state) => membrane.load(positions, self.radius, state, load, force)?,
            MembraneLoad::QuadraticElements(membrane, mass) => {
                membrane.load(patch, &self.nodes, self.radius, force)?;
                symmetry.symmetrise(mesh, force);
                mass.solve(patch, symmetry, &self.nodes, force, load)?;
            }
        }
        for component in force.as_flattened_mut().iter_mut().chain(load.as_flattened_mut()) {
            *component /= self.capillary_number;
        }
        Ok(())
    }

    /// The greatest normal velocity in the frame of the centroid, at the last evaluation, whose rate this is.
    pub fn residual(&self, rate: &[f64]) -> f64 {
        let velocity = rate.as_chunks().0;
        velocity
            .iter()
            .zip(&self.geometry.normals)
            .map(|(v, n)| Vector3::from(*v).dot(&Vector3::from(*n)).abs())
            .fold(0.0, f64::max)
    }

    /// Moves the shape so that its volume centroid, at the last evaluation, is the origin again.
    ///
    /// The equations keep it there; integration errors do not. The laboratory positions stay.
    pub fn recentre(&self, value: &mut [f64]) {
        let (positions, _) = value.as_chunks_mut();
        // The first moment is homogeneous of degree four in the positions (Euler).
        let moment = 0.25 * self.discretisation.patch.dot(positions, &self.geometry.moment_gradient);
        let offset = moment / self.geometry.volume;
        for x in positions {
            x[0] -= offset;
        }
        if let Some(centroid) = value.last_mut() {
            *centroid += offset;
        }
    }

    /// The laboratory fields of a state and its rate.
    pub fn fields(&self, value: &[f64], rate: &[f64]) -> Fields {
        let centroid = value.last().copied().unwrap_or_default();
        let centroid_velocity = rate.last().copied().unwrap_or_default();
        let expand = |flat: &[f64], offset: f64| {
            let mut full = vec![[0.0; 3]; self.nodes.len()];
            self.discretisation.symmetry.expand(flat.as_chunks().0, &mut full);
            full.iter_mut().for_each(|v| v[0] += offset);
            full
        };
        Fields {
            positions: expand(value, centroid),
            velocities: expand(rate, centroid_velocity),
            centroid,
            centroid_velocity,
        }
    }

    /// The enclosed volume at the last evaluation.
    pub fn volume(&self) -> f64 {
        self.geometry.volume
    }

    /// The additional pressure drop at the last evaluation (mu V/l).
    pub fn pressure_drop(&self) -> f64 {
        self.pressure_drop
    }

    /// How many times the velocity was evaluated.
    pub fn evaluations(&self) -> usize {
        self.evaluations
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flow::{Background, Duct, DuctSettings, FreeSpace, MembraneQuadrature, Precision};
    use crate::surface::Moments;

    /// The two relaxation rates of a mode of degree two on the unit sphere: the negative eigenvalues of the linear
    /// response, projected by least squares on the fields `grad Y` and `Y r`.
    fn relaxation_rates(
        frequency: usize,
        membrane: MembraneDiscretisation,
        harmonic: fn([f64; 3]) -> (f64, [f64; 3]),
    ) -> [f64; 2] {
        let discretisation = Discretisation::new(frequency, false, membrane, MembraneLaw::default()).unwrap();
        let flow = FreeSpace::new(Background::Rest);
        let mut capsule = Capsule::new(&discretisation, &flow, 1.0, 1.0);
        let nodes = &discretisation.mesh.nodes;
        // The harmonic polynomial's gradient less its radial part (degree two: 2 Y).
        let tangential = |&r: &[f64; 3]| {
            let (y, gradient) = harmonic(r);
            [0, 1, 2].map(|d| gradient[d] - 2.0 * y * r[d])
        };
        let radial = |&r: &[f64; 3]| r.map(|c| harmonic(r).0 * c);
        let basis: [Vec<[f64; 3]>; 2] = [
            nodes.iter().map(tangential).collect(),
            nodes.iter().map(radial).collect(),
        ];
        let product = |a: &[[f64; 3]], b: &[[f64; 3]]| -> f64 {
            a.as_flattened().iter().zip(b.as_flattened()).map(|(a, b)| a * b).sum()
        };
        let step = 1e-4;
        let mut response = [[0.0; 2]; 2];
        for (column, field) in basis.iter().enumerate() {
            let mut displaced = |sign: f64| {
                let moved: Vec<_> = nodes
                    .iter()
                    .zip(field)
                    .map(|(r, u)| [0, 1, 2].map(|d| r[d] + sign * step * u[d]))
                    .collect();
                let value = capsule.value(&moved);
                let mut rate = vec![0.0; value.len()];
                capsule.rate(&value, &mut rate).unwrap();
                rate.as_chunks::<3>().0.to_vec()
            };
            let (forth, back) = (displaced(1.0), displaced(-1.0));
            let rate: Vec<_> = forth
                .iter()
                .zip(&back)
                .map(|(f, b)| [0, 1, 2].map(|d| (f[d] - b[d]) / (2.0 * step)))
                .collect();
            // Normal equations of the projection; the basis is orthogonal up to the mesh.
            let [tt, rr, tr] = [(0, 0), (1, 1), (0, 1)].map(|(i, j)| product(&basis[i], &basis[j]));
            let [t, r] = [0, 1].map(|i| product(&basis[i], &rate));
            let determinant = tt * rr - tr * tr;
            response[0][column] = (t * rr - r * tr) / determinant;
            response[1][column] = (r * tt - t * tr) / determinant;
        }
        let [[a, b], [c, d]] = response;
        let (mean, root) = (0.5 * (a + d), (0.25 * (a - d) * (a - d) + b * c).sqrt());
        [-(mean + root), -(mean - root)]
    }

    #[test]
    fn relaxation_rates_of_the_sphere_converge() {
        let axial = |[x, y, z]: [f64; 3]| (x * x - 0.5 * (y * y + z * z), [2.0 * x, -y, -z]);
        let oblique = |[x, y, z]: [f64; 3]| (x * y + y * z, [y, x + z, y]);
        // The layer's quadrature on the six-node surface is of fourth order, the elements' load of first.
        let membrane = MembraneDiscretisation::Harmonics {
            degree: None,
            bending: 0.0,
        };
        for (membrane, bound, reduction) in [
            (membrane, 4e-4, 12.0),
            (MembraneDiscretisation::QuadraticElements, 1e-3, 2.0),
        ] {
            for harmonic in [axial, oblique] {
                let errors = [4, 8].map(|n| {
                    let [slow, fast] = relaxation_rates(n, membrane, harmonic);
                    (slow / 0.248359 - 1.0).abs().max((fast / 2.208784 - 1.0).abs())
                });
                assert!(
                    errors[1] < bound && errors[1] < errors[0] / reduction,
                    "{membrane:?} {errors:?}"
                );
            }
        }
    }

    /// The fields of a hollow shape in a coarse duct, and the pressure drop; without what depends on how the nodes are
    /// grouped.
    fn in_coarse_duct(symmetric: bool) -> (Fields, f64) {
        let discretisation =
            Discretisation::new(3, symmetric, MembraneDiscretisation::default(), MembraneLaw::default()).unwrap();
        let duct = Duct::new(&DuctSettings {
            symmetric,
            precision: Precision::Double,
            membrane: MembraneQuadrature {
                far: 50.0,
                ..MembraneQuadrature::default()
            },
            ..DuctSettings::coarse()
        })
        .unwrap();
        let mut capsule = Capsule::new(&discretisation, &duct, 0.1, 0.9);
        let hollow = |&[x, y, z]: &[f64; 3]| {
            [
                x - 0.3 * (y * y + z * z),
                0.8 * y * (1.0 - 0.1 * z * z),
                0.8 * z * (1.0 - 0.1 * y * y),
            ]
        };
        let shape: Vec<_> = discretisation.mesh.nodes.iter().map(hollow).collect();
        let mut value = capsule.value(&shape);
        let mut rate = vec![0.0; value.len()];
        // The first evaluation finds the centroid.
        capsule.rate(&value, &mut rate).unwrap();
        capsule.recentre(&mut value);
        capsule.rate(&value, &mut rate).unwrap();
        (capsule.fields(&value, &rate), capsule.pressure_drop())
    }

    #[test]
    fn an_eighth_of_the_duct_gives_the_velocity_of_the_whole() {
        let (reduced, full) = (in_coarse_duct(true), in_coarse_duct(false));
        assert!(
            (reduced.1 - full.1).abs() < 1e-11 && full.1.abs() > 1.0,
            "{} {}",
            reduced.1,
            full.1
        );
        let mut difference = 0.0_f64;
        for (a, b) in reduced
            .0
            .velocities
            .iter()
            .flatten()
            .zip(full.0.velocities.iter().flatten())
        {
            difference = difference.max((a - b).abs());
        }
        // The walls' equation is of the first kind and amplifies round-off.
        assert!(difference < 2e-9, "{difference}");
    }

    #[test]
    fn velocities_keep_volume_and_centroid() {
        let (fields, _) = in_coarse_duct(true);
        let mesh = Mesh::octahedral(3).unwrap();
        let moments = |time: f64| {
            let moved: Vec<_> = fields
                .positions
                .iter()
                .zip(&fields.velocities)
                .map(|(x, v)| [0, 1, 2].map(|d| x[d] + time * v[d]))
                .collect();
            Moments::of(&mesh.elements, &moved)
        };
        let step = 1e-4;
        let (before, after) = (moments(-step), moments(step));
        assert!(((after.volume - before.volume) / (2.0 * step)).abs() < 1e-6);
        let centroid_velocity = (after.centroid[0] - before.centroid[0]) / (2.0 * step);
        assert!((centroid_velocity - fields.centroid_velocity).abs() < 1e-6);
    }

    #[test]
    fn recentring_keeps_the_laboratory_positions() {
        let discretisation =
            Discretisation::new(3, true, MembraneDiscretisation::default(), MembraneLaw::default()).unwrap();
        let flow = FreeSpace::new(Background::Rest);
        let mut capsule = Capsule::new(&discretisation, &flow, 1.0, 1.0);
        let shifted: Vec<_> = discretisation
            .mesh
            .nodes
            .iter()
            .map(|&[x, y, z]| [x + 0.3, y, z])
            .collect();
        let mut value = capsule.value(&shifted);
        let mut rate = vec![0.0; value.len()];
        capsule.rate(&value, &mut rate).unwrap();
        let before = capsule.fields(&value, &rate);
        capsule.recentre(&mut value);
        let after = capsule.fields(&value, &rate);
        assert!((after.centroid - 0.3).abs() < 1e-13);
        for (a, b) in before.positions.iter().zip(&after.positions) {
            assert!((a[0] - b[0]).abs() < 1e-14);
        }
    }
}
