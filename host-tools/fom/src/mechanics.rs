//! Mechanics of a snapshot on request: the deformation at the nodes, from which stretches, tensions and energy follow,
//! the load, and totals.
//!
//! Derivatives come from the nodes alone, by the same stencils as in the reduced-order model. The load is the solver's
//! own where that is smooth: for a membrane in harmonics, bending included. For one of six-node elements, whose nodal
//! load oscillates from node to node, it is that of the smooth surface through the nodes.

use capsule_core::EvaluateError;
use capsule_core::mechanics::{Deformation, Stencil};

use crate::harmonic_membrane::HarmonicState;
use crate::membrane::Membrane;
use crate::shape_functions::nodes_of;
use crate::surface::{Moments, Patch};
use crate::system::{Discretisation, MembraneModel};
use crate::{EvaluationError, MembraneLaw, Symmetry};

/// Precomputed operators that all snapshots of a discretisation share.
#[derive(Debug, Clone)]
pub struct Mechanics<'a> {
    discretisation: &'a Discretisation,
    stencils: Vec<Stencil<f64>>,
    /// All elements.
    patch: Patch,
    membrane: Membrane,
}

/// Integrals over the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Totals {
    /// Area (l²).
    pub area: f64,
    /// Enclosed volume (l³).
    pub volume: f64,
    /// Elastic energy (G_s l²), without bending.
    pub energy: f64,
}

/// Why a snapshot has no mechanics.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MechanicsError {
    /// No deformation at a node.
    #[error("no deformation of the membrane: {0}")]
    Deformation(#[from] EvaluateError),
    /// No load.
    #[error("no load of the membrane: {0}")]
    Load(#[from] EvaluationError),
    /// No load of this law in six-node elements.
    #[error(
        "the load at the nodes of six-node elements is known for the neo-Hookean law, and this is {law}: take harmonics"
    )]
    Law {
        /// The law.
        law: MembraneLaw,
    },
}

impl<'a> Mechanics<'a> {
    /// Prepares the derivatives at all nodes.
    ///
    /// # Errors
    /// [`EvaluateError::StencilTooSmall`] if the mesh is too coarse for them.
    pub fn new(discretisation: &'a Discretisation) -> Result<Self, MechanicsError> {
        let mesh = &discretisation.mesh;
        let stencil = |node| Stencil::new(mesh.nodes.iter().copied(), node);
        let patch = Patch::new(mesh, &Symmetry::unreduced(mesh));
        Ok(Self {
            discretisation,
            stencils: (0..mesh.nodes.len()).map(stencil).collect::<Result<_, _>>()?,
            membrane: Membrane::new(mesh, &patch, discretisation.law),
            patch,
        })
    }

    /// The deformation at every node, for current `positions` (l) of a sphere of `radius`.
    ///
    /// # Errors
    /// [`EvaluateError::UnknownNode`] if there are fewer positions than nodes; [`EvaluateError::NotFinite`] where the
    /// surface has no area.
    pub fn deformations(&self, positions: &[[f64; 3]], radius: f64) -> Result<Vec<Deformation<f64>>, MechanicsError> {
        let nodes = positions.len();
        let position = |node: usize| {
            let unknown = EvaluateError::UnknownNode { node, nodes };
            positions.get(node).copied().ok_or(unknown)
        };
        let deformation = |stencil: &Stencil<f64>| Ok(stencil.deformation(radius, position)?);
        self.stencils.iter().map(deformation).collect()
    }

    /// The principal tensions of a deformation, T_1 >= T_2, in G_s.
    pub fn tensions(&self, deformation: &Deformation<f64>) -> [f64; 2] {
        self.discretisation.law.tensions(deformation.stretches())
    }

    /// The elastic energy of a deformation per stress-free area, in G_s.
    pub fn energy_density(&self, deformation: &Deformation<f64>) -> f64 {
        let [first, second] = deformation.stretches().map(|stretch| stretch * stretch);
        self.discretisation.law.energy_density(first + second, first * second)
    }

    /// Checks that the load at the nodes is known: that of the smooth surface through them is for the neo-Hookean law.
    ///
    /// # Errors
    /// [`MechanicsError::Law`].
    pub fn check_load(&self) -> Result<(), MechanicsError> {
        let Discretisation { law, membrane, .. } = self.discretisation;
        match membrane {
            MembraneModel::QuadraticElements(_) if !law.is_neo_hookean() => Err(MechanicsError::Law { law: *law }),
            MembraneModel::QuadraticElements(_) | MembraneModel::Harmonics(_) => Ok(()),
        }
    }

    /// The load of the fluid on the membrane at every node (mu V/l), for current `positions` of all nodes.
    ///
    /// # Errors
    /// As [`deformations`](Self::deformations) and [`check_load`](Self::check_load); [`EvaluationError::Collapsed`].
    pub fn load(
        &self,
        positions: &[[f64; 3]],
        radius: f64,
        capillary_number: f64,
    ) -> Result<Vec<[f64; 3]>, MechanicsError> {
        self.check_load()?;
        let Discretisation { symmetry, membrane, .. } = self.discretisation;
        let MembraneModel::Harmonics(harmonics) = membrane else {
            let deformations = self.deformations(positions, radius)?;
            return Ok(deformations
                .iter()
                .map(|at| at.load(capillary_number))
                .collect::<Result<_, _>>()?);
        };
        let sector: Vec<_> = symmetry.sector.iter().map(|&node| positions[node as usize]).collect();
        let mut load = vec![[0.0; 3]; sector.len()];
        let mut force = load.clone();
        harmonics.load(&sector, radius, &mut HarmonicState::default(), &mut load, &mut force)?;
        for component in load.as_flattened_mut() {
            *component /= capillary_number;
        }
        let mut full = vec![[0.0; 3]; positions.len()];
        symmetry.expand(&load, &mut full);
        Ok(full)
    }

    /// Area, volume and energy for current `positions` of all nodes.
    pub fn totals(&self, positions: &[[f64; 3]], radius: f64) -> Totals {
        let mut area = 0.0;
        for element in &self.patch.elements {
            let nodes = nodes_of(element, positions);
            for point in self.patch.points() {
                area += point.weight * point.area(&nodes);
            }
        }
        Totals {
            area,
            volume: Moments::of(&self.patch.elements, positions).volume,
            energy: self.membrane.energy(&self.patch, positions, radius),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MembraneDiscretisation;
    use crate::vectors::norm;
    use nalgebra::Vector3;

    fn discretisation(frequency: usize, harmonics: bool, law: MembraneLaw) -> Discretisation {
        let membrane = if harmonics {
            MembraneDiscretisation::Harmonics {
                degree: None,
                bending: 0.0,
            }
        } else {
            MembraneDiscretisation::QuadraticElements
        };
        Discretisation::new(frequency, true, membrane, law).unwrap()
    }

    /// A hollow shape with the symmetry of the square: polynomials, which harmonics hold exactly.
    fn hollow([x, y, z]: [f64; 3]) -> [f64; 3] {
        [
            x - 0.4 * (y * y + z * z),
            0.85 * y * (1.0 - 0.2 * z * z + 0.1 * x),
            0.85 * z * (1.0 - 0.2 * y * y + 0.1 * x),
        ]
    }

    #[test]
    fn load_from_the_nodes_converges_to_that_of_the_harmonics() {
        let errors = [6, 12].map(|frequency| {
            let [exact, found] = [true, false].map(|harmonics| {
                let discretisation = discretisation(frequency, harmonics, MembraneLaw::NeoHookean);
                let positions: Vec<_> = discretisation.mesh.nodes.iter().map(|&node| hollow(node)).collect();
                let mechanics = Mechanics::new(&discretisation).unwrap();
                mechanics.load(&positions, 0.9, 0.1).unwrap()
            });
            let error = exact
                .iter()
                .zip(&found)
                .map(|(a, b)| norm(Vector3::from(*a) - Vector3::from(*b)));
            error.fold(0.0, f64::max) / exact.iter().map(|&v| norm(v.into())).fold(0.0, f64::max)
        });
        assert!(errors[1] < 3e-4 && errors[0] > 5.0 * errors[1], "{errors:?}");
    }

    #[test]
    fn totals_and_tensions_of_the_inflated_sphere() {
        let (radius, stretch) = (0.9, 1.2_f64);
        let square = stretch * stretch;
        // Tension 1 - lambda^-6; and lambda^2 - 1 + C lambda^2 (lambda^4 - 1), all with their energies.
        let cases = [
            (
                MembraneLaw::NeoHookean,
                1.0 - stretch.powi(-6),
                0.5 * (2.0 * square + stretch.powi(-4) - 3.0),
            ),
            (
                MembraneLaw::Skalak { area: 2.0 },
                square - 1.0 + 2.0 * square * (square * square - 1.0),
                (square - 1.0).powi(2) * (0.5 + 0.5 * (square + 1.0).powi(2)),
            ),
        ];
        for (law, exact, density) in cases {
            check_inflated(law, radius, stretch, exact, density);
        }
    }

    fn check_inflated(law: MembraneLaw, radius: f64, stretch: f64, exact: f64, density: f64) {
        let discretisation = discretisation(8, false, law);
        let mechanics = Mechanics::new(&discretisation).unwrap();
        let sphere = |n: &[f64; 3]| n.map(|x| radius * stretch * x);
        let positions: Vec<_> = discretisation.mesh.nodes.iter().map(sphere).collect();
        let Totals { area, volume, energy } = mechanics.totals(&positions, radius);
        let sphere = 4.0 * std::f64::consts::PI * radius * radius;
        assert!((area / (sphere * stretch.powi(2)) - 1.0).abs() < 1e-4);
        assert!((volume / (sphere * radius * stretch.powi(3) / 3.0) - 1.0).abs() < 1e-4);
        assert!((energy / (sphere * density) - 1.0).abs() < 1e-4);
        for deformation in mechanics.deformations(&positions, radius).unwrap() {
            for tension in mechanics.tensions(&deformation) {
                assert!((tension / exact - 1.0).abs() < 2e-3, "{tension} {exact}");
            }
            let energy = mechanics.energy_density(&deformation);
            assert!((energy / density - 1.0).abs() < 2e-3, "{energy} {density}");
        }
        assert!(mechanics.deformations(&positions[1..], radius).is_err());
        // The load of elements is not that of another law.
        let refused = matches!(mechanics.load(&positions, radius, 0.1), Err(MechanicsError::Law { .. }));
        assert_eq!(refused, !law.is_neo_hookean());
    }

    #[test]
    fn the_coarsest_mesh_has_derivatives() {
        let discretisation = discretisation(crate::mesh::MINIMUM_FREQUENCY, false, MembraneLaw::NeoHookean);
        assert!(Mechanics::new(&discretisation).is_ok());
    }
}
