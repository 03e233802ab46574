//! The numerical settings that are varied, and their values.

use capsule_fom::flow::{DuctSettings, MembraneQuadrature};
use capsule_fom::{Integrator, MembraneDiscretisation, Settings, SteadyCriteria};

/// Settings that differ from those of production in one thing.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// The setting that is varied.
    pub cause: &'static str,
    /// Its value.
    pub value: String,
    /// The settings.
    pub settings: Settings,
    /// Whether the cause has its value of production.
    pub production: bool,
}

/// Mesh frequency of production.
const MESH: usize = 13;
/// Mesh frequency of the cases that do not vary the membrane.
const COARSE_MESH: usize = 8;
/// The instant of comparison, unless the shape is steady before (l/V).
const END_TIME: f64 = 8.0;

/// (Ca, a/l) of the study: the paper's example; a long capsule; one with a thin film whose rear buckles; one near the
/// limit of steady shapes.
pub const CONFIGURATIONS: [(f64, f64); 4] = [(0.10, 0.90), (0.03, 1.10), (0.005, 0.85), (0.15, 0.75)];

/// The cause that six-node elements have instead of [`HARMONICS`].
pub(super) const ELEMENTS: &str = "mesh, elements";
/// The harmonics' mesh, with the degree that goes with it.
pub(super) const HARMONICS: &str = "mesh, harmonics";
/// A property of the membrane more than an error.
pub(super) const BENDING: &str = "bending / (G_s a^2)";

/// The settings of production on another mesh, run to the instant of comparison.
fn on_mesh(mesh_frequency: usize) -> Settings {
    Settings {
        mesh_frequency,
        end_time: END_TIME,
        snapshot_interval: 0.5,
        // The shape stands still to far below what is measured: then the instant does not matter.
        steady: SteadyCriteria {
            motion: 1e-9,
            ..SteadyCriteria::default()
        },
        ..Settings::default()
    }
}

/// The cases; the last of each cause is its finest. Causes that are not the membrane's are varied on a coarser mesh, on
/// which they are cheaper and do the same.
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    let mut add = |cause: &'static str, base: &Settings, value: String, change: &dyn Fn(&mut Settings)| {
        let mut settings = base.clone();
        change(&mut settings);
        cases.push(Case {
            cause,
            value,
            production: settings == *base,
            settings,
        });
    };
    let production = on_mesh(MESH);
    for mesh in [8, 10, 13, 16] {
        add(HARMONICS, &production, mesh.to_string(), &|s| s.mesh_frequency = mesh);
    }

    let coarse = on_mesh(COARSE_MESH);
    for panels in [2, 3, 4] {
        add("wall panels", &coarse, panels.to_string(), &|s| {
            s.duct.transverse_panels = panels;
            s.duct.uniform_panels = (5 * panels).div_ceil(3);
            s.duct.growing_panels = panels;
        });
    }
    for order in [3, 4, 5] {
        add("wall order", &coarse, order.to_string(), &|s| s.duct.order = order);
    }
    for (half_length, panels) in [(4.0, 3), (4.5, 3), (6.0, 4)] {
        add("duct half length / l", &coarse, half_length.to_string(), &|s| {
            (s.duct.half_length, s.duct.growing_panels) = (half_length, panels);
        });
    }
    for factor in [1, 2] {
        add("quadrature, finer by", &coarse, factor.to_string(), &|s| {
            let DuctSettings {
                wall_reach, membrane, ..
            } = &mut s.duct;
            let finer = f64::from(factor);
            *wall_reach *= finer;
            *membrane = MembraneQuadrature {
                far: finer * membrane.far,
                middle: finer * membrane.middle,
                near: finer * membrane.near,
                duffy: membrane.duffy.map(|points| points * factor as usize),
            };
        });
    }
    for tolerance in [1e-4, 1e-5, 1e-6] {
        add("time tolerance / l", &coarse, format!("{tolerance:e}"), &|s| {
            s.integrator = Integrator::Rkc2 { tolerance };
        });
    }

    let harmonics = |degree, bending| MembraneDiscretisation::Harmonics { degree, bending };
    for degree in [16, 24, 32] {
        add("degree at mesh 13", &production, degree.to_string(), &|s| {
            s.membrane = harmonics(Some(degree), MembraneDiscretisation::BENDING);
        });
    }
    add("degree at mesh 13", &production, (3 * MESH).to_string(), &|_| ());
    for bending in [3e-4, MembraneDiscretisation::BENDING, 3e-5, 0.0] {
        add(BENDING, &production, bending.to_string(), &|s| {
            s.membrane = harmonics(None, bending);
        });
    }

    let elements = Settings {
        membrane: MembraneDiscretisation::QuadraticElements,
        ..production
    };
    for mesh in [8, 10, 13, 16] {
        add(ELEMENTS, &elements, mesh.to_string(), &|s| s.mesh_frequency = mesh);
    }
    cases
}
