//! The single layer of the unit sphere: vector spherical harmonics are its eigenfields.

use capsule_fom::flow::{Background, Flow, FreeSpace, Membrane};
use capsule_fom::vectors::{greatest_magnitude, norm};
use capsule_fom::{FomError, Mesh};
use nalgebra::Vector3;

use crate::harmonic::Harmonic;
use crate::{Check, ValidationError};

const SOURCE: &str = "exact";
const MESH: usize = 13;

/// Eigenvalues for the degrees 2 to 4, uniform and normal traction, and the greatest error at a node.
pub fn checks() -> Result<Vec<Check>, ValidationError> {
    let sphere = Sphere::new(MESH)?;
    let uniform = sphere.apply(|_| Vector3::new(1.0, -0.5, 0.3))?;
    let mut worst = uniform.error(2.0 / 3.0);
    let mut checks = vec![
        Check::relative(
            "single layer, uniform traction",
            uniform.eigenvalue(),
            2.0 / 3.0,
            1e-4,
            SOURCE,
        ),
        Check::new(
            "single layer, normal traction: greatest velocity",
            sphere.apply(|r| r)?.error(0.0),
            0.0,
            1e-4,
            SOURCE,
        ),
    ];
    for degree in [2_u32, 3, 4] {
        let harmonic = Harmonic::oblique(degree);
        let n = f64::from(degree);
        let v = |r| {
            let (y, gradient) = harmonic.at(r);
            gradient - (n + 1.0) * y * r
        };
        let w = |r| {
            let (y, gradient) = harmonic.at(r);
            gradient + n * y * r
        };
        let x = |r: Vector3<f64>| r.cross(&harmonic.at(r).1);
        let modes = [
            ("V", sphere.apply(v)?, n / ((2.0 * n + 1.0) * (2.0 * n + 3.0))),
            ("W", sphere.apply(w)?, (n + 1.0) / ((2.0 * n + 1.0) * (2.0 * n - 1.0))),
            ("X", sphere.apply(x)?, 1.0 / (2.0 * n + 1.0)),
        ];
        for (name, response, exact) in modes {
            let quantity = format!("single layer, {name}_{degree}");
            checks.push(Check::relative(quantity, response.eigenvalue(), exact, 5e-4, SOURCE));
            worst = worst.max(response.error(exact));
        }
    }
    checks.push(Check::new(
        "single layer: greatest error of these fields at a node",
        worst,
        0.0,
        1e-3,
        SOURCE,
    ));
    Ok(checks)
}

struct Sphere {
    mesh: Mesh,
    flow: FreeSpace,
}

/// A load and minus the velocity that it gives, relative to the load's greatest magnitude.
struct Response {
    load: Vec<Vector3<f64>>,
    velocity: Vec<Vector3<f64>>,
}

impl Sphere {
    fn new(frequency: usize) -> Result<Self, FomError> {
        Ok(Self {
            mesh: Mesh::octahedral(frequency)?,
            flow: FreeSpace::new(Background::Rest),
        })
    }

    fn apply(&self, load: impl Fn(Vector3<f64>) -> Vector3<f64>) -> Result<Response, ValidationError> {
        let Mesh { nodes, elements } = &self.mesh;
        let load: Vec<[f64; 3]> = nodes.iter().map(|&r| load(r.into()).into()).collect();
        let targets: Vec<u32> = (0..nodes.len() as u32).collect();
        let mut velocity = vec![[0.0; 3]; nodes.len()];
        let membrane = Membrane {
            elements,
            nodes,
            load: &load,
            // For the pressure drop, of which there is none in free space.
            force: &vec![[0.0; 3]; nodes.len()],
        };
        self.flow.velocity(&membrane, &targets, &mut velocity)?;
        let vectors = |field: Vec<[f64; 3]>| field.into_iter().map(Vector3::from).collect();
        Ok(Response {
            load: vectors(load),
            velocity: vectors(velocity),
        })
    }
}

impl Response {
    /// `- v . q / q . q` over the nodes.
    fn eigenvalue(&self) -> f64 {
        let product = |a: &[Vector3<f64>]| self.load.iter().zip(a).map(|(q, a)| q.dot(a)).sum::<f64>();
        -product(&self.velocity) / product(&self.load)
    }

    /// The greatest of `|v + lambda q|` at a node over the greatest load.
    fn error(&self, eigenvalue: f64) -> f64 {
        let pairs = self.load.iter().zip(&self.velocity);
        let difference = pairs.map(|(q, v)| norm(v + eigenvalue * q));
        greatest_magnitude(difference) / greatest_magnitude(self.load.iter().copied().map(norm))
    }
}
