//! A made-up family of capsules for tests: smooth in time, and in the parameters a polynomial that both interpolations
//! reproduce (1, Ca, a/l, (a/l)^2), so that a model must return it at any query.

use std::collections::HashMap;

use capsule_database::{Mesh, Status, Trajectory};

/// An octahedral geodesic mesh of the unit sphere with `8 n^2` elements.
pub fn octahedral(n: i32) -> Mesh {
    let m = 2 * n;
    let mut nodes = Vec::new();
    let mut index = HashMap::new();
    let mut node = |p: [i32; 3]| -> u32 {
        *index.entry(p).or_insert_with(|| {
            let s = p.map(|k| (std::f64::consts::FRAC_PI_2 * f64::from(k) / f64::from(m)).sin());
            let norm = (s[0] * s[0] + s[1] * s[1] + s[2] * s[2]).sqrt();
            nodes.push(s.map(|c| c / norm));
            nodes.len() as u32 - 1
        })
    };
    let mut elements = Vec::new();
    for octant in 0..8 {
        let sign = [0, 1, 2].map(|d| if octant >> d & 1 == 0 { 1 } else { -1 });
        let flipped = sign.iter().product::<i32>() < 0;
        let mut triangle = |a: [i32; 2], b: [i32; 2], c: [i32; 2]| {
            let [a, b, c] = if flipped { [a, c, b] } else { [a, b, c] };
            let point = |p: [i32; 2]| [sign[0] * p[0], sign[1] * p[1], sign[2] * (m - p[0] - p[1])];
            let middle = |p: [i32; 2], q: [i32; 2]| [(p[0] + q[0]) / 2, (p[1] + q[1]) / 2];
            elements.push([a, b, c, middle(a, b), middle(b, c), middle(c, a)].map(|p| node(point(p))));
        };
        for i in (0..m).step_by(2) {
            for j in (0..m - i).step_by(2) {
                triangle([i, j], [i + 2, j], [i, j + 2]);
                if i + j + 2 < m {
                    triangle([i + 2, j], [i + 2, j + 2], [i, j + 2]);
                }
            }
        }
    }
    Mesh { nodes, elements }
}

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
