//! How good the full-order model is: checks against exact and published results, the error of each numerical cause
//! alone, and the cost of each time integrator.

pub mod convergence;
mod design;
mod duct;
mod elasticity;
mod error;
mod harmonic;
pub mod integrators;
mod outline;
pub mod poiseuille;
mod relaxation;
mod shear;
mod single_layer;

pub use error::ValidationError;
pub use outline::Outline;

use capsule_database::Database;
use capsule_fom::MembraneDiscretisation;
use serde::Serialize;

/// The reference that a computed quantity is compared with.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Reference {
    /// A value.
    Value(f64),
    /// The range of several sources.
    Range([f64; 2]),
}

/// One quantity against its reference.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    /// Name of the quantity, with its unit or scaling.
    pub quantity: String,
    /// The value that this solver computes.
    pub computed: f64,
    /// The reference.
    pub reference: Reference,
    /// Source of the reference.
    pub source: &'static str,
    /// Computed less reference; from the nearer end of a range, 0 within.
    pub difference: f64,
    /// The greatest difference that passes.
    pub tolerance: f64,
    /// Whether the difference is within the tolerance.
    pub passed: bool,
}

impl From<f64> for Reference {
    fn from(value: f64) -> Self {
        Self::Value(value)
    }
}

impl From<[f64; 2]> for Reference {
    fn from(range: [f64; 2]) -> Self {
        Self::Range(range)
    }
}

impl Check {
    /// A check with an absolute tolerance. NaN and infinities do not pass.
    pub fn new(
        quantity: impl Into<String>,
        computed: f64,
        reference: impl Into<Reference>,
        tolerance: f64,
        source: &'static str,
    ) -> Self {
        let reference = reference.into();
        let difference = match reference {
            Reference::Value(value) => computed - value,
            Reference::Range([low, high]) => (computed - low).min(0.0) + (computed - high).max(0.0),
        };
        Self {
            quantity: quantity.into(),
            computed,
            reference,
            source,
            difference,
            tolerance,
            passed: computed.is_finite() && difference.abs() <= tolerance,
        }
    }

    /// A check whose tolerance is relative to the reference.
    pub fn relative(
        quantity: impl Into<String>,
        computed: f64,
        reference: f64,
        tolerance: f64,
        source: &'static str,
    ) -> Self {
        Self::new(quantity, computed, reference, tolerance * reference.abs(), source)
    }
}

/// Both discretisations of the membrane, by name. Without bending, which the references in free space do not have.
const MEMBRANES: [(&str, MembraneDiscretisation); 2] = [
    (
        "harmonics",
        MembraneDiscretisation::Harmonics {
            degree: None,
            bending: 0.0,
        },
    ),
    ("elements", MembraneDiscretisation::QuadraticElements),
];

/// A group of checks with its name.
type Part<'a> = (&'a str, &'a dyn Fn() -> Result<Vec<Check>, ValidationError>);

/// Runs all checks: the flow, the membrane, both together in free space and in the duct, and the steady configurations
/// of `database`. `progress` receives the name of each part before it starts, the number of finished parts and the
/// number of all parts.
///
/// # Errors
/// [`ValidationError`] when a part could not be computed at all.
pub fn validate(database: &Database, progress: &dyn Fn(&str, usize, usize)) -> Result<Vec<Check>, ValidationError> {
    run(
        &[
            ("square duct", &|| Ok(poiseuille::checks())),
            ("single layer", &single_layer::checks),
            ("membrane", &elasticity::checks),
            ("linear response", &|| relaxation::checks(&relaxation::RATES)),
            ("simple shear", &shear::checks),
            ("stiff spheres in the duct", &duct::stiff_spheres),
            ("steady capsule in the duct", &|| {
                duct::steady_capsule(&duct::membranes())
            }),
            ("steady configurations", &|| design::checks(database)),
        ],
        progress,
    )
}

/// Runs the checks that take seconds and together cover every operator of the solver: the undisturbed flow, the single
/// layer, both membranes, their coupling, and one run each in shear and in the duct. A wrong constant in the solver
/// fails at least one of them.
///
/// # Errors
/// As [`validate`].
pub fn validate_quick(progress: &dyn Fn(&str, usize, usize)) -> Result<Vec<Check>, ValidationError> {
    run(
        &[
            ("square duct", &|| Ok(poiseuille::checks())),
            ("single layer", &single_layer::checks),
            ("membrane", &elasticity::checks),
            ("linear response", &|| relaxation::checks(&relaxation::RATES[..1])),
            ("simple shear", &shear::quick_checks),
            ("stiff spheres in the duct", &duct::stiff_spheres),
            ("steady capsule in the duct", &|| {
                duct::steady_capsule(&duct::membranes()[..1])
            }),
        ],
        progress,
    )
}

fn run(parts: &[Part], progress: &dyn Fn(&str, usize, usize)) -> Result<Vec<Check>, ValidationError> {
    let mut checks = Vec::new();
    for (done, (name, part)) in parts.iter().enumerate() {
        progress(name, done, parts.len());
        checks.extend(part()?);
    }
    Ok(checks)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts() {
        let check = |computed, reference: Reference| Check::new("", computed, reference, 0.1, "");
        assert!(check(1.05, 1.0.into()).passed && !check(1.2, 1.0.into()).passed);
        assert!(!check(f64::NAN, 1.0.into()).passed && !check(f64::NAN, [0.0, 1.0].into()).passed);
        let low = check(0.8, [1.0, 2.0].into());
        assert!(!low.passed && (low.difference + 0.2).abs() < 1e-15);
        assert_eq!(check(1.5, [1.0, 2.0].into()).difference, 0.0);
        assert!(check(2.05, [1.0, 2.0].into()).passed);
        assert!(Check::relative("", -99.0, -100.0, 0.02, "").passed);
    }
}
