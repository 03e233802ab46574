//! The membrane of each law: an inflated sphere and a sheet pulled in one direction.

use std::sync::Mutex;

use capsule_fom::flow::{Flow, FlowError, Membrane as FluidMembrane};
use capsule_fom::membrane::Membrane;
use capsule_fom::surface::{Moments, Patch};
use capsule_fom::system::{Capsule, Discretisation};
use capsule_fom::{MembraneLaw, Mesh, Symmetry};
use nalgebra::Vector3;

use crate::{Check, MEMBRANES, ValidationError};

const SOURCE: &str = "exact";
const MESH: usize = 13;

/// Skalak's law of the checks.
const SKALAK: MembraneLaw = MembraneLaw::Skalak { area: 1.0 };

/// Inflation pressures and tractions of both discretisations, uniaxial tension.
pub fn checks() -> Result<Vec<Check>, ValidationError> {
    let mut checks = Vec::new();
    for (name, membrane) in MEMBRANES {
        let discretisation = Discretisation::new(MESH, true, membrane, MembraneLaw::NeoHookean)?;
        let skalak = Discretisation::new(MESH, true, membrane, SKALAK)?;
        // p = 2 T / lambda with the tension T = 1 - lambda^-6, and lambda^2 - 1 + C lambda^2 (lambda^4 - 1).
        for (law, discretisation, exact) in [
            ("", &discretisation, 2.0 * (1.0 / 1.2 - 1.2_f64.powi(-7))),
            ("Skalak, C = 1, ", &skalak, 2.0 * (1.2_f64.powi(5) - 1.0 / 1.2)),
        ] {
            let (pressure, traction) = inflate(discretisation, 1.2)?;
            checks.push(Check::relative(
                format!("{law}inflation by 1.2: p a/G_s, {name}"),
                pressure,
                exact,
                1e-4,
                SOURCE,
            ));
            // The elements' nodal tractions converge slowly: the surface has kinks.
            checks.push(Check::new(
                format!("{law}inflation by 1.2: greatest error of the traction over p, {name}"),
                traction,
                0.0,
                if name == "elements" { 0.15 } else { 1e-3 },
                SOURCE,
            ));
        }
        let (stretch, greatest) = limit_point(&discretisation)?;
        let limit = 7_f64.powf(1.0 / 6.0);
        checks.push(Check::relative(
            format!("inflation limit: stretch, {name}"),
            stretch,
            limit,
            1e-4,
            SOURCE,
        ));
        checks.push(Check::relative(
            format!("inflation limit: p a/G_s, {name}"),
            greatest,
            2.0 * (1.0 / limit - limit.powi(-7)),
            1e-4,
            SOURCE,
        ));
    }
    for stretch in [0.8, 1.3, 2.0_f64] {
        let exact = stretch.powf(1.5) - stretch.powf(-1.5);
        let quantity = format!("uniaxial stretch {stretch}: tension/G_s, elements");
        let computed = uniaxial(MembraneLaw::NeoHookean, stretch, stretch.sqrt().recip())?;
        checks.push(Check::relative(quantity, computed, exact, 1e-10, SOURCE));
        // The lateral stretch without lateral tension: m^2 - 1 + C l^2 (l^2 m^2 - 1) = 0.
        let square = stretch * stretch;
        let lateral_2 = (1.0 + square) / (1.0 + square * square);
        let exact = stretch / lateral_2.sqrt() * (square - 1.0 + lateral_2 * (square * lateral_2 - 1.0));
        let quantity = format!("Skalak, C = 1, uniaxial stretch {stretch}: tension/G_s, elements");
        let computed = uniaxial(SKALAK, stretch, lateral_2.sqrt())?;
        checks.push(Check::relative(quantity, computed, exact, 1e-10, SOURCE));
    }
    Ok(checks)
}

/// Force and traction at the nodes.
type Seen = (Vec<[f64; 3]>, Vec<[f64; 3]>);

/// A fluid at rest that records the membrane's force and traction.
#[derive(Default)]
struct Witness {
    seen: Mutex<Seen>,
}

impl Flow for Witness {
    fn velocity(&self, membrane: &FluidMembrane, _: &[u32], out: &mut [[f64; 3]]) -> Result<f64, FlowError> {
        if let Ok(mut seen) = self.seen.lock() {
            *seen = (membrane.force.to_vec(), membrane.load.to_vec());
        }
        out.fill([0.0; 3]);
        Ok(0.0)
    }
}

/// The pressure in the inflated unit sphere by virtual work, `r . x = 3 p V`, and the greatest error of a nodal
/// traction over the pressure.
fn inflate(discretisation: &Discretisation, stretch: f64) -> Result<(f64, f64), ValidationError> {
    let witness = Witness::default();
    let mesh = &discretisation.mesh;
    let nodes: Vec<_> = mesh.nodes.iter().map(|r| r.map(|c| stretch * c)).collect();
    let mut capsule = Capsule::new(discretisation, &witness, 1.0, 1.0);
    let value = capsule.value(&nodes);
    capsule.rate(&value, &mut vec![0.0; value.len()])?;
    let (force, load) = witness.seen.into_inner().unwrap_or_default();
    let product = |(a, b): (&[f64; 3], &[f64; 3])| Vector3::from(*a).dot(&Vector3::from(*b));
    let work: f64 = force.iter().zip(&nodes).map(product).sum();
    let pressure = work / (3.0 * Moments::of(&mesh.elements, &nodes).volume);
    let error = load
        .iter()
        .zip(&mesh.nodes)
        .map(|pair| (product(pair) / pressure - 1.0).abs())
        .fold(0.0, f64::max);
    Ok((pressure, error))
}

/// The stretch of the greatest pressure, from the parabola through three stretches, and that pressure.
fn limit_point(discretisation: &Discretisation) -> Result<(f64, f64), ValidationError> {
    let (middle, step) = (1.383, 0.002);
    let [low, at, high] = [middle - step, middle, middle + step].map(|stretch| inflate(discretisation, stretch));
    let (low, at, high) = (low?.0, at?.0, high?.0);
    let offset = 0.5 * (low - high) / (low - 2.0 * at + high);
    Ok((middle + offset * step, at - 0.25 * (low - high) * offset))
}

/// The tension of a flat element with free sides, whose width becomes `lateral`; by virtual work.
fn uniaxial(law: MembraneLaw, stretch: f64, lateral: f64) -> Result<f64, ValidationError> {
    let mesh = Mesh {
        nodes: vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.5, 0.0, 0.0],
            [0.5, 0.5, 0.0],
            [0.0, 0.5, 0.0],
        ],
        elements: vec![[0, 1, 2, 3, 4, 5]],
    };
    let patch = Patch::new(&mesh, &Symmetry::unreduced(&mesh));
    let nodes: Vec<_> = mesh
        .nodes
        .iter()
        .map(|&[x, y, _]| [stretch * x, lateral * y, 0.0])
        .collect();
    let mut load = vec![[0.0; 3]; nodes.len()];
    Membrane::new(&mesh, &patch, law).load(&patch, &nodes, 1.0, &mut load)?;
    let work: f64 = load.iter().zip(&nodes).map(|(r, x)| r[0] * x[0]).sum();
    Ok(work / (0.5 * stretch * lateral))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_pass() {
        let checks = checks().unwrap();
        assert!(checks.iter().all(|check| check.passed), "{checks:#?}");
    }
}
