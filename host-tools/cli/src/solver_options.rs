//! Options that every full-order run shares.

use capsule_fom::{Integrator, MembraneDiscretisation, MembraneLaw, Settings};
use clap::{Args, ValueEnum};

#[derive(Args)]
pub struct SolverOptions {
    /// Mesh frequency n: 8 n^2 elements, 16 n^2 + 2 nodes (8 for work, 13 the paper's size)
    #[arg(long, default_value_t = 8)]
    mesh: usize,
    /// Law of the membrane: neo-hookean (softens under strain), or skalak:C (hardens; its area dilatation modulus is
    /// G_s (1 + 2 C), that of the neo-Hookean law 3 G_s)
    #[arg(long, default_value = "neo-hookean")]
    law: MembraneLaw,
    /// Discretisation of the membrane
    #[arg(long, value_enum, default_value_t = Membrane::Harmonics)]
    membrane: Membrane,
    /// Greatest degree of the harmonics [default: three times the mesh frequency]
    #[arg(long)]
    degree: Option<usize>,
    /// Bending stiffness of the membrane (harmonics), over G_s a^2: regularises buckling, 0 switches it off
    #[arg(long, default_value_t = MembraneDiscretisation::BENDING, allow_negative_numbers = true)]
    bending: f64,
    /// Time integrator
    #[arg(long, value_enum, default_value_t = Scheme::Rkc2)]
    integrator: Scheme,
    /// Step of the fixed-step integrators, in l/V
    #[arg(long, default_value_t = 5e-4)]
    step: f64,
    /// Position error allowed a step (rkc2), in l
    #[arg(long, default_value_t = 1e-5)]
    tolerance: f64,
    /// Last instant, in l/V
    #[arg(long, default_value_t = 20.0)]
    end_time: f64,
    /// Time between snapshots, in l/V
    #[arg(long, default_value_t = 0.2)]
    snapshot_interval: f64,
    /// Compute all nodes instead of an eighth (slow: it checks the symmetry reduction)
    #[arg(long)]
    unreduced: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum Membrane {
    /// Spherical harmonics: smooth, converges fast
    Harmonics,
    /// The paper's six-node elements
    P2,
}

#[derive(Clone, Copy, ValueEnum)]
enum Scheme {
    /// Stabilised second-order Runge-Kutta-Chebyshev with error control
    Rkc2,
    /// Forward Euler, fixed step
    Euler,
    /// Ralston's second-order scheme, fixed step
    Ralston,
}

impl SolverOptions {
    pub fn settings(&self) -> Settings {
        let mut settings = Settings {
            mesh_frequency: self.mesh,
            law: self.law,
            membrane: match self.membrane {
                Membrane::Harmonics => MembraneDiscretisation::Harmonics {
                    degree: self.degree,
                    bending: self.bending,
                },
                Membrane::P2 => MembraneDiscretisation::QuadraticElements,
            },
            integrator: match self.integrator {
                Scheme::Rkc2 => Integrator::Rkc2 {
                    tolerance: self.tolerance,
                },
                Scheme::Euler => Integrator::ForwardEuler { step: self.step },
                Scheme::Ralston => Integrator::Ralston { step: self.step },
            },
            end_time: self.end_time,
            snapshot_interval: self.snapshot_interval,
            symmetric: !self.unreduced,
            ..Settings::default()
        };
        settings.duct.symmetric = !self.unreduced;
        settings
    }

    pub fn integrator_name(&self) -> String {
        self.integrator
            .to_possible_value()
            .map(|value| value.get_name().to_owned())
            .unwrap_or_default()
    }
}
