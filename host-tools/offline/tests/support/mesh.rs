//! A mesh for tests.

use std::collections::HashMap;

use capsule_database::Mesh;

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
