//! What is varied, and over which values.

use capsule_fom::flow::{DuctSettings, MembraneQuadrature};
use capsule_fom::{Integrator, MembraneDiscretisation, Settings, SteadyCriteria};

/// Settings that differ from those of production in one thing.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// What is varied.
    pub cause: &'static str,
    /// Its value.
    pub value: String,
    /// The settings.
    pub settings: Settings,
    /// Whether these are the production settings, or what comes next to them for this cause.
    pub production: bool,
}

/// Mesh frequency of production.
const MESH: usize = 13;
/// The instant of comparison, unless the shape stands still before (l/V).
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

/// The settings of production, run to the instant of comparison.
fn production() -> Settings {
    Settings {
        mesh_frequency: MESH,
        end_time: END_TIME,
        snapshot_interval: 0.5,
        // Steady to far below what is measured: then the instant does not matter.
        steady: SteadyCriteria {
            translation: 1e-9,
            ..SteadyCriteria::default()
        },
        ..Settings::default()
    }
}

/// The cases; the last of each cause is its finest.
pub fn cases() -> Vec<Case> {
    let production = production();
    let harmonics = |degree, bending| MembraneDiscretisation::Harmonics { degree, bending };
    let mut cases = Vec::new();
    let mut add = |cause: &'static str, value: String, change: &dyn Fn(&mut Settings)| {
        let mut settings = production.clone();
        change(&mut settings);
        cases.push(Case {
            cause,
            value,
            production: settings == production || (cause == ELEMENTS && settings.mesh_frequency == MESH),
            settings,
        });
    };
    for mesh in [8, 10, 13, 16] {
        add(ELEMENTS, mesh.to_string(), &|s| {
            (s.mesh_frequency, s.membrane) = (mesh, MembraneDiscretisation::QuadraticElements);
        });
    }
    for mesh in [8, 10, 13, 16] {
        add(HARMONICS, mesh.to_string(), &|s| s.mesh_frequency = mesh);
    }
    for degree in [16, 24, 32] {
        add("degree at mesh 13", degree.to_string(), &|s| {
            s.membrane = harmonics(Some(degree), MembraneDiscretisation::BENDING);
        });
    }
    add("degree at mesh 13", (3 * MESH).to_string(), &|_| ());
    for mesh in [8, 10, 13, 16] {
        add("mesh at degree 24", mesh.to_string(), &|s| {
            (s.mesh_frequency, s.membrane) = (mesh, harmonics(Some(24), MembraneDiscretisation::BENDING));
        });
    }
    for bending in [1e-3, 3e-4, 1e-4, 3e-5, 0.0] {
        add(BENDING, bending.to_string(), &|s| s.membrane = harmonics(None, bending));
    }
    for panels in [2, 3, 4, 5] {
        add("wall panels", panels.to_string(), &|s| {
            s.duct.transverse_panels = panels;
            s.duct.uniform_panels = (5 * panels).div_ceil(3);
            s.duct.growing_panels = panels;
        });
    }
    for order in [3, 4, 5] {
        add("wall order", order.to_string(), &|s| s.duct.order = order);
    }
    for (half_length, panels) in [(4.0, 3), (4.5, 3), (6.0, 4), (8.0, 5)] {
        add("duct half length / l", half_length.to_string(), &|s| {
            (s.duct.half_length, s.duct.growing_panels) = (half_length, panels);
        });
    }
    for factor in [1, 2] {
        add("quadrature, finer by", factor.to_string(), &|s| {
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
    for tolerance in [1e-4, 1e-5, 1e-6, 1e-7] {
        add("time tolerance / l", format!("{tolerance:e}"), &|s| {
            s.integrator = Integrator::Rkc2 { tolerance };
        });
    }
    cases
}
