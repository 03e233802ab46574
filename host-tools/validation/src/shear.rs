//! A capsule in unbounded simple shear.

use capsule_fom::shear::{Settings, shear};
use capsule_fom::{Integrator, MembraneDiscretisation, MembraneLaw};

use crate::{Check, MEMBRANES, ValidationError};

const MESH: usize = 8;

/// Deformations at several instants.
struct Published {
    capillary_number: f64,
    interval: f64,
    deformations: &'static [f64],
    /// Relative: that of reading a figure.
    tolerance: f64,
}

/// Pozrikidis (J. Fluid Mech. 297, 1995), boundary integrals, read off his figures by others.
const POZRIKIDIS: [Published; 2] = [
    Published {
        capillary_number: 0.0375,
        interval: 0.1,
        deformations: &[0.0383, 0.0578, 0.0680, 0.0723],
        tolerance: 0.04,
    },
    Published {
        capillary_number: 0.3,
        interval: 0.5,
        deformations: &[0.2015, 0.311, 0.361],
        tolerance: 0.02,
    },
];

/// The deformation at Ca = 0.3, long after the start.
const STEADY_TIME: f64 = 6.0;

/// The slope of the deformation at small capillary numbers, and the deformation at two finite ones.
pub fn checks() -> Result<Vec<Check>, ValidationError> {
    let mut checks = Vec::new();
    for (name, membrane) in MEMBRANES {
        checks.push(Check::relative(
            format!("shear, Ca -> 0: D/Ca, {name}"),
            slope(membrane)?,
            25.0 / 12.0,
            1e-3,
            "exact (Barthes-Biesel 1980)",
        ));
        checks.extend(transients(name, membrane)?);
        let steady = deformation(membrane, 0.3, STEADY_TIME, STEADY_TIME, 1e-5)?;
        checks.push(Check::new(
            format!("shear, Ca = 0.3: steady D, {name}"),
            steady[1],
            [0.381, 0.392],
            0.008,
            "range of three published codes",
        ));
    }
    Ok(checks)
}

/// The deformation at the published instants alone, by the harmonics.
pub fn quick_checks() -> Result<Vec<Check>, ValidationError> {
    let [(name, membrane), _] = MEMBRANES;
    transients(name, membrane)
}

/// The deformation at the published instants.
fn transients(name: &str, membrane: MembraneDiscretisation) -> Result<Vec<Check>, ValidationError> {
    let mut checks = Vec::new();
    for published in POZRIKIDIS {
        let Published {
            capillary_number,
            interval,
            deformations,
            tolerance,
        } = published;
        let end_time = interval * deformations.len() as f64;
        let computed = deformation(membrane, capillary_number, end_time, interval, 1e-5)?;
        for (k, &exact) in deformations.iter().enumerate() {
            checks.push(Check::relative(
                format!(
                    "shear, Ca = {capillary_number}: D at t = {:.1}, {name}",
                    interval * (k + 1) as f64
                ),
                computed[k + 1],
                exact,
                tolerance,
                "Pozrikidis (1995), digitised",
            ));
        }
    }
    Ok(checks)
}

/// The Taylor deformation from t = 0, at every `interval`.
fn deformation(
    membrane: MembraneDiscretisation,
    capillary_number: f64,
    end_time: f64,
    interval: f64,
    tolerance: f64,
) -> Result<Vec<f64>, ValidationError> {
    let settings = Settings {
        mesh_frequency: MESH,
        membrane,
        law: MembraneLaw::NeoHookean,
        integrator: Integrator::Rkc2 { tolerance },
        end_time,
        interval,
    };
    Ok(shear(capillary_number, &settings)?.taylor_deformation)
}

/// `D / Ca` of the steady shape for Ca -> 0: reversing the flow changes its sign, so that the next term is of second
/// order, and two capillary numbers remove it. They are so small that the shape is steady before the part of the
/// membrane that is compressed has wrinkled, at a rate that does not depend on Ca.
fn slope(membrane: MembraneDiscretisation) -> Result<f64, ValidationError> {
    let at = |capillary_number: f64| -> Result<f64, ValidationError> {
        // Twelve times the slowest relaxation time.
        let end_time = 12.0 / 0.248 * capillary_number;
        let tolerance = 1e-4 * capillary_number;
        Ok(deformation(membrane, capillary_number, end_time, end_time, tolerance)?[1] / capillary_number)
    };
    Ok((4.0 * at(0.002)? - at(0.004)?) / 3.0)
}
