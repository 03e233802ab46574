//! A capsule in unbounded simple shear flow `u = (y, 0, 0)`: the classic case to compare with other methods.
//!
//! Lengths in the capsule's radius a, time in 1 / (shear rate), `Ca = mu a (shear rate) / G_s`.

use std::f64::consts::FRAC_PI_4;

use crate::flow::{Background, FreeSpace};
use crate::integrator::{Integration, State, StepError, Stepper};
use crate::parameters::{positive, snapshots};
use crate::surface::Moments;
use crate::system::{Capsule, Discretisation};
use crate::{FomError, Integrator, MembraneDiscretisation, MembraneLaw};

/// The solver's settings.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Mesh frequency `n`: 8 n² elements.
    pub mesh_frequency: usize,
    /// Discretisation of the membrane on this mesh.
    pub membrane: MembraneDiscretisation,
    /// Law of the membrane.
    pub law: MembraneLaw,
    /// Time integrator.
    pub integrator: Integrator,
    /// Last instant.
    pub end_time: f64,
    /// Time between two entries of the outcome.
    pub interval: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            mesh_frequency: 8,
            membrane: MembraneDiscretisation::default(),
            law: MembraneLaw::default(),
            integrator: Integrator::default(),
            end_time: 4.0,
            interval: 0.1,
        }
    }
}

/// The deformation over time.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ShearOutcome {
    /// Time.
    pub t: Vec<f64>,
    /// Taylor deformation `(L - B) / (L + B)` in the shear plane, from the ellipsoid with the capsule's second moments
    /// of volume (as Pozrikidis, J. Fluid Mech. 297, 1995).
    pub taylor_deformation: Vec<f64>,
    /// Angle of its long axis to the flow direction (rad).
    pub inclination: Vec<f64>,
    /// Velocity evaluations.
    pub velocity_evaluations: usize,
    /// Greatest relative change of the enclosed volume.
    pub volume_drift: f64,
}

/// Deforms a spherical, stress-free capsule by simple shear.
///
/// # Errors
/// [`FomError::NotPositive`], [`FomError::Law`], [`FomError::MeshFrequency`] or [`FomError::TooManySnapshots`] for a
/// bad setting, [`FomError::UnstableStep`] for a fixed step that is too long, [`FomError::Shear`] if the surface cannot
/// be carried on.
pub fn shear(capillary_number: f64, settings: &Settings) -> Result<ShearOutcome, FomError> {
    positive("capillary number Ca", capillary_number)?;
    positive("end time", settings.end_time)?;
    positive("interval", settings.interval)?;
    snapshots(settings.end_time, settings.interval)?;
    settings.integrator.validate()?;
    // The shear has not the symmetry of the square.
    let discretisation = Discretisation::new(settings.mesh_frequency, false, settings.membrane, settings.law)?;
    let flow = FreeSpace::new(Background::Shear { rate: 1.0 });
    let mut capsule = Capsule::new(&discretisation, &flow, capillary_number, 1.0);
    let failed = |time: f64, reason: String| FomError::Shear { time, reason };
    let value = capsule.value(&discretisation.mesh.nodes);
    let mut state =
        State::new(0.0, value, &mut |x, rate| capsule.rate(x, rate)).map_err(|error| failed(0.0, error.to_string()))?;
    let initial_volume = capsule.volume();
    let mut stepper = Integration::new(&settings.integrator);
    let mut outcome = ShearOutcome::default();
    for entry in 0.. {
        let until = (f64::from(entry) * settings.interval).min(settings.end_time);
        while state.time < until {
            stepper
                .step(&mut |x, rate| capsule.rate(x, rate), &mut state, until)
                .map_err(|error| match error {
                    StepError::Unstable { step, limit, time } => FomError::UnstableStep { step, limit, time },
                    other => failed(state.time, other.to_string()),
                })?;
        }
        let positions = capsule.fields(&state.value, &state.rate).positions;
        let (deformation, inclination) = ellipse(&Moments::of(&discretisation.mesh.elements, &positions));
        outcome.t.push(state.time);
        outcome.taylor_deformation.push(deformation);
        outcome.inclination.push(inclination);
        outcome.volume_drift = outcome
            .volume_drift
            .max((capsule.volume() / initial_volume - 1.0).abs());
        if until >= settings.end_time * (1.0 - 1e-12) {
            break;
        }
    }
    outcome.velocity_evaluations = capsule.evaluations();
    Ok(outcome)
}

/// Taylor deformation and inclination of the ellipse with these second moments in the shear plane `(x, y)`.
///
/// A circle has no inclination; it gets that of the flow's extension, 45 degrees, the limit at short times.
fn ellipse(moments: &Moments) -> (f64, f64) {
    let [xx, yy, xy] = [(0, 0), (1, 1), (0, 1)].map(|index| moments.second[index]);
    let (mean, half_difference) = (0.5 * (xx + yy), 0.5 * (xx - yy));
    let radius = half_difference.hypot(xy);
    if radius < 1e-12 * mean {
        return (0.0, FRAC_PI_4);
    }
    let (long, short) = ((mean + radius).sqrt(), (mean - radius).max(0.0).sqrt());
    ((long - short) / (long + short), 0.5 * xy.atan2(half_difference))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Mesh;

    #[test]
    fn ellipse_of_a_known_ellipsoid() {
        let mesh = Mesh::octahedral(6).unwrap();
        let (sine, cosine) = 0.4_f64.sin_cos();
        let nodes: Vec<_> = mesh
            .nodes
            .iter()
            .map(|&[x, y, z]| {
                let (long, short) = (1.5 * x, 0.7 * y);
                [cosine * long - sine * short, sine * long + cosine * short, z]
            })
            .collect();
        let (deformation, inclination) = ellipse(&Moments::of(&mesh.elements, &nodes));
        assert!((deformation - 0.8 / 2.2).abs() < 1e-3, "{deformation}");
        assert!((inclination - 0.4).abs() < 1e-3);
    }

    /// Pozrikidis (J. Fluid Mech. 297, 1995), read off his figure by others: good to a few percent.
    #[test]
    fn deformation_at_short_times_agrees_with_pozrikidis() {
        let settings = Settings {
            mesh_frequency: 4,
            end_time: 0.4,
            ..Settings::default()
        };
        let outcome = shear(0.0375, &settings).unwrap();
        let published = [0.0383, 0.0578, 0.0680, 0.0723];
        for (k, exact) in published.into_iter().enumerate() {
            let deformation = outcome.taylor_deformation[k + 1];
            assert!((deformation / exact - 1.0).abs() < 0.04, "{deformation} {exact}");
        }
        assert!(outcome.volume_drift < 1e-5);
        // From the direction of extension it turns towards the flow.
        assert_eq!(outcome.inclination[0], FRAC_PI_4);
        assert!(outcome.inclination.windows(2).all(|pair| pair[1] < pair[0]));
    }

    #[test]
    fn bad_settings_are_named() {
        assert!(matches!(
            shear(f64::NAN, &Settings::default()),
            Err(FomError::NotPositive { .. })
        ));
        let settings = Settings {
            mesh_frequency: 1,
            ..Settings::default()
        };
        assert!(matches!(shear(0.1, &settings), Err(FomError::MeshFrequency { .. })));
    }
}
