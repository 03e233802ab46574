//! A made-up family of capsules for tests: smooth in time, and in the parameters a polynomial that both interpolations
//! reproduce (1, Ca, a/l, (a/l)^2), so that a model must return it at any query.

mod mesh;

use capsule_database::{Mesh, Status, Trajectory};
pub use mesh::octahedral;

/// Position, velocity and centroid of a node of the family, in the laboratory frame.
fn node([x, y, z]: [f64; 3], [ca, a]: [f64; 2], t: f64) -> ([f64; 3], [f64; 3]) {
    let (fast, slow) = (1.0 - (-2.0 * t).exp(), 1.0 - (-t).exp());
    let (fast_rate, slow_rate) = (2.0 * (-2.0 * t).exp(), (-t).exp());
    let (p, q) = (0.1 + 2.0 * ca + 0.3 * a * a, 0.2 * a - ca);
    let speed = 2.0 - 0.5 * a * a + ca;
    let first = [x * (y * y + z * z), -0.3 * y, -0.3 * z];
    let second = [0.2 * x, y * z * z, z * y * y];
    let mut position = [a * x, a * y, a * z];
    let mut velocity = [0.0; 3];
    for d in 0..3 {
        position[d] += 0.5 * (p * slow * first[d] + q * fast * second[d]);
        velocity[d] += 0.5 * (p * slow_rate * first[d] + q * fast_rate * second[d]);
    }
    position[0] += speed * t - 0.2 * p * slow;
    velocity[0] += speed - 0.2 * p * slow_rate;
    (position, velocity)
}

/// One member of the family.
pub fn trajectory(mesh: &Mesh, parameters: [f64; 2], times: &[f64]) -> Trajectory {
    let at = |t: f64| -> (Vec<[f64; 3]>, Vec<[f64; 3]>) { mesh.nodes.iter().map(|n| node(*n, parameters, t)).unzip() };
    let (positions, velocities) = times.iter().map(|t| at(*t)).unzip();
    Trajectory {
        parameters: parameters.to_vec(),
        status: Status::Steady {
            time: times.last().copied().unwrap_or(0.0),
        },
        times: times.to_vec(),
        positions,
        velocities,
        // By fore-aft symmetry the volume centroid is where the shape's own terms vanish.
        centroid: times.iter().map(|t| node([0.0; 3], parameters, *t).0[0]).collect(),
        pressure_drop: vec![0.0; times.len()],
    }
}
