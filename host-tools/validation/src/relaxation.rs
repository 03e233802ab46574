//! How a slightly deformed sphere relaxes in fluid at rest.

use capsule_fom::MembraneLaw;
use capsule_fom::flow::{Background, FreeSpace};
use capsule_fom::system::{Capsule, Discretisation};
use nalgebra::Vector3;

use crate::harmonic::Harmonic;
use crate::{Check, MEMBRANES, ValidationError};

const SOURCE: &str = "exact (linear theory)";
const MESH: usize = 13;
/// Degree of the harmonic and its two rates in `G_s / (mu a)`, viscosity ratio 1.
pub const RATES: [(u32, [f64; 2]); 4] = [
    (2, [0.248359, 2.208784]),
    (3, [0.19868, 3.28704]),
    (4, [0.15983, 4.33368]),
    (8, [0.08729, 8.41178]),
];

/// The slow and the fast rate of these degrees (of [`RATES`]), by both discretisations.
pub fn checks(rates: &[(u32, [f64; 2])]) -> Result<Vec<Check>, ValidationError> {
    let mut checks = Vec::new();
    for (name, membrane) in MEMBRANES {
        let discretisation = Discretisation::new(MESH, false, membrane, MembraneLaw::default())?;
        for &(degree, exact) in rates {
            let computed = relaxation_rates(&discretisation, Harmonic::oblique(degree))?;
            for (speed, rate, exact) in [("slow", computed[0], exact[0]), ("fast", computed[1], exact[1])] {
                let quantity = format!("{speed} rate of degree {degree}, {name}");
                // The mesh resolves a harmonic the less, the shorter its waves.
                let tolerance = 5e-4 * f64::from(degree);
                checks.push(Check::relative(quantity, rate, exact, tolerance, SOURCE));
            }
        }
    }
    Ok(checks)
}

/// The negative eigenvalues of the linear response, by central differences and projection on the tangential and the
/// radial field of the harmonic.
fn relaxation_rates(discretisation: &Discretisation, harmonic: Harmonic) -> Result<[f64; 2], ValidationError> {
    const STEP: f64 = 1e-4;
    let flow = FreeSpace::new(Background::Rest);
    let mut capsule = Capsule::new(discretisation, &flow, 1.0, 1.0);
    let nodes: Vec<_> = discretisation.mesh.nodes.iter().copied().map(Vector3::from).collect();
    let mut velocities = |field: &[Vector3<f64>], step: f64| {
        let moved: Vec<_> = nodes.iter().zip(field).map(|(r, u)| (r + step * u).into()).collect();
        let value = capsule.value(&moved);
        let mut rate = vec![0.0; value.len()];
        capsule.rate(&value, &mut rate)?;
        Ok::<_, ValidationError>(capsule.fields(&value, &rate).velocities.into_iter().map(Vector3::from))
    };
    let product = |a: &[Vector3<f64>], b: &[Vector3<f64>]| a.iter().zip(b).map(|(a, b)| a.dot(b)).sum::<f64>();

    let tangential: Vec<_> = nodes.iter().map(|&r| harmonic.at(r).1).collect();
    let radial: Vec<_> = nodes.iter().map(|&r| harmonic.at(r).0 * r).collect();
    // Normal equations of the projection: the two fields are orthogonal at every node.
    let norms = [product(&tangential, &tangential), product(&radial, &radial)];
    let mut response = [[0.0; 2]; 2];
    for (column, field) in [&tangential, &radial].into_iter().enumerate() {
        let (forth, back) = (velocities(field, STEP)?, velocities(field, -STEP)?);
        let rate: Vec<_> = forth.zip(back).map(|(f, b)| (f - b) / (2.0 * STEP)).collect();
        response[0][column] = product(&tangential, &rate) / norms[0];
        response[1][column] = product(&radial, &rate) / norms[1];
    }
    let [[a, b], [c, d]] = response;
    let (mean, root) = (0.5 * (a + d), (0.25 * (a - d) * (a - d) + b * c).sqrt());
    Ok([-(mean + root), -(mean - root)])
}
